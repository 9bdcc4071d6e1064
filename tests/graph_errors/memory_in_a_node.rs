use reflex::dataflow::graph;

fn copied(x: f32) -> f32 {
    x
}

fn summed(x: f32, y: f32) -> f32 {
    x + y
}

graph! {
    struct Graph;

    input rate: f32, at 1000 Hz, gates;
    node change: f32 = summed(rate, last change);
    output command: f32 = copied(change);
}

fn main() {}
