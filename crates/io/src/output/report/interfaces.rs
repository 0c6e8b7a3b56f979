//! What every agent measures and transmits.

use forwardstep_sim::delay::Delay;
use forwardstep_sim::setup::{AgentSetup, Setup};
use maud::{Markup, html};

use super::super::text::number;

/// Bytes of one number in a message.
const BYTES: usize = 8;

/// Agents that measure and transmit the same.
struct Group<'a> {
    agents: Vec<&'a str>,
    measures: &'static [&'static str],
    axes: usize,
}

/// A table of what is measured and what is transmitted, with the traffic of one edge.
pub(crate) fn interfaces(setup: &Setup) -> Markup {
    let transmits = setup.transmits();
    html! {
        section #interfaces {
            h2 { "Measured and transmitted" }
            div.card.scroll {
                table.facts {
                    thead { tr { th scope="col" { "Agents" } th scope="col" { "Measured" } th scope="col" { "Transmitted" } th scope="col" { "On one edge" } } }
                    tbody {
                        @for group in groups(setup) {
                            tr {
                                th scope="row" { (names(&group.agents)) }
                                td data-what="Measured" { (setup.measures_for(group.measures).join(", ")) }
                                td data-what="Transmitted" { @if transmits.is_empty() { "nothing" } @else { (transmits.join(", ")) } }
                                td data-what="On one edge" { (traffic(setup, transmits.len() * group.axes)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn groups(setup: &Setup) -> Vec<Group<'_>> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for agent @ AgentSetup { name, robot, .. } in &setup.agents {
        let (measures, axes) = (agent.measures(), robot.axes.len());
        match groups.iter_mut().find(|group| group.measures == measures && group.axes == axes) {
            Some(group) => group.agents.push(name),
            None => groups.push(Group { agents: vec![name], measures, axes }),
        }
    }
    groups
}

/// The first and the last of a longer list.
fn names(agents: &[&str]) -> String {
    match agents {
        [first, _, _, .., last] => format!("{first} … {last}"),
        few => few.join(", "),
    }
}

/// Messages of so many numbers, sent in packets or at every sample.
fn traffic(setup: &Setup, numbers: usize) -> String {
    let bytes = BYTES * numbers;
    if numbers == 0 {
        return "–".to_owned();
    }
    let delays = || setup.network.used_delays().map(|index| &setup.network.delays[index]);
    let radios = delays().filter(|delay| delay.packets().is_some()).count();
    let every_s = |delay: &Delay| delay.packets().and_then(|trace| trace.link()).map(|link| link.every_s);
    let mut each = delays().map(every_s);
    match (each.next().flatten(), &setup.control) {
        (Some(every_s), _) if each.all(|other| other == Some(every_s)) => {
            format!("{} bytes/s: {bytes} bytes every {} s", number(bytes as f64 / every_s), number(every_s))
        }
        _ if radios > 0 => format!("{bytes} bytes per message; how often one is sent differs from link to link"),
        (_, None) => format!("{bytes} bytes per message; in continuous time there is no rate"),
        (_, Some(control)) => {
            format!("{} bytes/s: {bytes} bytes at every sample", number(bytes as f64 * control.sample_hz))
        }
    }
}
