//! Sentences of practical verdicts.

use forwardstep_sim::ClippedSamples;

use super::{
    AgreementBound, AxisBound, ClippedCommands, Finding, Over, PowerBound, PracticalAnswer, RECOMMENDED_MARGIN,
    ReferenceGains, SamplingMargin, StaticLoad, WholeLoop,
};
use crate::hypothesis::numbers::{rounded, rounded_up};

/// What it is about.
pub(super) fn about(finding: &Finding) -> &'static str {
    match finding {
        Finding::SamplingMargin(_) => "they sample fast enough for K and Γ",
        Finding::WholeLoop(_) => "the loop as a whole decays from sample to sample",
        Finding::StaticLoad(_) => "torques and thrusts within their limits hold the robots at rest",
        Finding::ClippedCommands(_) => "no command reaches a limit of the actuators",
        Finding::TrackingPower(_) => "how large s stays",
        Finding::TrackingDisagreement(_) => "what s adds to the disagreement",
    }
}

/// What was found.
pub(super) fn because(finding: &Finding) -> String {
    match finding {
        Finding::SamplingMargin(margin) => sampling(margin),
        Finding::WholeLoop(found) => whole(found),
        Finding::StaticLoad(load) => standing(load),
        Finding::ClippedCommands(found) => clipped(found),
        Finding::TrackingPower(bound) => power(bound),
        Finding::TrackingDisagreement(bound) => agreement(bound),
    }
}

fn sampling(margin: &SamplingMargin) -> String {
    let SamplingMargin { start, worst, postures, .. } = margin;
    let (sigma, name) = (rounded(worst.sigma), &worst.agent.name);
    let between = match worst.led_s {
        _ if sigma == rounded(start.sigma) => String::new(),
        Some(t_s) => format!(", and {sigma} on the way that its reference leads ({name} at {} s)", rounded(t_s)),
        None => format!(", {sigma} at most at {postures} postures between the starts ({name})"),
    };
    let anywhere = margin.anywhere.filter(|anywhere| *anywhere < 1.0).map_or_else(String::new, |anywhere| {
        format!("; of the damping alone it is at most {} at any q", rounded_up(anywhere))
    });
    let targets = match margin.adaptation_left_out {
        0 => "",
        _ => "; the adaptation of those that follow targets of their own is not in it",
    };
    format!(
        "σ = {} at the start ({}), whose fastest mode has {}/s{}{between}{}; {}{anywhere}{targets}",
        rounded(start.sigma),
        start.agent.name,
        rounded(start.fastest_per_s),
        hold(margin),
        too_slow(margin),
        periods(margin),
    )
}

/// What σ from 1 on means.
fn too_slow(SamplingMargin { start, worst, held_by_references, .. }: &SamplingMargin) -> &'static str {
    if *held_by_references {
        "; by itself the fastest mode would grow, and as a whole, with references that answer it, the loop decays"
    } else if start.is_unstable && start.damping_sigma < 1.0 {
        "; damping and adaptation together are unstable at the start: let Γ be smaller, or sample faster"
    } else if start.is_unstable {
        "; sampling is too slow at the start: the fastest mode grows"
    } else if worst.is_unstable && worst.led_s.is_some() {
        "; sampling is too slow for it there"
    } else if worst.is_unstable {
        "; sampling is too slow at such a posture"
    } else if worst.sigma < 1.0 {
        ""
    } else {
        "; V may grow from sample to sample, though with Y frozen no mode does"
    }
}

fn standing(load: &StaticLoad) -> String {
    let StaticLoad { agent, axis_name, torque, unit, limit, postures, .. } = load;
    let (torque, limit) = (rounded(*torque), rounded(*limit));
    let pushed = if load.pushed { "; what a push that does not end asks for is not counted" } else { "" };
    if load.is_thrust() {
        return format!("{} hovers with m g = {torque} N of the {limit} N that its rotors give{pushed}", agent.name);
    }
    let those = if *postures == 1 {
        "at the start".into()
    } else {
        format!("over {postures} postures between the starts and on the way")
    };
    format!(
        "the largest share of a torque limit {those}: |g| is {torque} {unit} of {limit} {unit} ({}, {axis_name}){pushed}",
        agent.name
    )
}

