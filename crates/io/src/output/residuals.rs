//! How well the identities of an explanation hold along a run, as text and as JSON.

use forwardstep_check::derivation::residual::{Largest, ROUNDING, Residual};
use forwardstep_sim::Setup;
use serde_json::{Value, json};

use super::explanation::TextLine;
use super::formula::unicode;
use super::names;
use super::text::number as number_words;

/// Residuals line by line: for every design its agents and its equations, each with where its sides differ most.
pub fn residual_lines(setup: &Setup, found: &[(Vec<usize>, Vec<Residual>)]) -> Vec<TextLine> {
    let mut lines = Vec::new();
    for (agents, residuals) in found {
        lines.push(TextLine::Agents(names::some_names(setup, agents)));
        if residuals.is_empty() {
            lines.push(TextLine::Words("Nothing is derived that could be evaluated.".into()));
        }
        let mut subject = None;
        for residual in residuals {
            if subject != Some(residual.subject) {
                subject = Some(residual.subject);
                lines.push(TextLine::Heading(residual.subject.heading()));
            }
            lines.push(TextLine::Formula(unicode(&residual.formula), residual.place));
            lines.push(TextLine::Words(words(setup, residual)));
        }
    }
    lines
}

fn words(setup: &Setup, residual: &Residual) -> String {
    match &residual.largest {
        Err(missing) => format!("not evaluated: {missing}"),
        Ok(Largest { relative, difference, agent, entry, t_s, .. }) => {
            let agent = names::agent_name(setup, *agent);
            let ends = if residual.holds() == Some(true) { "" } else { ", which is NO ROUNDING" };
            let [relative, difference, t_s] = [*relative, *difference, *t_s].map(number_words);
            format!("{relative} at most, at {t_s} s: {difference} in entry {} of {agent}{ends}", entry + 1)
        }
    }
}

/// Residuals as JSON, design by design.
pub fn residual_document(setup: &Setup, found: &[(Vec<usize>, Vec<Residual>)]) -> Value {
    let residual = |residual: &Residual| {
        let mut value = json!({
            "subject": residual.subject.name(),
            "unicode": unicode(&residual.formula),
            "paper": residual.place,
            "holds": residual.holds(),
        });
        match &residual.largest {
            Err(missing) => value["not_evaluated"] = missing.to_string().into(),
            Ok(Largest { relative, difference, agent, entry, t_s, moments }) => {
                // JSON has no infinity.
                value["relative"] = relative.is_finite().then_some(*relative).into();
                value["difference"] = difference.is_finite().then_some(*difference).into();
                value["agent"] = names::agent_name(setup, *agent).into();
                value["entry"] = entry.saturating_add(1).into();
                value["t_s"] = (*t_s).into();
                value["moments"] = (*moments).into();
            }
        }
        value
    };
    let design = |(agents, residuals): &(Vec<usize>, Vec<Residual>)| {
        let names: Vec<String> = agents.iter().map(|agent| names::agent_name(setup, *agent)).collect();
        json!({ "agents": names, "residuals": residuals.iter().map(residual).collect::<Vec<_>>() })
    };
    json!({ "rounding": ROUNDING, "designs": found.iter().map(design).collect::<Vec<_>>() })
}
