use reflex::dataflow::graph;

fn copied(x: f32) -> f32 {
    x
}

graph! {
    struct Graph;

    input propagate: f32, at 1000 Hz, gates;
    output command: f32 = copied(propagate);
}

fn main() {}
