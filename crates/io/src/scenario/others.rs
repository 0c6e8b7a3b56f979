//! All that is wrong with the form of a scenario: keys, kinds of values, choices.
//!
//! A reader that builds typed structs stops at its first mistake. So what is mistaken is cut out of the tree and the rest read
//! again, until nothing more is found. A cut leaves a gap, and what is said of a gap is not said to the user.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::document::Document;
use super::fault::Fault;
use super::kinds::Kinds;
use super::problem::ScenarioProblem;
use super::value_problem::ValueProblem;
use crate::SourceText;
use crate::wording::nearest;

/// No more are told at once.
const MOST: usize = 20;

/// What else is wrong with the form of the scenario, in the order of the file.
pub(super) fn others(first: &Fault, source: &SourceText, kinds: &Kinds) -> Vec<Fault> {
    let mut found = Vec::new();
    let Ok(mut document) = Document::parse(source) else { return found };
    let mut cut: Vec<String> = Vec::new();
    let mut span = first.span.clone();
    // Every cut makes the tree smaller; those that are not told count too.
    for _ in 0..10 * MOST {
        let Some(key) = span.take().and_then(|span| without(document.root_mut(), &span)) else { break };
        cut.push(key);
        let Err(fault) = document.file(kinds) else { break };
        span.clone_from(&fault.span);
        if !is_of_a_gap(&fault, &cut) {
            found.push(fault);
        }
        if found.len() == MOST {
            break;
        }
    }
    found.sort_by_key(|fault| fault.span.as_ref().map_or(0, |span| span.start));
    found
}

/// Whether something is missed that was cut out, under this name or as a slip of it.
fn is_of_a_gap(fault: &Fault, cut: &[String]) -> bool {
    match &*fault.problem {
        ScenarioProblem::Value(ValueProblem::MissingKey { key }) => {
            cut.iter().any(|cut| nearest(cut, [*key]).is_some())
        }
        ScenarioProblem::Value(ValueProblem::NoChoice { .. } | ValueProblem::Empty { .. }) => true,
        _ => false,
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