fn clipped(found: &ClippedCommands) -> String {
    let ClippedSamples { samples, torque, rate } = found.of;
    let until = if found.is_whole {
        "in a trial of the whole run".to_owned()
    } else {
        format!("in a trial of the first {} s, which is no whole run,", rounded(found.until_s))
    };
    let changed = match (torque, rate) {
        (0, 0) => return format!("{until} none of {samples} commands does"),
        (torque, 0) => format!("limits of torques change {torque}"),
        (0, rate) => format!("limits of torque rates change {rate}"),
        (torque, rate) => format!("limits of torques change {torque} and limits of their rates {rate}"),
    };
    let so = match found.answer() {
        PracticalAnswer::Marginal => "the verdicts and predictions here apply while they change none",
        _ => {
            "the verdicts and predictions here do not apply to this loop: raise the limits, or ask for less by smaller roots, weights and gains"
        }
    };
    format!("{until} {changed} of {samples} commands; {so}")
}

fn power(bound: &PowerBound) -> String {
    let PowerBound { agents, span_s, start_w, .. } = *bound;
    let who = if agents == 1 { "sᵀKs".to_owned() } else { format!("Σ sᵀKs of {agents} agents") };
    // Sampled, what the plant does between samples is taken along the references.
    let kind = if bound.is_expected() { "is expected to be at most" } else { "is at most" };
    let part = |name: &str, value: f64| match value {
        value if value > 0.0 => format!(", {name} {} W", rounded_up(value)),
        _ => String::new(),
    };
    let swings = [("forces", bound.swing.forced), ("the start", bound.swing.started)];
    let swings: Vec<String> = swings
        .into_iter()
        .filter(|(_, factor)| *factor > 1.005)
        .map(|(of, factor)| format!("{of} times {}", rounded_up(factor)))
        .collect();
    let sampled = if !swings.is_empty() {
        format!(
            "; their square roots add up, {}, since s swings up where torques come late or velocities are filtered (and no less than the whole divided by 1 − σ, with σ = {})",
            swings.join(" and "),
            rounded(bound.sigma)
        )
    } else if bound.sigma > 0.0 {
        format!("; their square roots add up, and the whole is divided by 1 − σ, with σ = {}", rounded(bound.sigma))
    } else {
        String::new()
    };
    format!(
        "the mean of {who} over {span_s} s {kind} {} W while nothing is clipped: V(0)/T {} W{}{}{}{}{}{}{}{sampled}",
        rounded_up(bound.mean_w),
        rounded_up(start_w),
        part("pushes", bound.push_w),
        part("measurement errors", bound.noise_w),
        part("dynamics at positions with errors", bound.positions_w),
        part("steps of the torque", bound.steps_w),
        part("torques that are held and velocities that lag while they move", bound.held_w),
        part("what s gains from sample to sample", bound.between_w),
        part("dry friction", bound.friction_w),
    )
}

fn agreement(bound: &AgreementBound) -> String {
    let gains = match &bound.gains {
        Ok(gains) => gains,
        Err(reason) => return format!("no gain from s to the disagreement is given, since {reason}"),
    };
    let ReferenceGains { peak_s, rms_s, drift_peak, drift_rms, bias, over } = *gains;
    let network = match over {
        Over::Fixed => "the fixed graph".to_owned(),
        Over::Period(period_s) => format!("the network, which repeats itself every {} s,", rounded(period_s)),
        Over::Horizon(end_s) => format!("the network, which does not repeat itself, as it is written up to {end_s} s"),
    };
    let moved = if drift_peak == 0.0 {
        "; it does not move what all agree on for ever".to_owned()
    } else {
        format!(
            "; everybody together moves at a speed of at most {} RMS s and {} max|s|",
            rounded_up(drift_rms),
            rounded_up(drift_peak)
        )
    };
    let error = bias.filter(|_| bound.measured).map_or_else(String::new, |bias| {
        format!("; a constant error of all measured velocities moves everybody at {} times itself", rounded(bias))
    });
    format!(
        "{}over {network} RMS disagreement ≤ {} s × RMS s, and at any time ≤ {} s × max|s|, or half of what s varies by{moved}{error}",
        axes(bound),
        rounded_up(rms_s),
        rounded_up(peak_s),
    )
}

