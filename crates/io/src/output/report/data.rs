//! What the page's plots are drawn from: a JSON index and one block of numbers.

use base64::Engine;
use forwardstep_check::Injection;
use forwardstep_check::prediction::CascadeSpread;
use forwardstep_sim::recording::Signal;
use forwardstep_sim::trajectory::Path;
use serde::Serialize;

use super::super::decimate::Grid;
use super::super::metrics::{DisagreementSeries, Gap, balance_residuals, keeps_balance};
use super::super::names;
use super::super::record::RunRecord;
use super::super::table::Table;
use super::super::text;
use super::super::timeline::{self, Timeline};
use super::cascade::CascadeIndex;
use super::families::{Family, FamilyIndex};
use super::network::{self, Gantt};
use super::scene::Scene;
use super::single::{Origins, Singles};
use crate::shapes::Solid;

/// Points of a signal on the page, as far as space allows.
const MOST_POINTS: usize = 5000;
/// Points of an estimate.
const MOST_ESTIMATE_POINTS: usize = 500;
/// Fewer would not show anything.
const FEWEST_POINTS: usize = 64;
/// Numbers of all signals together, four bytes each before encoding.
const ROOM: usize = 450_000;
/// Numbers of all estimates together.
const ESTIMATE_ROOM: usize = 200_000;
/// More vertical lines would hide the plots.
const MOST_LINES: usize = 400;

/// Everything the plots need.
pub(crate) struct Payload {
    /// The index, safe inside a script element.
    pub(crate) json: String,
    /// Little-endian numbers in base64: first the times of all grids as f64, then all series as f32, those in space last.
    pub(crate) block: String,
    /// Whether bodies are drawn, and not points alone.
    pub(crate) solid: bool,
    /// Whether something is guaranteed of cascaded variables, where there are any.
    pub(crate) cascade: Option<bool>,
    /// What was left out, for the reader.
    pub(crate) notes: Vec<String>,
}

#[derive(Serialize)]
struct Index {
    until_s: f64,
    agents: Vec<AgentIndex>,
    grids: Grids,
    signals: Signals,
    families: Vec<FamilyIndex>,
    disagreement: Option<DisagreementIndex>,
    goal: Option<f64>,
    predicted: Option<Vec<f64>>,
    break_points: Vec<f64>,
    gantt: Gantt,
    delays: Vec<DelayIndex>,
    scene: Scene,
    leader: Option<LeaderIndex>,
    /// Where the cascaded variables are defined.
    cascade: Option<CascadeIndex>,
    /// The unit of V.
    energy: String,
    /// V of all agents, and what changed it.
    injected: Option<InjectedIndex>,
}

