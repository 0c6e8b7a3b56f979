//! CSV tables that a scenario names: cells with their places, columns by name in any order.
//!
//! Cells are separated by commas; blanks around them do not count, nor do empty lines. A cell may stand in quotation marks,
//! `"a ""quoted"" cell"`, and then ends on its own line.

use std::borrow::Cow;
use std::ops::Range;

use forwardstep_sim::quantity::LARGEST;
use thiserror::Error;

use super::at::At;
use super::de::quoted;
use super::fault::{Fault, Faults, fault, values};
use super::inputs::InputFolder;
use super::push_problem::PushProblem;
use super::shipped::shipped_table;
use super::value_problem::ValueProblem;
use crate::files::ReadError;
use crate::wording::{beginning, choose, entry_count, more_mistakes};
use crate::{Meant, SourceText};

/// Why a table has no meaning.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TableProblem {
    /// A table that cannot be read.
    #[error("cannot read the table `{file}`: {reason}")]
    File {
        /// The name as written.
        file: String,
        /// Why not.
        reason: ReadError,
        /// What might be meant.
        known: Vec<String>,
    },
    /// Nothing at all.
    #[error("the table is empty")]
    NoHeader {
        /// The columns that are known.
        columns: Vec<String>,
    },
    /// A text that is clearly something else.
    #[error("this is {meant}, and no table")]
    Meant {
        /// What it is.
        meant: Meant,
        /// The columns that a table would have.
        columns: Vec<String>,
    },
    /// A column that means nothing here.
    #[error("unknown column `{name}`")]
    UnknownColumn {
        /// Its name.
        name: String,
        /// The columns that are known.
        columns: Vec<String>,
    },
    /// A column that must be there is not.
    #[error("the column `{name}` is missing")]
    MissingColumn {
        /// Its name.
        name: String,
        /// The columns that are known.
        columns: Vec<String>,
    },
    /// Two columns of one name.
    #[error("a second column is named `{name}`")]
    ColumnTwice {
        /// The name.
        name: String,
    },
    /// A line with more or fewer cells than there are columns.
    #[error("this line has {}, but there are {columns} columns", entry_count(*.found))]
    LineLength {
        /// How many cells.
        found: usize,
        /// How many columns.
        columns: usize,
    },
    /// Nothing where something must stand.
    #[error("`{name}` is empty")]
    EmptyCell {
        /// The column.
        name: String,
    },
    /// A quotation mark without its partner.
    #[error("this quotation mark is not closed on its line")]
    OpenQuote,
    /// Text behind a cell in quotation marks.
    #[error("found {found} behind a cell in quotation marks, where a comma or the end of the line should stand")]
    AfterQuote {
        /// What was found.
        found: String,
    },
    /// So many mistakes that only their number is told.
    #[error("{}", more_mistakes(*.count))]
    Further {
        /// How many more there are.
        count: usize,
    },
}

impl TableProblem {
    pub(super) fn help(&self) -> Option<String> {
        const HEADER: &str = "the first line names the columns;";
        match self {
            TableProblem::File { reason, .. } if reason.help().is_some() => reason.help().map(str::to_owned),
            TableProblem::File { file, known, .. } if !known.is_empty() => Some(choose(file, "there are", known)),
            TableProblem::NoHeader { columns }
            | TableProblem::Meant { columns, .. }
            | TableProblem::MissingColumn { columns, .. } => Some(choose("", &format!("{HEADER} they are"), columns)),
            TableProblem::UnknownColumn { name, columns } if name.contains([';', '\t', '|']) => {
                Some(choose("", "commas separate the columns of a table, which are", columns))
            }
            // What is short of its unit is nearer to that than to any other letter.
            TableProblem::UnknownColumn { name, columns } => {
                let short = |column: &&String| column.split_once('_').is_some_and(|(stem, _)| stem == name);
                let word = columns.iter().find(short).unwrap_or(name);
                Some(choose(word, &format!("{HEADER} they are"), columns))
            }
            TableProblem::OpenQuote => Some("a quotation mark inside a quoted cell is written twice: \"\"".into()),
            _ => None,
        }
    }
}

/// Of a name that no column has, so many characters are shown.
const LONGEST_NAME: usize = 40;

/// A column that a table may have.
#[derive(Clone, Copy)]
pub(super) struct Column {
    pub(super) name: &'static str,
    /// Whether the column must be there, with something in every line.
    pub(super) required: bool,
}

pub(super) type Cell<'a> = At<Cow<'a, str>>;

/// The text of a table beside the scenario, else of a shipped one.
pub(super) fn table_text(file: &At<String>, folder: &mut InputFolder) -> Result<SourceText, Fault> {
    let name = file.value.as_str();
    folder.text(name).or_else(|reason| match shipped_table(name) {
        Some(shipped) if reason == ReadError::Missing => Ok(SourceText::new(shipped.name, shipped.text)),
        _ => {
            let known = folder.neighbours(name, "csv");
            Err(fault(file, TableProblem::File { file: name.into(), reason, known }))
        }
    })
}

