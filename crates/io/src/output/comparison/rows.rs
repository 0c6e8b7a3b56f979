//! The rows of the table.

use std::collections::{BTreeMap, BTreeSet};

use forwardstep_check::Answer;
use forwardstep_check::smoothness::LargestJump;
use forwardstep_core::signal::superscript;
use forwardstep_sim::Setup;
use forwardstep_sim::recording::{Ending, Signal};
use forwardstep_sim::reference::Desired;
use toml::Table as Toml;

use super::super::guarantee::{Guarantee, GuaranteeFound};
use super::super::metrics::{Disagreement, Gap, Metrics};
use super::super::names;
use super::super::packets::Link;
use super::super::prediction::{CourseFound, PredictedCourse, PredictedRate, Predictions};
use super::super::table::Table;
use super::super::text::{self, number};
use super::{Compared, ComparedCell as Cell, ComparedRow as Row, RowGroup, words};
use crate::wording::beginning;

/// Why a run has no prediction.
const NOT_AGREED_UPON: &str = "nothing is agreed upon: agents follow targets or a leader";
const UNPREDICTED: &str = "it was not predicted; `forwardstep run --predict` predicts";
/// Where more keys of scenarios differ they are others, and no variants.
const MOST_VARIED: usize = 12;
/// Letters of a value of a scenario that are shown.
const MOST_LETTERS: usize = 80;
/// What rows of their own show, or what is no number.
const SHOWN_ELSEWHERE: [&str; 4] = ["format", "title", "law", "reference"];

/// A run with what its rows are made from.
pub(super) struct Subject<'a> {
    run: &'a Compared<'a>,
    metrics: Metrics,
    scenario: Toml,
}

impl<'a> Subject<'a> {
    pub(super) fn new(run: &'a Compared<'a>) -> Self {
        let record = run.record;
        let goal = record.goal.map(|outcome| outcome.goal);
        let metrics = Metrics::of(record.setup, &record.outcome.recording, record.predicted_agreement.as_deref(), goal);
        Subject { run, metrics, scenario: words::scenario(record.scenario_text) }
    }

    fn setup(&self) -> &'a forwardstep_sim::Setup {
        self.run.record.setup
    }

    fn prediction(&self) -> Result<&'a Predictions, Cell> {
        let because = if Gap::of(self.setup()) == Gap::Error { NOT_AGREED_UPON } else { UNPREDICTED };
        self.run.record.prediction.as_ref().ok_or_else(|| Cell::none(because))
    }

    fn course(&self) -> Result<&'a CourseFound, Cell> {
        match &self.prediction()?.course {
            PredictedCourse::Found(course) => Ok(course),
            PredictedCourse::NoneSince(reason) => Err(Cell::none(reason.as_str())),
        }
    }

    fn guarantee(&self) -> Result<&'a GuaranteeFound, Cell> {
        match &self.prediction()?.guarantee {
            Some(Guarantee::Found(found)) => Ok(found),
            Some(Guarantee::NoneSince(reason)) => Err(Cell::none(reason.as_str())),
            None => Err(Cell::none("an earlier version predicted, which guaranteed no rate")),
        }
    }

    fn gap_unit(&self) -> String {
        words::gap_unit(self.setup())
    }
}

