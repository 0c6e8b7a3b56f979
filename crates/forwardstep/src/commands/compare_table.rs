//! The table of a comparison in the terminal.
//!
//! As wide as the terminal, and 80 columns in pipes. What is the same in all runs is said once, below a heading of its own; what is not known
//! stands as — with the reason at the end.

use std::io;

use forwardstep::io::output::{ComparedRow, Comparison, RowGroup};
use textwrap::{Options, WordSeparator, WordSplitter};

use crate::console::width_of;

/// In pipes, and of terminals that say nothing of themselves.
const USUAL: usize = 80;
/// The names of rows.
const NAMES: usize = 17;
/// Narrower columns cannot be read.
const NARROWEST: usize = 11;
/// Between columns.
const GAP: usize = 2;

/// The table in lines.
pub(crate) fn table(comparison: &Comparison) -> String {
    let width = width_of(&io::stdout()).unwrap_or(USUAL);
    in_width(comparison, width)
}

fn in_width(comparison: &Comparison, width: usize) -> String {
    let runs = comparison.runs.len();
    let column = (width.saturating_sub(NAMES) / runs.max(1)).saturating_sub(GAP).max(NARROWEST);
    let mut text = String::new();
    for run in &comparison.runs {
        text += &hanging(&format!("{}:", run.name), &run.title, width);
    }
    let same: Vec<&ComparedRow> = comparison.rows.iter().filter(|row| row.same).collect();
    if !same.is_empty() {
        text += if comparison.is_same() {
            "\nThe runs are the same in all that is compared\n"
        } else {
            "\nThe same in all\n"
        };
        for group in RowGroup::ALL {
            for row in same.iter().filter(|row| row.group == group) {
                let Some(cell) = row.cells.first() else { continue };
                let before = if group == RowGroup::Predicted { "predicted " } else { "" };
                let name = format!("{before}{}", row.name);
                text += &hanging(&name, cell.because.as_deref().map_or(cell.words.as_str(), |_| "—"), width);
            }
        }
    }
    if !comparison.is_same() {
        text += "\nDifferent\n";
        let names: Vec<&str> = comparison.runs.iter().map(|run| run.name.as_str()).collect();
        text += &line("", &names, column);
        for group in RowGroup::ALL {
            let rows: Vec<&ComparedRow> =
                comparison.rows.iter().filter(|row| row.group == group && !row.same).collect();
            if rows.is_empty() {
                continue;
            }
            text += &format!("{}\n", group.words());
            for row in rows {
                let cells: Vec<&str> = row.cells.iter().map(|cell| cell.words.as_str()).collect();
                text += &line(&format!("  {}", row.name), &cells, column);
            }
        }
    }
    text += &notes(comparison, width);
    text
}

/// Why a run, or all of them, has nothing to say in some rows, or why numbers of those are not to be compared.
struct Note {
    of: Option<String>,
    reason: String,
    rows: Vec<(RowGroup, String)>,
}

/// Why cells are empty, and which are not to be compared as numbers; each reason once for a run.
fn notes(comparison: &Comparison, width: usize) -> String {
    let mut notes: Vec<Note> = Vec::new();
    for row in &comparison.rows {
        let mut add = |of: Option<&str>, reason: &str| {
            let this = (row.group, row.name.clone());
            match notes.iter_mut().find(|note| note.of.as_deref() == of && note.reason == reason) {
                Some(note) => note.rows.push(this),
                None => notes.push(Note { of: of.map(Into::into), reason: reason.into(), rows: vec![this] }),
            }
        };
        if let Some(note) = &row.note {
            add(None, note);
        }
        let empty = row.cells.iter().zip(&comparison.runs);
        let empty: Vec<_> = empty.filter_map(|(cell, run)| Some((run, cell.because.as_deref()?))).collect();
        match empty.first() {
            Some((_, reason)) if row.same => add(None, reason),
            _ => empty.into_iter().for_each(|(run, reason)| add(Some(&run.name), reason)),
        }
    }
    let options = wrapping(width.max(USUAL / 2)).initial_indent("— ").subsequent_indent("  ");
    let mut text = String::from(if notes.is_empty() { "" } else { "\nNotes\n" });
    for Note { of, reason, rows } in notes {
        let in_group = |group: RowGroup| {
            let names: Vec<&str> = rows.iter().filter(|(of, _)| *of == group).map(|(_, name)| name.as_str()).collect();
            (!names.is_empty()).then(|| format!("{}: {}", group.words().to_lowercase(), names.join(", ")))
        };
        let about: Vec<String> = RowGroup::ALL.into_iter().filter_map(in_group).collect();
        let of = of.unwrap_or_else(|| "all".into());
        text += &(textwrap::fill(&format!("{of} ({}): {reason}", about.join("; ")), &options) + "\n");
    }
    text
}

/// A name and what it is, which goes on below itself.
fn hanging(name: &str, words: &str, width: usize) -> String {
    let indent = " ".repeat(NAMES);
    let name = if name.chars().count() < NAMES { format!("{name:<NAMES$}") } else { format!("{name} ") };
    let options = wrapping(width.max(USUAL / 2)).initial_indent(&name).subsequent_indent(&indent);
    textwrap::fill(words, options) + "\n"
}

fn wrapping<'a>(width: usize) -> Options<'a> {
    Options::new(width)
        .break_words(true)
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::HyphenSplitter)
}

/// One row; cells go on below themselves.
fn line(name: &str, cells: &[&str], column: usize) -> String {
    let wrapped: Vec<Vec<String>> = std::iter::once(textwrap::wrap(name, wrapping(NAMES - 1).subsequent_indent("  ")))
        .chain(cells.iter().map(|cell| textwrap::wrap(cell, wrapping(column))))
        .map(|lines| lines.into_iter().map(|line| line.into_owned()).collect())
        .collect();
    let height = wrapped.iter().map(Vec::len).max().unwrap_or(0);
    let mut text = String::new();
    for row in 0..height {
        let mut one = String::new();
        for (k, lines) in wrapped.iter().enumerate() {
            let part = lines.get(row).map_or("", String::as_str);
            let room = if k == 0 { NAMES } else { column + GAP };
            one += part;
            one += &" ".repeat(room.saturating_sub(textwrap::core::display_width(part)));
        }
        text += one.trim_end();
        text.push('\n');
    }
    text
}
