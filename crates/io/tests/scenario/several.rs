//! Several mistakes in one file: which are told, and which are only consequences of others.

use std::fmt::Write;

use miette::Diagnostic;

use super::{SOUND, read};

/// The first lines of all that is said of [`SOUND`] with these passages replaced.
fn all(changes: &[(&str, &str)]) -> Vec<String> {
    let mut text = SOUND.to_owned();
    for (from, to) in changes {
        assert_eq!(SOUND.matches(from).count(), 1, "{from:?} must occur once");
        text = text.replace(from, to);
    }
    let error = read(&text).unwrap_err();
    let others = error.related().into_iter().flatten();
    std::iter::once(error.to_string()).chain(others.map(ToString::to_string)).collect()
}

#[test]
fn all_mistakes_of_the_form_are_told_at_once() {
    let found = all(&[
        ("record_every_s", "recrod_every_s"),
        ("count = 2", "count = \"two\"\nobstacles = []"),
        ("dimension = 2, mass_kg = 4.0", "dimension = 2, mas_kg = 4.0"),
        ("exchange = \"position_velocity\"", "exchange = \"postion\""),
        ("weight = 1.0", "weight = true"),
        ("disagreement_below = 1e-3", "disagreement_below = nan"),
    ]);
    let expected = [
        "test.toml:6:1: unknown key `recrod_every_s`",
        "test.toml:10:9: found \"two\" where a whole number should stand",
        "test.toml:11:1: unknown key `obstacles`",
        "test.toml:17:37: unknown key `mas_kg`",
        "test.toml:21:12: unknown choice `postion`",
        "test.toml:29:10: found true where a number or a formula in t in quotes should stand",
        "test.toml:39:22: nan is not a finite number",
    ];
    assert_eq!(found, expected);
}

#[test]
fn what_is_missed_because_of_another_mistake_is_not_told() {
    assert_eq!(all(&[("end_s = 10", "ends_s = 10")]), ["test.toml:5:1: unknown key `ends_s`"]);
    assert_eq!(all(&[("[goal]", "[gaol]")]).len(), 1);
    assert_eq!(all(&[("name = \"cart\"\n", "")]).len(), 1);
    let found = all(&[("name = \"cart\"\n", ""), ("weight = 1.0", "wait = 1.0")]);
    assert!(found.len() == 2 && found[0].contains("`name` is missing") && found[1].contains("`wait`"), "{found:?}");
}

#[test]
fn not_more_are_told_than_can_be_read() {
    let mut keys = String::from("title = \"test\"\n");
    (0..100).for_each(|k| writeln!(keys, "key_{k} = {k}").unwrap());
    assert_eq!(all(&[("title = \"test\"\n", &keys)]).len(), 21);
}
