//! `forwardstep manipulability`

use forwardstep::check::manipulability::{LowFrequency, Manipulability, Measured, NoManipulability, Trial, measure};
use forwardstep::io::output::names;
use forwardstep::io::scenario::Scenario;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::sim::{Adaptive, Setup};
use thiserror::Error;

use super::stop::Stop;
use crate::arguments::ManipulabilityOptions;
use crate::console::{Console, DIM, Plain, complain};
use crate::status::Status;

/// How long the push that ends lasts, s.
const PUSH_S: f64 = 1.0;

/// No agent has the name given.
#[derive(Debug, Error)]
#[error("no agent is called `{name}`; there are {known}")]
struct NoSuchAgent {
    name: String,
    known: String,
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
        if !options.table {
            head(&scenario, trial, console);
        }
        for lambda in &options.lambda {
            let mut setup = scenario.setup.clone();
            setup.agents.iter_mut().for_each(|agent| agent.manipulability = *lambda);
            let theory = Manipulability::of(&setup, trial.agent, trial.axis)
                .map_err(|error| refuse(&setup, &error))?
                .low_frequency();
            let found = measure(&setup, trial, &mut |_| stop.flow());
            if let Some(status) = stop.asked() {
                return Err(status);
            }
            let found = found.map_err(|error| refuse(&setup, &error))?;
            let cells = cells(*lambda, theory, found);
            if options.table {
                let adapts = setup.agents[trial.agent].law.is::<Adaptive>();
                let law = if adapts { "adapted" } else { "known" };
                console.line(format_args!("| {} | {law} | {} |", scenario.name, cells.join(" | ")));
            } else {
                let [lambda, degree, gain, impulse, moved, constant, displaced] = cells;
                console.line(format_args!("  λ = {lambda}: degree {degree}, gain {gain}"));
                console.line(format_args!("    an impulse of 1 displaces it by     {impulse}, measured {moved}"));
                console.line(format_args!("    a constant torque of 1: theory      {constant}, measured {displaced}"));
            }
        }
    }
    Ok(Status::Fine)
}

/// Why there is no transfer, with agents by name.
#[derive(Debug, Error)]
#[error("{0}")]
struct NoTransfer(String);

fn refuse(setup: &Setup, error: &dyn std::error::Error) -> Status {
    complain(&Plain::new(NoTransfer(names::reason(setup, error))))
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

fn head(scenario: &Scenario, trial: Trial, console: &mut Console) {
    let setup = &scenario.setup;
    let (agent, torque) = (&setup.agents[trial.agent], trial.torque);
    console.line(&scenario.title);
    let axis = agent.robot.axes.get(trial.axis).map_or("", |axis| axis.name.as_str());
    console.line(format_args!(
        "{DIM}  {} is pushed with {torque} on {axis}, at rest: for {PUSH_S} s, and for all of {} s{DIM:#}",
        agent.name, setup.time.end_s
    ));
}

/// λ, degree, gain, and by an impulse and by a constant torque what is predicted and what was measured.
fn cells(lambda: f64, theory: LowFrequency, found: Measured) -> [String; 7] {
    let (constant, moved) = if theory.degree > 0 {
        (format!("{} /s", digits(theory.by_impulse())), format!("{} /s", digits(found.drift)))
    } else {
        (digits(theory.by_constant()), digits(found.by_constant))
    };
    let [gain, impulse, displaced] = [theory.gain, theory.by_impulse(), found.by_impulse].map(digits);
    [lambda.to_string(), theory.degree.to_string(), gain, impulse, displaced, constant, moved]
}

/// Six places: what is below is no more than the solver's tolerance leaves.
fn digits(value: f64) -> String {
    // What rounds to zero has no sign.
    let text = format!("{value:.6}");
    if text.bytes().any(|digit| (b'1'..=b'9').contains(&digit)) { text } else { "0".into() }
}
