//! `forwardstep manipulability`

use forwardstep::check::manipulability::{LowFrequency, Manipulability, Measured, NoManipulability, Trial, measure};
use forwardstep::io::output::names;
use forwardstep::io::scenario::Scenario;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::sim::quantity::{number, rounded, with_power};
use forwardstep::sim::{Adaptive, Setup, Signal};
use thiserror::Error;

use super::stop::Stop;
use crate::arguments::ManipulabilityOptions;
use crate::console::{Console, DIM, Plain, complain};
use crate::status::Status;

/// How long the push that ends lasts, s.
const PUSH_S: f64 = 1.0;
/// So many axes are told of where it is pushed.
const MOST_AXES: usize = 8;

/// No agent has the name given.
#[derive(Debug, Error)]
#[error("no agent is called `{name}`; there are {known}")]
struct NoSuchAgent {
    name: String,
    known: String,
}

/// The push would outlast the run.
#[derive(Debug, Error)]
#[error("the push lasts {PUSH_S} s, and the run {end_s} s: let `time.end_s` be longer")]
struct ShortRun {
    end_s: f64,
}

/// Pushes scenarios at rest with several λ, and sets what happened beside the theory.
pub(crate) fn manipulability(
    options: &ManipulabilityOptions,
    kinds: &Kinds,
    console: &mut Console,
) -> Result<Status, Status> {
    let stop = Stop::listen();
    if options.table {
        console.line("| Scenario | Parameters | λ | Degree | Gain | By an impulse: theory | measured | By a constant torque: theory | measured |");
        console.line("|---|---|---|---|---|---|---|---|---|");
    }
    for name in &options.scenarios {
        let scenario = kinds.open_scenario(name).map_err(|error| complain(&error))?;
        let trial = trial(options, &scenario.setup)?;
        let end_s = scenario.setup.time.end_s;
        if end_s <= PUSH_S {
            return Err(complain(&Plain::new(ShortRun { end_s })));
        }
        for (k, lambda) in options.lambda.iter().enumerate() {
            let mut setup = scenario.setup.clone();
            setup.agents.iter_mut().for_each(|agent| agent.manipulability = *lambda);
            let transfer =
                Manipulability::of(&setup, trial.agent, trial.axis).map_err(|error| refuse(&scenario, &error))?;
            let theory = transfer.low_frequency();
            if k == 0 && !options.table {
                head(&scenario, trial, transfer.posture(), console);
            }
            let found = measure(&setup, trial, &mut |_| stop.flow());
            if let Some(status) = stop.asked() {
                return Err(status);
            }
            let found = match found {
                Ok(found) => found,
                Err(error) if k == 0 || options.table => return Err(refuse(&scenario, &error)),
                // Not every law has λ; without it something has been said already.
                Err(error) => {
                    console.line(format_args!("  λ = {lambda}: nothing, since {}", names::reason(&setup, &error)));
                    break;
                }
            };
            let why = differs(theory, found, trial);
            let words = Words::of(*lambda, theory, found);
            if options.table {
                let adapts = setup.agents[trial.agent].law.is::<Adaptive>();
                let law = if adapts { "adapted" } else { "known" };
                console.line(words.row(&scenario.name, law));
            } else {
                let Words { lambda, degree, gain, by_impulse, by_constant } = words;
                console.line(format_args!("  λ = {lambda}: degree {degree}, gain {gain}"));
                let Response { theory, measured } = by_impulse;
                console.line(format_args!("    an impulse of 1 displaces it by     {theory}, measured {measured}"));
                let Response { theory, measured } = by_constant;
                console.line(format_args!("    a constant torque of 1: theory      {theory}, measured {measured}"));
                if let Some(why) = why {
                    console.line(format_args!("{DIM}    {why}{DIM:#}"));
                }
            }
        }
    }
    Ok(Status::Fine)
}

/// A part of the gain by which theory and measurement may differ without a word.
const ALIKE: f64 = 0.01;
/// Displacements below this, rad or m, are lost in what positions are rounded to and solved with.
const LOST: f64 = 1e-10;

/// Why what was measured is not what theory says, where it is not.
fn differs(theory: LowFrequency, found: Measured, trial: Trial) -> Option<&'static str> {
    let constant =
        if theory.degree > 0 { found.drift - theory.by_impulse() } else { found.by_constant - theory.by_constant() };
    let off = (found.by_impulse - theory.by_impulse()).abs().max(constant.abs());
    let is_lost = (trial.torque * trial.for_s * theory.gain).abs() < LOST;
    // Of what is no number nothing is alike.
    let alike = off <= ALIKE * theory.gain.abs();
    let is_told = !alike && (0..=1).contains(&theory.degree);
    is_told.then_some(match is_lost {
        true => "so small a push is lost in rounding: let `--torque` be larger",
        false => {
            "the theory is that of small pushes, long after they began: let `--torque` be smaller, or the run longer"
        }
    })
}

/// Why there is no transfer, with agents by name.
fn refuse(scenario: &Scenario, error: &dyn std::error::Error) -> Status {
    let said = format!("`{}`: {}", scenario.name, names::reason(&scenario.setup, error));
    let help = "the transfer is that of a fixed graph with constant weights and delays, and robots under (6)-(7), as in `remark-4`";
    complain(&Plain::with_help(said, Some(help)))
}

