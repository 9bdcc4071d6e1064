//! A graph known to be right, with the order in which its values are computed.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::Ident;
use syn::{Error, Result};

use crate::expression::Expression;
use crate::graph::{Computed, Gates, Graph, Rate, Value};

/// As many values as fit the word of dirty marks.
const MOST_VALUES: usize = 32;

/// A checked graph.
pub struct Plan<'a> {
    /// What was declared.
    pub graph: &'a Graph,
    /// Places in `graph.values` of the values with an expression, each behind all that it reads.
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

    /// The parameters, each behind those that it is made of.
    pub fn params(&self) -> impl Iterator<Item = &'a Value> {
        let given = self.graph.values.iter();
        let given = given.filter(|it| it.is_param() && it.expression().is_none());
        given.chain(self.derived_params().map(|(value, _)| value))
    }

    /// The parameters that are made of others, in an order in which they can be.
    pub fn derived_params(&self) -> impl Iterator<Item = (&'a Value, &'a Expression)> {
        self.order.iter().filter_map(|place| {
            let value = &self.graph.values[*place];
            let derivation = value.expression().filter(|_| value.is_param());
            derivation.map(|derivation| (value, derivation))
        })
    }

    /// The values that a change can reach, in the order of the lines: each has a mark.
    pub fn marked(&self) -> impl Iterator<Item = &'a Value> {
        self.graph.values.iter().filter(|it| !it.is_param())
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
    ///
    /// A parameter makes none run.
    pub fn wakes(&self, value: &'a Value) -> Vec<&'a Value> {
        let names: Vec<&Ident> = match (value.clock(), value.computed()) {
            (Some(clock), _) => vec![clock],
            (None, Some(computed)) => computed.reads().map(|it| &it.name).collect(),
            (None, None) => Vec::new(),
        };
        let places: BTreeSet<usize> = names.into_iter().map(|name| self.place(name)).collect();
        let values = places.into_iter().map(|place| &self.graph.values[place]);
        values.filter(|value| !value.is_param()).collect()
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
                && let Some(expression) = self.graph.values[place].expression()
            {
                waiting.extend(expression.reads.iter().map(|it| self.place(&it.name)));
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
            .any(|(_, it)| it.reads().any(|it| it.last && it.name == *name))
    }

    /// True where the input advances a state: then the same value is a new sample.
    pub fn is_clock(&self, name: &Ident) -> bool {
        self.graph.values.iter().any(|it| it.clock() == Some(name))
    }

    fn check_names(&self, value: &Value) -> Result<()> {
        let Some(expression) = value.expression() else {
            return Ok(());
        };
        for read in &expression.reads {
            self.check_declared(&read.name)?;
        }
        if let Some(name) = expression.bound.iter().find(|it| self.is_declared(it)) {
            let message =
                format!("`{name}` names a value of the graph: call it something else here");
            return Err(Error::new(name.span(), message));
        }
        if value.is_param() {
            return self.check_derived(value, expression);
        }
        let mut reads = expression.reads.iter();
        if reads.all(|read| self.value(&read.name).is_param()) {
            let message = if expression.reads.is_empty() {
                "reads nothing: what never changes belongs into a `const`"
            } else {
                "reads parameters alone: what is made of them is a `param` too"
            };
            let message = format!("`{}` {message}", value.name);
            return Err(Error::new(value.name.span(), message));
        }
        for read in expression.reads.iter().filter(|read| read.last) {
            self.check_last(value, &read.name)?;
        }
        match value.clock() {
            Some(clock) => self.check_clock(clock),
            None => Ok(()),
        }
    }

    /// A parameter is made of parameters.
    fn check_derived(&self, value: &Value, derivation: &Expression) -> Result<()> {
        let mut reads = derivation.reads.iter();
        let Some(read) = reads.find(|it| it.last || !self.value(&it.name).is_param()) else {
            return Ok(());
        };
        let message = format!(
            "parameter `{}` is made of other parameters alone, and `{}` is none",
            value.name, read.name
        );
        Err(Error::new(read.name.span(), message))
    }

    /// What was is read by states alone, and kept of computed values alone.
    fn check_last(&self, value: &Value, name: &Ident) -> Result<()> {
        let message = if value.clock().is_none() {
            format!(
                "only a state may read `last {name}`: in `{}` it would be memory without a clock",
                value.name
            )
        } else if self.value(name).input().is_some() {
            format!("`last {name}` is not kept, `{name}` is an input: let a state remember it")
        } else if self.value(name).is_param() {
            format!("`last {name}` is not kept, `{name}` is a parameter: no run changes it")
        } else {
            return Ok(());
        };
        Err(Error::new(name.span(), message))
    }

    fn is_declared(&self, name: &Ident) -> bool {
        self.places.contains_key(&name.to_string())
    }

    fn check_declared(&self, name: &Ident) -> Result<()> {
        if self.is_declared(name) {
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
            .filter(|place| values[*place].expression().is_none())
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
        let reads = value.expression().into_iter().flat_map(|it| &it.reads);
        let own = |name: &Ident| value.clock().is_some() && *name == value.name;
        reads
            .filter(|read| !read.last && !own(&read.name))
            .map(|read| self.place(&read.name))
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
    let mut marked = graph.values.iter().filter(|it| !it.is_param());
    if let Some(value) = marked.nth(MOST_VALUES) {
        let message = format!("more than {MOST_VALUES} values that change: split the graph");
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