/// All rows, in order.
pub(super) fn all(subjects: &[Subject<'_>]) -> Vec<Row> {
    let row = |group, key, name, cell: fn(&Subject<'_>) -> Result<Cell, Cell>| {
        Row::of(group, key, name, subjects.iter().map(|subject| cell(subject).unwrap_or_else(|none| none)).collect())
    };
    let Some(first) = subjects.first() else { return Vec::new() };
    // The same words for all, where they are the same.
    let shared = |said: fn(&Setup) -> &'static str, else_words: &'static str| {
        let first = said(first.setup());
        if subjects.iter().all(|subject| said(subject.setup()) == first) { first } else { else_words }
    };
    let input = shared(|setup| names::input_words(setup).0, "input");
    let (peak, bound) = (format!("peak {input}"), format!("{input} bound"));
    let agreed_upon = shared(names::value_words, "Value").to_lowercase();
    let alike = |same: fn(&Subject<'_>, &Subject<'_>) -> bool| move |k: usize| same(first, &subjects[k]);
    use RowGroup::{Observed, Predicted, Promised, Simulated};
    let mut rows = vec![
        row(Simulated, "robots", "robots", |s| Ok(Cell::words(words::robots(&s.scenario, s.setup()))))
            .unless(alike(same_robots)),
        row(Simulated, "law", "law", |s| Ok(Cell::words(words::laws(&s.scenario, s.setup())))),
        row(Simulated, "reference", "reference dynamics", |s| {
            Ok(Cell::words(words::reference(&s.scenario, s.setup())))
        }),
        row(Simulated, "order", "order", order),
        row(Simulated, "told", "told each other", told),
        row(Simulated, "network", "network", |s| Ok(Cell::words(words::network(s.setup()))))
            .unless(alike(same_network)),
        row(Simulated, "start", "gap at the start", start).unless(alike(same_start)),
        row(Simulated, "control", "control", |s| Ok(Cell::words(words::control(s.setup())))),
        row(Simulated, "horizon_s", "horizon", |s| Ok(Cell::number(s.setup().time.end_s, "s"))),
    ];
    rows.extend(varied(subjects));
    rows.extend([
        row(Promised, "theorem", "theorem", |s| Ok(Cell::words(s.run.record.verdicts.theorem.to_string()))),
        row(Promised, "verdict", "verdict", verdict),
        row(Promised, "guaranteed_settled_s", "1 % left by", |s| {
            let found = s.guarantee()?;
            found
                .settled_s
                .map(|t_s| Cell::number(t_s, "s"))
                .ok_or_else(|| Cell::none("more than 1 % may be left on the horizon"))
        }),
        row(Promised, "guaranteed_rate_per_s", "guaranteed rate", |s| {
            let repeat =
                s.guarantee()?.repeat.ok_or_else(|| Cell::none("what is left is not known to fall again and again"))?;
            Ok(Cell::number(repeat.left.ln() / repeat.over_s, "1/s"))
        }),
        row(Predicted, "predicted_value", &agreed_upon, |s| {
            let course = s.course()?;
            if !course.reached {
                return Err(Cell::none("agreement is not predicted on the horizon"));
            }
            Ok(Cell::entries(&course.value, &s.gap_unit()))
        }),
        row(Predicted, "predicted_settled_s", "settled to 1 %", |s| {
            s.course()?.settled_s.map(|t_s| Cell::number(t_s, "s")).ok_or_else(|| Cell::none("not before the horizon"))
        }),
        row(Predicted, "predicted_rate_per_s", "rate", |s| match &s.prediction()?.rate {
            PredictedRate::Roots { root_per_s: [real, _], .. } => Ok(Cell::number(*real, "1/s")),
            PredictedRate::Period { rate_per_s, .. } => Ok(Cell::number(*rate_per_s, "1/s")),
            PredictedRate::NoneSince(reason) => Err(Cell::none(reason.as_str())),
        }),
        row(Predicted, "predicted_peak_torque", &peak, |s| {
            let peak =
                s.course()?.peak_torque().ok_or_else(|| Cell::none("torques are predicted of robots under (6)–(7)"))?;
            Ok(Cell::number(peak.value.abs(), &torque_unit(s, peak.agent, peak.axis)))
        }),
        row(Predicted, "torque_bound", &bound, |s| {
            let bounds = s.course()?.peak_torques.iter().filter_map(|peak| Some((peak.at_most?, peak)));
            let (at_most, peak) = bounds
                .reduce(|a, b| if b.0 > a.0 { b } else { a })
                .ok_or_else(|| Cell::none("V(0) is not known, or V may grow"))?;
            Ok(Cell::number(at_most, &torque_unit(s, peak.agent, peak.axis)))
        }),
        row(Observed, "ended", "ended", ended),
        row(Observed, "goal", "goal", |s| match s.run.record.goal {
            Some(goal) => Ok(Cell::words(s.run.record.goal_word(goal)).and(&goal.goal.words())),
            None => Err(Cell::none("the scenario states none")),
        }),
        row(Observed, "final_gap", "gap at the end", final_gap),
        row(Observed, "settled_s", "settled to 1 %", |s| {
            s.metrics
                .settled_to_1_percent_s
                .map(|t_s| Cell::number(t_s, "s"))
                .ok_or_else(|| Cell::none("not before the end"))
        }),
        row(Observed, "value", &agreed_upon, value),
        row(Observed, "peak_torque", &peak, |s| {
            let peaks = s.metrics.peak_torques.iter();
            let peak = peaks.reduce(|a, b| if b.value.abs() > a.value.abs() { b } else { a });
            let peak = peak.ok_or_else(|| Cell::none("no torque is recorded"))?;
            Ok(Cell::number(peak.value.abs(), &torque_unit(s, peak.agent, peak.axis)))
        }),
        row(Observed, "input_jump", "input jumps by", input_jump),
        row(Observed, "first_jump", "first that jumps", first_jump),
        row(Observed, "rms_torque", "effort, rms τ", rms_torque),
        row(Observed, "work_j", "effort, ∫ Σ |τⱼ q̇ⱼ|", work),
        row(Observed, "messages", "messages", messages),
    ]);
    rows
}

/// The keys in which scenarios differ, where these are few: what a sweep varies.
fn varied(subjects: &[Subject<'_>]) -> Vec<Row> {
    let stated: Vec<BTreeMap<String, String>> = subjects.iter().map(|s| words::stated(&s.scenario)).collect();
    let elsewhere = |path: &str| SHOWN_ELSEWHERE.contains(&path.split('.').next().unwrap_or_default());
    let paths: BTreeSet<&String> = stated.iter().flat_map(BTreeMap::keys).filter(|path| !elsewhere(path)).collect();
    let differs = |path: &&String| stated.windows(2).any(|pair| pair[0].get(*path) != pair[1].get(*path));
    let paths: Vec<&String> = paths.into_iter().filter(differs).collect();
    if paths.len() > MOST_VARIED {
        return Vec::new();
    }
    let cell = |stated: &BTreeMap<String, String>, path: &String| match stated.get(path) {
        Some(value) => Cell::words(beginning(value, MOST_LETTERS)),
        None => Cell::none("the scenario does not state it"),
    };
    let row = |path: &String| {
        let cells = stated.iter().map(|stated| cell(stated, path)).collect();
        // Long values may differ behind what is shown.
        Row { same: false, ..Row::of(RowGroup::Simulated, &format!("scenario.{path}"), path, cells) }
    };
    paths.into_iter().map(row).collect()
}

fn same_robots(a: &Subject<'_>, b: &Subject<'_>) -> bool {
    let robots = |s: &Subject<'_>| {
        s.setup().agents.iter().map(|agent| (agent.robot.theta.clone(), agent.robot.axes.clone())).collect::<Vec<_>>()
    };
    robots(a) == robots(b)
}

fn same_network(a: &Subject<'_>, b: &Subject<'_>) -> bool {
    a.setup().network == b.setup().network
}

/// The start of robots and plants; that of reference dynamics has another length for every order.
fn same_start(a: &Subject<'_>, b: &Subject<'_>) -> bool {
    let starts = |s: &Subject<'_>| {
        s.setup()
            .agents
            .iter()
            .map(|agent| (agent.start.q.clone(), agent.start.dq.clone(), agent.start.rest.clone()))
            .collect::<Vec<_>>()
    };
    starts(a) == starts(b)
}

