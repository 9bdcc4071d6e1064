//! Makes up graphs: each as a declaration, and as the values that it must compute.

use std::fmt::Write;
use std::ops::Range;

use oorandom::Rand32;

/// A value of a graph; it reads only values that were made up before it.
struct Value {
    name: String,
    source: Source,
}

enum Source {
    /// Gates, at a period of so many ms.
    Input(u32),
    Node(Call),
    /// With the number of the input that clocks it.
    State(Call, usize),
    Output(Call),
}

/// A call of a made-up function, with its arguments.
struct Call {
    /// Every function adds its arguments with these weights, shifts, and keeps few of the bits.
    weights: [u32; 3],
    shift: u32,
    arguments: Vec<Argument>,
}

struct Argument {
    value: usize,
    last: bool,
    by_reference: bool,
}

/// A program of so many graphs, which ends with an error where one goes wrong.
pub fn program(graphs: u64, seed: u64) -> String {
    let mut text = String::from("#![allow(dead_code, unused_variables)]\n");
    text.push_str(include_str!("functions.rs"));
    for number in 0..graphs {
        let mut random = Rand32::new(seed.wrapping_mul(1000).wrapping_add(number));
        let values = made_up(&mut random);
        let _ = writeln!(text, "mod graph_{number} {{\n    use super::*;");
        text.push_str(&declaration(&values, &mut random));
        text.push_str(&expectation(&values));
        text.push_str(&comparison(&values));
        text.push_str("}\n");
    }
    text.push_str("fn main() {\n");
    for number in 0..graphs {
        let _ = writeln!(text, "    graph_{number}::compare({number});");
    }
    text.push_str("}\n");
    text
}

fn below(random: &mut Rand32, end: usize) -> usize {
    random.rand_range(0..end as u32) as usize
}

/// One to four inputs, up to 22 computed values, and an output that reads all ends.
fn made_up(random: &mut Rand32) -> Vec<Value> {
    let inputs = 1 + below(random, 4);
    let mut values: Vec<Value> = (0..inputs)
        .map(|number| Value {
            name: format!("input_{number}"),
            source: Source::Input([1, 2, 4, 5][below(random, 4)]),
        })
        .collect();
    let computed = 1 + below(random, 22);
    for number in inputs..inputs + computed {
        let is_state = below(random, 3) == 0;
        let call = call(random, number, is_state, inputs..inputs + computed);
        let source = if is_state {
            Source::State(call, below(random, inputs))
        } else {
            Source::Node(call)
        };
        let name = format!("value_{number}");
        values.push(Value { name, source });
    }
    close(values, random)
}

/// A call by the value of this number, of values before it, and of any computed one as it was.
fn call(random: &mut Rand32, number: usize, is_state: bool, computed: Range<usize>) -> Call {
    let mut arguments: Vec<Argument> = (0..1 + below(random, 3))
        .map(|_| Argument {
            value: below(random, number),
            last: false,
            by_reference: below(random, 2) == 0,
        })
        .collect();
    if is_state {
        arguments[0].value = number;
        if let Some(argument) = arguments.get_mut(1)
            && below(random, 2) == 0
        {
            argument.value = computed.start + below(random, computed.len());
            argument.last = true;
        }
    }
    Call {
        weights: [0; 3].map(|_| random.rand_range(1..16)),
        shift: random.rand_range(0..4),
        arguments,
    }
}

/// Adds outputs until every value is read by one that leads to an output.
fn close(mut values: Vec<Value>, random: &mut Rand32) -> Vec<Value> {
    loop {
        let needed = needed(&values);
        let unread: Vec<usize> = (0..values.len()).filter(|it| !needed[*it]).collect();
        let Some(newest) = unread.last() else {
            return values;
        };
        let arguments = [*newest].into_iter().chain(unread.first().copied());
        let call = Call {
            weights: [0; 3].map(|_| random.rand_range(1..16)),
            shift: random.rand_range(0..4),
            arguments: arguments
                .map(|value| Argument {
                    value,
                    last: false,
                    by_reference: false,
                })
                .collect(),
        };
        values.push(Value {
            name: format!("output_{}", values.len()),
            source: Source::Output(call),
        });
    }
}

fn needed(values: &[Value]) -> Vec<bool> {
    let mut needed: Vec<bool> = values
        .iter()
        .map(|it| matches!(it.source, Source::Output(_)))
        .collect();
    loop {
        let before = needed.clone();
        for (place, value) in values
            .iter()
            .enumerate()
            .filter(|(place, _)| before[*place])
        {
            debug_assert!(needed[place]);
            for argument in value.call().into_iter().flat_map(|it| &it.arguments) {
                needed[argument.value] = true;
            }
            if let Source::State(_, clock) = value.source {
                needed[clock] = true;
            }
        }
        if needed == before {
            return needed;
        }
    }
}

