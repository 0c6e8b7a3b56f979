//! What a run came to, in plain words: whether what was to vanish did, how far it is, and what to change.

use forwardstep_check::prediction::only_passes;
use forwardstep_check::{Answer, Id, RECOMMENDED_MARGIN, Report, SamplingMargin};
use forwardstep_sim::recording::{ClippedSamples, Ending, Signal};
use forwardstep_sim::setup::Setup;

use super::disagreement::{Disagreement, DisagreementSeries, Gap, greater};
use super::metrics::Metrics;
use super::names::{agent_name, gap_unit_on, gap_words, unit};
use super::prediction::{PredictedRate, Predictions};
use super::record::RunRecord;
use super::table::Table;
use super::trend::{Trend, falls_steadily, is_slowing, lately};
use crate::scenario::Goal;
use crate::wording::about;

/// What is left of the largest gap when it is said to have vanished, without a goal.
const VANISHED: f64 = 0.01;
/// So many times what is missing at the rate of the end.
const ROOM: f64 = 1.5;
/// A longer run is advised up to so many times its length.
const LONGEST: f64 = 100.0;
/// A gap that is so many times what the design alone leaves is not its own.
const ALONE: f64 = 2.0;
/// The same where there is another reason.
const MUCH: f64 = 0.05;
/// A gap that is so many times what it was has not stayed: steps became short, or numbers too large, because it grew.
const DRIVEN_APART: f64 = 1e3;
/// s at the end, in 1/s of the gap, counts as left over above this.
pub(super) const LEFT_OVER: f64 = 1e-3;

/// What a run came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Conclusion {
    /// Whether what was to vanish did, as far as the goal asks, or to 1 % where there is none.
    pub reached: bool,
    /// One sentence without a full stop.
    pub sentence: String,
    /// What to change where it was not reached; the most likely first.
    pub advice: Vec<String>,
}

impl Conclusion {
    /// `None` for a run that was expected to diverge, for one that broke down without having been driven apart, and where nothing can be compared.
    pub fn of(record: &RunRecord<'_>, metrics: &Metrics) -> Option<Conclusion> {
        let bound = match record.goal.map(|outcome| outcome.goal) {
            Some(Goal::ExpectDiverges) => return None,
            goal => goal.and_then(|goal| goal.bound()),
        };
        let Disagreement::Measured { last, largest, .. } = metrics.disagreement else { return None };
        let table = Table::new(record.setup, &record.outcome.recording);
        let series = DisagreementSeries::of_table(&table).ok()?;
        let end = End::of(&table, &series)?;
        if matches!(record.outcome.ending, Ending::BrokeDown(_)) {
            let before = metrics.disagreement.initial()?;
            let grew = before > 0.0 && last > DRIVEN_APART * before && last.is_finite();
            return grew.then(|| Conclusion {
                reached: false,
                sentence: end.driven_apart(record.setup, before),
                advice: hypotheses(record.verdicts),
            });
        }
        let bound = bound.unwrap_or(VANISHED * largest);
        // What was nothing from the start has vanished as well.
        let t_s = &record.outcome.recording.t_s;
        let passes = only_passes(t_s, &series.overall, bound);
        let reached = last < bound && !passes || last == 0.0;
        let (trend, slows) = (Trend::of(t_s, &series.overall), is_slowing(t_s, &series.overall));
        // A goal may ask for less than that nothing is left.
        let arrival = match reached {
            true if last < VANISHED * largest || last == 0.0 => Arrival::Vanished,
            true => Arrival::WithinGoal,
            false if passes => Arrival::Passing,
            false => Arrival::Apart,
        };
        let sentence = end.sentence(record.setup, arrival, trend);
        // What passes is about as far off as it was lately.
        let left = if passes { lately(t_s, &series.overall) } else { last };
        let pace = Pace { trend, slows, steadily: falls_steadily(t_s, &series.overall), passes };
        let advice = if reached { Vec::new() } else { advice(record, metrics, pace, bound / left) };
        Some(Conclusion { reached, sentence, advice })
    }
}

/// How close agents came to each other, or to what they follow.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Arrival {
    /// Next to nothing is left, and no more than the goal allows.
    Vanished,
    /// As close as the goal asks.
    WithinGoal,
    /// As close for an instant, on the way through.
    Passing,
    /// Not so close.
    Apart,
}

