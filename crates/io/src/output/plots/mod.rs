//! `plots/*.svg`: figures for print, one panel per joint, one colour per agent as in the report.

mod figure;
mod smoothness;

use forwardstep_sim::recording::Signal;

pub use self::smoothness::{plot_filters, plot_orders};

use self::figure::{Across, Figure, Line, Panel};
use super::decimate::Grid;
use super::error::EncodeError;
use super::metrics::{DisagreementSeries, Gap};
use super::names;
use super::palette::{self, Ground};
use super::record::RunRecord;
use super::table::Table;
use super::text;
use super::timeline::Timeline;
use crate::wording::beginning;

/// Points of all lines of a figure together.
const ROOM: usize = 150_000;
/// More names would outgrow the panels.
const MOST_NAMES: usize = 24;
/// Of more parameters than this, those that move most are drawn, as many.
const MOST_PARAMETERS: usize = 12;
/// More agents do not fit on a page.
const MOST_ESTIMATE_PANELS: usize = 24;

/// Of what stands for no agent.
const INK: [u8; 3] = [0x16, 0x19, 0x1f];
/// Letters of a title that fit beside what a figure shows.
const TITLE_LETTERS: usize = 70;

/// What figures are drawn from.
pub(crate) struct Plots<'a> {
    record: &'a RunRecord<'a>,
    table: Table<'a>,
    break_points: Vec<f64>,
}

impl<'a> Plots<'a> {
    pub(crate) fn of(record: &'a RunRecord<'a>) -> Self {
        let table = Table::new(record.setup, &record.outcome.recording);
        let until_s = table.t_s.last().copied().unwrap_or(0.0);
        let timeline = Timeline::of_setup(record.setup, until_s);
        Plots { record, break_points: timeline.break_points(), table }
    }

    /// q, one panel per joint, and dashed that of a leader that is no agent.
    pub(crate) fn positions(&self) -> Result<String, EncodeError> {
        let predicted = |axis: usize| {
            let value = self.record.predicted_position()?.get(axis)?;
            Some((*value, "predicted agreement".to_owned()))
        };
        let mut panels = self.per_joint("q", Signal::Position, predicted);
        let mut legend = self.agents_legend();
        if let Some(leader) = self.record.setup.following().and_then(|following| following.motion()) {
            let grid = self.grid(leader.trajectory.paths().len());
            for (axis, panel) in &mut panels {
                let Some(path) = leader.trajectory.paths().get(*axis) else { continue };
                let points: Vec<_> = grid.t_s.iter().map(|t_s| (*t_s, path.jet(*t_s)[0])).collect();
                panel.lines.extend(dashes(&points, INK));
            }
            legend.push((format!("{}, dashed", leader.name), INK));
        }
        self.of_agents("Positions", legend, panels.into_iter().map(|(_, panel)| panel).collect())
    }

    /// τ, one panel per joint, and the thrust of what flies.
    pub(crate) fn torques(&self) -> Result<String, EncodeError> {
        let setup = self.record.setup;
        let mut panels: Vec<_> =
            self.per_joint("τ", Signal::Torque, |_| None).into_iter().map(|(_, panel)| panel).collect();
        let thrusts: Vec<_> = (0..self.table.agents())
            .filter_map(|agent| Some((agent, self.table.column(agent, Signal::Thrust, 0)?)))
            .collect();
        if !thrusts.is_empty() {
            let grid = self.grid(thrusts.len());
            let units = text::units(thrusts.iter().map(|(agent, _)| names::unit(setup, *agent, Signal::Thrust, 0)));
            panels.push(Panel {
                title: "thrust".into(),
                x: Across::Time,
                y: text::in_unit(&units).trim_start().to_owned(),
                log: false,
                lines: thrusts
                    .iter()
                    .map(|(agent, values)| self.line(&grid, values, true, self.colour(*agent)))
                    .collect(),
                guide: None,
            });
        }
        self.of_agents(names::input_words(setup).1, self.agents_legend(), panels)
    }

    fn of_agents(&self, what: &str, legend: Vec<(String, [u8; 3])>, panels: Vec<Panel>) -> Result<String, EncodeError> {
        Figure {
            title: self.title(what),
            legend,
            columns: columns(panels.len()),
            panels,
            panel: (380, 230),
            empty: "Nothing was recorded.",
        }
        .svg()
    }

