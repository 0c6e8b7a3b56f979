//! A new scenario is tried before it is written: gains and horizon are those with which its robots do what they are to do.

use std::ops::ControlFlow;

use forwardstep::io::output::{Disagreement, LimitKind, LimitReached, Metrics, ending_sentence, names, stiff_words};
use forwardstep::io::scenario::{Goal, LawTemplate, Scenario, Template, Tuning};
use forwardstep::sim::quantity::{about, with_power};
use forwardstep::sim::recording::{BreakdownCause, Signal};
use forwardstep::sim::{Ending, Setup, simulate};

use crate::commands::progress::Bar;
use crate::console::{Plain, complain, remark};
use crate::status::Status;

/// What may be left of the largest gap, and is written as the goal.
const LEFT: f64 = 0.01;
/// The gap of the trial is at most this much of the goal, since other machines round differently.
const MARGIN: f64 = 0.5;
/// A gap that falls is waited for up to so long, s: before other gains are tried, and after.
const LONGEST_S: [f64; 2] = [150.0, 2e4];
/// A gap falls if this much of the largest is left at the end.
const FALLS: f64 = 0.7;
/// What one trial may take, and all of them together: some tens of seconds. A step costs the squares of how many axes the robots have, and
/// something for each.
const EFFORT: [usize; 2] = [300_000_000, 900_000_000];
/// What a step costs for each robot besides.
const EACH: usize = 30;
/// A trial ends early if it has not come this far, of its horizon, after `EARLY` of what it may take.
const SO_FAR: f64 = 0.01;
/// After this much of what it may take, a trial that would not reach its end at this pace is asked why.
const EARLY: f64 = 0.1;
/// Steps of at most this mean length are so short for a reason that is looked for, s.
const SHORT_S: f64 = 1e-4;

/// The robot itself makes the closed loop stiff where its damping has this much of the fastest rate, which is known to a factor of two.
const OWN: f64 = 0.3;

/// The gains that are tried, one after the other: the default ones, faster learning, learning from nearby, slower gains, no learning at all, slower
/// without learning, which takes the least torque.
const TUNINGS: [Tuning; 7] = [
    Tuning::USUAL,
    Tuning { adaptation_per_s: 20.0, ..Tuning::USUAL },
    Tuning { adaptation_per_s: 20.0, known: 0.8, ..Tuning::USUAL },
    Tuning { damping_per_s: 4.0, adaptation_per_s: 4.0, known: 0.8 },
    Tuning { known: 1.0, ..Tuning::USUAL },
    Tuning { damping_per_s: 4.0, adaptation_per_s: 4.0, known: 1.0 },
    Tuning { damping_per_s: 1.0, adaptation_per_s: 1.0, known: 1.0 },
];

/// What the trials came to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tried {
    /// The scenario with the gains, the horizon and the goal that were found; as it was given where none were.
    pub(super) template: Template,
    /// Whether the robots did what they are to do.
    pub(super) works: bool,
}

/// How one run went.
enum Went {
    /// The gap vanished; a joint left its limits on the way, or took more torque than it has.
    Well { goal: f64, gap: String, leaves: Option<String>, exceeds: Option<Exceeds> },
    /// The gap falls, and would have vanished by then, s.
    TooShort { needs_s: f64, gap: String },
    /// Anything else, in words.
    Badly(String),
    /// What no gains would change.
    Hopeless(String),
}

/// A torque beyond a limit that is not enforced.
struct Exceeds {
    /// By how many times.
    times: f64,
    /// In words, without a beginning.
    words: String,
}

/// Gains that do what they should, but for limits that are reported only: better ones leave no position limits, and then take less torque.
struct SecondBest {
    leaves: bool,
    times: f64,
    template: Template,
    /// The gains in words.
    described: String,
}