/// What is furthest off at the last row.
struct End {
    kind: Gap,
    axis: usize,
    /// The agent furthest from its target; two agents furthest apart.
    agents: Vec<usize>,
    gap: f64,
    /// How far an agent that leads is from its target, and the others from it, with axis and agent.
    led: Option<[(f64, usize, usize); 2]>,
    /// The largest speed of any agent on an axis with the same unit, where it is recorded and agents should come to rest.
    speed: Option<f64>,
    /// Whether that is a good part of the largest it ever was.
    goes_on: bool,
}

/// What is slower than this part of the largest speed comes to rest.
const GOES_ON: f64 = 0.1;

impl End {
    fn of(table: &Table<'_>, series: &DisagreementSeries) -> Option<End> {
        let last_of = |values: &[f64]| values.last().copied();
        let gaps = series.per_axis.iter().enumerate().filter_map(|(axis, values)| Some((axis, last_of(values)?)));
        let (axis, gap) = gaps.reduce(|a, b| if greater(a.1, b.1).to_bits() == a.1.to_bits() { a } else { b })?;
        let kind = Gap::of(table.setup);
        let agents = 0..table.agents();
        let value = |agent: usize| {
            let offset = || table.column(agent, Signal::Offset, axis).and_then(last_of).unwrap_or(0.0);
            match kind {
                Gap::Error => table.column(agent, Signal::Error, axis).and_then(last_of).map(f64::abs),
                Gap::Disagreement => {
                    table.column(agent, Signal::Position, axis).and_then(last_of).map(|q| q - offset())
                }
            }
        };
        let values = || agents.clone().filter_map(|agent| Some((agent, value(agent)?)));
        let highest = values().max_by(|a, b| a.1.total_cmp(&b.1))?.0;
        let lowest = values().min_by(|a, b| a.1.total_cmp(&b.1))?.0;
        let agents_named = match kind {
            Gap::Error => vec![highest],
            Gap::Disagreement => vec![lowest.min(highest), lowest.max(highest)],
        };
        // Offsets may travel, and agents with them.
        let travels = agents.clone().any(|agent| table.column(agent, Signal::Offset, axis).is_some());
        let unit_of = |agent: usize, axis: usize| unit(table.setup, agent, Signal::Velocity, axis);
        let own = unit_of(lowest, axis);
        let alike =
            |agent: &usize| (0..series.per_axis.len()).filter(|axis| unit_of(*agent, *axis) == own).collect::<Vec<_>>();
        let speeds = agents.filter(|_| !travels).flat_map(|agent| {
            let axes = alike(&agent).into_iter();
            axes.filter_map(move |axis| table.column(agent, Signal::Velocity, axis))
        });
        let speeds: Vec<&[f64]> = speeds.collect();
        let speed = speeds.iter().filter_map(|values| last_of(values)).map(f64::abs).reduce(greater);
        let fastest = speeds.iter().flat_map(|values| values.iter()).copied().map(f64::abs).fold(0.0, f64::max);
        let goes_on = speed.is_some_and(|speed| speed > GOES_ON * fastest);
        let errors = |of: &dyn Fn(usize) -> bool| {
            let all = (0..table.agents()).filter(|agent| of(*agent)).flat_map(|agent| {
                let column = move |axis| table.column(agent, Signal::Error, axis).and_then(last_of);
                (0..series.per_axis.len()).filter_map(move |axis| Some((column(axis)?.abs(), axis, agent)))
            });
            all.reduce(|a, b| if greater(a.0, b.0).to_bits() == a.0.to_bits() { a } else { b })
        };
        let led = table
            .setup
            .leading_agent()
            .filter(|_| kind == Gap::Error)
            .and_then(|leader| Some([errors(&|agent| agent == leader)?, errors(&|agent| agent != leader)?]));
        Some(End { kind, axis, agents: agents_named, gap, led, speed, goes_on })
    }

