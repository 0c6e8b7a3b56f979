//! What the page of several runs draws of one of them: its network in space, and a few quantities that runs of any kind have.

use forwardstep_sim::Setup;
use forwardstep_sim::recording::Signal;
use serde::Serialize;

use super::super::decimate::Grid;
use super::super::disagreement::{DisagreementSeries, Gap, greater};
use super::super::names;
use super::super::record::RunRecord;
use super::super::table::Table;
use super::super::text;
use super::super::timeline::{self, Timeline};
use super::data::{DelayIndex, GridOrigins, GridRows, Grids, Series, block};
use super::network::{self, Gantt};
use super::scene::Scene;
use super::single::Origins;

/// Points of each line.
const POINTS: usize = 1200;
/// Axes whose positions are drawn.
const MOST_AXES: usize = 12;

/// A run on the page.
#[derive(Serialize)]
pub(super) struct SideIndex {
    name: String,
    until_s: f64,
    agents: Vec<AgentIndex>,
    grids: Grids,
    gantt: Gantt,
    delays: Vec<DelayIndex>,
    scene: Scene,
    quantities: Vec<Quantity>,
}

#[derive(Serialize)]
struct AgentIndex {
    name: String,
    axes: Vec<AxisIndex>,
}

#[derive(Serialize)]
struct AxisIndex {
    units: Units,
}

#[derive(Serialize)]
struct Units {
    q: String,
}

/// What one card draws, by entries that can be picked.
#[derive(Serialize)]
struct Quantity {
    id: &'static str,
    title: &'static str,
    /// Whether it spans decades, so that its axis begins as a logarithmic one.
    log: bool,
    entries: Vec<Entry>,
}

#[derive(Serialize)]
struct Entry {
    name: String,
    unit: String,
    lines: Vec<Line>,
}

#[derive(Serialize)]
struct Line {
    series: usize,
    style: Style,
}

#[derive(Clone, Copy, Serialize)]
#[serde(rename_all = "snake_case")]
enum Style {
    /// The run.
    Run,
    /// What was predicted of it.
    Predicted,
    /// The least and the greatest of all agents.
    Band,
}

/// The run with its block of numbers.
pub(super) fn side_data(name: &str, record: &RunRecord<'_>) -> (SideIndex, String) {
    let setup = record.setup;
    let table = Table::new(setup, &record.outcome.recording);
    let until_s = table.t_s.last().copied().unwrap_or(0.0);
    let timeline = Timeline::of_setup(setup, until_s);
    let mut main = Series::new(Grid::new(table.t_s, &timeline.break_points(), POINTS), table.t_s);
    let quantities = quantities(record, &table, &mut main);
    let (scene, space) = Scene::of(setup, &table, &timeline, None);
    let (delay_t_s, delay_values) = timeline::sample_delays(&setup.network.delays, &timeline, until_s);
    let shown = network::shown_delays(setup, &timeline);
    let axis = |agent, axis| AxisIndex { units: Units { q: unit(setup, agent, Signal::Position, axis) } };
    let index = SideIndex {
        name: name.to_owned(),
        until_s,
        agents: (0..table.agents())
            .map(|agent| AgentIndex {
                name: names::agent_name(setup, agent),
                axes: (0..table.dof(agent)).map(|k| axis(agent, k)).collect(),
            })
            .collect(),
        grids: Grids {
            main: main.grid.t_s.len(),
            estimates: 0,
            delays: delay_t_s.len(),
            scene: space.t_s.len(),
            main_series: main.numbers.count,
            estimate_series: 0,
            delay_series: shown.len(),
            rows: GridRows::of(&main.grid, None),
            origins: GridOrigins {
                main: main.numbers.origins,
                estimates: Origins::default(),
                scene: space.numbers.origins,
            },
        },
        gantt: Gantt::of(setup, &timeline, &mut Vec::new()),
        delays: shown
            .iter()
            .enumerate()
            .map(|(series, (delay, label))| DelayIndex { label: label.clone(), series, band: timeline.bands[*delay] })
            .collect(),
        scene,
        quantities,
    };
    let delays = shown.iter().filter_map(|(k, _)| delay_values.get(*k));
    let times = [&main.grid.t_s, &Vec::new(), &delay_t_s, &space.t_s];
    let numbers = block(times, [&main.numbers.values].into_iter().chain(delays).chain([&space.numbers.values]));
    (index, numbers)
}

fn unit(setup: &Setup, agent: usize, signal: Signal, axis: usize) -> String {
    text::unit(&names::unit(setup, agent, signal, axis))
}