#[derive(Serialize)]
struct InjectedIndex {
    v: usize,
    /// The series of each cause with its name.
    by: Vec<(&'static str, usize)>,
}

/// What leads and is no agent: its motion beside those of the agents.
#[derive(Serialize)]
struct LeaderIndex {
    name: String,
    q: Vec<usize>,
    dq: Vec<usize>,
}

#[derive(Serialize)]
struct AgentIndex {
    name: String,
    axes: Vec<AxisIndex>,
    parameters: Vec<ParameterIndex>,
}

#[derive(Serialize)]
struct AxisIndex {
    name: String,
    units: Units,
    position_limits: Option<[f64; 2]>,
    velocity_limit: Option<f64>,
    effort_limit: Option<f64>,
}

/// Of the signals with an entry per axis.
#[derive(Serialize)]
struct Units {
    q: String,
    dq: String,
    s: String,
    tau: String,
    tau_ext: String,
    /// z, ż, …
    reference: Vec<String>,
}

#[derive(Serialize)]
struct ParameterIndex {
    name: String,
    truth: Option<f64>,
    /// Index of its series, if it is on the page.
    series: Option<usize>,
}

/// Numbers of points.
#[derive(Serialize)]
pub(super) struct Grids {
    pub(super) main: usize,
    pub(super) estimates: usize,
    pub(super) delays: usize,
    pub(super) scene: usize,
    /// Series on the main grid, which come first; then estimates, then delays.
    pub(super) main_series: usize,
    pub(super) estimate_series: usize,
    pub(super) delay_series: usize,
    /// Of delays there are none.
    pub(super) origins: GridOrigins,
    /// Which points are rows as they were recorded; absent where all are, as they are of the other grids.
    pub(super) rows: GridRows,
}

/// Bits in base64, the lowest first.
#[derive(Serialize, Default)]
pub(super) struct GridRows {
    main: Option<String>,
    estimates: Option<String>,
}

impl GridRows {
    pub(super) fn of(main: &Grid, estimates: Option<&Grid>) -> Self {
        let bits = |grid: &Grid| {
            let byte = |eight: &[bool]| eight.iter().rev().fold(0_u8, |byte, bit| byte << 1 | u8::from(*bit));
            let bytes: Vec<u8> = grid.exact.chunks(8).map(byte).collect();
            grid.exact.contains(&false).then(|| base64::engine::general_purpose::STANDARD.encode(bytes))
        };
        GridRows { main: bits(main), estimates: estimates.and_then(bits) }
    }
}

/// What is to be added to some series of each grid.
#[derive(Serialize, Default)]
pub(super) struct GridOrigins {
    pub(super) main: Origins,
    pub(super) estimates: Origins,
    pub(super) scene: Origins,
}

/// Indices of series by agent and axis.
#[derive(Serialize, Default)]
struct Signals {
    q: Vec<Vec<Option<usize>>>,
    dq: Vec<Vec<Option<usize>>>,
    s: Vec<Vec<Option<usize>>>,
    tau: Vec<Vec<Option<usize>>>,
    tau_ext: Vec<Vec<Option<usize>>>,
    /// z, ż, …
    reference: Vec<Vec<Vec<Option<usize>>>>,
    lyapunov: Vec<Option<usize>>,
    balance_sum: Vec<Option<usize>>,
    balance_residual: Vec<Option<usize>>,
}

#[derive(Serialize)]
struct DisagreementIndex {
    /// `disagreement` or `error`.
    word: &'static str,
    unit: String,
    overall: usize,
    per_axis: Vec<usize>,
    /// What is predicted for s ≡ 0.
    predicted: Option<usize>,
    /// What the axes are called.
    names: Vec<String>,
}

#[derive(Serialize)]
pub(super) struct DelayIndex {
    pub(super) label: String,
    pub(super) series: usize,
    /// The series is the greatest and the least value around each time in turn.
    pub(super) band: bool,
}

/// Series on one grid.
pub(super) struct Series<'a> {
    pub(super) grid: Grid,
    rows_t_s: &'a [f64],
    pub(super) numbers: Singles,
}

impl<'a> Series<'a> {
    pub(super) fn new(grid: Grid, rows_t_s: &'a [f64]) -> Self {
        Series { grid, rows_t_s, numbers: Singles::default() }
    }

    pub(super) fn add(&mut self, values: &[f64], may_jump: bool) -> usize {
        self.numbers.add(&self.grid.sample(self.rows_t_s, values, may_jump))
    }
}

