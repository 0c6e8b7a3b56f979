//! What a shell offers where a name or a file is to be typed.

use std::ffi::OsStr;
use std::path::Path;

use clap_complete::engine::{CompletionCandidate, PathCompleter, ValueCompleter};
use forwardstep::io::breaks_lines;
use forwardstep::io::scenario::SHIPPED_SCENARIOS;
use forwardstep::io::urdf::SHIPPED_ROBOTS;

/// Shipped scenarios, files that end in `.toml`, and folders, in which more may be.
pub(crate) fn scenarios(begun: &OsStr) -> Vec<CompletionCandidate> {
    let mut offered = shipped(begun);
    offered.extend(scenario_files(begun));
    offered
}

/// Shipped scenarios.
pub(crate) fn shipped(begun: &OsStr) -> Vec<CompletionCandidate> {
    names(SHIPPED_SCENARIOS.iter().map(|scenario| scenario.name), begun)
}

/// Files that end in `.toml`, and folders.
pub(crate) fn scenario_files(begun: &OsStr) -> Vec<CompletionCandidate> {
    files("toml", begun)
}

/// Shipped robots, files that end in `.urdf`, and folders.
pub(crate) fn robots(begun: &OsStr) -> Vec<CompletionCandidate> {
    let mut offered = names(SHIPPED_ROBOTS.iter().map(|(name, _)| *name), begun);
    offered.extend(files("urdf", begun));
    offered
}

/// The same behind the kinds of which `new` makes a robot.
pub(crate) fn kinds_and_robots(begun: &OsStr) -> Vec<CompletionCandidate> {
    const KINDS: [&str; 9] = [
        "planar_arm",
        "point_mass",
        "ship",
        "vehicle",
        "rotorcraft",
        "spacecraft",
        "chain",
        "strict_feedback",
        "pure_feedback",
    ];
    let mut offered = names(KINDS.into_iter(), begun);
    offered.extend(robots(begun));
    offered
}

fn names(all: impl Iterator<Item = &'static str>, begun: &OsStr) -> Vec<CompletionCandidate> {
    let Some(begun) = begun.to_str() else { return Vec::new() };
    all.filter(|name| name.starts_with(begun)).map(CompletionCandidate::new).collect()
}

/// Files of a folder that end so. A name that would steer the terminal is not offered.
fn files(extension: &'static str, begun: &OsStr) -> Vec<CompletionCandidate> {
    let wanted = move |path: &Path| path.is_dir() || path.extension().is_some_and(|found| found == extension);
    let offered = PathCompleter::any().filter(wanted).complete(begun);
    let plain = |candidate: &CompletionCandidate| {
        candidate.get_value().to_str().is_some_and(|name| !name.contains(breaks_lines))
    };
    offered.into_iter().filter(plain).collect()
}
