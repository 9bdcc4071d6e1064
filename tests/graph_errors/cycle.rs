use reflex::dataflow::graph;

fn copied(x: f32) -> f32 {
    x
}

fn summed(x: f32, y: f32) -> f32 {
    x + y
}

graph! {
    struct Graph;

    input rate: f32, at 1000 Hz, gates;
    node error: f32 = summed(rate, wanted);
    node wanted: f32 = copied(torque);
    node torque: f32 = copied(error);
    output command: f32 = copied(torque);
}

fn main() {}
