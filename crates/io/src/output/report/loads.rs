//! What the robots had to bring up: peaks of torques, thrusts and wheels, and the limits that were reached.

use forwardstep_sim::recording::Signal;
use forwardstep_sim::setup::Setup;
use maud::{Markup, html};

use super::super::loads::Load;
use super::super::metrics::{LimitKind, LimitReached, Metrics, Peak};
use super::super::names;
use super::super::text::{self, number};
use super::sections::unit_at;

/// More rows would only repeat themselves.
const MOST_LIMIT_ROWS: usize = 24;
const MOST_TORQUE_ROWS: usize = 64;

/// Peak torques, agents by axes, and the limits that were reached.
pub(crate) fn loads(setup: &Setup, metrics: &Metrics) -> Markup {
    let most_axes = metrics.peak_torques.iter().map(|peak| peak.axis + 1).max().unwrap_or(0);
    let peak = |agent, axis| metrics.peak_torques.iter().find(|p| p.agent == agent && p.axis == axis);
    html! {
        section #loads {
            h2 { "Loads and limits" }
            @if metrics.peak_torques.is_empty() && metrics.peak_loads.is_empty() { p.note { "No torques or forces were recorded." } }
            @if !metrics.peak_torques.is_empty() {
                div.card.scroll {
                    h3 { "Peak " (names::input_words(setup).0) " " span.by { "largest |τ| at recorded rows, the time, and its share of the limit where one is known" } }
                    table.numbers.peaks {
                        thead { tr { th {} @for axis in 0..most_axes { th scope="col" { (names::shared_words(setup, axis, names::torque_words)) } } } }
                        tbody {
                            @for agent in 0..setup.agents.len().min(MOST_TORQUE_ROWS) {
                                tr {
                                    th scope="row" { span.dot.{ "a" (agent) } {} (names::agent_name(setup, agent)) }
                                    @for axis in 0..most_axes {
                                        td { @if let Some(p) = peak(agent, axis) { (torque(setup, p)) } }
                                    }
                                }
                            }
                        }
                    }
                }
            }
            @if !metrics.peak_loads.is_empty() { (beside_axes(setup, &metrics.peak_loads)) }
            div.card.scroll #limits {
                h3 { "Limits" " " span.by { "reported; enforced only where the scenario asks for it" } }
                @if metrics.limits_reached.is_empty() { p.note { "No known limit was exceeded." } } @else {
                    table.numbers {
                        thead { tr { th scope="col" { "Agent" } th scope="col" { "limit" } th scope="col" { "value" } th scope="col" { "worst" } th scope="col" { "exceeded by" } th scope="col" { "first at" } th scope="col" { "of the rows" } th scope="col" { "enforced" } } }
                        tbody { @for limit in metrics.limits_reached.iter().take(MOST_LIMIT_ROWS) {
                            @let (kind, signal) = match limit.kind {
                                LimitKind::Position | LimitKind::Unknown => ("position".to_owned(), Signal::Position),
                                LimitKind::Velocity => ("speed".to_owned(), Signal::Velocity),
                                LimitKind::Effort => {
                                    (if names::unit(setup, limit.agent, Signal::Torque, limit.axis) == "N" { "force" } else { "torque" }.to_owned(), Signal::Torque)
                                }
                                LimitKind::Rotor => ("thrust".to_owned(), Signal::Thrust),
                                LimitKind::Signal(signal) => (signal.name().replace('_', " "), signal),
                            };
                            @let unit = unit_at(setup, signal, limit.agent, limit.axis);
                            tr {
                                th scope="row" { span.dot.{ "a" (limit.agent) } {} (names::agent_name(setup, limit.agent)) " · " (limit_entry(setup, limit, signal)) }
                                td { (kind) }
                                td { (number(limit.limit)) " " (unit) }
                                td { (number(limit.worst)) " " (unit) }
                                td { @if limit.excess > 0.0 { (number(limit.excess)) } @else { "reached" } }
                                td { (number(limit.first_t_s)) " s" }
                                td { (number((1000.0 * limit.share).ceil() / 10.0)) " %" }
                                td { @if limit.enforced { "yes" } @else { "no" } }
                            }
                        } }
                    }
                    @if metrics.limits_reached.len() > MOST_LIMIT_ROWS {
                        p.note { "The first " (MOST_LIMIT_ROWS) " of " (metrics.limits_reached.len()) "; summary.json has all." }
                    }
                }
            }
        }
    }
}

/// What of an agent has the limit: an axis, an entry of a signal, or a rotor.
fn limit_entry(setup: &Setup, limit: &LimitReached, signal: Signal) -> String {
    match limit.kind {
        LimitKind::Rotor => format!("rotor {}", limit.axis + 1),
        _ => names::entry_words(setup, limit.agent, signal, limit.axis),
    }
}

fn torque(setup: &Setup, peak: &Peak) -> Markup {
    let unit = unit_at(setup, Signal::Torque, peak.agent, peak.axis);
    load(peak, &unit, setup.agents[peak.agent].robot.axes[peak.axis].effort_limit)
}

/// The largest magnitude, when it was, and its share of the limit.
fn load(peak: &Peak, unit: &str, limit: Option<f64>) -> Markup {
    html! {
        span.value { (number(peak.value.abs())) }
        span.unit { " " (unit) }
        small {
            (number(peak.t_s)) " s"
            @if let Some(limit) = limit {
                @let share = peak.value.abs() / limit;
                " · " span.bad[share > 1.0] { (number((100.0 * share).round())) " %" }
            }
        }
    }
}

/// What acts without an axis, agents by thrusts, rotors and wheels.
fn beside_axes(setup: &Setup, loads: &[Load]) -> Markup {
    let mut columns: Vec<String> = Vec::new();
    for words in loads.iter().map(Load::words) {
        if !columns.contains(&words) {
            columns.push(words);
        }
    }
    let mut agents: Vec<usize> = loads.iter().map(|load| load.peak.agent).collect();
    agents.dedup();
    let of = |agent: usize, words: &str| loads.iter().find(|load| load.peak.agent == agent && load.words() == words);
    html! {
        div.card.scroll {
            h3 { "Peaks of thrusts and wheels" " " span.by { "largest magnitude at recorded rows, the time, and its share of the limit where one is known" } }
            table.numbers.peaks {
                thead { tr { th {} @for words in &columns { th scope="col" { (words) } } } }
                tbody {
                    @for agent in agents.into_iter().take(MOST_TORQUE_ROWS) {
                        tr {
                            th scope="row" { span.dot.{ "a" (agent) } {} (names::agent_name(setup, agent)) }
                            @for words in &columns {
                                td { @if let Some(found) = of(agent, words) { (load(&found.peak, &text::unit(&found.unit(setup)), found.limit)) } }
                            }
                        }
                    }
                }
            }
        }
    }
}