    /// What became of a gap before a run broke down.
    fn driven_apart(&self, setup: &Setup, before: f64) -> String {
        let End { kind, axis, agents, gap, .. } = self;
        let size = sized(*gap, &gap_unit_on(setup, agents.first().copied().unwrap_or(0), *axis));
        let (done, how) = match (kind, setup.following().is_some()) {
            (Gap::Disagreement, _) => ("driven apart", "apart"),
            (Gap::Error, true) => ("driven away from the leader", "off"),
            (Gap::Error, false) => ("driven away from the target", "off"),
        };
        let names: Vec<String> = agents.iter().map(|agent| agent_name(setup, *agent)).collect();
        format!(
            "{done}: {}, {size} {how} ({}), {} at the start; see to that first",
            gap_words(setup, *axis),
            names.join(", "),
            about(before)
        )
    }

    fn sentence(&self, setup: &Setup, arrival: Arrival, trend: Trend) -> String {
        let End { kind, axis, agents, gap, led: errors, speed, goes_on } = self;
        let first = agents.first().copied().unwrap_or(0);
        let size = sized(*gap, &gap_unit_on(setup, first, *axis));
        let names: Vec<String> = agents.iter().map(|agent| agent_name(setup, *agent)).collect();
        let led = setup.following().is_some();
        let (done, so_far) = match (kind, led) {
            (Gap::Disagreement, _) if Gap::keeps_offsets(setup) => {
                ("in formation", format!("{size} apart, less offsets,"))
            }
            (Gap::Disagreement, _) => ("agreed", format!("{size} apart")),
            (Gap::Error, true) => match errors {
                Some([(own, own_axis, _), (others, axis, other)]) => {
                    let leader = setup.leading_agent().unwrap_or(first);
                    let [own, others] = [(own, own_axis), (others, axis)]
                        .map(|(size, axis)| sized(*size, &gap_unit_on(setup, first, *axis)));
                    let name = agent_name(setup, leader);
                    let whose = agent_name(setup, *other);
                    ("following", format!("{others} from {name} ({whose}), and {name} {own} from its target,"))
                }
                None => ("following", format!("{size} from the leader")),
            },
            (Gap::Error, false) => ("on target", format!("{size} from the target")),
        };
        // Who agrees may run away with all others.
        let together = match speed {
            Some(speed) if *goes_on && *kind == Gap::Disagreement => {
                format!(
                    ", all together still moving at {}",
                    sized(*speed, &unit(setup, first, Signal::Velocity, *axis))
                )
            }
            Some(_) | None => String::new(),
        };
        match arrival {
            Arrival::Vanished => return format!("{done}: {so_far} at most{together}"),
            Arrival::WithinGoal => return format!("{done} as far as the goal asks: {so_far} at most{together}"),
            Arrival::Passing | Arrival::Apart => {}
        }
        let still = match speed {
            Some(0.0) if *kind == Gap::Disagreement => ", at rest".to_owned(),
            Some(speed) if *kind == Gap::Disagreement => {
                format!(", still moving at {}", sized(*speed, &unit(setup, first, Signal::Velocity, *axis)))
            }
            Some(_) | None => String::new(),
        };
        let trend = if arrival == Arrival::Passing { "and so near only in passing" } else { trend.words() };
        // Who leads has been named with how far it is off.
        let whose = if led && errors.is_some() { String::new() } else { format!(" ({})", names.join(", ")) };
        let so_far = if whose.is_empty() { so_far.trim_end_matches(',') } else { &so_far };
        let name = gap_words(setup, *axis);
        // "axis 1 1 m" would be one number.
        let apart = if name.ends_with(|letter: char| letter.is_ascii_digit()) { "," } else { "" };
        format!("not {done}: {name}{apart} {so_far}{whose}{still}, {trend}")
    }
}

fn sized(value: f64, unit: &str) -> String {
    format!("{} {unit}", about(value)).trim_end().to_owned()
}

/// How the gap moves at the end.
#[derive(Clone, Copy)]
struct Pace {
    trend: Trend,
    /// It falls more and more slowly.
    slows: bool,
    /// It falls from row to row.
    steadily: bool,
    /// It is small only in passing.
    passes: bool,
}

/// Whether an error stays since controllers hold what they ask for while a target or a leader moves on.
fn samples_leave(setup: &Setup) -> bool {
    setup.control.is_some() && (setup.all_track() || setup.leader().is_some())
}

