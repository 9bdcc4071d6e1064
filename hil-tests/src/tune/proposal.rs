//! The change of `config/` that pays most, as a diff that `git apply` takes.

use anyhow::{Context, Result};
use schemars::JsonSchema;
use serde::Serialize;
use similar::TextDiff;
use toml_edit::{DocumentMut, Item, Value};

use super::tried::Tried;
use crate::toolchain;

/// The file that all tuned values are in, from the project's folder.
const FILE: &str = "config/reactive.toml";

/// A change that pays.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Proposal {
    /// What it changes, as `table.key`.
    pub value: String,
    /// The configured value, in TOML.
    pub from: String,
    /// The proposed one.
    pub to: String,
    /// A unified diff of the file in `config/`.
    pub diff: String,
}

/// The value that pays most: whose sure gain is the largest.
///
/// # Errors
/// The configuration's file cannot be read, or holds no such value any more.
pub(super) fn of(values: &[Tried]) -> Result<Option<Proposal>> {
    let paying = values.iter().filter(|tried| tried.pays);
    let Some(best) = paying.min_by(|one, other| sure_change(one).total_cmp(&sure_change(other)))
    else {
        return Ok(None);
    };
    let path = toolchain::root().join(FILE);
    let text = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    Ok(Some(Proposal {
        value: best.path(),
        from: best.from.clone(),
        to: best.to.clone(),
        diff: diff(&text, best).with_context(|| path.display().to_string())?,
    }))
}

/// The change of runs or deviation, %, that the better of the two surely reaches.
fn sure_change(tried: &Tried) -> f64 {
    let most = [tried.runs, tried.strayed].map(|effect| effect?.at_most());
    most.into_iter().flatten().fold(0.0, f64::min)
}

/// The text with one value changed, as a diff: comments stay.
pub(super) fn diff(text: &str, tried: &Tried) -> Result<String> {
    let mut document: DocumentMut = text.parse().context("is no TOML")?;
    let mut item: &mut Item = document.as_item_mut();
    for table in tried.section.split('.') {
        item = item
            .get_mut(table)
            .with_context(|| format!("has no table [{}]", tried.section))?;
    }
    let missing = || format!("has no value {}", tried.path());
    let value = item.get_mut(&tried.key).and_then(Item::as_value_mut);
    let value = value.with_context(missing)?;
    let mut new: Value = tried.to.parse().context("is no value of TOML")?;
    *new.decor_mut() = value.decor().clone();
    *value = new;
    let changed = document.to_string();
    let diff = TextDiff::from_lines(text, &changed);
    let mut diff = diff.unified_diff();
    let names = (format!("a/{FILE}"), format!("b/{FILE}"));
    Ok(diff.header(&names.0, &names.1).to_string())
}
