//! A problem on its way up, and the checks of single numbers that raise one.

use std::fmt;
use std::ops::Range;

use forwardstep_sim::quantity::{self, QuantityError};

use toml::Spanned;
use toml::de::DeValue;

use super::at::At;
use super::document::deepest;
use super::problem::ScenarioProblem;
use super::table::TableProblem;
use super::value_problem::ValueProblem;
use crate::SourceText;

/// So many mistakes of a table are told beside the first; the rest is counted.
const MOST_OTHERS: usize = 23;

/// A problem, and where once that is known.
#[derive(Debug)]
pub struct Fault {
    pub(super) problem: Box<ScenarioProblem>,
    pub(super) span: Option<Range<usize>>,
    /// The file that the span is of, if it is not the scenario.
    pub(super) source: Option<SourceText>,
    /// What else is wrong with the scenario.
    pub(super) others: Vec<Fault>,
}

impl Fault {
    /// A problem without a place.
    pub fn new(problem: impl Into<ScenarioProblem>) -> Self {
        Fault { problem: Box::new(problem.into()), span: None, source: None, others: Vec::new() }
    }

    /// Adds the place unless a closer one is known.
    pub fn at(mut self, span: &Range<usize>) -> Self {
        if self.source.is_none() {
            self.span.get_or_insert_with(|| span.clone());
        }
        self
    }

    /// Adds the place of a quantity whose path leads inwards from `table`, unless a place is known.
    pub(super) fn inside(self, table: &Spanned<DeValue<'_>>) -> Self {
        match &*self.problem {
            ScenarioProblem::Value(ValueProblem::Quantity(error)) => {
                let (_, span) = deepest(table, error.path.segments());
                self.at(&span)
            }
            _ => self,
        }
    }

    /// Adds what else is wrong with the scenario.
    pub(super) fn beside(mut self, others: Vec<Fault>) -> Self {
        self.others.extend(others);
        self
    }

    /// Says that the problem, and its place, are in another file than the scenario.
    pub(super) fn within(mut self, source: &SourceText) -> Self {
        self.source.get_or_insert_with(|| source.clone());
        self.others = self.others.into_iter().map(|other| other.within(source)).collect();
        self
    }
}

impl Fault {
    /// The same of a table that the scenario names: that it is none is said where it is named.
    pub(super) fn within_table(self, table: &SourceText, file: &At<String>) -> Self {
        match &*self.problem {
            ScenarioProblem::Table(TableProblem::Meant { .. }) => self.at(&file.span),
            _ => self.within(table),
        }
    }
}

/// The mistakes of one table, which are told together.
#[derive(Default)]
pub(super) struct Faults {
    found: Vec<Fault>,
    untold: usize,
}

impl Faults {
    /// What was read; a mistake is noted.
    pub(super) fn noted<T>(&mut self, read: Result<T, Fault>) -> Option<T> {
        match read {
            Ok(read) => return Some(read),
            Err(fault) if self.found.len() <= MOST_OTHERS => self.found.push(fault),
            Err(_) => self.untold += 1,
        }
        None
    }

    /// Notes a mistake, which is put into words only if it is told.
    pub(super) fn add(&mut self, fault: impl FnOnce() -> Fault) {
        if self.found.len() <= MOST_OTHERS {
            self.found.push(fault());
        } else {
            self.untold += 1;
        }
    }

    /// All of them as one, the first that was met in front and the others in the order of the file.
    pub(super) fn end(self) -> Result<(), Fault> {
        let mut found = self.found.into_iter();
        let Some(first) = found.next() else { return Ok(()) };
        let mut others: Vec<Fault> = found.collect();
        others.sort_by_key(|fault| fault.span.as_ref().map_or(0, |span| span.start));
        if self.untold > 0 {
            others.push(Fault::new(TableProblem::Further { count: self.untold }));
        }
        Err(first.beside(others))
    }
}