    /// The panels of all joints of which something was recorded, in their order, each with its number.
    fn per_joint(
        &self,
        letter: &str,
        signal: Signal,
        guide: impl Fn(usize) -> Option<(f64, String)>,
    ) -> Vec<(usize, Panel)> {
        let (setup, table) = (self.record.setup, &self.table);
        let grid = self.grid(table.axes(signal).count());
        let panel = |axis: usize| {
            let owners: Vec<_> = (0..table.agents())
                .filter_map(|agent| Some((agent, table.column(agent, signal, axis)?)))
                .filter(|(agent, _)| axis < table.dof(*agent))
                .collect();
            let units = text::units(owners.iter().map(|(agent, _)| names::unit(setup, *agent, signal, axis)));
            let line = |&(agent, values): &(usize, &[f64])| {
                self.line(&grid, values, signal == Signal::Torque, self.colour(agent))
            };
            let panel = Panel {
                title: names::shared_axis_words(setup, axis),
                x: Across::Time,
                y: format!("{letter}{}", text::in_unit(&units)),
                log: false,
                lines: owners.iter().map(line).collect(),
                guide: guide(axis),
            };
            (axis, panel)
        };
        let axes = if table.t_s.is_empty() { 0 } else { table.largest_dof() };
        (0..axes).map(panel).filter(|(_, panel)| !panel.lines.is_empty()).collect()
    }

    /// ϑ̂, one panel per agent.
    pub(crate) fn estimates(&self) -> Result<String, EncodeError> {
        let (setup, table) = (self.record.setup, &self.table);
        let count =
            |agent: usize| setup.agents[agent].robot.theta_names.len().max(setup.agents[agent].robot.theta.len());
        let of = |agent: usize| -> Vec<&[f64]> {
            (0..count(agent)).filter_map(|k| table.column(agent, Signal::Estimate, k)).collect()
        };
        let estimates: Vec<_> =
            (0..table.agents()).map(|agent| (agent, of(agent))).filter(|(_, e)| !e.is_empty()).collect();
        let shown = &estimates[..estimates.len().min(MOST_ESTIMATE_PANELS)];
        let names_of =
            |agent: usize| (0..count(agent)).map(|k| names::parameter_name(setup, agent, k)).collect::<Vec<_>>();
        // One legend for all panels, if the same parameters are estimated in all.
        let first = shown.first().map(|(agent, _)| names_of(*agent)).unwrap_or_default();
        let shared = shown.iter().all(|(agent, e)| e.len() == first.len() && names_of(*agent) == first);
        let common =
            if shared { largest_moves(shown.iter().map(|(_, columns)| columns.as_slice())) } else { Vec::new() };
        let drawn = |columns: &[&[f64]]| if shared { common.clone() } else { largest_moves([columns].into_iter()) };
        let grid = self.grid(shown.iter().map(|(_, e)| e.len().min(MOST_PARAMETERS)).sum());
        let colour = |k: usize, n: usize| palette::ramp(k, n, Ground::Light);
        let panel = |(agent, columns): &(usize, Vec<&[f64]>)| {
            let drawn = drawn(columns);
            let (name, all) = (names::agent_name(setup, *agent), text::count(columns.len(), "parameter"));
            let part = if drawn.len() < columns.len() {
                format!("the {} that move most of ", drawn.len())
            } else {
                String::new()
            };
            Panel {
                title: format!("{name}, {part}{all}"),
                x: Across::Time,
                y: "in SI units".into(),
                log: false,
                lines: (drawn.iter().enumerate())
                    .map(|(k, column)| self.line(&grid, columns[*column], false, colour(k, drawn.len())))
                    .collect(),
                guide: None,
            }
        };
        let panels: Vec<_> = if table.t_s.is_empty() { Vec::new() } else { shown.iter().map(panel).collect() };
        Figure {
            title: match estimates.len() - shown.len() {
                0 => self.title("Parameter estimates"),
                _ => self.title(&format!("Parameter estimates of the first {MOST_ESTIMATE_PANELS} agents")),
            },
            legend: (common.iter().enumerate())
                .filter_map(|(k, parameter)| Some((first.get(*parameter)?.clone(), colour(k, common.len()))))
                .collect(),
            columns: columns(panels.len()),
            panels,
            panel: (380, 230),
            empty: "No agent estimates parameters.",
        }
        .svg()
    }

