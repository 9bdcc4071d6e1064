//! A graph known to be right, with the order in which its values are computed.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::Ident;
use syn::{Error, Result};

use crate::graph::{Argument, Computed, Gates, Graph, Rate, Source, Value};

/// As many values as fit the word of dirty marks.
const MOST_VALUES: usize = 32;

/// A checked graph.
pub struct Plan<'a> {
    pub graph: &'a Graph,
    /// Places in `graph.values` of the computed values, each behind all that it reads.
    order: Vec<usize>,
    places: BTreeMap<String, usize>,
}

impl<'a> Plan<'a> {
    /// Checks and orders a graph.
    ///
    /// # Errors
    /// What is wrong, in the words of the declaration and at its line: a name that is declared
    /// twice or not at all, a cycle, a state without a clock, a value that no output needs.
    pub fn of(graph: &'a Graph) -> Result<Self> {
        let places = places(graph)?;
        let mut plan = Self {
            graph,
            order: Vec::new(),
            places,
        };
        for value in &graph.values {
            plan.check_names(value)?;
            check_constants(value)?;
        }
        plan.order = plan.ordered()?;
        plan.check_used()?;
        Ok(plan)
    }

    /// The inputs, in the order of the lines.
    pub fn inputs(&self) -> impl Iterator<Item = &'a Value> {
        self.graph.values.iter().filter(|it| it.input().is_some())
    }

    /// The computed values, each behind all that it reads.
    pub fn computed(&self) -> impl Iterator<Item = (&'a Value, &'a Computed)> {
        self.order.iter().filter_map(|place| {
            let value = &self.graph.values[*place];
            value.computed().map(|computed| (value, computed))
        })
    }

    /// The place of a declared value in the order of the lines.
    pub fn place(&self, name: &Ident) -> usize {
        self.places[&name.to_string()]
    }

    /// A declared value.
    pub fn value(&self, name: &Ident) -> &'a Value {
        &self.graph.values[self.place(name)]
    }

    /// The values whose change makes another one run: its clock, or else all that it reads.
    pub fn wakes(&self, value: &'a Value) -> Vec<&'a Value> {
        let names: Vec<&Ident> = match (value.clock(), value.computed()) {
            (Some(clock), _) => vec![clock],
            (None, Some(computed)) => computed.arguments.iter().map(|it| &it.name).collect(),
            (None, None) => Vec::new(),
        };
        let places: BTreeSet<usize> = names.into_iter().map(|name| self.place(name)).collect();
        places
            .into_iter()
            .map(|place| &self.graph.values[place])
            .collect()
    }

    /// The inputs that can, through others, make a value run.
    pub fn inputs_behind(&self, value: &'a Value) -> BTreeSet<usize> {
        if value.input().is_some() {
            return BTreeSet::from([self.place(&value.name)]);
        }
        self.wakes(value)
            .into_iter()
            .flat_map(|waker| self.inputs_behind(waker))
            .collect()
    }

    /// The values read in computing these, and those read in computing them, and so on.
    pub fn needed_by(&self, values: impl Iterator<Item = &'a Value>) -> BTreeSet<usize> {
        let mut waiting: Vec<usize> = values.map(|value| self.place(&value.name)).collect();
        let mut needed = BTreeSet::new();
        while let Some(place) = waiting.pop() {
            if needed.insert(place)
                && let Some(computed) = self.graph.values[place].computed()
            {
                waiting.extend(computed.arguments.iter().map(|it| self.place(&it.name)));
                let clock = self.graph.values[place].clock();
                waiting.extend(clock.map(|clock| self.place(clock)));
            }
        }
        needed
    }

    /// The values that must be computed for this one, of the same run, with itself.
    pub fn needed_now(&self, value: &Value) -> BTreeSet<usize> {
        let mut waiting = vec![self.place(&value.name)];
        let mut needed = BTreeSet::new();
        while let Some(place) = waiting.pop() {
            if needed.insert(place) {
                waiting.extend(self.read_now(place));
            }
        }
        needed
    }

    /// True where a state reads this value as it was before the run.
    pub fn is_remembered(&self, name: &Ident) -> bool {
        self.computed()
            .any(|(_, it)| it.arguments.iter().any(|it| it.last && it.name == *name))
    }

    /// True where the input advances a state: then the same value is a new sample.
    pub fn is_clock(&self, name: &Ident) -> bool {
        self.graph.values.iter().any(|it| it.clock() == Some(name))
    }

    fn check_names(&self, value: &Value) -> Result<()> {
        let Some(computed) = value.computed() else {
            return Ok(());
        };
        if computed.arguments.is_empty() {
            let message = format!(
                "`{}` reads nothing: what never changes belongs into a `const`",
                value.name
            );
            return Err(Error::new(value.name.span(), message));
        }
        for argument in &computed.arguments {
            self.check_declared(&argument.name)?;
            if argument.last && value.clock().is_none() {
                let message = format!(
                    "only a state may read `last {0}`: in `{1}` it would be memory without a clock",
                    argument.name, value.name
                );
                return Err(Error::new(argument.name.span(), message));
            }
        }
        let mut read_before = computed.arguments.iter().filter(|it| it.last);
        if let Some(argument) = read_before.find(|it| self.value(&it.name).input().is_some()) {
            let message = format!(
                "`last {0}` is not kept, `{0}` is an input: let a state remember it",
                argument.name
            );
            return Err(Error::new(argument.name.span(), message));
        }
        match value.clock() {
            Some(clock) => self.check_clock(clock),
            None => Ok(()),
        }
    }

    fn check_declared(&self, name: &Ident) -> Result<()> {
        if self.places.contains_key(&name.to_string()) {
            return Ok(());
        }
        let known: Vec<String> = self
            .graph
            .values
            .iter()
            .map(|it| it.name.to_string())
            .collect();
        let message = format!(
            "`{name}` is not declared in this graph; declared are {}",
            known.join(", ")
        );
        Err(Error::new(name.span(), message))
    }

    fn check_clock(&self, clock: &Ident) -> Result<()> {
        self.check_declared(clock)?;
        if self.value(clock).input().is_some() {
            return Ok(());
        }
        let inputs: Vec<String> = self.inputs().map(|it| it.name.to_string()).collect();
        let message = format!(
            "`{clock}` cannot clock a state: only an input ticks, which are {}",
            inputs.join(", ")
        );
        Err(Error::new(clock.span(), message))
    }

    /// Always the first line next whose values are all there: the same order for the same graph.
    fn ordered(&self) -> Result<Vec<usize>> {
        let values = &self.graph.values;
        let mut ready: BTreeSet<usize> = (0..values.len())
            .filter(|place| values[*place].input().is_some())
            .collect();
        let mut order = Vec::new();
        while ready.len() < values.len() {
            let next = (0..values.len())
                .find(|place| !ready.contains(place) && self.read_now(*place).is_subset(&ready));
            let Some(next) = next else {
                return Err(self.cycle(&ready));
            };
            ready.insert(next);
            order.push(next);
        }
        Ok(order)
    }

    /// Places of the values that must be computed before this one.
    fn read_now(&self, place: usize) -> BTreeSet<usize> {
        let value = &self.graph.values[place];
        let Source::Computed(computed) = &value.source else {
            return BTreeSet::new();
        };
        let read_now = |argument: &&Argument| {
            let own = value.clock().is_some() && argument.name == value.name;
            !argument.last && !own
        };
        computed
            .arguments
            .iter()
            .filter(read_now)
            .map(|argument| self.place(&argument.name))
            .collect()
    }

    /// The error of a graph in which none of the values that are left can be first.
    fn cycle(&self, ready: &BTreeSet<usize>) -> Error {
        let left = |place: &usize| !ready.contains(place);
        let mut path: Vec<usize> = (0..self.graph.values.len())
            .find(left)
            .into_iter()
            .collect();
        // Every value that is left reads one that is left, so the walk must come back.
        let first = loop {
            let at = path[path.len() - 1];
            let next = self.read_now(at).into_iter().find(left).unwrap_or(at);
            if let Some(first) = path.iter().position(|place| *place == next) {
                break first;
            }
            path.push(next);
        };
        let names: Vec<String> = path[first..]
            .iter()
            .chain([&path[first]])
            .map(|place| format!("`{}`", self.graph.values[*place].name))
            .collect();
        let message = format!(
            "a cycle: {}; let a state read the value of the run before with `last NAME`",
            names.join(" reads ")
        );
        Error::new(self.graph.values[path[first]].name.span(), message)
    }

    fn check_used(&self) -> Result<()> {
        let outputs = || self.graph.values.iter().filter(|it| it.is_output());
        if outputs().next().is_none() {
            let message = format!("`{}` has no output", self.graph.name);
            return Err(Error::new(self.graph.name.span(), message));
        }
        let needed = self.needed_by(outputs());
        let mut unused = self.graph.values.iter().enumerate();
        match unused.find(|(place, _)| !needed.contains(place)) {
            None => Ok(()),
            Some((_, value)) => {
                let message = format!(
                    "`{0}` reaches no output: remove it, or let something that does read it",
                    value.name
                );
                Err(Error::new(value.name.span(), message))
            }
        }
    }
}

