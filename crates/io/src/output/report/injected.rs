//! What changed V along a run under digital control.

use forwardstep_check::{Injection, Source};
use maud::{Markup, html};

use super::super::injected::Injected;
use super::super::names;
use super::super::record::RunRecord;
use super::super::text::number;

/// More rows would only repeat themselves.
const MOST_ROWS: usize = 24;

/// Agents by causes; nothing in continuous time.
pub(crate) fn injected(record: &RunRecord<'_>) -> Markup {
    let Some(first) = record.injected.first() else { return html! {} };
    let setup = record.setup;
    // Causes that act on no agent need no column.
    let acts = |injection: &Injection| record.injected.iter().any(|own| own.term_j(*injection) != 0.0);
    let causes: Vec<Injection> = Injection::ALL.into_iter().filter(acts).collect();
    let agent = |own: &Injected| names::agent_name(setup, own.agent);
    let first_of = |own: &Injected| {
        own.first
            .as_ref()
            .map_or_else(|| "–".to_owned(), |first| format!("{}, t = {} s", first.cause, number(first.t_s)))
    };
    let residual = record.injected.iter().fold(first.residual_j.abs(), |most, own| most.max(own.residual_j.abs()));
    html! {
        section #injected {
            h2 { "What changed V" }
            div.card.scroll {
                h3 { "Energy put into V by each cause, in J or the unit of V" " " span.by { (Source::Derived.words()) } }
                table.numbers {
                    thead { tr {
                        th {} th scope="col" { "V at the start" }
                        @for cause in &causes { th scope="col" title=(cause.words()) { (cause.name()) } }
                        th scope="col" { "V at the end" } th scope="col" { "First beyond the proof" }
                    } }
                    tbody { @for own in record.injected.iter().take(MOST_ROWS) { tr {
                        th scope="row" { (agent(own)) } td { (number(own.start_j)) }
                        @for cause in &causes { td { (number(own.term_j(*cause))) } }
                        td { (number(own.end_j)) } td { (first_of(own)) }
                    } } }
                }
                @if record.injected.len() > MOST_ROWS { p.note { "All agents are in summary.json." } }
                p.note {
                    @for cause in &causes { (cause.name()) ": " (cause.words()) ". " }
                    "The proof allows what is dissipated, and pushes that end; a cause is named once it has put in more than 1 % of the "
                    "largest V so far. The terms add up to the change of V within " (number(residual)) "."
                }
            }
        }
    }
}