impl Value {
    fn call(&self) -> Option<&Call> {
        match &self.source {
            Source::Input(_) => None,
            Source::Node(call) | Source::State(call, _) | Source::Output(call) => Some(call),
        }
    }
}

impl Call {
    /// The function's name: how references and copies are taken, and what it computes.
    fn function(&self) -> String {
        let [a, b, c] = self.weights;
        format!("mixed::<{a}, {b}, {c}, {}>", self.shift)
    }
}

fn declaration(values: &[Value], random: &mut Rand32) -> String {
    let mut lines: Vec<String> = values.iter().map(|it| line(it, values)).collect();
    for place in (1..lines.len()).rev() {
        lines.swap(place, below(random, place + 1));
    }
    format!(
        "    graph! {{\n        pub struct Graph;\n{}    }}\n",
        lines.concat()
    )
}

fn line(value: &Value, values: &[Value]) -> String {
    let name = &value.name;
    let with = |call: &Call| {
        let arguments = call.arguments.iter().map(|argument| {
            let reference = if argument.by_reference { "&" } else { "" };
            let last = if argument.last { "last " } else { "" };
            format!("{reference}{last}{}", values[argument.value].name)
        });
        let kinds = call.arguments.iter().map(|it| it.by_reference);
        let kind: String = kinds.map(|it| if it { 'r' } else { 'c' }).collect();
        let function = call
            .function()
            .replacen("mixed", &format!("mixed_{kind}"), 1);
        format!("{function}({})", arguments.collect::<Vec<_>>().join(", "))
    };
    match &value.source {
        Source::Input(period) => {
            format!("        input {name}: u32, every micros({period}_000), gates;\n")
        }
        Source::Node(call) => format!("        node {name}: u32 = {};\n", with(call)),
        Source::Output(call) => format!("        output {name}: u32 = {};\n", with(call)),
        Source::State(call, clock) => format!(
            "        state {name}: u32 = {}, clocked by {}, starting 3;\n",
            with(call),
            values[*clock].name
        ),
    }
}

/// The same graph as plain code, in the order in which it was made up.
fn expectation(values: &[Value]) -> String {
    let mut text = format!(
        "    #[derive(Clone)]\n    struct Expected([u32; {0}]);\n    impl Expected {{\n        \
         fn step(&mut self, ticked: [bool; {0}], before: [u32; {0}], states: bool) {{\n",
        values.len()
    );
    for (place, value) in values.iter().enumerate() {
        let Some(call) = value.call() else { continue };
        let arguments = call.arguments.iter().map(|argument| {
            let from = if argument.last || argument.value == place {
                "before"
            } else {
                "self.0"
            };
            format!("{from}[{}]", argument.value)
        });
        let arguments = arguments.collect::<Vec<_>>().join(", ");
        let condition = match value.source {
            Source::State(_, clock) => format!("states && ticked[{clock}]"),
            _ => "true".to_owned(),
        };
        let _ = writeln!(
            text,
            "            if {condition} {{ self.0[{place}] = {}(&[{arguments}]); }}",
            call.function()
        );
    }
    text.push_str("        }\n    }\n");
    text
}

/// Sets random inputs again and again, and compares.
fn comparison(values: &[Value]) -> String {
    let count = values.len();
    let starting = values.iter().map(|it| match it.source {
        Source::State(..) => "3",
        _ => "0",
    });
    let starting = starting.collect::<Vec<_>>().join(", ");
    let mut text = format!(
        "    pub fn compare(seed: u64) {{\n        let mut random = Random(seed);\n        \
         let mut graph = Graph::new();\n        \
         let mut expected = Expected([{starting}]);\n        \
         expected.step([false; {count}], expected.0, false);\n        \
         for step in 0..2000 {{\n            \
         let before = expected.0;\n            let mut ticked = [false; {count}];\n"
    );
    for (place, value) in values.iter().enumerate() {
        if value.call().is_none() {
            let name = &value.name;
            let _ = writeln!(
                text,
                "            if random.below(3) > 0 {{ ticked[{place}] = true; \
                 expected.0[{place}] = random.below(4); graph.set_{name}(expected.0[{place}]); }}"
            );
        }
    }
    let _ = writeln!(text, "            expected.step(ticked, before, true);");
    for (place, value) in values.iter().enumerate() {
        if matches!(value.source, Source::Output(_)) {
            let name = &value.name;
            let _ = writeln!(
                text,
                "            assert_eq!(graph.foresee_{name}(), expected.0[{place}]);"
            );
        }
    }
    text.push_str("            let dirty = graph.propagate();\n");
    for (place, value) in values.iter().enumerate() {
        let (name, mark) = (&value.name, value.name.to_uppercase());
        let _ = writeln!(
            text,
            "            assert_eq!(*graph.{name}(), expected.0[{place}], \"{name}, step {{step}}\");\n            \
             assert!(dirty.any(Graph::{mark}) || expected.0[{place}] == before[{place}]);"
        );
    }
    text.push_str("        }\n    }\n");
    text
}