/// Names that the generated type needs for itself.
const RESERVED: [&str; 7] = [
    "default",
    "dirty",
    "description",
    "hyperperiod",
    "inputs",
    "new",
    "propagate",
];

/// Where each name is declared; no name twice.
fn places(graph: &Graph) -> Result<BTreeMap<String, usize>> {
    let mut places = BTreeMap::new();
    for (place, value) in graph.values.iter().enumerate() {
        if RESERVED.contains(&value.name.to_string().as_str()) {
            let message = format!("`{}` names something else in every graph", value.name);
            return Err(Error::new(value.name.span(), message));
        }
        if let Some(first) = places.insert(value.name.to_string(), place) {
            let message = format!("`{}` is written by two lines", value.name);
            let mut error = Error::new(value.name.span(), message);
            let before = &graph.values[first].name;
            error.combine(Error::new(before.span(), "the first one is here"));
            return Err(error);
        }
    }
    if let Some(value) = graph.values.get(MOST_VALUES) {
        let message = format!("more than {MOST_VALUES} values: split the graph");
        return Err(Error::new(value.name.span(), message));
    }
    Ok(places)
}

/// What can be seen of constants before they are evaluated.
fn check_constants(value: &Value) -> Result<()> {
    let Some(input) = value.input() else {
        return Ok(());
    };
    let Rate::Hertz { number, literal } = &input.rate else {
        return Ok(());
    };
    let whole = (1e6 / number).fract() == 0.0;
    if whole || matches!(input.gates, Gates::Never) {
        return Ok(());
    }
    let message = format!(
        "`{}` gates, so its period must be whole microseconds: say `every PERIOD`",
        value.name
    );
    Err(Error::new(literal.span(), message))
}
