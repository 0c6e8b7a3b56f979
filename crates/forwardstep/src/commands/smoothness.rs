//! `forwardstep smoothness`

use std::fmt::Display;
use std::fs::File;
use std::io::{BufReader, Read};
use std::ops::ControlFlow;
use std::path::Path;

use forwardstep::check::smoothness::{
    self as input, Covered, Filters, LargestJump, OfOrder, Smoothness, filters, orders, traces,
};
use forwardstep::core::signal::superscript;
use forwardstep::io::output::{
    EncodeError, SmoothScenario, SmoothnessDocument, SmoothnessFound, names, plot_filters, plot_orders,
};
use forwardstep::io::scenario::Scenario;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::sim::quantity::with_power;
use forwardstep::sim::{Progress, Setup, Signal};

use super::replace;
use super::stop::Stop;
use crate::arguments::SmoothnessOptions;
use crate::console::{Console, DIM, Plain, complain};
use crate::status::Status;

/// How much of the torque a plot shows on either side of a jump, s.
const AROUND_S: f64 = 0.1;

/// Reports how far derivatives of torques jump at switches and delay jumps: as scenarios are, for several orders, or under the baseline.
pub(crate) fn smoothness(options: &SmoothnessOptions, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    if let Some(path) = &options.plot {
        replace::may_replace(path, is_own).map_err(|refused| complain(&refused))?;
    }
    let stop = Stop::listen();
    let mut observer = |_: Progress| stop.flow();
    // Whoever stops a run wants to hear nothing of it.
    let failed = |error: &dyn Display| stop.asked().unwrap_or_else(|| complain(&Plain::new(error.to_string())));
    let mut status = Status::Fine;
    let mut documents = Vec::new();
    if options.table {
        head(options, console);
    }
    for name in &options.scenarios {
        let scenario = kinds.open_scenario(name).map_err(|error| complain(&error))?;
        let setup = &scenario.setup;
        let words = !options.json;
        if words && !options.table {
            console.line(&scenario.title);
        }
        let (kept, document) = if !options.orders.is_empty() {
            let found = orders(setup, &options.orders, &mut observer).map_err(|error| failed(&error))?;
            if words {
                print_orders(options, &scenario, &found, console);
            }
            if let Some(path) = &options.plot {
                let drawn = draw_orders(&scenario, &found, &mut observer).map_err(|error| failed(&error))?;
                write(path, &drawn)?;
            }
            (found.iter().all(|of| of.kept), SmoothnessFound::orders(setup, &found))
        } else if !options.filters_s.is_empty() {
            let found = filters(setup, &options.filters_s, &mut observer).map_err(|error| failed(&error))?;
            if words {
                print_filters(options, &scenario, &found, console);
            }
            if let Some(path) = &options.plot {
                let drawn = plot_filters(&found, &unit_of(setup, found.jumps.first().map(|of| of.jump)));
                let drawn = drawn.map_err(|error| failed(&error))?;
                write(path, &drawn)?;
            }
            (true, SmoothnessFound::filters(setup, &found))
        } else {
            let found = input::smoothness(setup, &mut observer).map_err(|error| failed(&error))?;
            if words {
                print_jumps(options, &scenario, &found, console);
            }
            (found.kept(), SmoothnessFound::as_it_is(setup, &found))
        };
        documents.push(SmoothScenario::new(&scenario, document));
        if !kept {
            status = Status::Missed;
        }
    }
    if options.json {
        let document = SmoothnessDocument::new(env!("CARGO_PKG_VERSION"), documents);
        console.json(document.to_json().map_err(|error| failed(&error))?);
    }
    Ok(status)
}

/// What a plot ends with, by which it is known again.
const DRAWN: &str = "<!-- drawn by forwardstep smoothness -->\n";

fn is_own(mut file: BufReader<File>) -> bool {
    let mut text = String::new();
    file.read_to_string(&mut text).is_ok() && text.ends_with(DRAWN)
}

fn write(path: &Path, drawn: &str) -> Result<(), Status> {
    replace::write(path, &format!("{drawn}{DRAWN}")).map_err(|refused| complain(&refused))
}