/// What to change: `share` of the gap is what may be left. With its trend comes whether that slows down.
fn advice(record: &RunRecord<'_>, metrics: &Metrics, pace: Pace, share: f64) -> Vec<String> {
    let Pace { trend, slows, steadily, passes } = pace;
    let mut advice: Vec<String> = Vec::new();
    let takes_s = slow_s(record.prediction.as_ref(), metrics, share, trend);
    let stopped = record.outcome.ending.before_horizon_s().is_some();
    // Where messages do not reach everybody no time is enough.
    let violated = |id: Id| record.verdicts.hypotheses.iter().any(|it| it.id == id && it.answer() == Answer::Violated);
    let is_cut = violated(Id::SpanningTree);
    let takes_s = takes_s.filter(|_| !is_cut);
    if let (Trend::Falls(left), Some(last_t_s), false) = (trend, metrics.last_t_s, is_cut) {
        // What falls fast at first slows down to what the design does by itself, where that is known.
        let more_s = (last_t_s * share.ln() / left.ln() / 4.0).max(takes_s.unwrap_or(0.0));
        // Half as much again as it takes at this rate, which need not stay.
        let end_s = nice(last_t_s + ROOM * more_s);
        if stopped && end_s <= record.setup.time.end_s {
            advice.push("let it run to its end: at this rate that is enough".into());
        } else if more_s.is_finite() && more_s <= LONGEST * last_t_s {
            advice.push(if passes {
                "run longer, and record more often: how long a gap takes that swings through zero cannot be told from its end".into()
            } else if slows {
                format!("run longer: it comes closer more and more slowly; try `time.end_s = {end_s}`")
            } else if !steadily && samples_leave(record.setup) {
                format!(
                    "run longer, or sample faster: it comes closer unevenly, and may come no closer than samples let it; try `time.end_s = {end_s}`"
                )
            } else if !steadily {
                format!("run longer: it comes closer unevenly; try `time.end_s = {end_s}`")
            } else {
                format!("run longer: at this rate `time.end_s = {end_s}` would be about enough")
            });
        }
    }
    // A time has been advised, with room.
    let at_least = if matches!(trend, Trend::Falls(_)) { "" } else { " at least" };
    let needs = |takes_s: f64| {
        if advice.is_empty() { format!(": it needs some {} s more{at_least}", nice(takes_s)) } else { String::new() }
    };
    advice.extend(takes_s.map(needs).map(|needs| {
        format!("the design is slow, whatever the robots do{needs}; larger weights, more links or larger roots make it faster")
    }));
    advice.extend(hypotheses(record.verdicts));
    if let Some(ClippedSamples { samples, torque, rate }) = record.outcome.statistics.clipped
        && torque + rate > 0
    {
        // One command can meet both.
        let changed = match (torque, rate) {
            (torque, 0) => format!("limits of torques changed {torque}"),
            (0, rate) => format!("limits of torque rates changed {rate}"),
            (torque, rate) => format!("limits of torques changed {torque}, and limits of their rates {rate},"),
        };
        advice.push(format!("{changed} of {samples} commands: raise them, or ask for less"));
    }
    let late = is_late_behind_leader(record.verdicts) && !matches!(trend, Trend::Falls(_));
    if late {
        advice.push(
            "messages are late, and a leader that moves is followed as closely as they let it, see what `forwardstep check` promises: shorter \
             delays, or fewer links in a row, leave less"
                .into(),
        );
    }
    let alone = left_alone(record.prediction.as_ref());
    if let (Some(s), Disagreement::Measured { last, .. }) = (metrics.final_tracking_error, metrics.disagreement)
        && !matches!(trend, Trend::Falls(_))
        && s > left_over(late, record.verdicts) * last
        && alone.is_none_or(|alone| last > ALONE * alone)
    {
        // More damping is what samples bear least.
        let coarse = metrics.watched.and_then(|watched| watched.sampling_margin).map(|margin| margin.sigma);
        let before = SamplingMargin::of(record.setup).map_or(0.0, |margin| margin.worst.sigma);
        let change = match coarse.filter(|sigma| *sigma > RECOMMENDED_MARGIN) {
            Some(sigma) if before > RECOMMENDED_MARGIN => format!(
                "the sampling period is too long for the gains (margin σ = {}): sample faster or lower the gains; `forwardstep check` says which",
                about(sigma)
            ),
            // Whatever drives robots away makes them fast, and σ large.
            Some(sigma) => format!(
                "see what acts on them first; the sampling margin, {} before the run, came to {} where that led",
                about(before),
                about(sigma)
            ),
            None if alone.is_some() => "raise the damping, or see what acts on them".to_owned(),
            None => "raise the damping, or see what acts on them; `forwardstep check --predict` tells how much the design leaves by itself".to_owned(),
        };
        advice.push(format!("robots do not follow their references, |s| is still {}: {change}", about(s)));
    }
    if advice.is_empty() {
        advice.push("see `forwardstep check --predict` for how fast the design is without tracking errors".into());
    }
    advice
}

