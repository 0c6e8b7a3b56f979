//! What was predicted for s ≡ 0 beside what was observed.

use forwardstep_sim::Setup;
use forwardstep_sim::recording::{Ending, Signal};
use maud::{Markup, html};

use super::super::conclusion::LEFT_OVER;
use super::super::metrics::{Disagreement, Metrics};
use super::super::names;
use super::super::prediction::{
    CourseFound, PredictedCourse, PredictedRate, PredictedTorque, Predictions, is_far, is_pushed, with_digits_of,
};
use super::super::record::RunRecord;
use super::super::text::{self, number, prose};
use super::sections::last_tracking_error;

/// What is left is due to s where it is so many times what would be left without.
const FAR_MORE: f64 = 10.0;
/// Less of what was at the start is as good as nothing.
const NOTICED: f64 = 1e-6;
/// More rows would only repeat themselves.
/// What is said where something acts from outside.
const PUSHED: &str =
    "Pushes act in this run. What they do to the course, to the value agreed upon and to torques is not predicted.";
const MOST_TORQUES: usize = 24;
const MOST_AXES: usize = 32;

/// The section; nothing where nothing is predicted.
pub(crate) fn section(record: &RunRecord<'_>, metrics: &Metrics) -> Markup {
    let told = record.prediction.as_ref().filter(|prediction| !prediction.is_of_one_alone(record.setup));
    let Some(prediction) = told else { return html! {} };
    let (setup, unit) = (record.setup, names::gap_unit(record.setup));
    html! {
        section #predicted {
            h2 { "Predicted and observed" }
            div.card.scroll {
                h3 { "Agreement" " " span.by { "predicted from the reference dynamics alone: robots that follow them exactly, s ≡ 0" } }
                @match &prediction.course {
                    PredictedCourse::NoneSince(reason) => p.note { "The course of agreement is not predicted, since " (prose(reason)) "." },
                    PredictedCourse::Found(course) => {
                        table.numbers {
                            thead { tr { th {} th scope="col" { "predicted" } th scope="col" { "observed" } } }
                            tbody { @for (name, predicted, observed) in rows(record, course, metrics) {
                                tr { th scope="row" { (name) } td { (text::unbroken(&predicted)) } td { (text::unbroken(&observed)) } }
                            } }
                        }
                    }
                }
                @match &prediction.rate {
                    PredictedRate::NoneSince(reason) => p.note { "The rate is not predicted, since " (prose(reason)) "." },
                    PredictedRate::Period { period_s, factor, rate_per_s, wavers, periods } => p.note {
                        "Rate: " (number(*rate_per_s)) " 1/s. Every " (number(*period_s)) " s the disagreement " @if *factor < 1.0 { "shrinks" } @else { "grows" }
                        " to " (number(100.0 * factor)) " % (over " (periods) " periods, of which single ones differ from that by up to " (number(100.0 * wavers)) " %)."
                    },
                    PredictedRate::Roots { root_per_s: [re, im], multiplicity, correction_per_s, backward_error, excited, settled_s } => p.note {
                        "Rate: rightmost characteristic root beside zero " (number(*re)) @if *im != 0.0 { " ± " (number(*im)) " i" } " 1/s"
                        @if *multiplicity > 1 { " (" (multiplicity) " roots)" }
                        " (to " (number(*correction_per_s)) " 1/s), backward error " (number(*backward_error))
                        "; its part of the disagreement starts from " (number(*excited)) " " (unit)
                        @if let Some(t_s) = settled_s { "; by it and the next roots settled to 1 % after " (number(*t_s)) " s" }
                        "."
                    },
                }
                @for sentence in prediction.guarantee.iter().flat_map(|guarantee| guarantee.sentences(setup.time.end_s)) {
                    p.note { "Guaranteed: " (prose(&sentence)) "." }
                }
                @if let Some(sentences) = tracking_error(record, metrics) { p.note { (sentences) } }
                @if is_pushed(setup) { p.note { (PUSHED) } }
            }
            @if let Some(course) = prediction.course().filter(|course| !course.peak_torques.is_empty()) {
                (torques(setup, course, metrics))
            }
        }
    }
}