    /// max |qᵢ − qⱼ| on a logarithmic axis.
    pub(crate) fn disagreement(&self) -> Result<String, EncodeError> {
        let series = DisagreementSeries::of_table(&self.table);
        let gap = Gap::of(self.record.setup);
        let mut legend = Vec::new();
        let mut panels = Vec::new();
        if let Ok(series) = &series {
            let axes = if series.per_axis.len() > 1 { series.per_axis.as_slice() } else { &[] };
            let grid = self.grid(axes.len() + 1);
            let colour = |axis| palette::ramp(axis, axes.len(), Ground::Light);
            let mut lines: Vec<_> =
                axes.iter().enumerate().map(|(axis, values)| self.line(&grid, values, false, colour(axis))).collect();
            if let Some(course) = self.record.prediction.as_ref().and_then(|prediction| prediction.drawn()) {
                let points: Vec<_> = course.t_s.iter().copied().zip(course.disagreement.iter().copied()).collect();
                lines.extend(dashes(&points, INK));
            }
            lines.push(Line { width: 2, ..self.line(&grid, &series.overall, false, INK) });
            if !axes.is_empty() {
                legend = (0..axes.len().min(MOST_NAMES))
                    .map(|axis| (names::gap_words(self.record.setup, axis), colour(axis)))
                    .collect();
                legend.push(("largest".into(), INK));
            }
            if self.record.prediction.as_ref().is_some_and(|prediction| prediction.drawn().is_some()) {
                legend.push(("predicted, dashed".into(), INK));
            }
            let unit = text::in_unit(&names::gap_unit(self.record.setup));
            let guide = self.record.goal.and_then(|outcome| Some((outcome.goal.bound()?, "goal".to_owned())));
            panels.push(Panel {
                title: String::new(),
                x: Across::Time,
                y: format!("{}{unit}", gap.formula(self.record.setup)),
                log: true,
                lines,
                guide,
            });
        }
        Figure {
            title: self.title(gap.name()),
            legend,
            panels,
            columns: 1,
            panel: (760, 400),
            empty: match series {
                Err(absence) => absence.words(),
                Ok(_) => "",
            },
        }
        .svg()
    }

    fn title(&self, what: &str) -> String {
        let title = self.record.title;
        if title.is_empty() { what.to_owned() } else { format!("{what} – {}", beginning(title, TITLE_LETTERS)) }
    }

    fn colour(&self, agent: usize) -> [u8; 3] {
        palette::agent(agent, self.table.agents(), Ground::Light)
    }

    /// All agents by name, or the first and last few where colours run through a ramp.
    fn agents_legend(&self) -> Vec<(String, [u8; 3])> {
        let agents = self.table.agents();
        let entry = |agent| (names::agent_name(self.record.setup, agent), self.colour(agent));
        if agents <= MOST_NAMES {
            return (0..agents).map(entry).collect();
        }
        (0..8).map(|k| k * (agents - 1) / 7).map(entry).collect()
    }

    fn grid(&self, lines: usize) -> Grid {
        Grid::new(self.table.t_s, &self.break_points, (ROOM / lines.max(1)).clamp(60, 700))
    }

    fn line(&self, grid: &Grid, values: &[f64], may_jump: bool, colour: [u8; 3]) -> Line {
        let sampled = grid.sample(self.table.t_s, values, may_jump);
        let points = grid.t_s.iter().copied().zip(sampled).collect();
        Line { colour, width: 1, points }
    }
}

/// Every other piece of a line.
fn dashes(points: &[(f64, f64)], colour: [u8; 3]) -> impl Iterator<Item = Line> {
    let pieces = points.chunks(DASH).step_by(2).filter(|piece| piece.len() > 1);
    pieces.map(move |piece| Line { colour, width: 1, points: piece.to_vec() })
}

/// Points of a dash.
const DASH: usize = 4;

/// Which columns move most in any of the panels, at most [`MOST_PARAMETERS`] of them, in their order.
fn largest_moves<'c>(panels: impl Iterator<Item = &'c [&'c [f64]]>) -> Vec<usize> {
    let mut moves: Vec<f64> = Vec::new();
    for columns in panels {
        moves.resize(moves.len().max(columns.len()), 0.0);
        for (most, values) in moves.iter_mut().zip(columns) {
            let finite = || values.iter().copied().filter(|value| value.is_finite());
            let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
            *most = most.max(high - low);
        }
    }
    let mut order: Vec<usize> = (0..moves.len()).collect();
    order.sort_by(|a, b| moves[*b].total_cmp(&moves[*a]));
    order.truncate(MOST_PARAMETERS);
    order.sort_unstable();
    order
}

/// Columns for this many panels: wide rather than tall.
fn columns(panels: usize) -> usize {
    match panels {
        0..=3 => panels.max(1),
        4 => 2,
        5..=12 => 3,
        _ => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_parameters_those_that_move_most_in_any_panel_are_drawn_in_order() {
        let columns: Vec<[f64; 3]> =
            (0..40).map(|k| [0.0, f64::NAN, if k % 3 == 0 { k as f64 } else { 0.1 }]).collect();
        let still = [[5.0; 3]; 40];
        let panel = |columns: &'static [[f64; 3]]| columns.iter().map(|c| &c[..]).collect::<Vec<&[f64]>>();
        let (moving, still) = (panel(Vec::leak(columns)), panel(Vec::leak(still.to_vec())));
        let drawn = largest_moves([still.as_slice(), &moving].into_iter());
        assert_eq!(drawn, (1..=12).map(|k| 3 * k + 3).filter(|k| *k < 40).collect::<Vec<_>>());
        assert_eq!(largest_moves([&moving[..5]].into_iter()), [0, 1, 2, 3, 4]);
    }
}
