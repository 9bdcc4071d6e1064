use reflex::dataflow::graph;

graph! {
    struct Graph;

    param gain: f32;
    param shift: f32 = gain * rate;
    input rate: f32, at 1000 Hz, gates;
    output command: f32 = rate + shift;
}

fn main() {}