/// Who is pushed.
fn trial(options: &ManipulabilityOptions, setup: &Setup) -> Result<Trial, Status> {
    let axis = options.axis as usize - 1;
    let of = |agent| Trial { agent, axis, torque: options.torque, for_s: PUSH_S };
    let Some(name) = &options.on else {
        // Any other reason is told of the first one.
        let followed = |agent: &usize| {
            !matches!(Manipulability::of(setup, *agent, axis), Err(NoManipulability::NoInfluence { .. }))
        };
        return Ok(of((0..setup.agents.len()).find(followed).unwrap_or(0)));
    };
    let found = setup.agents.iter().position(|agent| agent.name == *name);
    let known = || setup.agents.iter().map(|agent| agent.name.as_str()).collect::<Vec<_>>().join(", ");
    found.map(of).ok_or_else(|| complain(&Plain::new(NoSuchAgent { name: name.clone(), known: known() })))
}

fn head(scenario: &Scenario, trial: Trial, posture: &[f64], console: &mut Console) {
    let setup = &scenario.setup;
    let (agent, torque) = (&setup.agents[trial.agent], trial.torque);
    console.line(&scenario.title);
    let axis = agent.robot.axes.get(trial.axis).map_or("", |axis| axis.name.as_str());
    let force = names::unit(setup, trial.agent, Signal::Torque, trial.axis);
    console.line(format_args!(
        "{DIM}  {} is pushed with {torque} {force} on {axis}, at rest where all agree: for {PUSH_S} s, and for all of {} s{DIM:#}",
        agent.name, setup.time.end_s
    ));
    // Beside the largest, what rounding leaves is zero.
    let largest = posture.iter().fold(1.0_f64, |largest, q| largest.max(q.abs()));
    let place = |(axis, q): (usize, &f64)| {
        let unit = names::unit(setup, trial.agent, Signal::Position, axis);
        let q = if q.abs() < 1e-12 * largest { 0.0 } else { *q };
        format!("{} {} {unit}", agent.robot.axes[axis].name, rounded(q))
    };
    let place: Vec<String> = posture.iter().enumerate().take(MOST_AXES).map(place).collect();
    let more = if posture.len() > MOST_AXES { ", …" } else { "" };
    console.line(format_args!("{DIM}  it stands at {}{more}{DIM:#}", place.join(", ")));
}

/// What is predicted and what was measured.
struct Response {
    theory: String,
    measured: String,
}

/// One λ in words.
struct Words {
    lambda: String,
    degree: String,
    gain: String,
    by_impulse: Response,
    by_constant: Response,
}

impl Words {
    fn of(lambda: f64, theory: LowFrequency, found: Measured) -> Words {
        let digits = |value| digits(value, theory.gain);
        let by_constant = if theory.degree > 0 {
            let [theory, measured] = [theory.by_impulse(), found.drift].map(|speed| format!("{} /s", digits(speed)));
            Response { theory, measured }
        } else {
            let [theory, measured] = [theory.by_constant(), found.by_constant].map(digits);
            Response { theory, measured }
        };
        let by_impulse = Response { theory: digits(theory.by_impulse()), measured: digits(found.by_impulse) };
        let (lambda, degree) = (lambda.to_string(), theory.degree.to_string());
        Words { lambda, degree, gain: digits(theory.gain), by_impulse, by_constant }
    }

    /// As a row of the table.
    fn row(&self, scenario: &str, law: &str) -> String {
        let Words { lambda, degree, gain, by_impulse, by_constant } = self;
        let both = |response: &Response| format!("{} | {}", response.theory, response.measured);
        format!("| {scenario} | {law} | {lambda} | {degree} | {gain} | {} | {} |", both(by_impulse), both(by_constant))
    }
}

/// Four digits of the gain: what is below is no more than the solver's tolerance, and the second order of the push, leave.
fn digits(value: f64, gain: f64) -> String {
    let last = 10_f64.powf(gain.abs().log10().floor() - 3.0);
    if !(last > 0.0 && last.is_finite()) {
        return number(rounded(value)).to_string();
    }
    let digits = (value / last).round();
    if digits == 0.0 {
        // What rounds to zero has no sign.
        return "0".into();
    }
    if !(1e-4..1e7).contains(&gain.abs()) {
        return with_power(&format!("{:.3e}", digits * last));
    }
    format!("{value:.*}", (-last.log10().round()).max(0.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regress_gains_of_heavy_machines_are_not_rounded_to_nothing() {
        let found = [
            (0.0325521, 0.0325521),
            (5.912e-10, 5.912e-10),
            (-4e-14, 5.9e-10),
            (-2e-6, 0.0186),
            (123.456, 123.456),
            (1.5, 0.0),
        ];
        let shown = found.map(|(value, gain)| digits(value, gain));
        assert_eq!(shown, ["0.03255", "5.912 × 10⁻¹⁰", "0", "0", "123.5", "1.5"]);
    }
}
