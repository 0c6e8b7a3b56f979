//! All that is wrong with the form of a scenario: keys, kinds of values, choices.
//!
//! A reader that builds typed structs stops at its first mistake. So what is mistaken is cut out of the tree and the rest read
//! again, until nothing more is found. A cut leaves a gap, and what is said of a gap is not said to the user. A slip of the pen in a key
//! leaves none: what was meant stands there then.
//!
//! Once the form is sound, values can be looked at as well.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::document::Document;
use super::fault::Fault;
use super::kinds::Kinds;
use super::network_problem::NetworkProblem;
use super::problem::ScenarioProblem;
use super::scope::nearest_here;
use super::value_problem::ValueProblem;
use crate::SourceText;
use crate::wording::nearest;

/// No more are told at once.
const MOST: usize = 20;

/// What else is wrong with the form of a scenario.
pub(super) struct Others<'i> {
    /// In the order of the file.
    pub(super) found: Vec<Fault>,
    /// The scenario with all of it mended, if nothing had to be cut out but keys that nothing reads.
    pub(super) mended: Option<Document<'i>>,
    gaps: Gaps,
}

/// What may be missed, or wrong, only because of what was mended.
#[derive(Default)]
struct Gaps {
    /// Keys that were cut out.
    cut: Vec<String>,
    /// Places of the values under keys that were guessed.
    guessed: Vec<Range<usize>>,
}

impl Others<'_> {
    /// With what is wrong with the values of the mended scenario, unless it may be wrong only because of what was cut out.
    pub(super) fn with(mut self, mut values: Fault) -> Vec<Fault> {
        let further = std::mem::take(&mut values.others);
        let told = std::iter::once(values).chain(further).filter(|fault| !self.gaps.explain(fault));
        self.found.extend(told);
        self.found
    }
}

/// What else is wrong with the form of the scenario.
pub(super) fn others<'i>(first: &Fault, source: &'i SourceText, kinds: &Kinds) -> Others<'i> {
    let mut others = Others { found: Vec::new(), mended: None, gaps: Gaps::default() };
    let Ok(mut document) = Document::parse(source) else { return others };
    let mut is_whole = true;
    let mut last = Step::of(first);
    // Every step makes the tree smaller or what is unknown less; those that are not told count too.
    for _ in 0..10 * MOST {
        let Some(step) = last.take() else { break };
        let guessed = step.meant.and_then(|meant| renamed(document.root_mut(), &step.span, &meant));
        if let Some(value) = guessed {
            others.gaps.guessed.push(value);
        } else {
            let Some(key) = without(document.root_mut(), &step.span) else { break };
            others.gaps.cut.push(key);
            is_whole &= step.is_spare;
        }
        let fault = match document.file(kinds) {
            Ok(_) => {
                others.mended = Some(document).filter(|_| is_whole);
                break;
            }
            Err(fault) => fault,
        };
        last = Step::of(&fault);
        if !others.gaps.explain(&fault) {
            others.found.push(fault);
        }
        if others.found.len() == MOST {
            break;
        }
    }
    others.found.sort_by_key(|fault| fault.span.as_ref().map_or(0, |span| span.start));
    others
}

/// How a mistake is mended so that the rest can be read.
struct Step {
    span: Range<usize>,
    /// The key that was meant.
    meant: Option<String>,
    /// Whether nothing reads what is cut out.
    is_spare: bool,
}

impl Step {
    fn of(fault: &Fault) -> Option<Step> {
        let (meant, is_spare) = match &*fault.problem {
            ScenarioProblem::Value(ValueProblem::UnknownKey { key, allowed }) => {
                (nearest(key, allowed.iter().copied()), true)
            }
            _ => (None, false),
        };
        Some(Step { span: fault.span.clone()?, meant, is_spare })
    }
}

/// Gives the key that stands at `span` another name, unless there is one of that name already; the place of its value.
fn renamed(value: &mut DeValue<'_>, span: &Range<usize>, meant: &str) -> Option<Range<usize>> {
    match value {
        DeValue::Table(table) => {
            let inner = table.iter_mut().find_map(|(_, value)| renamed(value.get_mut(), span, meant));
            if inner.is_some() || table.contains_key(meant) {
                return inner;
            }
            let key = table.keys().find(|key| key.span() == *span)?.get_ref().to_string();
            let value = table.remove(key.as_str())?;
            let place = value.span();
            table.insert(Spanned::new(span.clone(), meant.to_owned().into()), value);
            Some(place)
        }
        DeValue::Array(list) => list.iter_mut().find_map(|entry| renamed(entry.get_mut(), span, meant)),
        _ => None,
    }
}

impl Gaps {
    fn explain(&self, fault: &Fault) -> bool {
        match &*fault.problem {
            // Under this name or as a slip of it.
            ScenarioProblem::Value(ValueProblem::MissingKey { key }) => {
                let is_whole = fault.span.is_none();
                // What a whole file lacks is not told beside a wish for what is not modelled.
                self.cut.iter().any(|cut| nearest(cut, [*key]).is_some() || is_whole && nearest_here(cut).is_some())
            }
            ScenarioProblem::Value(ValueProblem::NoChoice { .. } | ValueProblem::Empty { .. }) => true,
            // What does not go together may have been meant otherwise.
            ScenarioProblem::Network(NetworkProblem::Missing) | ScenarioProblem::Setup(_) => !self.cut.is_empty(),
            _ => fault.span.as_ref().is_some_and(|span| self.guessed.contains(span)),
        }
    }
}

/// Cuts out the entry whose key or value stands at `span`; its key.
fn without(value: &mut DeValue<'_>, span: &Range<usize>) -> Option<String> {
    match value {
        DeValue::Table(table) => without_entry(table, span),
        DeValue::Array(list) => without_element(list, span),
        _ => None,
    }
}

fn without_entry(table: &mut DeTable<'_>, span: &Range<usize>) -> Option<String> {
    for (_, value) in table.iter_mut() {
        let cut = without(value.get_mut(), span);
        if cut.is_some() {
            return cut;
        }
    }
    let is_here = |value: &Spanned<DeValue<'_>>| value.span() == *span || is_in_list(value, span);
    let found = table.iter().find(|(key, value)| key.span() == *span || is_here(value));
    let key = found.map(|(key, _)| key.get_ref().to_string())?;
    table.remove(key.as_str()).map(|_| key)
}

/// Whether `span` is of an entry of a list, at any depth, or of part of a text. Lists are cut out whole: their lengths mean something.
fn is_in_list(value: &Spanned<DeValue<'_>>, span: &Range<usize>) -> bool {
    match value.get_ref() {
        DeValue::Array(list) => list.iter().any(|entry| entry.span() == *span || is_in_list(entry, span)),
        DeValue::String(_) => value.span().start <= span.start && span.end <= value.span().end,
        _ => false,
    }
}

/// Of a list of tables, `[[agents]]`, one is cut out; of what stands in them that alone.
fn without_element(list: &mut DeArray<'_>, span: &Range<usize>) -> Option<String> {
    let cut = list.iter_mut().find_map(|entry| without(entry.get_mut(), span));
    if cut.is_some() {
        return cut;
    }
    let at = list.iter().position(|entry| entry.get_ref().is_table() && entry.span() == *span)?;
    *list = list.iter().enumerate().filter(|(k, _)| *k != at).map(|(_, entry)| entry.clone()).collect();
    // Nothing is missed under the name of an entry.
    Some(String::new())
}