/// The bounds on s put through the gains.
fn axes(AgreementBound { axes, expected, sampled, inexact, .. }: &AgreementBound) -> String {
    let Some([least, most]) = axes else {
        return "how large s is cannot be told before the run; ".into();
    };
    let one = |AxisBound { name, unit, tracking, disagreement, drift }: &AxisBound| {
        let drift = if *drift > 0.0 {
            format!(", and the posture may move at ≤ {}{unit}/s", rounded_up(*drift))
        } else {
            String::new()
        };
        // More than half a turn says nothing of a joint.
        let use_of_it = match *unit == " rad" && *disagreement > core::f64::consts::PI {
            true => ", of no practical use",
            false => "",
        };
        let (disagreement, tracking) = (rounded_up(*disagreement), rounded_up(*tracking));
        format!("RMS disagreement ≤ {disagreement}{unit}{drift} ({name}, RMS s ≤ {tracking}{unit}/s{use_of_it})")
    };
    let kind = if *expected { "is expected to be: " } else { "is: " };
    let both = if rounded(least.tracking) == rounded(most.tracking) {
        one(most)
    } else {
        format!("{}, {}", one(least), one(most))
    };
    let beside = match (*sampled, *inexact) {
        (_, true) => "references that are sampled, and hear positions with errors, leave with s = 0",
        (true, false) => "references that are sampled leave with s = 0",
        (false, false) => "s = 0 leaves",
    };
    format!("beside what {beside} there {kind}{both}; ")
}

/// Of how many agents one is the worst.
fn worst_of(agents: usize, all: usize) -> String {
    match (agents, all) {
        (1, 1) => String::new(),
        (2, 2) => ", the worse of both agents".to_owned(),
        (agents, all) if agents == all => format!(", the worst of all {all} agents"),
        (agents, all) => format!(", the worst of {agents} of {all} agents that were looked at"),
    }
}