fn rows(record: &RunRecord<'_>, course: &CourseFound, metrics: &Metrics) -> Vec<(String, String, String)> {
    let setup = record.setup;
    let unit = names::gap_unit(setup);
    let never_apart = metrics.disagreement.initial() == Some(0.0);
    let seconds = |t_s: Option<f64>| match t_s {
        Some(t_s) => format!("{} s", number(t_s)),
        None if never_apart => "never apart".to_owned(),
        None => "not yet".to_owned(),
    };
    let size = |value: f64| format!("{} {unit}", number(value));
    let (last, observed_reached) = match metrics.disagreement {
        Disagreement::Measured { last, .. } => (size(last), record.is_agreed(metrics)),
        Disagreement::Absent(_) => ("–".to_owned(), false),
    };
    let reached = |reached: bool| if reached { "reached" } else { "not reached" }.to_owned();
    let mut rows = vec![
        ("Agreement by the end".to_owned(), reached(course.reached), reached(observed_reached)),
        (
            "Settled to 1 % of the start after".to_owned(),
            seconds(course.settled_s),
            seconds(metrics.settled_to_1_percent_s),
        ),
        (
            "Disagreement at the end".to_owned(),
            course.disagreement.last().map_or_else(String::new, |last| size(*last)),
            last,
        ),
    ];
    rows.extend(values(record, course, metrics));
    rows
}

/// What s at the end does: that it is what is left, where without it far less would be; else that nothing is known of it.
fn tracking_error(record: &RunRecord<'_>, metrics: &Metrics) -> Option<String> {
    let setup = record.setup;
    let (agent, axis, s) = last_tracking_error(record).filter(|(.., s)| *s > 0.0)?;
    let unit = text::unit(&names::unit(setup, agent, Signal::TrackingError, axis));
    let (who, joint) = (names::agent_name(setup, agent), names::axis_words(setup, agent, axis));
    let sized = |value: f64, unit: &str| format!("{} {unit}", number(value)).trim_end().to_owned();
    let size = format!("{} ({who}, {joint})", sized(s, &unit));
    let unknown = || {
        Some(format!(
            "Tracking errors at the last row are at most {size}; what they do to the course is not predicted."
        ))
    };
    let course = record.prediction.as_ref().and_then(Predictions::course);
    let (Some(course), Disagreement::Measured { last, .. }) = (course, metrics.disagreement) else { return unknown() };
    let without = course.disagreement.last().copied().unwrap_or(f64::NAN);
    let is_far = last > FAR_MORE * without && last > NOTICED * metrics.disagreement.initial().unwrap_or(f64::NAN);
    let is_left = record.outcome.ending == Ending::Completed && is_far && s > LEFT_OVER * last;
    if !is_left {
        return unknown();
    }
    let adapts = course.peak_torques.iter().any(|peak| peak.agent == agent && peak.estimate_off > 0.0);
    let why = if adapts && record.verdicts.worst().is_fine() {
        ": estimates have not settled. The theorem gives s → 0 without a rate"
    } else {
        ""
    };
    let without = sized(without, &names::gap_unit(setup));
    if setup.control.is_some() {
        return Some(format!(
            "At the end s is still {size}{why}. Without s, and in continuous time, {without} would be left."
        ));
    }
    let moved = match metrics.final_means.as_ref().is_some_and(|means| course.is_beside(means, last)) {
        true if course.moved_by_s => "; it also moved the value agreed upon",
        true => "; what they agree upon comes to the predicted value once it has vanished",
        false => "",
    };
    Some(format!(
        "At the end s is still {size}{why}. Without s {without} would be left: s, not the network, keeps the agents apart{moved}."
    ))
}