fn head(options: &SmoothnessOptions, console: &mut Console) {
    let names: &[&str] = if !options.orders.is_empty() {
        &["Scenario", "Order", "Settled, s", "First derivative that jumps", "Largest jump", "Agent and axis", "At, s"]
    } else if !options.filters_s.is_empty() {
        &["Scenario", "ε, s", "Largest jump of τ", "Agent and axis", "At, s", "Slope of all"]
    } else {
        &["Scenario", "Order", "Derivative", "Largest jump", "Agent and axis", "At, s", "Where", "Promised"]
    };
    console.line(format_args!("| {} |", names.join(" | ")));
    console.line(format_args!("|{}", "---|".repeat(names.len())));
}

fn draw_orders(
    scenario: &Scenario,
    found: &[OfOrder],
    observer: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<String, Box<dyn std::error::Error>> {
    // The first order jumps most plainly where its torque jumps most.
    let Some((at, orders)) = found.first().and_then(|of| of.jump).map(|at| (at, orders_of(found))) else {
        return Ok(plot_orders(found, &[], 0.0, &unit_of(&scenario.setup, None))?);
    };
    let traces = traces(&scenario.setup, &orders, at, AROUND_S, observer)?;
    let drawn: Result<String, EncodeError> = plot_orders(found, &traces, at.t_s, &unit_of(&scenario.setup, Some(at)));
    Ok(drawn?)
}

fn orders_of(found: &[OfOrder]) -> Vec<usize> {
    found.iter().map(|of| of.order).collect()
}

fn print_orders(options: &SmoothnessOptions, scenario: &Scenario, found: &[OfOrder], console: &mut Console) {
    let setup = &scenario.setup;
    for of in found {
        let (order, first) = (of.order, derivative(Signal::Torque, of.order - 1));
        let settled = of.settled_s.map_or_else(|| "–".into(), digits);
        let found = of.jump.map(|jump| [sized(setup, jump, order - 1), who(setup, jump), digits(jump.t_s)]);
        if options.table {
            let [size, who, at] = found.unwrap_or_else(|| ["–"; 3].map(str::to_owned));
            console.line(format_args!("| {} | {order} | {settled} | {first} | {size} | {who} | {at} |", scenario.name));
        } else {
            let settled = of.settled_s.map_or_else(|| "not settled".into(), |_| format!("settled at {settled} s"));
            let jumps = found.map_or_else(
                || "nothing that is heard jumps".into(),
                |[size, who, at]| {
                    format!("the first derivative that jumps is {first}, by {size} at most: {who}, {at} s")
                },
            );
            console.line(format_args!("  order {order}: {settled}; {jumps}"));
        }
    }
}

fn print_filters(options: &SmoothnessOptions, scenario: &Scenario, found: &Filters, console: &mut Console) {
    let setup = &scenario.setup;
    let last = found.jumps.len().saturating_sub(1);
    for (k, of) in found.jumps.iter().enumerate() {
        let (size, who, at) = (sized(setup, of.jump, 0), who(setup, of.jump), digits(of.jump.t_s));
        if options.table {
            let slope = if k == last { slope(found.slope) } else { "–".into() };
            console.line(format_args!("| {} | {} | {size} | {who} | {at} | {slope} |", scenario.name, of.filter_s));
        } else {
            console.line(format_args!("  ε = {} s: τ jumps by {size} at most ({who}, {at} s)", of.filter_s));
        }
    }
    if !options.table {
        console.line(format_args!("  slope of the jump over ε in a log-log plot: {}", slope(found.slope)));
    }
}

/// Three places behind the point, with a minus sign.
fn slope(slope: f64) -> String {
    format!("{slope:.3}").replace('-', "−")
}

fn print_jumps(options: &SmoothnessOptions, scenario: &Scenario, found: &Smoothness, console: &mut Console) {
    let setup = &scenario.setup;
    if !options.table {
        console.line(format_args!(
            "{DIM}  {} switches, and {} other instants at which a delay may jump{DIM:#}",
            found.switches, found.delay_jumps
        ));
        if setup.agents.iter().any(|agent| !agent.pushes.is_empty()) {
            console
                .line(format_args!("{DIM}  told is what the network makes jump; what pushes do besides is not{DIM:#}"));
        }
    }
    let kinds = found.kinds();
    for kind in kinds.iter().copied() {
        // That of the reference dynamics, where all have the same.
        let mut orders: Vec<usize> =
            found.agents_of(kind).into_iter().map(|agent| setup.agents[agent].roots_per_s.len()).collect();
        orders.sort_unstable();
        orders.dedup();
        let order = match (orders.as_slice(), kind.continuous) {
            ([order], Some(_)) => order.to_string(),
            _ => "–".into(),
        };
        if kinds.len() > 1 && !options.table {
            let of = names::some_names(setup, &found.agents_of(kind));
            console.line(format_args!("  {} of {of}:", letter(kind.signal)));
        }
        for r in 0..kind.derivatives {
            let (name, promised) = (derivative(kind.signal, r), promised(kind, r));
            let [size, who, at, place] = match found.largest(kind, r) {
                Some(jump) if jump.size > 0.0 => {
                    let place = if jump.switched { "switch" } else { "delay" };
                    [sized(setup, jump, r), who(setup, jump), digits(jump.t_s), place.into()]
                }
                Some(_) => ["0".to_owned(), "–".into(), "–".into(), "–".into()],
                None => ["–".to_owned(), "–".into(), "–".into(), "–".into()],
            };
            if options.table {
                console.line(format_args!(
                    "| {} | {order} | {name} | {size} | {who} | {at} | {place} | {promised} |",
                    scenario.name
                ));
            } else if place == "–" {
                let none = if size == "0" { "does not jump" } else { "nothing that enters it jumps" };
                console.line(format_args!("  {name:<8} {none}; promised: {promised}"));
            } else {
                console.line(format_args!(
                    "  {name:<8} jumps by {size} at most: {who}, {at} s, {place}; promised: {promised}"
                ));
            }
        }
    }
    if !options.table {
        for (agent, reason) in setup.agents.iter().zip(&found.agents) {
            if let Err(reason) = reason {
                console.line(format_args!("  nothing is said of {}: {reason}", agent.name));
            }
        }
    }
}

/// What is promised of the derivative of order `r`.
fn promised(kind: Covered, r: usize) -> &'static str {
    match kind.continuous {
        Some(continuous) if r < continuous => "no jump",
        Some(_) => "bounded",
        None => "nothing",
    }
}

