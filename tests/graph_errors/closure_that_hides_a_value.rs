use reflex::dataflow::graph;

graph! {
    struct Graph;

    input rate: f32, at 1000 Hz, gates;
    output command: f32 = Some(rate).map_or(0.0, |rate| -rate);
}

fn main() {}