fn told(s: &Subject<'_>) -> Result<Cell, Cell> {
    match s.setup().transmits().as_slice() {
        [] => Err(Cell::none("no agent hears another")),
        transmitted => Ok(Cell::words(transmitted.join(", "))),
    }
}

fn order(s: &Subject<'_>) -> Result<Cell, Cell> {
    // Desired dynamics are one polynomial for all, of which roots, where they are stated, are no agent's.
    if let Some(desired) = s.setup().reference.downcast::<Desired>() {
        return Ok(Cell::number(desired.polynomial.order() as f64, ""));
    }
    match words::orders(s.setup()) {
        None if s.setup().following().is_some() => Err(Cell::none("it is that of the design behind a leader")),
        None => Err(Cell::none("its reference dynamics have no roots")),
        Some((least, most)) if least == most => Ok(Cell::number(most as f64, "")),
        Some((least, most)) => Ok(Cell::words(format!("{least} to {most}"))),
    }
}

fn start(s: &Subject<'_>) -> Result<Cell, Cell> {
    match s.metrics.disagreement {
        Disagreement::Measured { initial, .. } => Ok(Cell::number(initial, &s.gap_unit())),
        Disagreement::Absent(absence) => Err(Cell::none(absence.words())),
    }
}

fn verdict(s: &Subject<'_>) -> Result<Cell, Cell> {
    let report = s.run.record.verdicts;
    let worst = report.worst();
    let names = report.hypotheses.iter().filter(|hypothesis| hypothesis.answer() == worst);
    let names: Vec<&str> = names.map(|hypothesis| hypothesis.id.name()).collect();
    let words = match worst {
        Answer::Holds => worst.words().to_owned(),
        _ => format!("{}: {}", worst.words(), names.join(", ")),
    };
    Ok(Cell::words([vec![words], s.run.record.failures()].concat().join("; ")))
}