impl From<QuantityError> for Fault {
    fn from(error: QuantityError) -> Self {
        Fault::new(ValueProblem::Quantity(error))
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.problem.fmt(f)
    }
}

impl std::error::Error for Fault {}

/// A problem with a value.
pub fn fault<T>(value: &At<T>, problem: impl Into<ScenarioProblem>) -> Fault {
    Fault::new(problem).at(&value.span)
}

/// What was checked; the mistake is at `place`.
pub(super) fn checked<T>(place: &At<T>, checked: Result<(), QuantityError>) -> Result<(), Fault> {
    checked.map_err(|error| fault(place, ValueProblem::Quantity(error)))
}

/// A positive number. Messages call it `key`.
///
/// # Errors
/// The mistake, at its place.
pub fn positive(key: &'static str, number: &At<f64>) -> Result<f64, Fault> {
    checked(number, quantity::positive("", key, number.value)).map(|()| number.value)
}

/// A number, or the default one; what it must be is checked where its kind is built.
pub fn number_or(number: &Option<At<f64>>, usual: f64) -> f64 {
    number.as_ref().map_or(usual, |number| number.value)
}

/// A positive number, or the default one.
///
/// # Errors
/// The mistake, at its place.
pub fn positive_or(key: &'static str, number: &Option<At<f64>>, usual: f64) -> Result<f64, Fault> {
    number.as_ref().map_or(Ok(usual), |number| positive(key, number))
}

/// A number that is not negative, or the default one.
///
/// # Errors
/// The mistake, at its place.
pub fn not_negative_or(key: &'static str, number: &Option<At<f64>>, usual: f64) -> Result<f64, Fault> {
    number.as_ref().map_or(Ok(usual), |number| not_negative(key, number))
}

/// A number that is not negative.
///
/// # Errors
/// The mistake, at its place.
pub fn not_negative(key: &'static str, number: &At<f64>) -> Result<f64, Fault> {
    checked(number, quantity::not_negative("", key, number.value)).map(|()| number.value)
}

/// A number from `low` up to `high`.
///
/// # Errors
/// The mistake, at its place.
pub fn between(key: &'static str, number: &At<f64>, low: f64, high: f64) -> Result<f64, Fault> {
    checked(number, quantity::within("", key, number.value, low, high)).map(|()| number.value)
}

/// A whole number from one up to `most`.
///
/// # Errors
/// The mistake, at its place.
pub fn count(key: &'static str, number: &At<i64>, most: u32) -> Result<usize, Fault> {
    checked(number, quantity::within("", key, number.value as f64, 1.0, most.into()))?;
    // Within these bounds nothing is lost.
    Ok(number.value as usize)
}

/// A whole number from one up.
pub(super) fn positive_count(key: &'static str, number: &At<i64>) -> Result<u64, Fault> {
    checked(number, quantity::positive("", key, number.value as f64)).map(|()| number.value as u64)
}

pub(super) fn seed(number: &At<i64>) -> Result<u64, Fault> {
    checked(number, quantity::not_negative("", "seed", number.value as f64)).map(|()| number.value as u64)
}

/// A list with at least one entry.
///
/// # Errors
/// The mistake, at its place.
pub fn filled<'a, T>(key: &'static str, list: &'a At<Vec<T>>) -> Result<&'a [T], Fault> {
    if list.value.is_empty() { Err(fault(list, ValueProblem::Empty { key })) } else { Ok(&list.value) }
}

/// A list at `place` has as many entries as `whose` need.
///
/// # Errors
/// The mistake, at its place.
pub fn length(key: &'static str, place: &Range<usize>, found: usize, need: usize, whose: &str) -> Result<(), Fault> {
    if found == need {
        return Ok(());
    }
    Err(Fault::new(ValueProblem::VectorLength { key, found, need, agent: whose.to_owned() }).at(place))
}

/// The numbers of a list.
pub fn values(list: &[At<f64>]) -> Vec<f64> {
    list.iter().map(|number| number.value).collect()
}
