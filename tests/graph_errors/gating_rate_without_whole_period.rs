use reflex::dataflow::graph;

fn copied(x: f32) -> f32 {
    x
}

graph! {
    struct Graph;

    input rate: f32, at 30 Hz, gates;
    output command: f32 = copied(rate);
}

fn main() {}