fn ended(s: &Subject<'_>) -> Result<Cell, Cell> {
    Ok(match &s.run.record.outcome.ending {
        Ending::Completed => Cell::words("completed"),
        Ending::Interrupted { t_s } => Cell::words(format!("interrupted at {} s", number(*t_s))),
        Ending::CutOff { t_s } => Cell::words(format!("cut off at {} s", number(*t_s))),
        Ending::BrokeDown(breakdown) => {
            let agent = names::agent_name(s.setup(), breakdown.agent);
            Cell::words(format!("broke down at {} s, {agent}", number(breakdown.t_s)))
        }
    })
}

fn final_gap(s: &Subject<'_>) -> Result<Cell, Cell> {
    match s.metrics.disagreement {
        Disagreement::Measured { last, .. } => {
            let what = Gap::of(s.setup()).word();
            Ok(Cell::number(last, &s.gap_unit()).and(if what == "error" { "error" } else { "" }))
        }
        Disagreement::Absent(absence) => Err(Cell::none(absence.words())),
    }
}

fn value(s: &Subject<'_>) -> Result<Cell, Cell> {
    if Gap::of(s.setup()) == Gap::Error {
        return Err(Cell::none(NOT_AGREED_UPON));
    }
    let means = s.metrics.final_means.as_ref().ok_or_else(|| Cell::none("agents cannot be compared"))?;
    if !s.run.record.is_agreed(&s.metrics) {
        return Err(Cell::none("no agreement by the end"));
    }
    Ok(Cell::entries(means, &s.gap_unit()))
}

fn torque_unit(s: &Subject<'_>, agent: usize, axis: usize) -> String {
    text::unit(&names::unit(s.setup(), agent, Signal::Torque, axis))
}

/// The largest jump of each derivative, of all inputs whose derivative that is; and what jumps.
fn jumps(s: &Subject<'_>) -> Result<Vec<Option<LargestJump>>, Cell> {
    let found = s.run.jumps.map_err(Cell::none)?;
    let kinds = found.kinds();
    let most = kinds.iter().map(|kind| kind.derivatives).max().unwrap_or(0);
    let largest = |r: usize| {
        let all = kinds.iter().filter(|kind| r < kind.derivatives).filter_map(|kind| found.largest(*kind, r));
        all.reduce(|a, b| if b.size > a.size { b } else { a })
    };
    let all: Vec<_> = (0..most).map(largest).collect();
    if all.iter().all(Option::is_none) {
        return Err(Cell::none("nothing that is heard jumps"));
    }
    Ok(all)
}

fn jump_cell(s: &Subject<'_>, jump: LargestJump, r: usize, letter: &str) -> Cell {
    let unit = text::unit(&names::unit(s.setup(), jump.agent, jump.signal, jump.axis));
    let (unit, power) = unit.strip_suffix("/s").map_or((unit.as_str(), r), |unit| (unit, r + 1));
    let per = match power {
        0 => String::new(),
        1 => "/s".into(),
        power => format!("/s{}", superscript(power)),
    };
    // What is a pure number is still one per second.
    let unit = if unit.is_empty() && !per.is_empty() { "1" } else { unit };
    let mut cell = Cell::number(jump.size, &format!("{unit}{per}"));
    if !letter.is_empty() && cell.because.is_none() {
        cell.words = format!("{letter}, by {}", cell.words);
    }
    cell
}