/// The value agreed upon on every axis, where it is bounded and reached, beside the mean of the last positions.
fn values(record: &RunRecord<'_>, course: &CourseFound, metrics: &Metrics) -> Vec<(String, String, String)> {
    let setup = record.setup;
    let Some(within) = course.within.as_ref().filter(|_| course.reached) else { return Vec::new() };
    let mean = |axis: usize| metrics.final_means.as_ref().and_then(|means| means.get(axis)).copied();
    let agreed = if record.is_agreed(metrics) { "" } else { " (mean, not agreed)" };
    let for_zero = if course.moved_by_s { " with s ≡ 0" } else { "" };
    let unit = |axis: usize| match text::unit(&names::unit(setup, 0, Signal::Position, axis)) {
        none if none.is_empty() => none,
        unit => format!(" {unit}"),
    };
    let row = |(axis, [low, high]): (usize, &[f64; 2])| {
        let half = 0.5 * (high - low);
        (
            format!("{}, {}", names::value_words(setup), names::axis_words(setup, 0, axis)),
            format!("{} ± {}{}{for_zero}", with_digits_of(low + half, half), number(half), unit(axis)),
            mean(axis).map_or_else(|| "–".to_owned(), |mean| format!("{}{}{agreed}", number(mean), unit(axis))),
        )
    };
    within.iter().enumerate().take(MOST_AXES).map(row).collect()
}

fn torques(setup: &Setup, course: &CourseFound, metrics: &Metrics) -> Markup {
    let observed = |agent, axis| metrics.peak_torques.iter().find(|peak| (peak.agent, peak.axis) == (agent, axis));
    // Of many the largest, whether predicted or seen, in their order.
    let size = |peak: &PredictedTorque| {
        let seen = observed(peak.agent, peak.axis).map_or(0.0, |seen| seen.value.abs());
        peak.value.abs().max(seen)
    };
    let mut all: Vec<(usize, &PredictedTorque)> = course.peak_torques.iter().enumerate().collect();
    all.sort_by(|a, b| size(b.1).total_cmp(&size(a.1)));
    all.truncate(MOST_TORQUES);
    all.sort_by_key(|(place, _)| *place);
    html! {
        div.card.scroll {
            h3 { "Peak " (names::input_words(setup).0) " " span.by {
                "predicted with the true parameters along the reference; "
                @if course.peak_torques.iter().all(|peak| is_far(peak.estimate_off)) { "estimates start farther off than 20 %, so the torque can be another" }
                @else { "an indication where estimates start within 20 % of them" }
            } }
            table.numbers {
                thead { tr { th scope="col" { "Agent" } th scope="col" { "predicted" } th scope="col" { "observed" } th scope="col" title="while V ≤ V(0), near the course of s ≡ 0" { "bound by V(0)" } th scope="col" { "estimate starts off by" } } }
                tbody { @for (_, peak) in &all {
                    @let unit = text::unit(&names::unit(setup, peak.agent, Signal::Torque, peak.axis));
                    tr {
                        th scope="row" { span.dot.{ "a" (peak.agent) } {} (names::agent_name(setup, peak.agent)) " · " (names::torque_words(setup, peak.agent, peak.axis)) }
                        td { (text::unbroken(&format!("{} {unit}", number(peak.value.abs())))) }
                        td { @if let Some(seen) = observed(peak.agent, peak.axis) { (text::unbroken(&format!("{} {unit}", number(seen.value.abs())))) } @else { "–" } }
                        td { @if let Some(at_most) = peak.at_most { (text::unbroken(&format!("{} {unit}", number(at_most)))) } @else { "–" } }
                        td { (number((100.0 * peak.estimate_off).round())) " %" }
                    }
                } }
            }
            @if course.peak_torques.len() > MOST_TORQUES {
                p.note { "The largest " (MOST_TORQUES) " of " (course.peak_torques.len()) "; summary.json has all." }
            }
        }
    }
}
