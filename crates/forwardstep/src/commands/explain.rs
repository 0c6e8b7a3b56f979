//! `forwardstep explain`

use forwardstep::check::derivation::explain as derive;
use forwardstep::io::output::{TextLine, explanation_document, explanation_latex, explanation_lines};
use forwardstep::io::scenario::kinds::Kinds;

use crate::arguments::ExplainOptions;
use crate::console::{BOLD, Console, DIM, complain};
use crate::status::Status;

/// Derives why a scenario converges.
pub(crate) fn explain(options: &ExplainOptions, kinds: &Kinds, console: &mut Console) -> Status {
    let scenario = match kinds.open_scenario(&options.scenario) {
        Ok(scenario) => scenario,
        Err(error) => return complain(&error),
    };
    let explanation = derive(&scenario.setup);
    if options.json {
        let document = explanation_document(&scenario, env!("CARGO_PKG_VERSION"), &explanation);
        // The alternate form is indented.
        console.line(format_args!("{document:#}"));
    } else if options.latex {
        console.text(explanation_latex(&scenario.setup, &explanation));
    } else {
        console.line(format_args!("{BOLD}{}{BOLD:#}", scenario.title));
        for line in explanation_lines(&scenario.setup, &explanation) {
            show(&line, console);
        }
    }
    Status::Fine
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
