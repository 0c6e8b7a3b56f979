//! Any text gives a scenario or an error, never a panic; every error can be shown, and every scenario can be simulated.

use std::ops::ControlFlow;

use forwardstep_io::scenario::{SHIPPED_SCENARIOS, ScenarioError};
use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};
use proptest::prelude::*;

use super::blind::BLIND;
use super::chains::{CASCADES, DERIVATIVES};
use super::drives::{CLOSED, DRIVES};
use super::edges::RULES;
use super::links::LINKS;
use super::mixed::MIXED;
use super::pushes::PUSHES;
use super::spacecraft::SPACECRAFT;
use super::tips::{PLANAR, TIP};
use super::vehicles::VEHICLES;
use super::{SOUND, read};
use crate::support::some;

/// Every sound scenario that tests change.
pub(super) const SYSTEMS: [&str; 14] = [
    SOUND,
    DRIVES,
    CLOSED,
    RULES,
    LINKS,
    PUSHES,
    BLIND,
    CASCADES,
    DERIVATIVES,
    MIXED,
    SPACECRAFT,
    PLANAR,
    TIP,
    VEHICLES,
];

pub(super) fn texts() -> Vec<&'static str> {
    SHIPPED_SCENARIOS.iter().map(|scenario| scenario.text).chain(SYSTEMS).collect()
}

/// Reads; then shows the error, or begins to simulate: what the reader lets pass, the rooms below accept.
fn survives(text: &str) {
    match read(text) {
        Ok(scenario) => {
            forwardstep_check::check(&scenario.setup);
            let _ = forwardstep_check::predict(&scenario.setup);
            let _ = forwardstep_check::ideal(&scenario.setup);
            let outcome = forwardstep_sim::simulate(&scenario.setup, &mut |_| ControlFlow::Break(()));
            // What no run could record is refused by runs alone.
            let recorded = forwardstep_sim::check_recording(&scenario.setup).is_ok();
            assert_eq!(outcome.is_ok(), recorded, "{:?} of\n{text}", outcome.err());
        }
        Err(error) => shown(&error),
    }
}

fn shown(error: &ScenarioError) {
    assert!(!error.to_string().contains('\n'), "one line: {error}");
    let mut shown = String::new();
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::none());
    handler.render_report(&mut shown, error as &dyn Diagnostic).unwrap();
}

#[test]
fn prop_every_prefix_gives_a_result() {
    for (end, _) in SOUND.char_indices() {
        survives(&SOUND[..end]);
    }
}

#[test]
fn prop_every_line_may_be_missing_or_doubled() {
    for text in texts() {
        let lines: Vec<&str> = text.lines().collect();
        for k in some(0..lines.len(), 16) {
            survives(&[&lines[..k], &lines[k + 1..]].concat().join("\n"));
            survives(&[&lines[..=k], &lines[k..]].concat().join("\n"));
        }
    }
}

/// A run of 10¹⁹ s has a meaning, and more rows than any file: reading and verdicts take it, and the run alone refuses it.
#[test]
fn regress_what_no_run_could_record_is_refused_by_runs_alone() {
    // Nothing in it jumps again and again.
    let teleoperation = SHIPPED_SCENARIOS.iter().find(|scenario| scenario.name == "teleoperation").unwrap().text;
    let with_end = |line| if str::starts_with(line, "end_s") { "end_s = 9223372036854775807" } else { line };
    let long = teleoperation.lines().map(with_end).collect::<Vec<_>>().join("\n");
    let scenario = read(&long).unwrap();
    assert!(forwardstep_sim::check_recording(&scenario.setup).is_err());
    survives(&long);
}

proptest! {
    #[test]
    fn prop_mutated_text_never_panics(
        which in any::<prop::sample::Index>(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..6usize, "[ -~é\\n]{0,6}"), 1..6),
        tokens in prop::collection::vec(prop::sample::select(vec![
            "nan", "-inf", "1e999", "-1", "0", "1e-30", "[]", "{}", "[[]]", "[[1],2]", "\"\"", "true", "[1, 2, 3]", "1e30",
            "9223372036854775807", "{ random = { seed = 0, within = [-1e30, 1e30] } }",
        ]), 6),
    ) {
        let mut text = (*which.get(&texts())).to_owned();
        for ((place, length, junk), token) in edits.into_iter().zip(tokens) {
            let starts: Vec<usize> = text.char_indices().map(|(start, _)| start).collect();
            let start = starts[place.index(starts.len())];
            let end = starts[(place.index(starts.len()) + length).min(starts.len() - 1)].max(start);
            // Half of the time a whole value is exchanged, which goes deeper than broken syntax.
            match text[start..].find("= ") {
                Some(equals) if length % 2 == 0 => {
                    let value = start + equals + 2;
                    let stop = text[value..].find(['\n', ',', '}']).map_or(text.len(), |offset| value + offset);
                    text.replace_range(value..stop, token);
                }
                _ => text.replace_range(start..end, &junk),
            }
        }
        survives(&text);
    }
}