/// The lines of a table below its header, each with one cell per column of `columns`, in their order. A cell is empty where
/// its column is not there, or nothing stands in it; a required one never is, where no mistake is noted. Lines with a mistake are left out.
pub(super) fn read_table<'a, const N: usize>(
    text: &'a str,
    columns: [Column; N],
    faults: &mut Faults,
) -> Result<Vec<At<[Cell<'a>; N]>>, Fault> {
    let rows = read_rows(text, &columns.map(|Column { name, required }| (name, required)), faults)?;
    Ok(rows.into_iter().map(in_order).collect())
}

fn in_order<const N: usize>(row: At<Vec<Cell<'_>>>) -> At<[Cell<'_>; N]> {
    let At { value, span } = row;
    let mut cells = value.into_iter();
    let nothing = || At { value: Cow::Borrowed(""), span: span.clone() };
    At { value: std::array::from_fn(|_| cells.next().unwrap_or_else(nothing)), span }
}

/// The same for columns that are known only now, all of them required.
fn read_columns<'a>(text: &'a str, names: &[&str], faults: &mut Faults) -> Result<Vec<At<Vec<Cell<'a>>>>, Fault> {
    read_rows(text, &names.iter().map(|name| (*name, true)).collect::<Vec<_>>(), faults)
}

/// A table over time: its column `t_s`, which rises, and the numbers in the columns `names`, row after row.
pub(super) fn over_time(source: &SourceText, names: &[&str]) -> Result<(Vec<At<f64>>, Vec<f64>), Fault> {
    let columns: Vec<&str> = std::iter::once("t_s").chain(names.iter().copied()).collect();
    let numbers = || {
        let (mut times, mut numbers, mut faults) = (Vec::new(), Vec::new(), Faults::default());
        for row in read_columns(source.text(), &columns, &mut faults)? {
            for (k, cell) in row.value.iter().enumerate() {
                // The columns are required, so that no cell is empty where nothing is wrong.
                let Some(number) = faults.noted(cell_number(cell)).flatten() else { continue };
                if k == 0 {
                    times.push(number);
                } else {
                    numbers.push(number.value);
                }
            }
        }
        all_rising("t_s", &times, &mut faults);
        faults.end()?;
        Ok((times, numbers))
    };
    numbers().map_err(|fault: Fault| fault.within(source))
}

/// Times that rise.
pub(super) fn rising(key: &'static str, times: &[At<f64>]) -> Result<Vec<f64>, Fault> {
    falls(key, times).next().map_or_else(|| Ok(values(times)), Err)
}

/// Notes every time that does not come after the one before it.
pub(super) fn all_rising(key: &'static str, times: &[At<f64>], faults: &mut Faults) {
    falls(key, times).for_each(|fault| faults.add(|| fault));
}

fn falls(key: &'static str, times: &[At<f64>]) -> impl Iterator<Item = Fault> {
    times.windows(2).filter_map(move |pair| match pair {
        [At { value: before_s, .. }, after] if *before_s >= after.value => {
            let problem = PushProblem::TimesRise { key, before_s: *before_s, after_s: after.value };
            Some(fault(after, problem))
        }
        _ => None,
    })
}

