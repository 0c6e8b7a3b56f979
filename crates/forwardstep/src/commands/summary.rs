//! The table at the end of a run.

use std::path::{Path, PathBuf};
use std::time::Duration;

use comfy_table::{ContentArrangement, Table, presets};
use forwardstep::check::Injection;
use forwardstep::io::output::names::{agent_name, clipped_words, gap_unit, input_words, torque_words, unit, units};
use forwardstep::io::output::{
    Conclusion, Disagreement, FirstInjection, Gap, Injected, LimitReached, Load, Metrics, RunRecord, WatchedMargin,
    coarse_rows,
};
use forwardstep::io::{instant, shown};
use forwardstep::sim::reference::Backstepping;
use forwardstep::sim::{ClippedSamples, Drive, Setup, Signal};

use super::progress::speed;
use super::promise::list;
use crate::number::short;

/// What drove an agent that leads, beside γ.
fn driven(Drive { peak, peak_s, exceeds_until_s }: Drive, gamma: f64) -> String {
    let until = match exceeds_until_s {
        None => format!("below γ = {gamma} all the time"),
        Some(until_s) => format!("at times above γ = {gamma}, until {} s", instant(until_s)),
    };
    format!("driven by {} at most, at {} s; {until}", short(peak), instant(peak_s))
}

/// A few lines: what was promised, what happened, what it cost, and where it is.
/// `predicted` is the value that they are to agree on, with the digits that are known, `compared` the time that the same took in continuous time.
pub(crate) fn summary(
    record: &RunRecord<'_>,
    metrics: &Metrics,
    predicted: &str,
    compared: Option<Duration>,
    folder: &Path,
    files: &[PathBuf],
) -> String {
    let RunRecord { setup, outcome, .. } = record;
    let peak_of_inputs = format!("peak {}", input_words(setup).0);
    let mut rows: Vec<(&str, String)> = vec![("verdict", verdict(record))];
    if let Some(Conclusion { sentence, advice, .. }) = Conclusion::of(record, metrics) {
        rows.push(("in words", sentence));
        rows.extend(advice.into_iter().map(|line| ("to change", line)));
    }
    if let Some(goal) = record.goal {
        rows.push(("goal", format!("{}: {}", record.goal_word(goal), goal.goal.words())));
    }
    rows.push((final_gap(setup), disagreement(setup, metrics)));
    if let Some(settled_s) = metrics.settled_s {
        rows.push(("settled after", format!("{} s", instant(settled_s))));
    }
    // Who was never apart has nothing to settle.
    if metrics.disagreement.initial().is_some_and(|initial| initial != 0.0) {
        let time = |t_s: Option<f64>| t_s.map_or_else(|| "not yet".to_owned(), |t_s| format!("{} s", instant(t_s)));
        let course = record.prediction.as_ref().and_then(|prediction| prediction.course());
        let predicted = course.map(|course| format!(", predicted {}", time(course.settled_s)));
        let observed = time(metrics.settled_to_1_percent_s);
        rows.push(("settled to 1 %", format!("{observed}{}", predicted.unwrap_or_default())));
    }
    if let Some(s) = metrics.final_tracking_error {
        let size = with_unit(s, &units(setup, Signal::TrackingError));
        rows.push(("final tracking error", format!("|s| ≤ {size}")));
    }
    if let Some(agreement) = &metrics.agreement {
        let reached: Vec<f64> = agreement.iter().map(|axis| axis.reached).collect();
        rows.push(("predicted agreement", predicted.to_owned()));
        let (is_agreed, shown) = (record.is_agreed(metrics), list(&reached));
        // Agents may agree long before s has moved all of them to where they will rest.
        let course = record.prediction.as_ref().and_then(|prediction| prediction.course());
        let apart = metrics.disagreement.last().unwrap_or(f64::NAN);
        let is_beside = shown != predicted && course.is_some_and(|course| course.is_beside(&reached, apart));
        let moves = metrics.final_tracking_error.filter(|_| is_agreed && is_beside).map_or_else(String::new, |s| {
            format!(
                ", on the way to the predicted one while s, still {}, vanishes",
                with_unit(s, &units(setup, Signal::TrackingError))
            )
        });
        rows.push((if is_agreed { "reached agreement" } else { "mean, no agreement" }, shown + &moves));
    }
    if let Some(peak) = metrics.peak_torques.iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs())) {
        let unit = unit(setup, peak.agent, Signal::Torque, peak.axis);
        let (agent, axis) = (agent_name(setup, peak.agent), torque_words(setup, peak.agent, peak.axis));
        let value = with_unit(peak.value.abs(), &unit);
        rows.push((&peak_of_inputs, format!("{value}, {agent}, {axis} at {} s", instant(peak.t_s))));
    }
    rows.extend(loads(setup, &metrics.peak_loads));
    if !metrics.limits_reached.is_empty() {
        rows.push((limits_words(&metrics.limits_reached), format!("{}, see the report", metrics.limits_reached.len())));
    }
    rows.extend(watched(record, metrics, outcome.statistics.clipped));
    if let Some(gap) = record.digital.as_ref().and_then(|cost| cost.largest_gap) {
        let unit = unit(setup, gap.agent, Signal::Position, gap.axis);
        let agent = agent_name(setup, gap.agent);
        let value = with_unit(gap.value.abs(), &unit);
        let gap = format!("{value} from the continuous run ({agent} at {} s)", instant(gap.t_s));
        rows.push(("cost of going digital", gap));
    }
    rows.extend(injected(setup, &record.injected));
    let statistics = &outcome.statistics;
    if let (Some(drive), Some(following)) = (statistics.drive, setup.following()) {
        rows.push(("leader", driven(drive, following.gain)));
    }
    let steps = format!("{}, {} of them to break-points", statistics.steps, statistics.break_points);
    rows.push(("steps", format!("{steps}; {} rejected", statistics.rejected)));
    rows.extend(coarse_rows(setup, outcome).map(|words| ("rows", words)));
    if let Some(wall_s) = statistics.wall.map(|wall| wall.as_secs_f64()) {
        let factor = metrics.last_t_s.unwrap_or(0.0) / wall_s.max(1e-9);
        let twin = compared.map(|wall| format!(", and {:.2} s for the same in continuous time", wall.as_secs_f64()));
        rows.push(("wall time", format!("{wall_s:.2} s, {} × real time{}", speed(factor), twin.unwrap_or_default())));
    }
    rows.push(("files", names(folder, files)));

    let mut table = Table::new();
    table.load_preset(presets::NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    for (name, value) in rows {
        table.add_row([name, value.as_str()]);
    }
    let lines: Vec<_> = table.lines().map(|line| line.trim_end().to_owned() + "\n").collect();
    lines.concat()
}

