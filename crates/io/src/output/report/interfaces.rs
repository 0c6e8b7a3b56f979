//! What every agent measures and transmits.

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
                    thead { tr { th { "Agents" } th { "Measured" } th { "Transmitted" } th { "On one edge" } } }
                    tbody {
                        @for group in groups(setup) {
                            tr {
                                th { (names(&group.agents)) }
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

/// Messages of so many numbers, sent at every sample.
fn traffic(setup: &Setup, numbers: usize) -> String {
    let bytes = BYTES * numbers;
    match (&setup.control, numbers) {
        (_, 0) => "–".to_owned(),
        (None, _) => format!("{bytes} bytes per message; in continuous time there is no rate"),
        (Some(control), _) => {
            format!("{} bytes/s: {bytes} bytes at every sample", number(bytes as f64 * control.sample_hz))
        }
    }
}
