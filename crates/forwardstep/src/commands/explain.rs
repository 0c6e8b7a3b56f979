//! `forwardstep explain`

use forwardstep::check::derivation::explain as derive;
use forwardstep::check::derivation::residual::{ROUNDING, Residual, Residuals};
use forwardstep::check::{Footing, check};
use forwardstep::io::output::{
    TextLine, continuous_twin, ending_sentence, explanation_document, explanation_latex, explanation_lines,
    residual_document, residual_lines,
};
use forwardstep::io::scenario::Scenario;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::sim::{Ending, Observers, simulate_with};

use super::patience::{LOOKING, Patience};
use super::progress::Bar;
use super::stop::Stop;
use crate::arguments::ExplainOptions;
use crate::console::{BOLD, Console, DIM, Plain, complain, remark};
use crate::status::Status;

/// Derives why a scenario converges.
pub(crate) fn explain(options: &ExplainOptions, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    let patience = Patience::with(LOOKING);
    let scenario = kinds.open_scenario(&options.scenario).map_err(|error| complain(&error))?;
    if options.along {
        drop(patience);
        return along(&scenario, options.json, console);
    }
    let explanation = derive(&scenario.setup);
    let footing = Footing::of(&scenario.setup, &check(&scenario.setup));
    if options.json {
        let document = explanation_document(&scenario, env!("CARGO_PKG_VERSION"), &explanation, &footing);
        // The alternate form is indented.
        console.json(format_args!("{document:#}"));
    } else if options.latex {
        console.verbatim(explanation_latex(&scenario.setup, &explanation, &footing));
    } else {
        console.line(format_args!("{BOLD}{}{BOLD:#}", scenario.title));
        for line in explanation_lines(&scenario.setup, &explanation, &footing) {
            show(&line, console);
        }
    }
    Ok(Status::Fine)
}

/// The identities along a run in continuous time: under digital control none of them holds between samples.
fn along(scenario: &Scenario, json: bool, console: &mut Console) -> Result<Status, Status> {
    let digital = scenario.setup.control.is_some();
    let twin = digital.then(|| continuous_twin(&scenario.setup, scenario.setup.time.end_s));
    let setup = twin.as_ref().unwrap_or(&scenario.setup);
    scenario.check_recording().map_err(|error| complain(&error))?;
    let refused = |error| complain(&Plain::new(error));
    let mut residuals = Residuals::of(setup).map_err(refused)?;
    let (stop, mut bar) = (Stop::listen(), Bar::new());
    let mut observer = |progress| {
        bar.update(progress);
        stop.flow()
    };
    let outcome = simulate_with(
        setup,
        &mut observer,
        Observers { moments: Some(&mut |moment| residuals.look(moment)), ..Observers::default() },
    )
    .map_err(refused)?;
    bar.clear();
    if outcome.ending != Ending::Completed {
        remark(ending_sentence(setup, &outcome.ending));
    }
    let found = residuals.found();
    if json {
        let mut document = residual_document(setup, &found);
        document["scenario"] = scenario.name.as_str().into();
        document["version"] = env!("CARGO_PKG_VERSION").into();
        console.json(format_args!("{document:#}"));
    } else {
        console.line(format_args!("{BOLD}{}{BOLD:#}", scenario.title));
        let control = if digital { ", with control in continuous time, in which the equations hold" } else { "" };
        console.line(format_args!(
            "Along a run of {} s{control}: the two sides of every equation, evaluated from states, their rates and what is heard. Residuals \
             are relative to the size of the terms; up to {ROUNDING:e} they are rounding.",
            outcome.recording.t_s.last().copied().unwrap_or(0.0)
        ));
        residual_lines(setup, &found).iter().for_each(|line| show(line, console));
    }
    let all_hold = found.iter().flat_map(|(_, residuals)| residuals).all(|one: &Residual| one.holds() != Some(false));
    Ok(match outcome.ending {
        Ending::BrokeDown(_) => Status::BrokeDown,
        Ending::Interrupted { .. } | Ending::CutOff { .. } => stop.asked().unwrap_or(Status::Interrupted),
        Ending::Completed if all_hold => Status::Fine,
        Ending::Completed => Status::Missed,
    })
}

fn show(line: &TextLine, console: &mut Console) {
    match line {
        TextLine::Agents(names) => console.line(format_args!("\n{BOLD}{names}{BOLD:#}")),
        TextLine::Heading(heading) => console.line(format_args!("\n  {BOLD}{heading}{BOLD:#}")),
        TextLine::Words(words) => console.line(format_args!("  {words}")),
        TextLine::Formula(formula, "") => console.line(format_args!("      {formula}")),
        TextLine::Formula(formula, place) => console.line(format_args!("      {formula}    {DIM}{place}{DIM:#}")),
    }
}
