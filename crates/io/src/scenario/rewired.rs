//! The text of a scenario with another common delay, or with its graphs in another order and for other times.

use std::collections::BTreeSet;

use toml_edit::{Array, DocumentMut, InlineTable, Item, TableLike, Value};

use crate::SourceText;

/// What a scenario states of its network that can be varied.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedNetwork {
    /// Whether all edges share the delay of the network: none states its own, and none comes from a file.
    pub common_delay: bool,
    /// How many graphs take turns again and again; none where one stays in the end, or nothing is said of how long they stay.
    pub phases: usize,
    /// How long the shortest and the longest of them stay, s.
    pub dwell_s: [f64; 2],
}

/// How a network is varied. What is empty stays as it is stated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rewired {
    /// Pieces of the common delay, which repeat: how long each lasts, and the delay, s.
    pub delay: Vec<[f64; 2]>,
    /// Phases that repeat: the index of the graph among those stated, and how long it stays, s.
    pub phases: Vec<(usize, f64)>,
}

/// What `source`, the text of a scenario that can be read, states of its network; `None` where it has none.
pub fn stated_network(source: &SourceText) -> Option<StatedNetwork> {
    let document: DocumentMut = source.text().parse().ok()?;
    let network = document.get("network")?.as_table_like()?;
    let own = ["edges", "phases", "link_delays"].iter().filter_map(|key| network.get(key)).any(states_delays);
    let phases = network.get("phases").map(phases).unwrap_or_default();
    let switching = network.get("switching");
    let random = switching.and_then(|item| item.as_table_like()?.get("random")?.as_table_like()?.get("dwell_s"));
    let dwell: Vec<f64> = match random {
        Some(bounds) => bounds.as_array()?.iter().filter_map(number).collect(),
        None => phases.iter().filter_map(|phase| number(phase.get("dwell_s")?)).collect(),
    };
    // How long graphs stay that a table brings in is not stated.
    let stays = phases.len() < 2 || dwell.is_empty() || switching.and_then(Item::as_str) == Some("once");
    Some(StatedNetwork {
        common_delay: !own,
        phases: if stays { 0 } else { phases.len() },
        dwell_s: [dwell.iter().copied().fold(f64::INFINITY, f64::min), dwell.iter().copied().fold(0.0, f64::max)],
    })
}

/// The text of `source` with its network varied; `None` where it has no such network.
pub fn rewired(source: &SourceText, change: &Rewired) -> Option<String> {
    let mut document: DocumentMut = source.text().parse().ok()?;
    let network = document.get_mut("network")?.as_table_like_mut()?;
    if !change.delay.is_empty() {
        replace(network, "delay", delay(&change.delay).into());
    }
    if !change.phases.is_empty() {
        let stated = phases(network.get("phases")?);
        let mut all = Array::new();
        for (index, dwell_s) in &change.phases {
            let mut phase = stated.get(*index)?.clone();
            phase.insert("dwell_s", Value::from(*dwell_s));
            all.push(phase);
        }
        all.fmt();
        replace(network, "phases", all.into());
        replace(network, "switching", "repeat".into());
    }
    Some(document.to_string())
}

/// Puts a value where something else, perhaps a table, may have stood.
fn replace(table: &mut dyn TableLike, key: &str, value: Value) {
    table.remove(key);
    table.insert(key, Item::Value(value));
}

fn delay(pieces: &[[f64; 2]]) -> InlineTable {
    let mut rule = InlineTable::new();
    if let [[_, value_s]] = pieces {
        rule.insert("constant_s", Value::from(*value_s));
        return rule;
    }
    let (mut times, mut values, mut until_s) = (Array::new(), Array::new(), 0.0);
    for [for_s, value_s] in pieces {
        times.push(until_s);
        values.push(*value_s);
        until_s = rounded(until_s + for_s);
    }
    let mut pieces = InlineTable::new();
    pieces.insert("times_s", times.into());
    pieces.insert("values_s", values.into());
    pieces.insert("period_s", Value::from(until_s));
    rule.insert("piecewise_constant", pieces.into());
    rule
}

/// To a tenth of a millisecond, so that sums of short decimals are short again.
fn rounded(t_s: f64) -> f64 {
    (1e4 * t_s).round() / 1e4
}

/// The phases as inline tables, however they are written.
fn phases(item: &Item) -> Vec<InlineTable> {
    let inline = |value: Value| match value {
        Value::InlineTable(mut table) => {
            // Comments and line breaks of tables have no place in a line.
            table.fmt();
            Some(table)
        }
        Value::String(_) | Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) => None,
        Value::Array(_) => None,
    };
    match item.clone().into_value() {
        Ok(Value::Array(all)) => all.into_iter().filter_map(inline).collect(),
        Ok(_) | Err(_) => Vec::new(),
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|number| number as f64))
}

/// Whether edges state delays, or come from a file, in which they may.
fn states_delays(edges: &Item) -> bool {
    const KEYS: [&str; 2] = ["delay", "csv"];
    let keys: BTreeSet<String> = edges.clone().into_value().map(|value| all_keys(&value)).unwrap_or_default();
    KEYS.iter().any(|key| keys.contains(*key))
}

fn all_keys(value: &Value) -> BTreeSet<String> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(all_keys).collect(),
        Value::InlineTable(table) => {
            let own = table.iter().map(|(key, _)| key.to_owned());
            own.chain(table.iter().flat_map(|(_, value)| all_keys(value))).collect()
        }
        Value::String(_) | Value::Integer(_) | Value::Float(_) | Value::Boolean(_) | Value::Datetime(_) => {
            BTreeSet::new()
        }
    }
}
