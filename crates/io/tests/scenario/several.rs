//! Several mistakes in one file: which are told, and which are only consequences of others.

use std::fmt::Write;

use miette::Diagnostic;

use super::{SOUND, malformed, read};

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
    // Of a file that wishes for what is not modelled, the wish.
    let error = read("format = 2\ntitle = \"test\"\n[obstacles]\nradius_m = 1\n").unwrap_err();
    assert!(error.to_string().contains("unknown key `obstacles`"), "{error}");
    assert_eq!(error.related().into_iter().flatten().count(), 0);
}

#[test]
fn slips_in_keys_do_not_hide_mistakes_of_values() {
    let slips = [("record_every_s", "recrod_every_s"), ("[goal]", "[gaol]")];
    let values = [("end_s = 10", "end_s = -10"), ("disagreement_below = 1e-3", "disagreement_below = -1e-3")];
    let found = all(&[&slips[..], &values].concat());
    let expected = [
        "test.toml:6:1: unknown key `recrod_every_s`",
        "test.toml:37:2: unknown key `gaol`",
        "test.toml:5:9: `end_s` is -10, but must be positive",
        "test.toml:38:22: `disagreement_below` is -0.001, but must be positive",
    ];
    assert_eq!(found, expected);
    // A key that is there already is not what was meant, and a table that nothing reads hides only what it may be about.
    let twice = [("end_s = 10", "end_s = -10\nends_s = 3"), ("weight = 1.0", "obstacles = [1.0]")];
    let found = all(&twice);
    assert!(found.len() == 3 && found[2].contains("`end_s` is -10"), "{found:?}");
    // What a key that is not known stood for may be what is missed then.
    assert_eq!(all(&[("[network]", "[wires]"), ("end_s = 10", "end_s = 20")]).len(), 1);
}

#[test]
fn not_more_are_told_than_can_be_read() {
    let mut keys = String::from("title = \"test\"\n");
    (0..100).for_each(|k| writeln!(keys, "key_{k} = {k}").unwrap());
    assert_eq!(all(&[("title = \"test\"\n", &keys)]).len(), 21);
}

#[test]
fn all_impossible_values_are_told_at_once() {
    let found = all(&[
        ("record_every_s = 0.1", "record_every_s = -0.1"),
        ("mass_kg = [2.0, 1.5]", "mass_kg = [2.0, -1.5]"),
        ("start.position_rad = [[0.1, 0.2], [0.3, 0.4]]", "start.position_rad = [0.1, 0.2, 0.3]"),
        ("roots_per_s = [1.0, 2.0]", "roots_per_s = [0.0, -2.0]"),
        ("damping.gain = 8", "damping.gain = [8, 8, 8]"),
        ("weight = 1.0", "weight = 0"),
        ("[\"arm-2\", \"cart\"], [\"cart\", \"arm-1\"]", "[\"arm-2\", \"card\"], [\"cart\", \"arm-3\"]"),
        ("disagreement_below = 1e-3", "disagreement_below = -1"),
    ]);
    let expected = [
        "test.toml:6:18: `record_every_s` is -0.1, but must be positive",
        "test.toml:11:38: `mass_kg` is -1.5, but must be positive",
        "test.toml:12:22: `position_rad` has 3 entries, but `arm-1` needs 2",
        "test.toml:19:16: `roots_per_s` is 0, but must be positive",
        "test.toml:19:21: `roots_per_s` is -2, but must be positive",
        "test.toml:23:16: `damping.gain` has 3 entries, but `arm-1` needs 2",
        "test.toml:28:10: `weight` is 0, but must be positive",
        "test.toml:35:20: there is no agent `card`",
        "test.toml:35:38: there is no agent `arm-3`",
        "test.toml:38:22: `disagreement_below` is -1, but must be positive",
    ];
    assert_eq!(found, expected);
}

#[test]
fn what_follows_from_an_impossible_value_is_not_told() {
    let push = "[[external_wrenches]]\non = [\"arm-1\"]\nfrom_s = 8\nfor_s = 1\nby.torque_n_m = [1, 0]\n[goal]";
    let alone = all(&[("[goal]", push), ("end_s = 10", "end_s = -10")]);
    assert_eq!(alone, ["test.toml:5:9: `end_s` is -10, but must be positive"]);
    // Edges that name its agents follow from a name, and so does an agent that is not there for a number of agents.
    assert_eq!(all(&[("name = \"cart\"", "name = \"ca rt\"")]).len(), 1);
    assert_eq!(all(&[("count = 2", "count = 0")]).len(), 1);
    let found = all(&[("name = \"cart\"", "name = \"arm-2\""), ("weight = 1.0", "weight = -1")]);
    assert_eq!(found.len(), 2, "{found:?}");
}

