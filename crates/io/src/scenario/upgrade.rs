//! From scenario files of format 1 to what is read now.
//!
//! Formats differ in what keys and columns are called, not in what they mean: an upgraded file is the same scenario. Comments
//! and layout stay. The files that a scenario names are the same in both formats.

use toml_edit::{Array, DocumentMut, InlineTable, Item, Key, Table, Value};

use super::document::Document;
use super::fault::Fault;
use super::robots::Stop;
use super::value_problem::ValueProblem;
use super::{FORMAT, ScenarioError};
use crate::SourceText;

/// Keys of format 1, from the root of the file, and what they are called now; `*` stands for any keys.
const RENAMED: [(&str, &str); 12] = [
    ("solver.ledger", "lyapunov_balance"),
    ("pushes", "external_wrenches"),
    ("pushes.by.hand_on_axes", "virtual_spring_on_axes"),
    ("pushes.by.hand_on_point", "virtual_spring_on_point"),
    ("agents.spread", "parameter_variation"),
    ("agents.law.task_space.tip", "end_effector"),
    ("law.task_space.tip", "end_effector"),
    ("reference.leader.sign_every_s", "sign_period_s"),
    ("reference.leader.sign.layer", "boundary_layer"),
    ("network.*.packets.every_s", "period_s"),
    ("network.*.packets.loss.random.most_in_a_row", "most_consecutive"),
    ("network.*.packets.loss.bursts.most_in_a_row", "most_consecutive"),
];

/// A scenario file in the format that is read now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Upgraded {
    /// The file.
    pub text: String,
    /// What changed; nothing if it was of this format already.
    pub moved: Vec<Moved>,
}

/// A line that changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moved {
    /// Its number, from one.
    pub line: usize,
    /// What it was.
    pub from: String,
    /// What it is.
    pub to: String,
}

/// Converts a scenario file of an earlier format to the one that is read now. What else is wrong with it stays as it is.
///
/// ```
/// use forwardstep_io::SourceText;
/// use forwardstep_io::scenario::upgrade;
///
/// let old = SourceText::new("old.toml", "format = 1\n[reference.leader]\nsign_every_s = 0.1 # slow\n");
/// let new = upgrade(&old)?;
/// assert_eq!(new.text, "format = 2\n[reference.leader]\nsign_period_s = 0.1 # slow\n");
/// assert_eq!((new.moved[1].line, new.moved[1].from.as_str()), (3, "sign_every_s = 0.1 # slow"));
/// # Ok::<(), forwardstep_io::scenario::ScenarioError>(())
/// ```
///
/// # Errors
/// When the text is not TOML, has a format that is not known, or has a quantity under its old and its new key.
pub fn upgrade(source: &SourceText) -> Result<Upgraded, ScenarioError> {
    converted(source).map_err(|fault| Stop::from(fault).in_file(source))
}

fn converted(source: &SourceText) -> Result<Upgraded, Fault> {
    let text = source.text();
    let format = Document::parse(source)?.format()?;
    if format.value != 1 {
        Document::readable(&format, source)?;
        return Ok(Upgraded { text: text.to_owned(), moved: Vec::new() });
    }
    let unreadable =
        |error: toml_edit::TomlError| Fault::new(ValueProblem::Unreadable { message: error.message().to_owned() });
    let mut document: DocumentMut = text.parse().map_err(unreadable)?;
    in_table(document.as_table_mut(), &mut Vec::new())?;
    if let Some(Item::Value(value)) = document.get_mut("format") {
        let decor = value.decor().clone();
        *value = Value::from(FORMAT);
        *value.decor_mut() = decor;
    }
    let mut upgraded = document.to_string();
    if text.contains("\r\n") {
        upgraded = upgraded.replace("\r\n", "\n").replace('\n', "\r\n");
    }
    let lines = text.lines().zip(upgraded.lines()).enumerate();
    let moved = lines.filter(|(_, (from, to))| from != to).map(|(k, (from, to))| Moved {
        line: k + 1,
        from: from.trim().to_owned(),
        to: to.trim().to_owned(),
    });
    Ok(Upgraded { moved: moved.collect(), text: upgraded })
}

/// What the key at the end of `path` is called now.
fn renamed(path: &[String]) -> Option<(&'static str, &'static str)> {
    let is = |rule: &str| {
        let (start, end) = rule.split_once(".*.").map_or((None, rule), |(start, end)| (Some(start), end));
        let end: Vec<&str> = end.split('.').collect();
        let starts = start.map_or(path.len() == end.len(), |start| path.first().is_some_and(|key| key == start));
        starts && path.len() >= end.len() && path[path.len() - end.len()..].iter().eq(&end)
    };
    let rule = RENAMED.iter().find(|(rule, _)| is(rule));
    rule.map(|(rule, new)| (rule.rsplit('.').next().unwrap_or(rule), *new))
}

/// Takes every entry out and puts it back under the key that it has now, so that their order stays.
macro_rules! rename_keys {
    ($name:ident, $table:ty, $inner:expr) => {
        fn $name(table: &mut $table, path: &mut Vec<String>) -> Result<(), Fault> {
            let keys: Vec<String> = table.iter().map(|(key, _)| key.to_owned()).collect();
            for key in keys {
                let Some((mut key, mut value)) = table.remove_entry(&key) else { continue };
                path.push(key.get().to_owned());
                $inner(&mut value, path)?;
                if let Some((first, second)) = renamed(path) {
                    if table.contains_key(second) {
                        return Err(Fault::new(ValueProblem::SameQuantity { first, second }));
                    }
                    let (leaf, dotted) = (key.leaf_decor().clone(), key.dotted_decor().clone());
                    key = Key::new(second).with_leaf_decor(leaf).with_dotted_decor(dotted);
                }
                path.pop();
                table.insert_formatted(&key, value);
            }
            Ok(())
        }
    };
}

rename_keys!(in_table, Table, in_item);
rename_keys!(in_inline, InlineTable, in_value);

fn in_item(item: &mut Item, path: &mut Vec<String>) -> Result<(), Fault> {
    match item {
        Item::None => Ok(()),
        Item::Value(value) => in_value(value, path),
        Item::Table(table) => in_table(table, path),
        Item::ArrayOfTables(tables) => tables.iter_mut().try_for_each(|table| in_table(table, path)),
    }
}

fn in_value(value: &mut Value, path: &mut Vec<String>) -> Result<(), Fault> {
    match value {
        Value::InlineTable(table) => in_inline(table, path),
        Value::Array(array) => Array::iter_mut(array).try_for_each(|value| in_value(value, path)),
        _ => Ok(()),
    }
}
