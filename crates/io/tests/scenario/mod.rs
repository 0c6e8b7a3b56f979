//! Scenario files: what is read, and what every mistake gets.

mod blind;
mod chains;
mod control;
mod drives;
mod edges;
mod formulas;
mod leader;
mod links;
mod malformed;
mod meaning;
mod memory;
mod mixed;
mod mutated;
mod pushes;
mod quantities;
mod ranges;
mod several;
mod shipped;
mod spacecraft;
mod spread;
mod targets;
mod tips;
mod tracking;
mod unused;
mod vehicles;

use forwardstep_io::SourceText;
use forwardstep_io::scenario::{Scenario, ScenarioError, read_scenario};
use miette::Diagnostic;

/// A small scenario without mistakes, which the tests change.
const SOUND: &str = r#"format = 2
title = "test"

[time]
end_s = 10
record_every_s = 0.1

[[agents]]
name = "arm"
count = 2
robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }
start.position_rad = [[0.1, 0.2], [0.3, 0.4]]

[[agents]]
name = "cart"
robot.point_mass = { dimension = 2, mass_kg = 4.0 }

[reference.consensus]
roots_per_s = [1.0, 2.0]
exchange = "position_velocity"

[law.adaptive]
damping.gain = 8
adaptation_gain = 10
estimate_start = "zero"

[network]
weight = 1.0
delay.saw_tooth = { min_s = 0.1, max_s = 0.4, period_s = 0.6 }
[[network.phases]]
dwell_s = 1.0
edges = [["arm-1", "arm-2"]]
[[network.phases]]
dwell_s = 2.0
edges = [["arm-2", "cart"], ["cart", "arm-1"]]

[goal]
disagreement_below = 1e-3
"#;

/// [`SOUND`] with one passage replaced.
fn changed(from: &str, to: &str) -> String {
    assert_eq!(SOUND.matches(from).count(), 1, "{from:?} must occur once");
    SOUND.replace(from, to)
}

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    crate::seeds::keep("scenario", text);
    read_scenario("test", &SourceText::new("test.toml", text), None)
}

/// What to replace in a sound scenario, by what, the first line of the error, and a part of the help.
type Case = (&'static str, &'static str, &'static str, &'static str);

/// Every case is refused, with the message and the help that it states.
fn refused(sound: &str, cases: &[Case]) {
    let read = |(from, to, line, help): &Case| {
        assert_eq!(sound.matches(from).count(), 1, "{from:?} must occur once");
        ((*to).to_owned(), read(&sound.replace(from, to)), *line, *help)
    };
    as_stated(cases.iter().map(read));
}

/// The same of what was read in other ways: what it was, the first line of the error, without the folder of a table, and a
/// part of the help, which is empty where there is none. Nothing else is said: each has one mistake.
fn as_stated<'a>(cases: impl Iterator<Item = (String, Result<Scenario, ScenarioError>, &'a str, &'a str)>) {
    let (mut wrong, mut all) = (Vec::new(), 0);
    for (what, result, line, help) in cases {
        all += 1;
        let Err(error) = result else {
            wrong.push(format!("{what}\n    was accepted"));
            continue;
        };
        let mut found = error.to_string();
        if found.starts_with('/') {
            let file = found.find(':').and_then(|end| found[..end].rfind('/'));
            found = found[file.map_or(0, |file| file + 1)..].to_owned();
        }
        let found_help = error.help().map(|help| help.to_string()).unwrap_or_default();
        if found != line || !found_help.contains(help) || found_help.is_empty() != help.is_empty() {
            wrong.push(format!("{what}\n    {found:?}\n    {found_help:?}"));
        }
        // Of a log that lacks packets every link is told.
        for other in error.related().into_iter().flatten().filter(|_| !what.contains("log.file")) {
            wrong.push(format!("{what}\n    {found:?}\n    and {:?}", other.to_string()));
        }
    }
    assert!(wrong.is_empty(), "{} of {all}:\n{}", wrong.len(), wrong.join("\n"));
}
