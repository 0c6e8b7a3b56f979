//! `forwardstep check`

use std::ops::ControlFlow;
use std::path::Path;

use forwardstep::check::{Id, PracticalAnswer, Report, certify};
use forwardstep::io::output::{Findings, certificate_document, is_certificate};
use forwardstep::io::scenario::Scenario;
use forwardstep::io::scenario::kinds::Kinds;

use super::patience::{LOOKING, Patience};
use super::promise::{predictions, promise, show, show_predictions, style};
use super::replace;
use crate::arguments::CheckOptions;
use crate::console::{BOLD, Console, FAIR, Plain, complain};
use crate::status::Status;

/// Says which theorem speaks about a scenario and whether its hypotheses hold.
pub(crate) fn check(options: &CheckOptions, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    let patience = Patience::with(LOOKING);
    let scenario = kinds.open_scenario(&options.scenario).map_err(|error| complain(&error))?;
    let promise = promise(&scenario.setup);
    let report = &promise.report;
    let mut accepted = options.accept.clone();
    accepted.sort_unstable();
    accepted.dedup();
    let unproven = options.certificate.as_deref().map(|path| certificate(path, &scenario, report)).transpose();
    let unproven = unproven.map_err(|error| complain(&error))?.unwrap_or_default();
    let predicted = || predictions(&scenario.setup, options.thorough, &mut |_| ControlFlow::Continue(()));
    let predictions = options.predict.then(predicted).flatten();
    drop(patience);
    if options.json {
        let findings = Findings::of(
            &scenario,
            env!("CARGO_PKG_VERSION"),
            report,
            &promise.practical,
            &promise.agreement,
            predictions,
            &accepted,
        );
        console.json(findings.to_json().map_err(|error| complain(&Plain::new(error)))?);
    } else {
        show(&scenario, &promise, console);
        if let Some(predictions) = &predictions {
            show_predictions(&scenario.setup, predictions, console);
        }
        conclude(report, &accepted, console);
        if !unproven.is_empty() {
            console.line(format_args!(
                "{FAIR}without a proof in the certificate{FAIR:#}: {}; only this program vouches for that",
                unproven.join(", ")
            ));
        }
    }
    let practical = !options.practical || promise.practical.worst() != Some(PracticalAnswer::Inadequate);
    Ok(if report.worst_without(&accepted).is_fine() && practical { Status::Fine } else { Status::Missed })
}

/// Writes the answers with their proofs, and gives what is claimed without one. A waiver changes no answer.
fn certificate(path: &Path, scenario: &Scenario, report: &Report) -> Result<Vec<&'static str>, Plain<String>> {
    replace::may_replace(path, is_certificate)?;
    let certificate = certify(&scenario.setup, report);
    let mut unproven: Vec<_> =
        certificate.statements.iter().filter(|it| it.is_unproven()).map(|statement| statement.id.name()).collect();
    unproven.dedup();
    let document = certificate_document(scenario, env!("CARGO_PKG_VERSION"), &certificate);
    // The alternate form is indented.
    replace::write(path, &format!("{document:#}\n"))?;
    Ok(unproven)
}

/// What was waived, and what it all comes to.
fn conclude(report: &Report, accepted: &[Id], console: &mut Console) {
    let mut waived = Vec::new();
    for id in accepted {
        let said = report.hypotheses.iter().filter(|hypothesis| hypothesis.id == *id).map(|h| h.answer()).max();
        let name = id.name();
        console.line(match said {
            None => format!("{FAIR}accepted{FAIR:#}: {name}, which nothing here asks for"),
            Some(answer) if answer.is_fine() => {
                format!("{FAIR}accepted{FAIR:#}: {name}, without need: {}", answer.words())
            }
            Some(answer) => {
                waived.push(name);
                format!("{FAIR}accepted{FAIR:#}: {name}, although {}", answer.words())
            }
        });
    }
    let outcome = report.worst_without(accepted);
    let (style, words) = (style(outcome), outcome.words());
    let mut reasons: Vec<&str> = Vec::new();
    for hypothesis in &report.hypotheses {
        let name = hypothesis.id.name();
        if hypothesis.answer() == outcome && !accepted.contains(&hypothesis.id) && !reasons.contains(&name) {
            reasons.push(name);
        }
    }
    let because =
        if outcome.is_fine() || reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join(", ")) };
    let but =
        if waived.is_empty() { String::new() } else { format!(", but for what was accepted: {}", waived.join(", ")) };
    console.line(format_args!("{BOLD}all in all{BOLD:#}: {style}{words}{style:#}{because}{but}"));
}