#[test]
fn of_any_two_mistakes_both_are_told_and_nothing_else() {
    let said = |text: &str| -> Option<Vec<String>> {
        let error = read(text).err()?;
        // Lines and columns are those of the other mistake's text too.
        let message = |line: String| {
            let message = line.splitn(4, ':').last().unwrap_or_default().trim().to_owned();
            message.split("; the first is on line").next().unwrap_or_default().to_owned()
        };
        let others = error.related().into_iter().flatten().map(|other| message(other.to_string()));
        Some(std::iter::once(message(error.to_string())).chain(others).collect())
    };
    let cases = malformed::CASES.iter().step_by(3);
    let cases: Vec<_> = cases.map(|case| (case, said(&SOUND.replace(case.0, case.1)).unwrap())).collect();
    // Those of values, beside those of the form, after which values cannot be told.
    let is_of_a_value = |said: &[String]| [" must ", "entries, but", "no agent"].iter().any(|of| said[0].contains(of));
    let (mut pairs, mut both, mut wrong, mut one_only) = (0, 0, Vec::new(), Vec::new());
    for (k, (one, first)) in cases.iter().enumerate() {
        for (other, second) in &cases[k + 1..] {
            let text = SOUND.replace(one.0, one.1);
            if text.matches(other.0).count() != 1 || first == second {
                continue;
            }
            let found = said(&text.replace(other.0, other.1)).unwrap_or_default();
            if is_of_a_value(first) && is_of_a_value(second) {
                pairs += 1;
                match found.contains(&first[0]) && found.contains(&second[0]) {
                    true => both += 1,
                    false => one_only.push(format!("{:?} and {:?}: {found:?}", one.1, other.1)),
                }
            }
            if found.iter().skip(1).any(|line| *line != first[0] && *line != second[0]) {
                wrong.push(format!("{:?} and {:?}: {found:?}", one.1, other.1));
            }
        }
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
    assert!(pairs > 100 && 10 * both > 9 * pairs, "{both} of {pairs}; not\n{}", one_only.join("\n"));
}

/// All that is said of [`SOUND`] with edges from this table, without its folder.
fn of_table(table: &str) -> Vec<String> {
    crate::seeds::keep("csv", table);
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("edges.csv"), table).unwrap();
    let text = SOUND.replace("edges = [[\"arm-1\", \"arm-2\"]]", "edges.csv.file = \"edges.csv\"");
    let source = forwardstep_io::SourceText::new("test.toml", text);
    let error = forwardstep_io::scenario::read_scenario("test", &source, Some(folder.path())).unwrap_err();
    let others = error.related().into_iter().flatten().map(ToString::to_string);
    let all = std::iter::once(error.to_string()).chain(others);
    all.map(|said| said.rsplit_once('/').map_or(said.clone(), |(_, rest)| rest.to_owned())).collect()
}

#[test]
fn all_mistakes_of_a_table_are_told_at_once() {
    let form = "from,form,weight,weight,delay_s\narm-1,arm-2,1,1\narm-1,x,1,1,\"0\n,arm-2,1,1,inf\n";
    assert_eq!(
        of_table(form),
        [
            "edges.csv:1:18: a second column is named `weight`",
            "edges.csv:1:6: unknown column `form`",
            "edges.csv:2:1: this line has 4 entries, but there are 5 columns",
            "edges.csv:3:13: this quotation mark is not closed on its line",
            "edges.csv:4:1: `from` is empty",
            "edges.csv:4:12: inf is not a finite number",
        ]
    );
    assert_eq!(
        of_table("weight,delay_s\n"),
        ["edges.csv:1:1: the column `from` is missing", "edges.csv:1:1: the column `to` is missing"]
    );
    // What names mean is asked where the form is sound.
    let names = "from,to,delay_s\narm-1,amr-2,0\ncart,cart,0\narm-2,arm-1,0\nx\u{1b}[2J,cart,0\n";
    assert_eq!(
        of_table(names),
        [
            "edges.csv:2:7: there is no agent `amr-2`",
            "edges.csv:3:1: `cart` cannot hear itself",
            "edges.csv:5:1: there is no agent `x\\u{1b}[2J`",
        ]
    );
    // Many are counted.
    let said = of_table(&format!("from,to\n{}", "arm-1\n".repeat(1000)));
    assert_eq!(said.len(), 25);
    assert_eq!(said[24], "edges.csv: 976 more mistakes are reported once these are mended");
    assert_eq!(said[23], "edges.csv:25:1: this line has 1 entry, but there are 2 columns");
    let said = of_table(&format!("from,to\n{}", "arm-1,nobody\n".repeat(25)));
    assert_eq!(said[24], "edges.csv: 1 more mistake is reported once these are mended");
}

#[test]
fn nothing_is_quoted_of_a_table_that_is_something_else() {
    for (text, what) in [
        ("<?xml version=\"1.0\"?>\n<robot name=\"secret\"/>", "a robot (URDF)"),
        ("{\"secret\": 1,\n\"b\": 2}", "JSON"),
        ("secret:\n  b: 2\n", "YAML"),
        ("format = 2\ntitle = \"secret\"\n", "a scenario"),
    ] {
        assert_eq!(of_table(text), [format!("test.toml:32:18: this is {what}, and no table")]);
    }
    // Of a table with other columns the first is told.
    assert_eq!(of_table("a,b,c\n1,2\n"), ["edges.csv:1:1: unknown column `a`"]);
    let said = of_table(&"word ".repeat(100_000));
    assert!(said.len() == 1 && said[0].len() < 500, "{said:?}");
}

#[test]
fn all_mistakes_of_times_and_numbers_are_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("rows.csv"), "t_s\n0\none\n2\n1\n3\n1e99\n3\n").unwrap();
    let text = SOUND.replace("record_every_s = 0.1", "record_at.csv.file = \"rows.csv\"");
    let source = forwardstep_io::SourceText::new("test.toml", text);
    let error = forwardstep_io::scenario::read_scenario("test", &source, Some(folder.path())).unwrap_err();
    let others = error.related().into_iter().flatten().map(ToString::to_string);
    let all: Vec<String> = std::iter::once(error.to_string()).chain(others).collect();
    let places = ["rows.csv:3:1:", "rows.csv:5:1:", "rows.csv:7:1:", "rows.csv:8:1:"];
    assert_eq!(all.len(), places.len(), "{all:?}");
    assert!(all.iter().zip(places).all(|(said, place)| said.contains(place)), "{all:?}");
}
