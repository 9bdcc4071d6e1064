use reflex::dataflow::graph;

fn summed(x: f32, y: f32) -> f32 {
    x + y
}

use reflex::time::micros;

graph! {
    struct Graph;

    input rate: f32, at 1000 Hz, gates;
    input height: f32, every micros(33_333), gates;
    output command: f32 = summed(rate, height);
}

fn main() {}
