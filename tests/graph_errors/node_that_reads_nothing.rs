use reflex::dataflow::graph;

fn summed(x: f32, y: f32) -> f32 {
    x + y
}

fn zero() -> f32 {
    0.0
}

graph! {
    struct Graph;

    input rate: f32, at 1000 Hz, gates;
    node level: f32 = zero();
    output command: f32 = summed(rate, level);
}

fn main() {}
