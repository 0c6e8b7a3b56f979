//! The book: its chapters are listed, and every command in it prints what it says.
#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::{is_long, some};
use forwardstep::io::scenario::{SHIPPED_SCENARIOS, open_scenario};

fn book() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/book/src")
}

/// The chapters, in their order.
fn chapters() -> Vec<String> {
    let summary = fs::read_to_string(book().join("SUMMARY.md")).unwrap();
    summary.split("](").skip(1).map(|link| link.split(')').next().unwrap().to_owned()).collect()
}

/// The blocks of a chapter: what stands behind the ticks, and the lines within.
fn blocks(text: &str) -> Vec<(&str, Vec<&str>)> {
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(kind) = line.strip_prefix("```") {
            blocks.push((kind, lines.by_ref().take_while(|line| *line != "```").collect()));
        }
    }
    blocks
}

/// Runs a command in `folder`; what it prints, whatever the stream, and its exit status.
fn printed(folder: &Path, command: &str) -> (String, i32) {
    let program = assert_cmd::cargo::cargo_bin("forwardstep");
    let path = format!("{}:{}", program.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let run = Command::new("sh")
        .args(["-c", &format!("{command} 2>&1")])
        .current_dir(folder)
        .envs([("PATH", path.as_str()), ("COLUMNS", "200"), ("NO_COLOR", "1")])
        .output()
        .unwrap();
    (String::from_utf8(run.stdout).unwrap(), run.status.code().unwrap_or(-1))
}

/// A console block: commands behind `$`, then what they print. `...` is anything, by itself or at an end of a line.
fn check(chapter: &str, folder: &Path, lines: &[&str]) {
    for listing in lines.join("\n").split("$ ").skip(1) {
        let (command, expected) = listing.split_once('\n').unwrap_or((listing, ""));
        let (text, status) = printed(folder, command);
        let wanted =
            expected.lines().find_map(|line| line.strip_prefix("(exit status ")?.strip_suffix(')')?.parse().ok());
        assert_eq!(status, wanted.unwrap_or(0), "{chapter}: {command}\n{text}");
        let mut rest = text.as_str();
        for line in expected.lines().filter(|line| *line != "..." && !line.starts_with("(exit status ")) {
            let part = line.trim_start_matches("...").trim_end_matches("...").trim_end();
            let Some(at) = rest.find(part) else {
                panic!("{chapter}: `{command}` does not print\n{part}\nafter what came before, but\n{text}");
            };
            rest = &rest[at + part.len()..];
        }
    }
}

#[test]
fn every_chapter_is_listed_and_every_picture_is_used() {
    let listed = chapters();
    let mut found: Vec<String> = fs::read_dir(book())
        .unwrap()
        .filter_map(|entry| entry.unwrap().file_name().into_string().ok())
        .filter(|name| name.ends_with(".md") && name != "SUMMARY.md")
        .collect();
    found.sort();
    let mut sorted = listed.clone();
    sorted.sort();
    assert_eq!(found, sorted);
    let all: String = listed.iter().map(|chapter| fs::read_to_string(book().join(chapter)).unwrap()).collect();
    for picture in fs::read_dir(book().join("pictures")).unwrap() {
        let name = picture.unwrap().file_name().into_string().unwrap();
        assert!(all.contains(&format!("](pictures/{name})")), "{name}");
    }
}

#[test]
fn the_gallery_misses_no_scenario() {
    let gallery = fs::read_to_string(book().join("gallery.md")).unwrap();
    let listed: Vec<&str> = gallery.lines().filter_map(|line| line.strip_prefix("## `")?.split('`').next()).collect();
    let shipped: Vec<&str> = SHIPPED_SCENARIOS.iter().map(|scenario| scenario.name).collect();
    assert_eq!(listed, shipped);
    for scenario in SHIPPED_SCENARIOS {
        let picture = format!("pictures/{}.svg", scenario.name);
        assert!(gallery.contains(&format!("]({picture})")), "{picture}");
        let drawn = fs::read_to_string(book().join(&picture)).unwrap_or_else(|error| panic!("{picture}: {error}"));
        assert!(drawn.starts_with("<svg ") && drawn.contains("<polyline "), "{picture}");
        let space = format!("pictures/{}-in-space.svg", scenario.name);
        assert!(gallery.contains(&format!("]({space})")), "{space}");
        let drawn = fs::read_to_string(book().join(&space)).unwrap_or_else(|error| panic!("{space}: {error}"));
        // Everybody's path, and everybody's name.
        assert!(drawn.starts_with("<svg ") && drawn.contains("<path ") && !drawn.contains("NaN"), "{space}");
        let agents = open_scenario(scenario.name).unwrap().setup.agents;
        let named = |name: &str| drawn.contains(&format!(">{name}<")) || drawn.contains(&format!(">{name}, leads<"));
        let missing: Vec<_> = agents.iter().map(|agent| &agent.name).filter(|name| !named(name)).collect();
        assert!(missing.len() <= agents.len() / 3, "{space}: {missing:?}");
    }
}

#[test]
fn every_listing_does_what_the_book_says() {
    let mut commands = 0;
    for chapter in some(chapters(), 6) {
        let text = fs::read_to_string(book().join(&chapter)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        for (kind, lines) in blocks(&text) {
            match kind.split_once(' ') {
                Some((_, file)) => fs::write(folder.path().join(file), lines.join("\n") + "\n").unwrap(),
                _ if kind == "console" => {
                    commands += lines.iter().filter(|line| line.starts_with("$ ")).count();
                    check(&chapter, folder.path(), &lines);
                }
                // What is included is run by the tests of its own file.
                _ => assert!(lines.iter().all(|line| line.starts_with("{{#include ")), "{chapter}: {kind}"),
            }
        }
    }
    assert!(commands > if is_long() { 20 } else { 2 }, "{commands}");
}