/// What an input is called in formulas.
fn letter(signal: Signal) -> String {
    match signal {
        Signal::Torque => "τ".into(),
        Signal::Thrust => "σ".into(),
        Signal::ThrustRate => "σ̇".into(),
        Signal::AngularVelocity => "ω".into(),
        other => other.name(),
    }
}

/// τ, dτ/dt, d²τ/dt², ….
fn derivative(signal: Signal, r: usize) -> String {
    let letter = letter(signal);
    match r {
        0 => letter,
        1 => format!("d{letter}/dt"),
        r => format!("d{0}{letter}/dt{0}", superscript(r)),
    }
}

fn sized(setup: &Setup, jump: LargestJump, r: usize) -> String {
    in_unit(jump.size, &unit_of(setup, Some(jump)), r)
}

/// A derivative of order `r` of what has this unit.
fn in_unit(value: f64, unit: &str, r: usize) -> String {
    let (unit, power) = unit.strip_suffix("/s").map_or((unit, r), |unit| (unit, r + 1));
    let per = match power {
        0 => String::new(),
        1 => "/s".into(),
        power => format!("/s{}", superscript(power)),
    };
    // What is a pure number is still one per second.
    let unit = if unit == "1" && per.is_empty() { "" } else { unit };
    format!("{} {unit}{per}", digits(value)).trim_end().to_owned()
}

/// That of an input.
fn unit_of(setup: &Setup, jump: Option<LargestJump>) -> String {
    jump.map_or_else(|| "N m".into(), |jump| names::unit(setup, jump.agent, jump.signal, jump.axis))
}

fn who(setup: &Setup, jump: LargestJump) -> String {
    let agent = names::agent_name(setup, jump.agent);
    match names::entry_words(setup, jump.agent, jump.signal, jump.axis).as_str() {
        "" => agent,
        entry => format!("{agent}, {entry}"),
    }
}

/// Three digits.
fn digits(value: f64) -> String {
    let places = |value: f64| (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e5).contains(&size) => format!("{value:.*}", places(value)),
        _ => with_power(&format!("{value:.2e}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the tenth on all derivatives were called the same.
    #[test]
    fn regress_derivatives_of_high_orders_have_their_numbers() {
        assert_eq!([0, 1, 2, 12].map(|r| derivative(Signal::Torque, r)), ["τ", "dτ/dt", "d²τ/dt²", "d¹²τ/dt¹²"]);
        assert_eq!(in_unit(1.0, "N m/s", 9), "1.00 N m/s¹⁰");
    }
}