/// The part of the gap above which s at the end is what keeps it: all of it behind a leader who is heard late, and much of it where a hypothesis
/// is violated, which says more.
fn left_over(late: bool, report: &Report) -> f64 {
    let is_violated = report.hypotheses.iter().any(|hypothesis| hypothesis.answer() == Answer::Violated);
    if late {
        1.0
    } else if is_violated {
        MUCH
    } else {
        LEFT_OVER
    }
}

/// Whether a leader is followed over links that delay, which leaves an error however well the robots do.
fn is_late_behind_leader(report: &Report) -> bool {
    let asks = |id: Id| report.hypotheses.iter().any(|hypothesis| hypothesis.id == id);
    asks(Id::SignGain) && asks(Id::BoundedDelays)
}

/// What is left at the end without s, where that is known. Where it is about as much, robots are not what keeps agents apart.
fn left_alone(prediction: Option<&Predictions>) -> Option<f64> {
    prediction?.course()?.disagreement.last().copied()
}

/// How long the design takes by itself, s, where that is long beside the run, and where by itself it would not have left much less than there is.
fn slow_s(prediction: Option<&Predictions>, metrics: &Metrics, share: f64, trend: Trend) -> Option<f64> {
    let prediction = prediction?;
    if let Disagreement::Measured { last, .. } = metrics.disagreement
        && left_alone(Some(prediction)).is_some_and(|alone| last > ALONE * alone)
    {
        return None;
    }
    let rate_per_s = match &prediction.rate {
        PredictedRate::Roots { root_per_s: [rate_per_s, _], .. } | PredictedRate::Period { rate_per_s, .. } => {
            *rate_per_s
        }
        PredictedRate::NoneSince(_) => return None,
    };
    // What does not fall yet begins to do so later.
    let room = if matches!(trend, Trend::Falls(_)) { 1.0 } else { ROOM };
    let takes_s = room * share.ln() / rate_per_s;
    (rate_per_s < 0.0 && takes_s > metrics.last_t_s? / 4.0).then_some(takes_s)
}

/// The hypotheses that keep the theorem from speaking, with the changes that would let it: those that say the same of several agents once.
fn hypotheses(report: &Report) -> Vec<String> {
    const MOST: usize = 3;
    let mut lines: Vec<(String, Vec<String>)> = Vec::new();
    for hypothesis in report.hypotheses.iter().filter(|hypothesis| !hypothesis.answer().is_fine()) {
        let (answer, requires, name) = (hypothesis.answer().words(), hypothesis.requires(), hypothesis.id.name());
        let line = format!("{answer} [{name}]: {requires}");
        let at = lines.iter().position(|(known, _)| *known == line).unwrap_or(lines.len());
        if at == lines.len() {
            lines.push((line, Vec::new()));
        }
        let changes = &mut lines[at].1;
        changes.extend(hypothesis.change().filter(|change| !changes.contains(change)));
    }
    let words = |(line, changes): (String, Vec<String>)| match &changes[..] {
        [] => line,
        changes => format!("{line}; to make it hold: {}", changes.join("; or ")),
    };
    lines.into_iter().take(MOST).map(words).collect()
}

/// The next number of one or two digits and zeros: a quotient or a product of whole numbers, which is written as short as it is.
fn nice(value: f64) -> f64 {
    let exponent = value.abs().log10().floor() as i32 - 1;
    let unit = 10.0_f64.powi(exponent.abs());
    if exponent < 0 { (value * unit).ceil() / unit } else { (value / unit).ceil() * unit }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_advised_that_one_would_write() {
        let advised = [12.3, 99.1, 100.0, 1234.5, 0.0431, 3.71, 3.8].map(nice);
        assert_eq!(advised, [13.0, 100.0, 100.0, 1300.0, 0.044, 3.8, 3.8]);
    }
}