fn whole(found: &WholeLoop) -> String {
    let WholeLoop { start, period_s, agents, of: all, along, .. } = found;
    let last = found.last();
    // Whose loop grows most, and what it would do in the ideal one.
    let (named, rate) = match along {
        Some(along) if found.last.is_none() || along.grows_per_s() >= found.lasting_per_s() => {
            (&along.agent, along.rate)
        }
        _ => (&last.agent, last.rate()),
    };
    let (of, name) = (worst_of(*agents, *all), &named.name);
    let whose = match last.network {
        Some(_) if *all == 2 => "both agents together".to_owned(),
        Some(_) => format!("all {all} agents together"),
        None => format!("{name}{of}"),
    };
    let at_last = found.last.as_ref().map(|last| format!("at the state predicted for t = {} s", rounded(last.t_s)));
    let places = match (along, at_last) {
        (None, None) => "at the start".to_owned(),
        (None, Some(last)) => format!("at the start and {last}"),
        (Some(_), None) => "at the start and along the motion that leads".to_owned(),
        (Some(_), Some(last)) => format!("at the start, along the motion that leads, and {last}"),
    };
    let advice = match rate.ideal_per_s.or(start.rate().ideal_per_s) {
        Some(_) => {
            "where velocities were measured and samples fast, it would not: sample faster, filter less, or let roots, weights or λ be smaller"
        }
        None => "sample faster, filter less, or let roots, weights or λ be smaller",
    };
    let meaning = match (found.lasting_per_s(), found.start_per_s(), found.amplified()) {
        _ if let Some(t_s) = found.trial.lost_s => format!(
            "in a trial the agents have run away by {} s, which they do not where samples are fast; sample faster{}",
            rounded(t_s),
            if found.adapts { ", or adapt more slowly" } else { ", or let roots, weights or λ be smaller" }
        ),
        (Some(rate), _, _) if found.answer() == PracticalAnswer::Inadequate => {
            let right = if found.adapts { " with estimates that are right" } else { "" };
            format!("a mode grows at {}/s{right}; {advice}", rounded(rate))
        }
        (Some(rate), _, _) if found.is_contradicted(rate) => format!(
            "a mode grows at {}/s in some of these states, though a trial of {} s does not run away; {advice}",
            rounded(rate),
            rounded(found.trial.lasted_s)
        ),
        (Some(rate), _, _) if found.answer() == PracticalAnswer::NotShown && found.amplified().is_none() => format!(
            "if the largest weights stayed for ever a mode would grow at {}/s, and the network changes; sample faster, filter less, or \
             let roots and weights be smaller",
            rounded(rate)
        ),
        (_, _, Some(part)) => format!(
            "what is heard is passed on up to {} times as large, so that in some network with such weights a mode may grow: sample \
             faster, filter less, or let roots and weights be smaller",
            rounded(part)
        ),
        (Some(rate), _, None) => {
            format!("a mode grows at {}/s, which is too slow to be seen until the end; {advice}", rounded(rate))
        }
        (None, Some(rate), None) => format!(
            "a mode grows at {}/s at the start ({}), but not where that leads; {advice}",
            rounded(rate),
            start.agent.name
        ),
        (None, None, None) => settled(found, advice),
    };
    format!("linearised {places} ({whose}), with a period of {} ms: {meaning}", rounded(1e3 * period_s))
}

/// Of a loop in which no mode grows while estimates are right.
fn settled(found: &WholeLoop, advice: &str) -> String {
    match (found.astray_per_s(), found.start.overshoot(), found.start.slowed_per_s()) {
        (Some(rate), _, _) => format!(
            "while estimates are right no mode grows; once they are at their upper bounds, or without bounds as they start, one \
             does at {}/s; {advice}",
            rounded(rate)
        ),
        (None, Some(leftmost), _) => {
            format!("a fast mode overshoots: its multiplier has the real part {}; sample faster", rounded(leftmost))
        }
        (None, None, Some([own, ideal])) => format!(
            "the slowest mode decays at {}/s, in continuous time at {}/s; sample faster",
            rounded(own),
            rounded(ideal)
        ),
        (None, None, None) => "no mode grows that would not in continuous time".to_owned(),
    }
}

/// What else there is between a sample and its torque.
fn hold(margin: &SamplingMargin) -> String {
    let late = match margin.hold.delay_s {
        late_s if late_s > 0.0 => format!(", with torques {} ms late", rounded(1e3 * late_s)),
        _ => String::new(),
    };
    let filter = margin.hold.cut_off_rad_s.map_or_else(String::new, |cut_off| {
        format!(
            "{} velocities filtered at {} Hz",
            if late.is_empty() { ", with" } else { " and" },
            rounded(cut_off / core::f64::consts::TAU)
        )
    });
    late + &filter
}

fn periods(margin: &SamplingMargin) -> String {
    let ms = |period_s: f64| rounded(1e3 * period_s);
    let Some(longest_s) = margin.longest_s else {
        return "no period is short enough for it: the torques come too late".into();
    };
    let half = margin.recommended_s.map_or_else(
        || format!("no period brings it below {RECOMMENDED_MARGIN}, which is recommended"),
        |period_s| format!("keep it below {RECOMMENDED_MARGIN}, a period of {} ms", ms(period_s)),
    );
    let faster = margin.rival_per_s.map_or_else(String::new, |rate| {
        format!(
            "; beside references that answer at up to {}/s, by their roots, weights and λ, and are not slow beside that mode, shorter periods may be \
             needed, of which whole-loop speaks",
            rounded(rate)
        )
    });
    format!("it reaches 1 at a period of {} ms; {half}{faster}", ms(longest_s))
}
