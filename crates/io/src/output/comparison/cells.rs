//! Cells, and rows of them.

use super::super::text::number;
use super::{ComparedCell, ComparedRow, NONE, RowGroup};

/// Entries of a value that are said.
const MOST_ENTRIES: usize = 4;

impl ComparedCell {
    /// Words alone.
    pub(super) fn words(words: impl Into<String>) -> Self {
        ComparedCell { words: words.into(), value: None, unit: None, because: None }
    }

    /// Nothing, and why.
    pub(super) fn none(because: impl Into<String>) -> Self {
        ComparedCell { words: NONE.into(), value: None, unit: None, because: Some(because.into()) }
    }

    /// A number with its unit, which may be empty.
    pub(super) fn number(value: f64, unit: &str) -> Self {
        if !value.is_finite() {
            return ComparedCell::none("it is not a finite number");
        }
        let words = format!("{} {unit}", number(value)).trim_end().to_owned();
        ComparedCell { words, value: Some(value), unit: (!unit.is_empty()).then(|| unit.to_owned()), because: None }
    }

    /// The same with words behind it.
    pub(super) fn and(mut self, words: &str) -> Self {
        if self.because.is_none() && !words.is_empty() {
            self.words = format!("{}, {words}", self.words);
        }
        self
    }

    /// A value with an entry per axis; of many the first few.
    pub(super) fn entries(values: &[f64], unit: &str) -> Self {
        match values {
            [] => ComparedCell::none("there is no axis"),
            [one] => ComparedCell::number(*one, unit),
            _ => {
                let more = if values.len() > MOST_ENTRIES { ", …" } else { "" };
                let shown: Vec<String> = values.iter().take(MOST_ENTRIES).map(|value| number(*value)).collect();
                let words = format!("({}{more}) {unit}", shown.join(", "));
                ComparedCell {
                    unit: (!unit.is_empty()).then(|| unit.to_owned()),
                    ..ComparedCell::words(words.trim_end())
                }
            }
        }
    }
}

impl ComparedRow {
    /// A row whose cells are the same where they say the same.
    pub(super) fn of(group: RowGroup, key: &str, name: &str, cells: Vec<ComparedCell>) -> Self {
        let same = cells.windows(2).all(|pair| pair[0] == pair[1]);
        let mut units: Vec<&str> = cells.iter().filter_map(|cell| cell.unit.as_deref()).collect();
        units.sort_unstable();
        units.dedup();
        let note = (units.len() > 1).then(|| format!("units differ: {}", units.join(", ")));
        ComparedRow { key: key.into(), group, name: name.into(), same, note, cells }
    }

    /// The same, where `same` says of a run whether it is as the first in all that the words leave out.
    pub(super) fn unless(mut self, same: impl Fn(usize) -> bool) -> Self {
        for k in 1..self.cells.len() {
            if self.cells[k] == self.cells[0] && !same(k) {
                self.cells[k].words += ", with other numbers";
            }
        }
        self.same = self.cells.windows(2).all(|pair| pair[0] == pair[1]);
        self
    }
}