/// Columns by name, with whether they are required. What has no column of these is no such table: then one mistake is told.
fn read_rows<'a>(
    text: &'a str,
    columns: &[(&str, bool)],
    faults: &mut Faults,
) -> Result<Vec<At<Vec<Cell<'a>>>>, Fault> {
    let mut lines = lines(text);
    let names = || columns.iter().map(|(name, _)| (*name).to_owned()).collect::<Vec<_>>();
    let Some(header) = lines.next().transpose()? else {
        return Err(Fault::new(TableProblem::NoHeader { columns: names() }));
    };
    let mut place: Vec<Option<usize>> = vec![None; columns.len()];
    let mut unknown = Vec::new();
    for (k, cell) in header.value.iter().enumerate() {
        let Some(column) = columns.iter().position(|(name, _)| *name == cell.value) else {
            unknown.push(cell);
            continue;
        };
        match place[column] {
            Some(_) => faults.add(|| fault(cell, TableProblem::ColumnTwice { name: cell.value.to_string() })),
            None => place[column] = Some(k),
        }
    }
    if place.iter().all(Option::is_none) {
        return Err(match (Meant::of(text), unknown.first()) {
            (Some(meant), _) if meant != Meant::Csv => Fault::new(TableProblem::Meant { meant, columns: names() }),
            (_, Some(cell)) => fault(cell, unknown_column(cell, names())),
            (_, None) => Fault::new(TableProblem::NoHeader { columns: names() }),
        });
    }
    for cell in &unknown {
        faults.add(|| fault(cell, unknown_column(cell, names())));
    }
    // What is missing may stand there under a name that is not known.
    let missing = columns.iter().zip(&place).filter(|((_, required), place)| *required && place.is_none());
    for ((name, _), _) in missing.filter(|_| unknown.is_empty()) {
        faults.add(|| {
            let problem = TableProblem::MissingColumn { name: (*name).to_owned(), columns: names() };
            fault(&header, problem)
        });
    }
    let mut rows = Vec::new();
    for line in lines {
        let Some(line) = faults.noted(line) else { continue };
        if line.value.len() != header.value.len() {
            let problem = TableProblem::LineLength { found: line.value.len(), columns: header.value.len() };
            faults.add(|| fault(&line, problem));
            continue;
        }
        let cell = |k: &Option<usize>| {
            let found = k.and_then(|k| line.value.get(k));
            found.cloned().unwrap_or_else(|| At { value: Cow::Borrowed(""), span: line.span.clone() })
        };
        let row: Vec<Cell<'_>> = place.iter().map(cell).collect();
        // What stands in a column that is missing is missed there.
        let cells = columns.iter().zip(&place).zip(&row);
        let empty =
            cells.filter(|(((_, required), place), cell)| *required && place.is_some() && cell.value.is_empty());
        for (((name, _), _), cell) in empty {
            faults.add(|| fault(cell, TableProblem::EmptyCell { name: (*name).to_owned() }));
        }
        rows.push(At { value: row, span: line.span.clone() });
    }
    Ok(rows)
}

fn unknown_column(cell: &Cell<'_>, columns: Vec<String>) -> TableProblem {
    TableProblem::UnknownColumn { name: beginning(&cell.value, LONGEST_NAME), columns }
}

/// The number in a cell; none in an empty one.
pub(super) fn cell_number(cell: &Cell<'_>) -> Result<Option<At<f64>>, Fault> {
    let text = cell.value.as_ref();
    if text.is_empty() {
        return Ok(None);
    }
    match text.parse::<f64>() {
        Ok(value) if value.abs() <= LARGEST => Ok(Some(At { value, span: cell.span.clone() })),
        Ok(_) if text.contains(['i', 'I', 'n', 'N']) => {
            Err(fault(cell, ValueProblem::NotFinite { found: text.into() }))
        }
        Ok(_) => Err(fault(cell, ValueProblem::NumberTooLarge { found: text.into() })),
        Err(_) => {
            let problem = ValueProblem::WrongType { found: quoted(text), expected: "a number".into() };
            Err(fault(cell, problem))
        }
    }
}

type Line<'a> = At<Vec<Cell<'a>>>;

/// The lines on which something stands, in cells.
fn lines(text: &str) -> impl Iterator<Item = Result<Line<'_>, Fault>> {
    // Some programs begin a file with a mark of its byte order.
    let mut next = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    std::iter::from_fn(move || {
        loop {
            let rest = text.get(next..).filter(|rest| !rest.is_empty())?;
            let start = next;
            let length = rest.find('\n').map_or(rest.len(), |end| end + 1);
            next += length;
            let line = rest[..length].trim_end();
            if !line.is_empty() {
                return Some(cells(line, start));
            }
        }
    })
}

/// The cells of one line that starts at byte `start`.
fn cells(line: &str, start: usize) -> Result<Line<'_>, Fault> {
    let at = |span: Range<usize>| start + span.start..start + span.end;
    let mut cells = Vec::new();
    let mut next = 0;
    loop {
        let first = next + blanks(&line[next..]);
        let end = if line[first..].starts_with('"') {
            let (value, length) = quoted_cell(&line[first..])
                .ok_or_else(|| Fault::new(TableProblem::OpenQuote).at(&at(first..line.len())))?;
            cells.push(At { value, span: at(first..first + length) });
            let end = first + length + blanks(&line[first + length..]);
            if !line[end..].is_empty() && !line[end..].starts_with(',') {
                let problem = TableProblem::AfterQuote { found: quoted(&line[end..]) };
                return Err(Fault::new(problem).at(&at(end..line.len())));
            }
            end
        } else {
            let end = line[first..].find(',').map_or(line.len(), |length| first + length);
            let value = line[first..end].trim_end();
            cells.push(At { value: Cow::Borrowed(value), span: at(first..first + value.len()) });
            end
        };
        if end == line.len() {
            return Ok(At { value: cells, span: at(blanks(line)..line.len()) });
        }
        next = end + 1;
    }
}

/// How many bytes of blanks a text begins with.
fn blanks(text: &str) -> usize {
    text.len() - text.trim_start().len()
}