fn quantities(record: &RunRecord<'_>, table: &Table<'_>, main: &mut Series<'_>) -> Vec<Quantity> {
    let setup = record.setup;
    let mut all = Vec::new();
    let mut add = |id, title, log, entries: Vec<Entry>| {
        if !entries.is_empty() {
            all.push(Quantity { id, title, log, entries });
        }
    };
    if let Ok(series) = DisagreementSeries::of_table(table) {
        let unit = names::gap_unit(setup);
        let mut lines = vec![Line { series: main.add(&series.overall, false), style: Style::Run }];
        if let Some(course) = record.prediction.as_ref().and_then(|prediction| prediction.drawn()) {
            lines.push(Line { series: main.add(&course.at(table.t_s), false), style: Style::Predicted });
        }
        let mut entries = vec![Entry { name: "largest".into(), unit: unit.clone(), lines }];
        if series.per_axis.len() > 1 {
            entries.extend(series.per_axis.iter().take(MOST_AXES).enumerate().map(|(axis, values)| Entry {
                name: names::gap_words(setup, axis),
                unit: unit.clone(),
                lines: vec![Line { series: main.add(values, false), style: Style::Run }],
            }));
        }
        // What vanishes of one run is not what vanishes of another: each has a card.
        let id = match Gap::of(setup) {
            Gap::Disagreement => "gap",
            Gap::Error => "gap-to-targets",
        };
        add(id, Gap::of(setup).name(), true, entries);
    }
    add("position", "Positions: mean, least and greatest", false, positions(table, main));
    for (id, title, signal, log) in [
        ("torque", "Torques and forces", Signal::Torque, false),
        ("speed", "Speeds", Signal::Velocity, false),
        ("error", "Tracking errors, s", Signal::TrackingError, true),
    ] {
        add(id, title, log, sizes(table, main, signal));
    }
    let v: Vec<&[f64]> = (0..table.agents()).filter_map(|agent| table.column(agent, Signal::Lyapunov, 0)).collect();
    if !v.is_empty() {
        let sum: Vec<f64> = (0..table.t_s.len()).map(|row| v.iter().filter_map(|v| v.get(row)).sum()).collect();
        let lines = vec![Line { series: main.add(&sum, false), style: Style::Run }];
        add(
            "lyapunov",
            "V of all agents",
            true,
            vec![Entry { name: "V".into(), unit: unit(setup, 0, Signal::Lyapunov, 0), lines }],
        );
    }
    all
}

/// Of every axis the mean of all agents that have it, and how far they are spread.
fn positions(table: &Table<'_>, main: &mut Series<'_>) -> Vec<Entry> {
    let rows = table.t_s.len();
    let entry = |axis: usize| {
        let owners: Vec<usize> =
            (0..table.agents()).filter(|agent| table.column(*agent, Signal::Position, axis).is_some()).collect();
        let all: Vec<&[f64]> = owners.iter().filter_map(|agent| table.column(*agent, Signal::Position, axis)).collect();
        let at = |row: usize| all.iter().filter_map(move |values| values.get(row).copied());
        let mean: Vec<f64> = (0..rows).map(|row| at(row).sum::<f64>() / all.len().max(1) as f64).collect();
        let low: Vec<f64> = (0..rows).map(|row| at(row).fold(f64::INFINITY, f64::min)).collect();
        let high: Vec<f64> = (0..rows).map(|row| at(row).fold(f64::NEG_INFINITY, f64::max)).collect();
        let mut line = |values: &[f64], style| Line { series: main.add(values, false), style };
        Entry {
            name: names::shared_axis_words(table.setup, axis),
            unit: text::units(owners.iter().map(|agent| names::unit(table.setup, *agent, Signal::Position, axis))),
            lines: vec![line(&mean, Style::Run), line(&low, Style::Band), line(&high, Style::Band)],
        }
    };
    (0..table.largest_dof().min(MOST_AXES)).map(entry).collect()
}

/// Of each unit that a signal has, the largest size of all agents and axes, and the root of the sum of all squares.
fn sizes(table: &Table<'_>, main: &mut Series<'_>, signal: Signal) -> Vec<Entry> {
    let mut units: Vec<(String, Vec<&[f64]>)> = Vec::new();
    for (agent, axis, values) in table.axes(signal) {
        let unit = unit(table.setup, agent, signal, axis);
        match units.iter_mut().find(|(known, _)| *known == unit) {
            Some((_, all)) => all.push(values),
            None => units.push((unit, vec![values])),
        }
    }
    let mut entries = Vec::new();
    for (unit, all) in units {
        let at = |row: usize| all.iter().filter_map(move |values| values.get(row).copied());
        let rows = 0..table.t_s.len();
        let largest: Vec<f64> = rows.clone().map(|row| at(row).map(f64::abs).fold(0.0, greater)).collect();
        let norm: Vec<f64> = rows.map(|row| at(row).map(|value| value * value).sum::<f64>().sqrt()).collect();
        for (name, values) in [("largest", largest), ("norm", norm)] {
            let lines = vec![Line { series: main.add(&values, signal.row().may_jump), style: Style::Run }];
            let name = if unit.is_empty() { name.to_owned() } else { format!("{name}, {unit}") };
            entries.push(Entry { name, unit: unit.clone(), lines });
        }
    }
    entries
}