impl Payload {
    pub(crate) fn of(record: &RunRecord<'_>, table: &Table<'_>, timeline: &Timeline<'_>, until_s: f64) -> Payload {
        let mut notes = Vec::new();
        let break_points = timeline.break_points();
        let columns = &record.outcome.recording.columns;
        let signals = columns.iter().filter(|c| c.signal != Signal::Estimate).count() + table.agents() + 1;
        // Shapes take from the same room: four bytes in base64 make five and a third.
        let shapes = record.shapes.map_or(0, |shapes| shapes.solids.iter().map(Solid::bytes).sum());
        let room = ROOM.saturating_sub(shapes * 3 / 16);
        let budget = (room / (signals + table.largest_dof())).clamp(FEWEST_POINTS, MOST_POINTS);
        let moving = columns.iter().filter(|column| column.signal != Signal::Estimate).map(|column| &column.values[..]);
        let mut main = Series::new(Grid::busy(table.t_s, &break_points, budget, moving), table.t_s);
        if main.grid.decimated {
            notes.push(format!(
                "For display, rows are gathered in buckets, of which the first row is kept, and two more points of each signal: its course up to \
                 the last row, or its extremes where it turns or swings. Of {} rows {} are here as they were recorded: in planes, and in the \
                 tables and CSVs of plots. The run's tables have every row.",
                table.t_s.len(),
                main.grid.exact.iter().filter(|exact| **exact).count()
            ));
        }

        let references = columns.iter().filter_map(|c| match c.signal {
            Signal::Reference(k) => Some(usize::from(k) + 1),
            _ => None,
        });
        let references = references.max().unwrap_or(0);
        let mut take = |signal: Signal| -> Vec<Vec<Option<usize>>> {
            let (axes, may_jump) = (|agent| 0..table.dof(agent), signal.row().may_jump);
            let mut one = |agent, axis| table.column(agent, signal, axis).map(|values| main.add(values, may_jump));
            (0..table.agents()).map(|agent| axes(agent).map(|axis| one(agent, axis)).collect()).collect()
        };
        let mut index = Signals {
            q: take(Signal::Position),
            dq: take(Signal::Velocity),
            s: take(Signal::TrackingError),
            tau: take(Signal::Torque),
            tau_ext: take(Signal::External),
            reference: (0..references).map(|k| take(Signal::Reference(k as u8))).collect(),
            ..Signals::default()
        };
        for agent in 0..table.agents() {
            let v = table.column(agent, Signal::Lyapunov, 0);
            let dissipated = table.column(agent, Signal::Dissipation, 0);
            let sum = v
                .zip(dissipated)
                .filter(|_| keeps_balance(record.setup))
                .map(|(v, d)| v.iter().zip(d).map(|(v, d)| v + d).collect::<Vec<_>>());
            let error = balance_residuals(table, agent).map(|e| e.iter().map(|e| e.abs()).collect::<Vec<_>>());
            index.lyapunov.push(v.map(|v| main.add(v, false)));
            index.balance_sum.push(sum.map(|sum| main.add(&sum, false)));
            index.balance_residual.push(error.map(|error| main.add(&error, false)));
        }
        let disagreement = DisagreementSeries::of_table(table).ok().map(|series| DisagreementIndex {
            word: Gap::of(record.setup).word(),
            unit: names::gap_unit(record.setup),
            overall: main.add(&series.overall, false),
            names: (0..series.per_axis.len()).map(|axis| names::gap_words(record.setup, axis)).collect(),
            predicted: record
                .prediction
                .as_ref()
                .and_then(|prediction| prediction.drawn())
                .map(|course| main.add(&course.at(table.t_s), false)),
            per_axis: series.per_axis.iter().map(|axis| main.add(axis, false)).collect(),
        });

        let families = Family::of(&record.outcome.recording);
        let families =
            families.iter().map(|family| family.index(table, &mut |values, may_jump| main.add(values, may_jump)));
        let families = families.collect();

        let leader = record.setup.following().and_then(|following| following.motion()).map(|leader| {
            let mut derivative = |k: usize| -> Vec<usize> {
                let axis = |path: &Path| table.t_s.iter().map(|t_s| path.jet(*t_s)[k]).collect::<Vec<f64>>();
                leader.trajectory.paths().iter().map(|path| main.add(&axis(path), false)).collect()
            };
            LeaderIndex { name: leader.name.clone(), q: derivative(0), dq: derivative(1) }
        });
        let spread = CascadeSpread::of(record.setup, &record.outcome.recording).ok();
        let cascade = spread.map(|spread| CascadeIndex::of(record, &spread, &mut |values| main.add(values, false)));
        let injected = record.injected_course.as_ref().map(|course| {
            let mut series = |values: &[Option<f64>]| main.add(&course.at(values, table.t_s), false);
            let causes =
                Injection::ALL.into_iter().filter_map(|cause| Some((cause.name(), course.by.get(cause.name())?)));
            InjectedIndex { v: series(&course.v), by: causes.map(|(name, values)| (name, series(values))).collect() }
        });
        let (scene, space) = Scene::of(record.setup, table, timeline, record.shapes);
        let solid = scene.is_solid();

        let (agents, estimates) = agents(record, table, references, &mut notes);
        let (delay_t_s, delay_values) = timeline::sample_delays(&record.setup.network.delays, timeline, until_s);
        let shown_delays = network::shown_delays(record.setup, timeline);
        let delays: Vec<DelayIndex> = (shown_delays.iter().enumerate())
            .map(|(series, (delay, label))| DelayIndex { label: label.clone(), series, band: timeline.bands[*delay] })
            .collect();
        if delays.iter().any(|delay| delay.band) {
            notes.push(
                "Delays that change too often to be drawn one by one are drawn as their least and their greatest value around each time."
                    .into(),
            );
        }

        let index = Index {
            until_s,
            agents,
            grids: Grids {
                main: main.grid.t_s.len(),
                estimates: estimates.grid.t_s.len(),
                delays: delay_t_s.len(),
                scene: space.t_s.len(),
                main_series: main.numbers.count,
                estimate_series: estimates.numbers.count,
                delay_series: shown_delays.len(),
                rows: GridRows::of(&main.grid, Some(&estimates.grid)),
                origins: GridOrigins {
                    main: main.numbers.origins,
                    estimates: estimates.numbers.origins,
                    scene: space.numbers.origins,
                },
            },
            signals: index,
            families,
            disagreement,
            goal: record.goal.and_then(|outcome| outcome.goal.bound()),
            predicted: record.predicted_position().map(<[f64]>::to_vec),
            break_points: if break_points.len() <= MOST_LINES { break_points } else { Vec::new() },
            gantt: Gantt::of(record.setup, timeline, &mut notes),
            delays,
            scene,
            leader,
            cascade,
            energy: text::unit(&names::unit(record.setup, 0, Signal::Lyapunov, 0)),
            injected,
        };
        let times = [&main.grid.t_s, &estimates.grid.t_s, &delay_t_s, &space.t_s];
        let delays = shown_delays.iter().filter_map(|(k, _)| delay_values.get(*k));
        let series =
            [&main.numbers.values, &estimates.numbers.values].into_iter().chain(delays).chain([&space.numbers.values]);
        let cascade = index.cascade.as_ref().map(CascadeIndex::is_guaranteed);
        Payload { json: harmless_json(&index), block: block(times, series), solid, cascade, notes }
    }
}

