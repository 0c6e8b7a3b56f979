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

/// Six places: what is below is no more than the solver's tolerance leaves.
fn digits(value: f64) -> String {
    // What rounds to zero has no sign.
    let text = format!("{value:.6}");
    if text.bytes().any(|digit| (b'1'..=b'9').contains(&digit)) { text } else { "0".into() }
}