fn input_jump(s: &Subject<'_>) -> Result<Cell, Cell> {
    let all = jumps(s)?;
    let jump = all.first().copied().flatten().ok_or_else(|| Cell::none("nothing that enters the input jumps"))?;
    Ok(jump_cell(s, jump, 0, ""))
}

fn first_jump(s: &Subject<'_>) -> Result<Cell, Cell> {
    let all = jumps(s)?;
    let (r, jump) = all
        .iter()
        .enumerate()
        .find_map(|(r, jump)| Some((r, (*jump).filter(|jump| jump.size > 0.0)?)))
        .ok_or_else(|| Cell::none("no derivative that is looked at jumps"))?;
    let letter = match (jump.signal, r) {
        (Signal::Torque, 0) => "τ".to_owned(),
        (Signal::Torque, 1) => "dτ/dt".to_owned(),
        (Signal::Torque, r) => format!("d{0}τ/dt{0}", superscript(r)),
        (signal, 0) => signal.name(),
        (signal, r) => format!("derivative {r} of {}", signal.name()),
    };
    Ok(jump_cell(s, jump, r, &letter))
}

/// The root of the mean of τ² over time, agents and axes of each unit.
fn rms_torque(s: &Subject<'_>) -> Result<Cell, Cell> {
    let table = Table::new(s.setup(), &s.run.record.outcome.recording);
    let mut sums: Vec<(String, f64, usize)> = Vec::new();
    for (agent, axis, values) in table.axes(Signal::Torque) {
        let unit = torque_unit(s, agent, axis);
        let square: f64 = values.iter().map(|value| value * value).sum();
        match sums.iter_mut().find(|(known, ..)| *known == unit) {
            Some((_, sum, many)) => (*sum, *many) = (*sum + square, *many + values.len()),
            None => sums.push((unit, square, values.len())),
        }
    }
    let rms = |(unit, sum, many): &(String, f64, usize)| Cell::number((sum / (*many).max(1) as f64).sqrt(), unit);
    match sums.as_slice() {
        [] => Err(Cell::none("no torque is recorded")),
        [one] => Ok(rms(one)),
        all => Ok(Cell::words(all.iter().map(|one| rms(one).words).collect::<Vec<_>>().join("; "))),
    }
}

/// ∫ Σ |τ q̇| dt by the trapezium rule over the rows.
fn work(s: &Subject<'_>) -> Result<Cell, Cell> {
    let setup = s.setup();
    if !setup.agents.iter().all(|agent| agent.robot.kind.lagrangian().is_some()) {
        return Err(Cell::none("τᵀq̇ is a power for robots with M, C and g alone"));
    }
    let table = Table::new(setup, &s.run.record.outcome.recording);
    let mut joules = 0.0;
    let mut any = false;
    for (agent, axis, torque) in table.axes(Signal::Torque) {
        let Some(speed) = table.column(agent, Signal::Velocity, axis) else { continue };
        any = true;
        let power: Vec<f64> = torque.iter().zip(speed).map(|(torque, speed)| (torque * speed).abs()).collect();
        joules +=
            table.t_s.windows(2).zip(power.windows(2)).map(|(t, p)| 0.5 * (t[1] - t[0]) * (p[0] + p[1])).sum::<f64>();
    }
    if any { Ok(Cell::number(joules, "J")) } else { Err(Cell::none("no torque or no velocity is recorded")) }
}

fn messages(s: &Subject<'_>) -> Result<Cell, Cell> {
    let links = Link::all(&s.setup().network, &s.run.record.outcome.ending);
    if !s.setup().network.has_edges() {
        return Err(Cell::none("no agent hears another"));
    }
    if links.is_empty() {
        return Err(Cell::none("messages flow continuously; there are no packets to count"));
    }
    let (sent, lost) = links.iter().fold((0, 0), |(sent, lost), link| (sent + link.sent, lost + link.lost));
    Ok(Cell::number(sent as f64, "").and(&format!("{lost} lost")))
}
