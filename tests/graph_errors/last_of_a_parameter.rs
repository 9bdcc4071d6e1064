use reflex::dataflow::graph;

graph! {
    struct Graph;

    param gain: f32;
    input rate: f32, at 1000 Hz, gates;
    state level: f32 = level + last gain * rate, clocked by rate;
    output command: f32 = level * gain;
}

fn main() {}