impl SecondBest {
    /// That it is no more than that: which limits no trial kept to, and what was taken all the same.
    fn words(&self) -> String {
        let limits = match (self.leaves, self.times > 0.0) {
            (true, true) => "limits of position and effort",
            (true, false) => "position limits",
            (false, _) => "effort limits",
        };
        let gains = self.described.trim_end_matches(": ");
        format!(
            "no trial kept within the {limits}, which runs report and do not enforce; what is written is the one that came nearest: {gains}"
        )
    }
}

/// Tries a scenario with several gains and horizons. `read` reads its text.
pub(super) fn tried(template: Template, read: &dyn Fn(&Template) -> Result<Scenario, Status>) -> Result<Tried, Status> {
    let adapts = template.robot.law == LawTemplate::Adaptive;
    let tunings = if adapts { &TUNINGS[..] } else { &TUNINGS[..1] };
    let patience: &[f64] = if adapts { &LONGEST_S } else { &LONGEST_S[1..] };
    let tries = patience.iter().flat_map(|longest_s| tunings.iter().map(move |tuning| (*longest_s, *tuning)));
    let (mut effort, mut says, mut second_best) = (EFFORT[1], Said::default(), None::<SecondBest>);
    for (longest_s, tuning) in tries {
        if effort == 0 || (longest_s > LONGEST_S[0] && second_best.is_some()) {
            break;
        }
        let mut candidate = Template { tuning, ..template.clone() };
        let described = describe(Tuning { known: template.robot.known(tuning.known), ..tuning }, adapts);
        loop {
            match run(&read(&candidate)?, &mut effort)? {
                Went::Well { goal, gap, leaves, exceeds } => {
                    candidate.goal = Some(goal);
                    let leaves_limits = leaves.iter().map(|axis| format!("{axis} leaves its limits on the way"));
                    let buts: Vec<String> = leaves_limits.chain(exceeds.iter().map(|it| it.words.clone())).collect();
                    let but = if buts.is_empty() { String::new() } else { format!(", but {}", buts.join(", and ")) };
                    says.push(format!("{described}{gap} after {} s{but}", candidate.end_s));
                    // What is reported only, and not kept to, shows nothing of a robot that has no more.
                    candidate.remarks.extend(exceeds.as_ref().map(|Exceeds { words, .. }| {
                        format!(
                            "In the trial {words}: effort limits are not enforced in it. With `enforce_limits = true` in \
                             [[agents]] the run keeps to them; slower gains or a nearer start need less."
                        )
                    }));
                    let (leaves, times) = (leaves.is_some(), exceeds.map_or(0.0, |it| it.times));
                    if !leaves && times == 0.0 {
                        return Ok(Tried { template: candidate, works: true });
                    }
                    if second_best.as_ref().is_none_or(|best| (leaves, times) < (best.leaves, best.times)) {
                        second_best = Some(SecondBest { leaves, times, template: candidate, described });
                    }
                }
                Went::TooShort { needs_s, .. } if needs_s <= longest_s && needs_s > candidate.end_s => {
                    candidate.end_s = needs_s;
                    continue;
                }
                Went::TooShort { gap, .. } => says.push(format!("{described}still {gap} after {} s", candidate.end_s)),
                Went::Badly(what) => says.push(format!("{described}{what}")),
                Went::Hopeless(what) => {
                    says.push(format!("{described}{what}"));
                    effort = 0;
                }
            }
            break;
        }
    }
    Ok(match second_best {
        // Limits are reported, not enforced: the robots agree all the same, so that this is no failure.
        Some(best) => {
            remark(best.words());
            Tried { template: best.template, works: true }
        }
        None => {
            let mut template = template;
            let usual = says.sentences.first().cloned().unwrap_or_default();
            template.remarks.push(format!("No trial of this did what it should: {usual}"));
            Tried { template, works: false }
        }
    })
}

/// What was said, each sentence once: gains that fail alike are tried again with more patience.
#[derive(Default)]
struct Said {
    sentences: Vec<String>,
}

impl Said {
    /// Tells it at once: several trials may take a minute.
    fn push(&mut self, sentence: String) {
        if !self.sentences.contains(&sentence) {
            remark(format_args!("tried {sentence}"));
            self.sentences.push(sentence);
        }
    }
}