/// The largest thrust, rotor, torque and momentum of a wheel.
fn loads(setup: &Setup, loads: &[Load]) -> Option<(&'static str, String)> {
    let mut largest: Vec<&Load> = Vec::new();
    for load in loads {
        match largest.iter_mut().find(|known| known.kind == load.kind) {
            Some(known) if load.peak.value.abs() > known.peak.value.abs() => *known = load,
            Some(_) => {}
            None => largest.push(load),
        }
    }
    let words = largest.iter().map(|load| {
        let value = with_unit(load.peak.value.abs(), &load.unit(setup));
        format!("{}: {value}, {} at {} s", load.words(), agent_name(setup, load.peak.agent), instant(load.peak.t_s))
    });
    (!largest.is_empty()).then(|| ("peaks", words.collect::<Vec<_>>().join("; ")))
}

/// What became of the limits in a list of them.
fn limits_words(limits: &[LimitReached]) -> &'static str {
    if limits.iter().all(|limit| limit.excess <= 0.0) { "limits reached" } else { "limits exceeded" }
}

/// The sampling margin along the run, and the commands that limits changed.
fn watched(record: &RunRecord<'_>, metrics: &Metrics, clipped: Option<ClippedSamples>) -> Vec<(&'static str, String)> {
    let (setup, recording) = (record.setup, &record.outcome.recording);
    let mut rows = Vec::new();
    if let Some(WatchedMargin { agent, t_s, sigma }) = metrics.watched.and_then(|watched| watched.sampling_margin) {
        let agent = agent_name(setup, agent);
        let of = metrics.watched.and_then(|watched| watched.rows_words(recording));
        let of = of.map_or_else(String::new, |rows| format!(" ({rows})"));
        rows.push(("sampling margin", format!("σ = {} at most{of}, {agent} at {} s", short(sigma), instant(t_s))));
    }
    rows.extend(clipped.and_then(|clipped| clipped_words(setup, clipped)).map(|words| ("clipped", words)));
    rows
}

