use reflex::dataflow::graph;

fn copied(x: f32) -> f32 {
    x
}

use reflex::time::micros;

graph! {
    struct Graph;

    input rate: f32, every micros(0), joins;
    output command: f32 = copied(rate);
}

fn main() {}
