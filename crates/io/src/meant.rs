//! What a text was probably written as, where it is not what it was given for.

use std::fmt;

use serde::de::IgnoredAny;

use crate::wording::for_shell;

/// A kind of text that people have beside scenarios, robots and tables, or mistake for one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Meant {
    /// A scenario of this program.
    Scenario,
    /// A robot.
    Urdf,
    /// A robot or a world for simulators with contact: SDF or MJCF.
    World,
    /// Other XML.
    Xml,
    /// JSON.
    Json,
    /// YAML.
    Yaml,
    /// A table.
    Csv,
}

impl fmt::Display for Meant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Meant::Scenario => "a scenario",
            Meant::Urdf => "a robot (URDF)",
            Meant::World => "a model for another simulator (SDF or MJCF)",
            Meant::Xml => "XML",
            Meant::Json => "JSON",
            Meant::Yaml => "YAML",
            Meant::Csv => "a table (CSV)",
        })
    }
}

impl Meant {
    /// What this text looks like, if it looks like anything.
    pub(crate) fn of(text: &str) -> Option<Meant> {
        let text = text.trim_start_matches('\u{feff}');
        if text.trim_start().starts_with('<') {
            return Some(match () {
                () if has_element(text, "robot") => Meant::Urdf,
                () if has_element(text, "sdf") || has_element(text, "mujoco") => Meant::World,
                () => Meant::Xml,
            });
        }
        let mut lines = text.lines().map(str::trim_end).filter(|line| !line.is_empty() && !line.starts_with('#'));
        let first = lines.clone().next()?;
        // Before JSON, since a list of one table's name is a list.
        if text.lines().map(str::trim).any(|line| line == "[[agents]]" || is_format(line)) {
            return Some(Meant::Scenario);
        }
        if first.trim_start().starts_with(['{', '[']) && serde_json::from_str::<IgnoredAny>(text).is_ok() {
            return Some(Meant::Json);
        }
        if first == "---" || first.starts_with("%YAML") || lines.clone().take(3).any(is_yaml) {
            return Some(Meant::Yaml);
        }
        let cells = |line: &str| line.split(',').count();
        let second = lines.nth(1)?;
        let is_table = cells(first) > 1 && cells(first) == cells(second) && !first.contains(['=', '[', '{', ':']);
        is_table.then_some(Meant::Csv)
    }

    /// What to do with it where a scenario is asked for; `file` is its name as a shell takes it.
    pub(crate) fn given_as_scenario(self, file: &str) -> String {
        let file = for_shell(file);
        match self {
            Meant::Urdf => format!(
                "`forwardstep new my-scenario.toml --robot {file}` writes a scenario for it, and `forwardstep robot {file}` describes it"
            ),
            Meant::World | Meant::Xml => "robots are read from URDF: export it as that, then `forwardstep new my-scenario.toml --robot FILE.urdf`".into(),
            Meant::Json | Meant::Yaml => {
                "scenarios are TOML: `forwardstep new my-scenario.toml` writes one to start from, and `forwardstep schema` says what may stand in it"
                    .into()
            }
            Meant::Csv => "a scenario names its tables, such as `edges.csv.file = \"FILE\"`; `forwardstep new my-scenario.toml` writes one to start from".into(),
            Meant::Scenario => "correct it there".into(),
        }
    }

    /// What to do with it where a robot is asked for.
    pub(crate) fn given_as_robot(self, file: &str) -> String {
        let file = for_shell(file);
        match self {
            Meant::Scenario => format!(
                "`forwardstep check {file}` and `forwardstep run {file}` take it; a robot is a URDF, or a kind in the scenario"
            ),
            Meant::World | Meant::Xml => "export the robot as URDF".into(),
            _ => "a robot is a URDF: XML that begins with <robot name=\"…\">; kinds such as `planar_arm` need no file"
                .into(),
        }
    }
}

/// Whether an element of this name begins somewhere, without reading the XML.
fn has_element(text: &str, name: &str) -> bool {
    text.match_indices('<').any(|(at, _)| {
        let rest = text[at + 1..].strip_prefix(name);
        rest.is_some_and(|rest| rest.starts_with([' ', '>', '\t', '\n', '\r', '/']))
    })
}

/// `format = 2`, with which a scenario begins.
fn is_format(line: &str) -> bool {
    let value = line.strip_prefix("format").map(str::trim_start).and_then(|rest| rest.strip_prefix('='));
    value.is_some_and(|value| value.trim_start().starts_with(|c: char| c.is_ascii_digit()))
}

/// `key: value` or `- item`.
fn is_yaml(line: &str) -> bool {
    let line = line.trim_start();
    if let Some(item) = line.strip_prefix("- ") {
        return is_yaml(item) || !item.contains(['=', ',']);
    }
    let Some((key, rest)) = line.split_once(':') else { return false };
    let plain = key.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_-.".contains(&byte));
    !key.is_empty() && plain && (rest.is_empty() || rest.starts_with(' ')) && !rest.contains('=')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_known_by_how_they_are_written() {
        for (text, meant) in [
            ("<?xml version=\"1.0\"?>\n<!-- <link> -->\n<robot name=\"a\">", Some(Meant::Urdf)),
            ("<robotics/>", Some(Meant::Xml)),
            ("<sdf version='1.7'/>", Some(Meant::World)),
            ("<mujoco>", Some(Meant::World)),
            ("{\"agents\": [1, 2]}", Some(Meant::Json)),
            ("[1, 2]", Some(Meant::Json)),
            ("# one\nagents:\n  - name: arm\n", Some(Meant::Yaml)),
            ("- name: arm", Some(Meant::Yaml)),
            ("from,to\na,b\n", Some(Meant::Csv)),
            ("format = 2\ntime = {\n", Some(Meant::Scenario)),
            ("\n[[agents]]\n", Some(Meant::Scenario)),
            ("", None),
            ("Dear Ms Lovelace,\nplease keep this between us\n", None),
            ("first = 1\nDear Ms Lovelace,\n", None),
            ("time = \"12:30\"", None),
            ("{ a = 1 }", None),
            ("<", Some(Meant::Xml)),
        ] {
            assert_eq!(Meant::of(text), meant, "{text}");
        }
    }
}
