//! What was simulated, in the words of its scenario file: kinds and gains as their author wrote them.

use std::collections::BTreeMap;

use forwardstep_sim::Setup;
use toml::{Table, Value};

use super::super::names;
use super::super::text::{count, number};

/// The text of a scenario, as far as it can be read.
pub(super) fn scenario(text: &str) -> Table {
    text.parse().unwrap_or_default()
}

/// The tables of its agents.
fn agents(scenario: &Table) -> impl Iterator<Item = &Table> {
    scenario.get("agents").and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_table)
}

/// `5 × ship`, `2 × planar_arm, 1 × ur5e`; as many agents as there are, where the file does not say.
pub(super) fn robots(scenario: &Table, setup: &Setup) -> String {
    let mut kinds: Vec<(String, usize)> = Vec::new();
    for agent in agents(scenario) {
        let Some((kind, table)) = agent.get("robot").and_then(Value::as_table).and_then(|robot| robot.iter().next())
        else {
            continue;
        };
        let urdf = |key| table.get(key).and_then(Value::as_str).map(str::to_owned);
        let kind = urdf("name").or_else(|| urdf("robot")).or_else(|| urdf("file")).unwrap_or_else(|| kind.clone());
        let many = agent.get("count").and_then(Value::as_integer).and_then(|n| usize::try_from(n).ok()).unwrap_or(1);
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, n)) => *n += many,
            None => kinds.push((kind, many)),
        }
    }
    if kinds.iter().map(|(_, many)| many).sum::<usize>() != setup.agents.len() {
        return count(setup.agents.len(), "agent");
    }
    kinds.into_iter().map(|(kind, many)| format!("{many} × {kind}")).collect::<Vec<_>>().join(", ")
}

/// The laws with their numbers as they are written, for all and for single groups of agents.
pub(super) fn laws(scenario: &Table, setup: &Setup) -> String {
    said(scenario, "law").unwrap_or_else(|| {
        let mut laws: Vec<&str> = setup.agents.iter().map(|agent| agent.law.words().name).collect();
        laws.sort_unstable();
        laws.dedup();
        laws.join(", ")
    })
}

/// The reference dynamics with their numbers as they are written.
pub(super) fn reference(scenario: &Table, setup: &Setup) -> String {
    said(scenario, "reference").unwrap_or_else(|| setup.reference.words().name.to_owned())
}

fn said(scenario: &Table, key: &str) -> Option<String> {
    let own = agents(scenario).filter_map(|agent| agent.get(key)).map(written);
    let mut all: Vec<String> = scenario.get(key).map(written).into_iter().chain(own).collect();
    all.dedup();
    (!all.is_empty()).then(|| all.join("; "))
}

/// `adaptive: damping.gain = [60, 60, 12]`.
fn written(value: &Value) -> String {
    let kind = value.as_table().filter(|table| table.len() == 1).and_then(|table| table.iter().next());
    let mut entries = Vec::new();
    flatten("", kind.map_or(value, |(_, inner)| inner), &mut entries);
    let stated =
        |(path, text): &(String, String)| if path.is_empty() { text.clone() } else { format!("{path} = {text}") };
    let all = entries.iter().map(stated).collect::<Vec<_>>().join(", ");
    match kind {
        Some((kind, _)) if all.is_empty() => kind.clone(),
        Some((kind, _)) => format!("{kind}: {all}"),
        None => all,
    }
}

/// What a scenario states, by the paths of its keys; agents by name.
pub(super) fn stated(scenario: &Table) -> BTreeMap<String, String> {
    let mut all = Vec::new();
    scenario.iter().for_each(|(key, value)| flatten(key, value, &mut all));
    all.into_iter().collect()
}

/// The values below a path, each with its own. What is there by its name alone is `{}`.
fn flatten(path: &str, value: &Value, into: &mut Vec<(String, String)>) {
    let below = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Table(table) if path.is_empty() || !table.is_empty() => {
            table.iter().for_each(|(key, value)| flatten(&below(key), value, into));
        }
        Value::Array(all) if all.iter().any(Value::is_table) => {
            for (k, entry) in all.iter().enumerate() {
                let name = entry.get("name").and_then(Value::as_str);
                flatten(&below(&name.map_or_else(|| (k + 1).to_string(), str::to_owned)), entry, into);
            }
        }
        value => into.push((path.to_owned(), plain(value))),
    }
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Float(number) => number.to_string(),
        Value::Array(all) => format!("[{}]", all.iter().map(plain).collect::<Vec<_>>().join(", ")),
        Value::Table(table) if table.is_empty() => "{}".to_owned(),
        other => other.to_string(),
    }
}

/// Graphs, how they take turns, and how late what is heard is.
pub(super) fn network(setup: &Setup) -> String {
    let network = &setup.network;
    let graphs = &network.schedule.graphs;
    let edges: Vec<usize> = graphs.iter().map(Vec::len).collect();
    let (least, most) = (edges.iter().min().copied().unwrap_or(0), edges.iter().max().copied().unwrap_or(0));
    if most == 0 {
        return "no agent hears another".into();
    }
    let many = if least == most { count(most, "edge") } else { format!("{least} to {most} edges") };
    let graphs = match graphs.len() {
        1 => format!("one graph of {many}"),
        n => format!("{n} graphs of {many}, {}", network.schedule.words()),
    };
    let mut kinds: Vec<&str> = network.used_delays().map(|k| network.delays[k].words()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let late = network.used_delays().map(|k| network.delays[k].max_s()).fold(0.0, f64::max);
    let is_one = network.used_delays().all(|k| network.delays[k].is_constant() && network.delays[k].max_s() >= late);
    let size = if is_one { " of" } else { ", at most" };
    let late =
        if late > 0.0 { format!("; {}{size} {} s", kinds.join(", "), number(late)) } else { "; no delay".into() };
    graphs + &late
}

/// The least and the greatest order of the reference dynamics of those agents that have roots.
pub(super) fn orders(setup: &Setup) -> Option<(usize, usize)> {
    let orders = || setup.agents.iter().map(|agent| agent.roots_per_s.len()).filter(|order| *order > 0);
    Some((orders().min()?, orders().max()?))
}

/// How the controllers work.
pub(super) fn control(setup: &Setup) -> String {
    match &setup.control {
        None => "continuous time".into(),
        Some(control) => format!("sampled at {} Hz", number(control.sample_hz)),
    }
}

/// The unit of all entries of what is to vanish, if it is one.
pub(super) fn gap_unit(setup: &Setup) -> String {
    names::gap_unit(setup)
}