/// What changed V of all agents together, and what first put in more than the proof allows.
fn injected(setup: &Setup, all: &[Injected]) -> Vec<(&'static str, String)> {
    let [start_j, end_j] = [all.iter().map(|own| own.start_j).sum::<f64>(), all.iter().map(|own| own.end_j).sum()];
    // The z of backstepping jumps where a message does, and V with it, however short periods are.
    let backstepping = setup.reference.is::<Backstepping>();
    let named = |cause: &str| {
        let jumps = backstepping && cause == Injection::Held.name();
        format!("{cause}{}", if jumps { ", with jumps of z," } else { "" })
    };
    let terms = Injection::ALL.map(|cause| (cause.name(), all.iter().map(|own| own.term_j(cause)).sum::<f64>()));
    let mut terms: Vec<String> = terms
        .into_iter()
        .filter(|(_, energy_j)| *energy_j != 0.0)
        .map(|(name, energy_j)| format!("{} {}", named(name), short(energy_j)))
        .collect();
    if all.is_empty() || terms.is_empty() {
        return Vec::new();
    }
    // In a run that breaks away the last digits of large terms are more than V itself.
    let left_j = all.iter().map(|own| own.residual_j).sum::<f64>();
    let largest_j = all.iter().flat_map(|own| Injection::ALL.map(|cause| own.term_j(cause).abs()));
    let largest_j = largest_j.chain([start_j, end_j]).fold(0.0, f64::max);
    if left_j.abs() > UNEXPLAINED * largest_j || left_j.is_nan() {
        terms.push(format!("not accounted for {}", short(left_j)));
    }
    let first = match Injected::earliest(all) {
        None => "nothing that put in 1 % of V".to_owned(),
        Some((own, FirstInjection { cause, t_s })) => {
            format!(
                "first {}, {} at {} s",
                named(cause).trim_end_matches(','),
                agent_name(setup, own.agent),
                instant(*t_s)
            )
        }
    };
    // V of chains is in a unit of its own.
    let in_joules = all.iter().all(|own| unit(setup, own.agent, Signal::Lyapunov, 0) == "J");
    let joules = if in_joules { " J" } else { "" };
    let changed = format!("{} to {}{joules}: {}", short(start_j), short(end_j), terms.join(", "));
    vec![("V of all agents", changed), ("beyond the proof", first)]
}

/// Of the largest term and of V, what is not accounted for is said above this share.
const UNEXPLAINED: f64 = 1e-3;

fn verdict(record: &RunRecord<'_>) -> String {
    let report = record.verdicts;
    [vec![format!("{}: {}", report.theorem, report.worst().words())], record.failures()].concat().join("; ")
}

/// What remains at the end, by name.
fn final_gap(setup: &Setup) -> &'static str {
    match Gap::of(setup) {
        Gap::Disagreement => "final disagreement",
        Gap::Error => "final error",
    }
}

fn disagreement(setup: &Setup, metrics: &Metrics) -> String {
    let unit = match gap_unit(setup) {
        unit if unit.is_empty() => unit,
        unit => format!(" {unit}"),
    };
    match metrics.disagreement {
        Disagreement::Measured { initial, last, .. } => format!("{}{unit}, from {}", short(last), short(initial)),
        Disagreement::Absent(absence) => format!("none: {}", absence.words()),
    }
}

/// The folder, and in it the report by name, which is what to open.
fn names(folder: &Path, files: &[PathBuf]) -> String {
    let report = files.iter().find(|file| file.extension().is_some_and(|extension| extension == "html"));
    match report {
        Some(report) => format!("{} and {} others in that folder", shown(report), files.len() - 1),
        None => shown(folder).to_string(),
    }
}

/// With its unit, but for a pure number.
fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() || unit == "1" { short(value) } else { format!("{} {unit}", short(value)) }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_of_any_size_stay_short() {
        let values = [0.0, 66.8123, 0.4, 3600.0, 0.0123456, 2.59e-4, 6.69e169, f64::NAN, f64::INFINITY];
        let expected = ["0", "66.8", "0.400", "3600", "0.0123", "2.59 × 10⁻⁴", "6.69 × 10¹⁶⁹", "NaN", "inf"];
        assert_eq!(values.map(short), expected);
    }
}
