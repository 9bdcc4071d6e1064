use reflex::dataflow::graph;

graph! {
    struct Graph;

    input rate: f32, at 1000 Hz, gates;
    output command: f32 = rate + f32::from(matches!(rate, 0.0..1.0));
}

fn main() {}
