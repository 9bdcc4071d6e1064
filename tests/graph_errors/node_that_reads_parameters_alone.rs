use reflex::dataflow::graph;

graph! {
    struct Graph;

    param gain: f32;
    input rate: f32, at 1000 Hz, gates;
    node doubled: f32 = 2.0 * gain;
    output command: f32 = rate * doubled;
}

fn main() {}