/// The gains in words that begin a sentence.
fn describe(tuning: Tuning, adapts: bool) -> String {
    let Tuning { damping_per_s, adaptation_per_s, known } = tuning;
    if !adapts {
        return "as it is: ".to_owned();
    }
    let knows = match known {
        0.0 => "nothing known".to_owned(),
        1.0 => "all known".to_owned(),
        share => format!("{share} of everything known"),
    };
    format!("with bandwidths of {damping_per_s} and {adaptation_per_s} per second and {knows}: ")
}

/// Whether a trial ends before its time, by the shares of its effort and of its horizon: it crawls, or it would not reach its end at this pace and
/// was not asked why before.
fn is_slow(taken: f64, come: f64, asked: bool) -> bool {
    taken > EARLY && (come < SO_FAR || (!asked && come < taken))
}

/// Simulates a scenario, as long as there is `effort` left.
fn run(scenario: &Scenario, effort: &mut usize) -> Result<Went, Status> {
    let setup = &scenario.setup;
    let step: usize = setup.agents.iter().map(|agent| agent.robot.axes.len().pow(2) + EACH).sum();
    let end_s = setup.time.end_s;
    let mut asked = false;
    let outcome = loop {
        let given = EFFORT[0].min(*effort);
        let (mut left, mut ends_early, mut bar) = (given, false, Bar::new());
        let outcome = simulate(setup, &mut |progress| {
            bar.update(progress);
            left = left.saturating_sub(step);
            let (taken, come) = (1.0 - left as f64 / given as f64, progress.t_s / progress.end_s);
            ends_early = is_slow(taken, come, asked);
            if left == 0 || ends_early { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        bar.clear();
        *effort -= given - left;
        let outcome = outcome.map_err(|error| complain(&Plain::new(error)))?;
        let (Ending::Interrupted { t_s } | Ending::CutOff { t_s }) = outcome.ending else { break outcome };
        if let Some(stiff) = too_many(setup, t_s * step as f64 / (given - left).max(1) as f64) {
            return Ok(stiff);
        }
        if asked || !ends_early || t_s < SO_FAR * end_s {
            let got = about(t_s);
            return Ok(Went::Badly(format!("too many steps for a trial, which got to {got} s of {end_s} s")));
        }
        // Nothing makes its steps short for good: it is tried once more, to its end.
        asked = true;
    };
    let metrics = Metrics::of(setup, &outcome.recording, None, None);
    if let Ending::BrokeDown(_) = outcome.ending {
        return Ok(Went::Badly(ending_sentence(setup, &outcome.ending)));
    }
    let Disagreement::Measured { last, largest, .. } = metrics.disagreement else {
        return Ok(Went::Badly("there is nothing to compare".to_owned()));
    };
    let goal = one_digit(LEFT * largest);
    let from = match (setup.following(), setup.agents.iter().any(|agent| agent.target.is_some())) {
        (Some(_), _) => "from the leader",
        (None, true) => "from the target",
        (None, false) => "apart",
    };
    let words =
        [about(last).to_string(), names::gap_unit(setup), from.to_owned()].into_iter().filter(|word| !word.is_empty());
    let gap = words.collect::<Vec<_>>().join(" ");
    // What swings may be small at the very end, and will not be a moment later.
    let asked = Some(Goal::DisagreementBelow(goal));
    let stays = last == 0.0 || Metrics::of(setup, &outcome.recording, None, asked).settled_s.is_some();
    if last <= MARGIN * goal && stays {
        let leaves = metrics.limits_reached.iter().find(|limit| limit.kind == LimitKind::Position);
        let leaves = leaves.map(|limit| {
            format!("{} of {}", names::axis_name(setup, limit.agent, limit.axis), names::agent_name(setup, limit.agent))
        });
        let exceeds = metrics.limits_reached.iter().filter(|limit| limit.kind == LimitKind::Effort && !limit.enforced);
        // By how many times: that of an axis which has none at all first.
        let times = |limit: &&LimitReached| (limit.worst / limit.limit).abs();
        let exceeds = exceeds.max_by(|a, b| times(a).total_cmp(&times(b))).map(|limit| {
            let unit = names::unit(setup, limit.agent, Signal::Torque, limit.axis);
            let words = format!(
                "{} of {} takes {} {unit} where its effort limit is {} {unit}",
                names::axis_name(setup, limit.agent, limit.axis),
                names::agent_name(setup, limit.agent),
                about(limit.worst.abs()),
                about(limit.limit.abs()),
            );
            Exceeds { times: times(&limit), words }
        });
        return Ok(Went::Well { goal, gap, leaves, exceeds });
    }
    if last.is_finite() && last < FALLS * largest {
        // As fast as from the largest to the last, and some more.
        let needs_s = 1.2 * end_s * (MARGIN * goal / largest).ln() / (last / largest).ln();
        let needs_s = if stays { needs_s } else { needs_s.max(1.5 * end_s) };
        return Ok(Went::TooShort { needs_s: (needs_s / 10.0).ceil() * 10.0, gap });
    }
    Ok(Went::Badly(format!("{gap} after {end_s} s, and not coming closer")))
}

/// Why steps are as short as `mean_s`, where that is because the closed loop is stiff: a run that may not take them says so at once.
fn too_many(setup: &Setup, mean_s: f64) -> Option<Went> {
    if mean_s > SHORT_S {
        return None;
    }
    let mut coarse = setup.clone();
    coarse.solver.min_step_s = 2.0 * mean_s;
    let outcome = simulate(&coarse, &mut |_| ControlFlow::Continue(())).ok()?;
    let Ending::BrokeDown(breakdown) = &outcome.ending else { return None };
    let BreakdownCause::StepUnderFloor { stiffness: Some(stiffness), .. } = &breakdown.cause else { return None };
    let why = stiff_words(&coarse, &outcome.ending)?;
    let own = stiffness.gains.is_some_and(|gains| gains.viscous_per_s > OWN * stiffness.rate_per_s);
    // The trial did not break down, and a run might not: it was too long.
    let (step_s, end_s) = (about(mean_s), setup.time.end_s);
    let advice = match why.contains("`armature`") {
        true => "",
        false => {
            "; links that are lighter than their drives make it so: state the `armature` of the joints, lock those that are so light, or lower the gains"
        }
    };
    let what = format!(
        "too stiff for a trial: its steps are about {step_s} s, so that a run of {end_s} s takes about {} of them; {why}{advice}",
        with_power(&format!("{:.0e}", end_s / mean_s))
    );
    Some(if own { Went::Hopeless(what) } else { Went::Badly(what) })
}

/// The next number of one digit and zeros.
fn one_digit(value: f64) -> f64 {
    let exponent = value.log10().floor();
    let digit = (value / 10.0_f64.powf(exponent)).ceil();
    // A product with a power of ten has more digits than the number that is meant.
    format!("{digit}e{exponent}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goals_are_written_with_one_digit() {
        for (value, goal) in [(0.0087, "9e-3"), (0.031, "4e-2"), (1.01, "2e0"), (97.0, "1e2"), (3.2e-7, "4e-7")] {
            assert_eq!(format!("{:e}", one_digit(value)), goal);
        }
    }

    #[test]
    fn a_trial_is_slow_where_it_crawls_or_would_not_reach_its_end_and_was_not_asked_why() {
        assert!(!is_slow(0.05, 0.001, false), "nothing is known so early");
        assert!(is_slow(0.2, 0.005, false) && is_slow(0.2, 0.005, true), "it crawls");
        assert!(is_slow(0.2, 0.15, false) && !is_slow(0.2, 0.15, true), "once is enough to ask");
        assert!(!is_slow(0.2, 0.25, false), "it reaches its end");
    }
}