/// "<" never stands in it as itself, so no name can end the script element.
pub(super) fn harmless_json(index: &impl Serialize) -> String {
    serde_json::to_string(index).unwrap_or_else(|_| "null".into()).replace('<', "\\u003c")
}

/// The times of all grids and then all series, in base64.
pub(super) fn block<'v>(times: [&Vec<f64>; 4], series: impl Iterator<Item = &'v Vec<f32>>) -> String {
    let mut bytes: Vec<u8> = times.into_iter().flatten().flat_map(|t| t.to_le_bytes()).collect();
    bytes.extend(series.flatten().flat_map(|v| v.to_le_bytes()));
    base64::engine::general_purpose::STANDARD.encode(bytes)
}

/// Names, limits and parameters of all agents, and the series of those estimates that there is room for.
fn agents<'a>(
    record: &RunRecord<'_>,
    table: &Table<'a>,
    references: usize,
    notes: &mut Vec<String>,
) -> (Vec<AgentIndex>, Series<'a>) {
    let setup = record.setup;
    let count =
        |agent: usize| setup.agents.get(agent).map_or(0, |a| a.robot.theta_names.len().max(a.robot.theta.len()));
    let estimated =
        |agent: usize| (0..count(agent)).filter(|k| table.column(agent, Signal::Estimate, *k).is_some()).count();
    let all: usize = (0..table.agents()).map(estimated).sum();
    let budget = (ESTIMATE_ROOM / all.max(1)).clamp(FEWEST_POINTS, MOST_ESTIMATE_POINTS);
    let mut series = Series::new(Grid::new(table.t_s, &[], budget), table.t_s);
    let room = ESTIMATE_ROOM / series.grid.t_s.len().max(1);
    let mut agents_left_out = 0;
    let agents = (0..table.agents())
        .map(|agent| {
            let fits = series.numbers.count + estimated(agent) <= room;
            agents_left_out += usize::from(!fits);
            let mut parameter = |k: usize| ParameterIndex {
                name: names::parameter_name(setup, agent, k),
                truth: setup.agents[agent].robot.theta.get(k).copied(),
                series: table.column(agent, Signal::Estimate, k).filter(|_| fits).map(|v| series.add(v, false)),
            };
            let adaptive = setup.agents[agent].estimates();
            let parameters = if adaptive { (0..count(agent)).map(&mut parameter).collect() } else { Vec::new() };
            AgentIndex { name: names::agent_name(setup, agent), axes: axes(setup, agent, references), parameters }
        })
        .collect();
    if agents_left_out > 0 {
        notes.push(format!(
            "The estimates of {agents_left_out} of {} agents are not on this page to keep it small; the tables have them.",
            table.agents()
        ));
    }
    (agents, series)
}

fn axes(setup: &forwardstep_sim::Setup, agent: usize, references: usize) -> Vec<AxisIndex> {
    let axes = setup.agents[agent].robot.axes.iter().enumerate();
    axes.map(|(axis, limits)| {
        let unit = |signal| text::unit(&names::unit(setup, agent, signal, axis));
        AxisIndex {
            name: names::axis_name(setup, agent, axis),
            units: Units {
                q: unit(Signal::Position),
                dq: unit(Signal::Velocity),
                s: unit(Signal::TrackingError),
                tau: unit(Signal::Torque),
                tau_ext: unit(Signal::External),
                reference: (0..references).map(|k| unit(Signal::Reference(k as u8))).collect(),
            },
            position_limits: limits.position_limits,
            velocity_limit: limits.velocity_limit,
            effort_limit: limits.effort_limit,
        }
    })
    .collect()
}