/// A cell in quotation marks at the start of a text, and its length with them; `None` if it does not end.
fn quoted_cell(text: &str) -> Option<(Cow<'_, str>, usize)> {
    let mut from = 1;
    loop {
        let mark = from + text.get(from..)?.find('"')?;
        if text[mark + 1..].starts_with('"') {
            from = mark + 2;
            continue;
        }
        let inner = &text[1..mark];
        let value = if from == 1 { Cow::Borrowed(inner) } else { Cow::Owned(inner.replace("\"\"", "\"")) };
        return Some((value, mark + 1));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The cells, or a message and its place.
    type Read = Result<Vec<[String; 3]>, (String, Option<Range<usize>>)>;

    fn columns() -> [Column; 3] {
        [("a", true), ("b", true), ("c", false)].map(|(name, required)| Column { name, required })
    }

    fn whole(text: &str) -> Result<Vec<At<[Cell<'_>; 3]>>, Fault> {
        let mut faults = Faults::default();
        let rows = read_table(text, columns(), &mut faults)?;
        faults.end().map(|()| rows)
    }

    fn read(text: &str) -> Read {
        let rows = whole(text).map_err(|fault| (fault.to_string(), fault.span))?;
        Ok(rows.into_iter().map(|row| row.value.map(|cell| cell.value.into_owned())).collect())
    }

    fn table(rows: &[[&str; 3]]) -> Read {
        Ok(rows.iter().map(|row| row.map(String::from)).collect())
    }

    #[test]
    fn cells_are_found_under_their_columns() {
        assert_eq!(read("a,b,c\n1,2,3\n4,5,\n"), table(&[["1", "2", "3"], ["4", "5", ""]]));
        assert_eq!(read("b,a\n1,2"), table(&[["2", "1", ""]]));
        assert_eq!(read("\u{feff}a, b\r\n\r\n 1 ,\t2 \r\n   \r\n"), table(&[["1", "2", ""]]));
        assert_eq!(read("\"a\",\"b\"\n \"x, y\" , \"say \"\"é\"\"\"\n"), table(&[["x, y", "say \"é\"", ""]]));
        assert_eq!(read("a,b"), table(&[]));
    }

    #[test]
    fn cells_know_their_places() {
        let text = "a,b,c\n é , \"2\",3\n";
        let rows = whole(text).unwrap();
        let places: Vec<_> = rows[0].value.iter().map(|cell| &text[cell.span.clone()]).collect();
        assert_eq!(places, ["é", "\"2\"", "3"]);
        assert_eq!(&text[rows[0].span.clone()], "é , \"2\",3");
    }

    #[test]
    fn what_is_no_table_is_refused_at_its_place() {
        let wrong = |text: &str| read(text).unwrap_err();
        let says = |message: &str, span| (message.to_owned(), span);
        assert_eq!(wrong(""), says("the table is empty", None));
        assert_eq!(wrong("a,b\n1,\"2\n"), says("this quotation mark is not closed on its line", Some(6..8)));
        let behind = "found \"3\" behind a cell in quotation marks, where a comma or the end of the line should stand";
        assert_eq!(wrong("a,b\n1,\"2\"3\n"), says(behind, Some(9..10)));
        assert_eq!(wrong("a,b\n1,\n"), says("`b` is empty", Some(6..6)));
        assert_eq!(wrong("a,b\n1\n"), says("this line has 1 entry, but there are 2 columns", Some(4..5)));
        assert_eq!(wrong("a,b,a\n"), says("a second column is named `a`", Some(4..5)));
        assert_eq!(wrong("a,c\n"), says("the column `b` is missing", Some(0..3)));
        assert_eq!(wrong("a,d\n"), says("unknown column `d`", Some(2..3)));
    }

    proptest! {
        #[test]
        fn prop_any_text_gives_cells_or_a_place(
            pieces in prop::collection::vec(
                prop::sample::select(vec!["a", "b", "c", ",", "\"", "\"\"", "\n", "\r\n", " ", "é", "\u{feff}", "\u{3000}", "1e999"]),
                0..40,
            ),
            header in prop::sample::select(vec!["", "a,b\n", "a,b,c\r\n"]),
        ) {
            let text = format!("{header}{}", pieces.concat());
            let shown = |span: Range<usize>| text.get(span).is_some();
            match whole(&text) {
                Ok(rows) => {
                    for row in rows {
                        prop_assert!(shown(row.span) && row.value.iter().all(|cell| shown(cell.span.clone())));
                        prop_assert!(row.value[..2].iter().all(|cell| !cell.value.is_empty()));
                        for cell in &row.value {
                            let _ = cell_number(cell);
                        }
                    }
                }
                Err(fault) => prop_assert!(fault.others.iter().chain([&fault]).all(|f| f.span.clone().is_none_or(shown))),
            }
        }
    }
}
