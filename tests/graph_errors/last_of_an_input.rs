use reflex::dataflow::graph;

fn summed(x: f32, y: f32) -> f32 {
    x + y
}

graph! {
    struct Graph;

    input rate: f32, at 1000 Hz, gates;
    state change: f32 = summed(rate, last rate), clocked by rate;
    output command: f32 = summed(rate, change);
}

fn main() {}
