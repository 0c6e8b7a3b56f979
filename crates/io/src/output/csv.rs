//! `trajectory.csv`: the numbers of the Parquet table with all digits needed to read the same numbers back.

use std::io::{Read, Write};

use forwardstep_sim::recording::Recording;
use forwardstep_sim::setup::Setup;

use super::leader::LeaderColumn;
use super::names;
use super::restore_error::TableError;
use super::table::NamedColumns;

/// Writes header and rows; values that are not finite are `NaN`, `inf` and `-inf`.
pub(crate) fn write(out: &mut impl Write, setup: &Setup, recording: &Recording) -> std::io::Result<()> {
    let mut table = ::csv::Writer::from_writer(out);
    table.write_record(names::table_header(setup, recording)).map_err(io_error)?;
    let leader = LeaderColumn::all(setup);
    let mut field = Vec::new();
    for (row, t_s) in recording.t_s.iter().enumerate() {
        let columns = recording.columns.iter().map(|c| c.values.get(row).copied().unwrap_or(f64::NAN));
        let leads = leader.iter().map(|column| column.at(*t_s));
        for value in std::iter::once(*t_s).chain(columns).chain(leads) {
            field.clear();
            write!(field, "{value:?}")?; // the shortest text that reads back as the same number
            table.write_field(&field).map_err(io_error)?;
        }
        table.write_record(None::<&[u8]>).map_err(io_error)?;
    }
    table.flush()
}

pub(super) fn io_error(error: ::csv::Error) -> std::io::Error {
    match error.into_kind() {
        ::csv::ErrorKind::Io(error) => error,
        other => std::io::Error::other(format!("{other:?}")),
    }
}

/// Reads columns back, whatever their names.
pub(crate) fn read(input: impl Read) -> Result<NamedColumns, TableError> {
    let mut table = ::csv::Reader::from_reader(input);
    let mut columns: NamedColumns = table.headers()?.iter().map(|name| (name.to_owned(), Vec::new())).collect();
    let mut row = ::csv::StringRecord::new();
    while table.read_record(&mut row)? {
        // A line of another length was refused by the reader.
        for (field, (name, values)) in row.iter().zip(&mut columns) {
            let Ok(value) = field.parse() else {
                let line = row.position().map_or(0, ::csv::Position::line);
                return Err(TableError::NotANumber { line, column: name.clone(), found: field.to_owned() });
            };
            values.push(value);
        }
    }
    Ok(columns)
}
