//! `trajectory.parquet`: wide, one f64 column per recorded signal.

use std::io::Write;
use std::sync::Arc;

use parquet::basic::{Compression, Encoding, Repetition, Type as PhysicalType};
use parquet::data_type::DoubleType;
use parquet::errors::Result;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::leader::LeaderColumn;
use super::names;
use super::record::RunRecord;

/// Rows of a row group: small enough to skip through a long run, large enough to compress well.
pub(crate) const ROWS_PER_GROUP: usize = 8192;

/// Writes the recording with title, digest, version and units in the file's metadata.
pub(crate) fn write(out: &mut (impl Write + Send), record: &RunRecord<'_>) -> Result<()> {
    let recording = &record.outcome.recording;
    let header = names::table_header(record.setup, recording);
    let leader = LeaderColumn::all(record.setup);
    let fields = header
        .iter()
        .map(|name| {
            let field = Type::primitive_type_builder(name, PhysicalType::DOUBLE);
            Ok(Arc::new(field.with_repetition(Repetition::REQUIRED).build()?))
        })
        .collect::<Result<Vec<_>>>()?;
    let schema = Arc::new(Type::group_type_builder("trajectory").with_fields(fields).build()?);
    let properties = WriterProperties::builder()
        .set_created_by(format!("forwardstep {}", record.version))
        .set_compression(Compression::SNAPPY)
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .set_key_value_metadata(Some(metadata(record, &header, &leader)))
        .build();
    let mut file = SerializedFileWriter::new(out, schema, Arc::new(properties))?;
    let rows = recording.t_s.len();
    let mut padded = Vec::new();
    for start in (0..rows).step_by(ROWS_PER_GROUP) {
        let range = start..(start + ROWS_PER_GROUP).min(rows);
        let mut group = file.next_row_group()?;
        let columns = std::iter::once(&recording.t_s).chain(recording.columns.iter().map(|c| &c.values));
        for values in columns {
            let Some(mut column) = group.next_column()? else { break };
            let values = match values.get(range.clone()) {
                Some(values) => values,
                None => {
                    padded.clear();
                    padded.extend(values.iter().skip(start).copied());
                    padded.resize(range.len(), f64::NAN);
                    &padded
                }
            };
            column.typed::<DoubleType>().write_batch(values, None, None)?;
            column.close()?;
        }
        for own in &leader {
            let Some(mut column) = group.next_column()? else { break };
            padded.clear();
            padded.extend(recording.t_s[range.clone()].iter().map(|t_s| own.at(*t_s)));
            column.typed::<DoubleType>().write_batch(&padded, None, None)?;
            column.close()?;
        }
        group.close()?;
    }
    file.close()?;
    Ok(())
}

fn metadata(record: &RunRecord<'_>, header: &[String], leader: &[LeaderColumn<'_>]) -> Vec<KeyValue> {
    let entry = |key: &str, value: String| KeyValue::new(format!("forwardstep.{key}"), Some(value));
    vec![
        entry("title", record.title.into()),
        entry("scenario", record.scenario_name.into()),
        entry("scenario_digest_blake3", record.digest()),
        entry("version", record.version.into()),
        entry("units", units(record, header, leader)),
    ]
}

/// A JSON object from column names to units.
fn units(record: &RunRecord<'_>, header: &[String], leader: &[LeaderColumn<'_>]) -> String {
    let columns = record.outcome.recording.columns.iter();
    let columns = columns.map(|c| names::unit(record.setup, c.agent, c.signal, c.axis));
    let leads = leader.iter().map(|column| column.unit.clone());
    let units = std::iter::once("s".to_owned()).chain(columns).chain(leads);
    let object: serde_json::Map<_, _> = header.iter().cloned().zip(units.map(serde_json::Value::from)).collect();
    serde_json::Value::Object(object).to_string()
}
