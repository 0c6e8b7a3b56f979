//! The parts of the page that are words and tables.

use std::collections::BTreeSet;

use forwardstep_check::{Answer, Hypothesis, Report, Rigour};
use forwardstep_core::reference::Choice;
use forwardstep_sim::leader::Following;
use forwardstep_sim::recording::{Drive, Ending, Signal};
use forwardstep_sim::setup::{Exchange, Method, RecordAt, Setup};
use maud::{Markup, html};

use super::super::ending::ending_sentence;
use super::super::metrics::{BALANCE_FLOOR_J, BalanceResidual, Disagreement, Gap, Metrics, balance_whole, coarse_rows};
use super::super::names;
use super::super::record::RunRecord;
use super::super::table::Table;
use super::super::text::{self, number, prose};

/// What the residual of the balance is.
pub(super) const BALANCE_WORDS: &str = "The proof rests on an identity: V loses what the law dissipates, dV/dt = −sᵀKs for most laws. The \
     residual is by how much V + ∫ dissipation strays from that along the run, relative to V; a small one says that the run was computed well.";

/// What is drawn of the balance. What acts from outside is part of the identity, so that what is integrated may fall under a push.
pub(super) fn balance_letters(record: &RunRecord<'_>) -> &'static str {
    let outside = [Signal::External, Signal::ExternalTorque, Signal::Disturbance];
    match record.outcome.recording.columns.iter().any(|column| outside.contains(&column.signal)) {
        true => "V + ∫ (dissipation − power from outside) = V(0)",
        false => "V + ∫ dissipation = V(0)",
    }
}

/// How the run ended, or how far it is.
pub(super) fn ending(record: &RunRecord<'_>, goes_on: bool) -> String {
    if !goes_on {
        return ending_sentence(record.setup, &record.outcome.ending);
    }
    format!("running: {}", so_far(record))
}

/// How far a run is that goes on.
pub(crate) fn so_far(record: &RunRecord<'_>) -> String {
    text::time_reached(record.outcome.recording.t_s.last().copied().unwrap_or(0.0), record.setup.time.end_s)
}

/// A number with its unit; without, when it is none.
fn quantity(x: f64, unit: &str) -> String {
    if x.is_finite() { format!("{} {unit}", number(x)) } else { number(x) }
}

pub(super) fn unit_at(setup: &Setup, signal: Signal, agent: usize, axis: usize) -> String {
    text::unit(&names::unit(setup, agent, signal, axis))
}

/// What was promised beside what happened.
pub(crate) fn verdicts(record: &RunRecord<'_>, metrics: &Metrics, goes_on: bool) -> Markup {
    let report = record.verdicts;
    let unit = names::gap_unit(record.setup);
    html! {
        section #promises {
            h2 { "Promised and observed" }
            div.beside {
                div.card {
                    h3 { "Promised" " " span.by { (report.theorem) " · " (report.theorem.source().words()) } }
                    p.promise { (prose(&report.promises)) }
                    @if report.hypotheses.is_empty() { p.note { "No hypotheses were checked." } }
                    ul.hypotheses {
                        @for hypothesis in &report.hypotheses {
                            @let (class, sign) = answer_style(hypothesis.answer());
                            li class=(class) {
                                span.sign aria-hidden="true" { (sign) }
                                div {
                                    p { strong { (prose(&hypothesis.requires())) } " " em { (hypothesis.answer().words()) } }
                                    p.because {
                                        (prose(&hypothesis.because()))
                                        @if hypothesis.answer() == Answer::Watched {
                                            @if let Some(failed) = record.failed(hypothesis) { "; " strong.bad { "in this run " (failed) } }
                                            @else if record.outcome.ending == Ending::Completed { "; this run reached its horizon" }
                                            @if let Some(nearest) = record.nearest(hypothesis) { "; " (nearest) }
                                        }
                                    }
                                    @if let Some(change) = hypothesis.change() {
                                        p.because { "To make it hold: " (prose(&change)) }
                                    }
                                    p.origin {
                                        code { (hypothesis.id.name()) } " · " (hypothesis.place()) " · "
                                        (hypothesis.source().words()) " · " span title=(hypothesis.rigour().meaning()) { (hypothesis.rigour().word()) }
                                    }
                                }
                            }
                        }
                    }
                    @if !report.hypotheses.is_empty() { p.note { "How answers were found – " (ways(report)) "." } }
                }
                div.card {
                    h3 { "Happened" }
                    table.facts { tbody { (happened(record, metrics, goes_on)) } }
                    @if let Some(agreement) = &metrics.agreement {
                        div.scroll {
                            table.numbers {
                                thead { tr { th scope="col" { "Agreement" @if !unit.is_empty() { " in " (unit) } } th scope="col" { "predicted" } th scope="col" { (if record.is_agreed(metrics) { "reached" } else { "mean, not agreed" }) } th scope="col" { "farthest agent" } } }
                                tbody {
                                    @for a in agreement.iter().take(32) {
                                        tr {
                                            th scope="row" { (names::axis_words(record.setup, 0, a.axis)) }
                                            td { (number(a.predicted)) }
                                            td { (number(a.reached)) }
                                            td { (number(a.distance)) }
                                        }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The words for how answers were found, with what each of them means.
fn ways(report: &Report) -> String {
    let ways: BTreeSet<Rigour> = report.hypotheses.iter().map(Hypothesis::rigour).collect();
    ways.iter().map(|way| format!("{}: {}", way.word(), way.meaning())).collect::<Vec<_>>().join("; ")
}

pub(super) fn answer_style(answer: Answer) -> (&'static str, &'static str) {
    match answer {
        Answer::Holds => ("good", "✓"),
        Answer::HoldsOnHorizon => ("fair", "✓"),
        Answer::Watched => ("fair", "◦"),
        Answer::NotShown | Answer::NotCovered => ("warn", "?"),
        Answer::Violated => ("bad", "✗"),
    }
}

fn happened(record: &RunRecord<'_>, metrics: &Metrics, goes_on: bool) -> Markup {
    let setup = record.setup;
    let unit = names::gap_unit(setup);
    html! {
        (fact("Ending", html! { (prose(&ending(record, goes_on))) }))
        @if let Some(outcome) = record.goal.filter(|_| !goes_on) {
            (fact("Goal", html! {
                (outcome.goal.words()) ": "
                @match record.goal_word(outcome) {
                    "met" => strong.good { "met" },
                    "missed" => strong.bad { "missed" },
                    _ => { strong { "undecided" } ", since the run ended early" },
                }
            }))
        }
        @match metrics.disagreement {
            Disagreement::Measured { initial, last, largest, .. } => (fact(Gap::of(setup).name(), html! {
                (number(initial)) " at the start, " (number(largest)) " at most, "
                strong { (quantity(last, &unit)) } " at the end"
            })),
            Disagreement::Absent(absence) => (fact(Gap::of(setup).name(), html! { "none: " (absence.words()) })),
        }
        @if record.goal.is_some() {
            @if let Some(t_s) = metrics.settled_s {
                (fact("Settled", html! { "below the goal from t = " (number(t_s)) " s on" }))
            }
        }
        @if let Some(speed) = metrics.speed {
            @let at = speed.largest;
            (fact("Speed", html! {
                (quantity(at.value, &unit_at(setup, Signal::Velocity, at.agent, at.axis))) " at most ("
                (names::agent_name(setup, at.agent)) ", " (names::axis_words(setup, at.agent, at.axis))
                ", t = " (number(at.t_s)) " s) at recorded rows, " (quantity(speed.last, &shared_unit(setup, Signal::Velocity))) " at the end"
            }))
        }
        @if let Some((agent, axis, s)) = last_tracking_error(record) {
            (fact("Tracking error", html! {
                "|s| is " (quantity(s, &unit_at(setup, Signal::TrackingError, agent, axis))) " at the end"
                @if s > 0.0 { " (" (names::agent_name(setup, agent)) ", " (names::axis_words(setup, agent, axis)) ")" }
            }))
        }
        @if let Some(words) = coarse_rows(setup, record.outcome) { (fact("Rows", html! { (words) })) }
        (fact("Limits", html! {
            @if metrics.limits_reached.is_empty() { "none exceeded, of those that are known" }
            @else { a href="#limits" { (text::count(metrics.limits_reached.len(), "limit")) " reached or exceeded" } }
        }))
        @if let Some(balance) = metrics.balance_residual {
            (fact("Balance", html! {
                @if balance.relative.is_finite() {
                    "V + ∫ dissipation " @if balance.relative > 1.0 { "leaves V(0) by " } @else { "= V(0) holds to " }
                    (missed(record, balance)) " (worst: "
                } @else { "V is no longer finite (" }
                (names::agent_name(setup, balance.agent)) ", t = " (number(balance.t_s)) " s)"
                small { (BALANCE_WORDS) }
            }))
        }
    }
}

/// By how much a balance misses: as a part of V(0), or as it is where that is small.
fn missed(record: &RunRecord<'_>, BalanceResidual { agent, relative, .. }: BalanceResidual) -> String {
    let setup = record.setup;
    let whole = balance_whole(&Table::new(setup, &record.outcome.recording), agent).unwrap_or(0.0);
    let name = if setup.agents[agent].pushes.is_empty() { "V(0)" } else { "the largest V" };
    if whole < BALANCE_FLOOR_J {
        let unit = text::unit(&names::unit(setup, agent, Signal::Lyapunov, 0));
        let sized = |value: f64| format!("{} {unit}", number(value)).trim_end().to_owned();
        return format!("{}, where {name} is {}", sized(relative * BALANCE_FLOOR_J), sized(whole));
    }
    format!("{} {} {name}", number(relative), if relative > 1.0 { "times" } else { "of" })
}

/// The agent and the axis with the largest |s| at the last row, and its size; nothing where s is not recorded or not finite.
pub(super) fn last_tracking_error(record: &RunRecord<'_>) -> Option<(usize, usize, f64)> {
    let table = Table::new(record.setup, &record.outcome.recording);
    let last = table.axes(Signal::TrackingError).filter_map(|(agent, axis, s)| Some((agent, axis, s.last()?.abs())));
    last.filter(|(.., s)| s.is_finite()).reduce(|best, next| if next.2 > best.2 { next } else { best })
}

/// The unit of a signal that all axes of all agents share; empty where they differ.
fn shared_unit(setup: &Setup, signal: Signal) -> String {
    let axes = |agent: usize| (0..setup.agents[agent].robot.axes.len()).map(move |axis| (agent, axis));
    let units = (0..setup.agents.len()).flat_map(axes).map(|(agent, axis)| unit_at(setup, signal, agent, axis));
    names::shared(units).unwrap_or_default()
}

/// What remains at the end, by name.
pub(super) fn final_gap(setup: &Setup) -> String {
    format!("Final {}", Gap::of(setup).word())
}

fn fact(name: &str, what: Markup) -> Markup {
    html! { tr { th scope="row" { (name) } td { (what) } } }
}

/// The run beside the same run in continuous time.
pub(crate) fn digital(record: &RunRecord<'_>) -> Markup {
    let setup = record.setup;
    let Some(cost) = &record.digital else { return html! {} };
    let unit = names::gap_unit(setup);
    let torque = unit_at(setup, Signal::Torque, 0, 0);
    let speed = unit_at(setup, Signal::Velocity, 0, 0);
    let (what, _) = names::input_words(setup);
    let (peak, mean) = (format!("Peak {what} at recorded rows"), format!("{what} of an axis, root mean square"));
    let (digital, continuous) = (&cost.digital, &cost.continuous);
    let rows = [
        (&*final_gap(setup), &*unit, continuous.final_disagreement, digital.final_disagreement),
        ("Settled after", "s", continuous.settled_s, digital.settled_s),
        (&*peak, &*torque, continuous.peak_torque, digital.peak_torque),
        (&*mean, &*torque, Some(continuous.rms_torque), Some(digital.rms_torque)),
        (
            "s of an axis, root mean square",
            &*speed,
            Some(continuous.rms_tracking_error),
            Some(digital.rms_tracking_error),
        ),
    ];
    let cell = |value: Option<f64>, unit: &str| value.map_or_else(|| "–".to_owned(), |value| quantity(value, unit));
    html! {
        section #digital {
            h2 { "The cost of going digital" }
            div.card.scroll {
                h3 {
                    "At " (number(cost.sample_hz)) " Hz, beside the same run in continuous time"
                    span.by { "with exact measurements and no limits; both until the earlier end" }
                }
                table.numbers {
                    thead { tr { th {} th scope="col" { "continuous" } th scope="col" { "digital" } } }
                    tbody { @for (name, unit, continuous, digital) in rows {
                        tr { th scope="row" { (name) } td { (cell(continuous, unit)) } td { (cell(digital, unit)) } }
                    } }
                }
                @if let Some(gap) = cost.largest_gap {
                    p.note {
                        "Positions differ by " (quantity(gap.value.abs(), &unit_at(setup, Signal::Position, gap.agent, gap.axis)))
                        " at most (" (names::agent_name(setup, gap.agent)) ", " (names::axis_words(setup, gap.agent, gap.axis))
                        ", t = " (number(gap.t_s)) " s)."
                    }
                }
                @if let Some(t_s) = cost.twin_ended_at_s {
                    p.note { "In continuous time the run ended at t = " (number(t_s)) " s." }
                }
            }
        }
    }
}

/// How values of a set-valued sign were chosen, and how restless they were.
fn sign_words(record: &RunRecord<'_>, following: &Following) -> String {
    let recording = &record.outcome.recording;
    let every = match record.setup.control {
        None => format!("every {} s", number(following.period_s)),
        Some(_) => "at every sample".to_owned(),
    };
    let chosen = match following.choice {
        Choice::Implicit => format!("a value of the set-valued sign was solved for {every}"),
        Choice::Explicit => format!("set to 1 or −1 {every}"),
        Choice::Layer { width } => format!("replaced by sat(e/ε) with ε = {}", number(width)),
    };
    let rest = match record.outcome.statistics.sign_residual {
        Some(rest) => format!("; the largest rest is {}", number(rest)),
        None => String::new(),
    };
    let half = recording.t_s.len() / 2;
    let span_s = recording.t_s.last().zip(recording.t_s.get(half)).map_or(0.0, |(last, first)| last - first);
    let signs = recording.columns.iter().filter(|column| column.signal == Signal::Selection);
    let moved = signs.map(|column| {
        let rows = column.values.get(half..).unwrap_or_default();
        rows.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>()
    });
    let most = moved.fold(0.0, f64::max);
    let restless = if span_s > 0.0 {
        format!("; over the second half it moved by at most {} per second, row to row", number(most / span_s))
    } else {
        String::new()
    };
    format!("{chosen}{rest}{restless}")
}

/// What drove an agent that leads, beside γ.
fn leader_words(setup: &Setup, following: &Following, drive: Drive) -> String {
    let leader = setup.leader().map_or("", |vertex| setup.vertex_name(vertex));
    let until = match drive.exceeds_until_s {
        None => "and never reached".to_owned(),
        Some(until_s) => format!("and, until t = {} s, was not below", number(until_s)),
    };
    let (peak, peak_s, gamma) = (number(drive.peak), number(drive.peak_s), number(following.gain));
    format!("{leader} leads; what drives it was at most {peak}, at t = {peak_s} s, {until} γ = {gamma}")
}

/// How it was computed, and from what.
pub(crate) fn provenance(record: &RunRecord<'_>) -> Markup {
    let setup = record.setup;
    let statistics = &record.outcome.statistics;
    html! {
        section #provenance {
            h2 { "How it was computed" }
            div.card {
                table.facts { tbody {
                    (fact("Method", match setup.solver.method {
                        Method::Adaptive { rtol, atol } => html! {
                            "Dormand–Prince 5(4), relative tolerance " (number(rtol)) ", absolute " (number(atol))
                        },
                        Method::Fixed { step_s } => html! { "Runge–Kutta of order 4, steps of " (number(step_s)) " s" },
                    }))
                    (fact("Steps", html! {
                        (statistics.steps) " accepted, " (statistics.rejected) " rejected, " (statistics.break_points)
                        " of them ended on a break-point; " (statistics.evaluations) " evaluations"
                    }))
                    @if let Some(control) = &setup.control {
                        (fact("Control", html! { "sampled at " (number(control.sample_hz)) " Hz, torques held; every sample ends a step" }))
                    }
                    @if let Some(following) = setup.following() {
                        (fact("Sign", html! { (sign_words(record, following)) }))
                        @if let Some(drive) = statistics.drive {
                            (fact("Leader", html! { (leader_words(setup, following, drive)) }))
                        }
                    }
                    (fact("Recording", html! {
                        (text::count(record.outcome.recording.t_s.len(), "row"))
                        @match &setup.time.record_at {
                            RecordAt::Intervals => { ", every " (number(setup.time.record_every_s)) " s" }
                            RecordAt::Rate { hz } => { ", at every sample, " (number(*hz)) " per second" }
                            RecordAt::Times(_) => ", at the times that the scenario states",
                        }
                    }))
                    (fact("Exchanged", html! { @match setup.exchange {
                        _ if !setup.network.has_edges() => "nothing: no agent hears another",
                        Exchange::Position => "positions",
                        Exchange::PositionVelocity => "positions and velocities",
                        Exchange::Composite => "one vector, y = ż + β z + α q",
                        Exchange::Estimates => "estimates of the leader's position and velocity",
                    } }))
                    (fact("Scenario", html! { (record.scenario_name) br; code { (record.digest()) } " (BLAKE3)" }))
                    (fact("Version", html! { "forwardstep " (record.version) }))
                } }
                details { summary { "The scenario" } pre { (record.scenario_text) } }
            }
        }
    }
}
