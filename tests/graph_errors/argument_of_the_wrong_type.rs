use reflex::dataflow::graph;

fn summed(x: f32, y: f32) -> f32 {
    x + y
}

graph! {
    struct Graph;

    input rate: f32, at 1000 Hz, gates;
    input armed: bool, at 10 Hz, joins;
    output command: f32 = summed(rate, armed);
}

fn main() {}
