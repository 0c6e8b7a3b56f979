//! The tree of a scenario file: read once as a whole, and again where a kind has a table of its own.

use std::collections::HashMap;
use std::ops::Range;

use forwardstep_sim::quantity::{Path, Segment};
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::FORMAT;
use super::at::At;
use super::de::ValueDe;
use super::fault::{Fault, fault};
use super::file::ScenarioFile;
use super::kinds::schedules::ScheduleKind;
use super::kinds::{AgentReferenceTable, Kinds, LawKind, ReferenceKind, RobotKind};
use super::problem::ScenarioProblem;
use super::robots::Stop;
use super::value_problem::{ValueProblem, is_too_deep};
use crate::{Meant, SourceText};

/// A scenario file as TOML.
#[derive(Clone)]
pub(super) struct Document<'i> {
    root: Spanned<DeValue<'i>>,
}

/// Which node of the tree of a file it is: its place in memory, where it stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Node(pub(super) u64);

impl Node {
    pub(super) fn of(value: &Spanned<DeValue<'_>>) -> Node {
        Node(std::ptr::from_ref(value).addr() as u64)
    }
}

/// Tables in the tree of a file.
pub(super) type Tables<'a, 'i> = HashMap<Node, &'a Spanned<DeValue<'i>>>;

/// A law with its key.
pub(super) type KeyedLaw = (&'static str, Box<dyn LawKind>);

impl<'i> Document<'i> {
    pub(super) fn parse(source: &'i SourceText) -> Result<Self, Fault> {
        let unreadable = |error: toml::de::Error| {
            // A scenario with a mistake stays one.
            if let Some(meant) = Meant::of(source.text()).filter(|meant| *meant != Meant::Scenario) {
                return Fault::new(ScenarioProblem::Meant { meant, file: source.name().to_owned() });
            }
            let fault = Fault::new(ValueProblem::Unreadable { message: error.message().to_owned() });
            match error.span().or_else(|| is_too_deep(error.message()).then(|| deepest_bracket(source.text()))) {
                Some(span) => fault.at(&span),
                None => fault,
            }
        };
        let table = DeTable::parse(source.text()).map_err(unreadable)?;
        Ok(Document { root: Spanned::new(table.span(), DeValue::Table(table.into_inner())) })
    }

    /// The tree.
    pub(super) fn root_mut(&mut self) -> &mut DeValue<'i> {
        self.root.get_mut()
    }

    /// The version of its format; what else the file says may depend on it.
    pub(super) fn format(&self) -> Result<At<i64>, Fault> {
        match self.root.get_ref().get("format") {
            Some(value) => At::deserialize(ValueDe { value, kinds: &Kinds::default() }),
            None if self.root.get_ref().as_table().is_some_and(|table| table.is_empty()) => {
                Err(Fault::new(ScenarioProblem::NothingWritten))
            }
            None => Err(Fault::new(ValueProblem::MissingKey { key: "format" })),
        }
    }

    /// Refuses a format that is not read now.
    pub(super) fn readable(format: &At<i64>, source: &SourceText) -> Result<(), Fault> {
        let problem = || ScenarioProblem::Format { found: format.value, file: source.name().to_owned() };
        if format.value == FORMAT { Ok(()) } else { Err(fault(format, problem())) }
    }

    /// The file, with the tables of `kinds` checked but left in the tree.
    pub(super) fn file(&self, kinds: &Kinds) -> Result<ScenarioFile, Fault> {
        ScenarioFile::deserialize(ValueDe { value: &self.root, kinds }).map_err(|mut fault| {
            // What is missing from the file as a whole has no place in it.
            if fault.span == Some(self.root.span()) {
                fault.span = None;
            }
            fault
        })
    }

    /// The robot of an entry of `[[agents]]`.
    pub(super) fn robot(&self, entry: usize, kinds: &Kinds) -> Result<(&'static str, Box<dyn RobotKind>), Fault> {
        match self.entry(entry).and_then(|entry| entry.get_ref().get("robot")) {
            Some(value) => kinds.robot(ValueDe { value, kinds }),
            None => Err(Fault::new(ValueProblem::MissingKey { key: "robot" })),
        }
    }

    /// A problem of the robot of an entry of `[[agents]]`, with the place of the quantity that it is about.
    pub(super) fn in_robot(&self, entry: usize, stop: Stop) -> Stop {
        match (stop, self.entry(entry).and_then(|entry| entry.get_ref().get("robot"))) {
            (Stop::Here(fault), Some(table)) => Stop::Here(fault.inside(table).at(&table.span())),
            (stop, _) => stop,
        }
    }

    /// The law of an entry of `[[agents]]`, else that of all agents, if there is one.
    pub(super) fn law(&self, entry: usize, kinds: &Kinds) -> Result<Option<KeyedLaw>, Fault> {
        let own = self.entry(entry).and_then(|entry| entry.get_ref().get("law"));
        let law = own.or_else(|| self.root.get_ref().get("law"));
        law.map(|value| kinds.law(ValueDe { value, kinds })).transpose()
    }

    /// The reference dynamics of all agents.
    pub(super) fn reference(&self, kinds: &Kinds) -> Result<(&'static str, Box<dyn ReferenceKind>), Fault> {
        match self.root.get_ref().get("reference") {
            Some(value) => kinds.reference(ValueDe { value, kinds }),
            None => Err(Fault::new(ValueProblem::MissingKey { key: "reference" })),
        }
    }

    /// What an entry of `[[agents]]` states of its own, under the key of everybody's reference dynamics.
    pub(super) fn agent_reference(
        &self,
        entry: usize,
        kinds: &Kinds,
    ) -> Result<Option<(&'static str, AgentReferenceTable)>, Fault> {
        let own = self.entry(entry).and_then(|entry| entry.get_ref().get("reference"));
        own.map(|value| kinds.agent_reference(ValueDe { value, kinds }).map(|(key, own)| (key, *own))).transpose()
    }

    /// How the phases of the network follow each other, if it says so.
    pub(super) fn switching(&self, kinds: &Kinds) -> Result<Option<Box<dyn ScheduleKind>>, Fault> {
        let value = self.root.get_ref().get("network").and_then(|network| network.get_ref().get("switching"));
        value.map(|value| kinds.schedule(ValueDe { value, kinds }).map(|(_, switching)| switching)).transpose()
    }

    /// All tables of the network.
    pub(super) fn network_tables(&self) -> Tables<'_, 'i> {
        fn collect<'a, 'i>(value: &'a Spanned<DeValue<'i>>, tables: &mut Tables<'a, 'i>) {
            match value.get_ref() {
                DeValue::Table(table) => {
                    tables.insert(Node::of(value), value);
                    table.values().for_each(|value| collect(value, tables));
                }
                DeValue::Array(list) => list.iter().for_each(|value| collect(value, tables)),
                _ => {}
            }
        }
        let mut tables = Tables::new();
        if let Some(network) = self.root.get_ref().get("network") {
            collect(network, &mut tables);
        }
        tables
    }

    /// The place of what stands at `path`, or of the nearest that is around it. `entries` has the entry of `[[agents]]` that
    /// stands for each agent; what an entry does not say itself is looked for where it is said for all.
    pub(super) fn place(&self, path: &Path, entries: &[usize]) -> Option<Range<usize>> {
        let (own, common) = match path.segments() {
            [Segment::Key("agents"), Segment::Index(agent), inner @ ..] => {
                let entry = self.entry(*entries.get(*agent)?)?;
                let own = deepest(entry, inner);
                // Without a law the robot has its default one.
                let robot = || (0, entry.get_ref().get("robot").unwrap_or(entry).span());
                (Some(if own.0 == 0 { robot() } else { own }), inner)
            }
            whole => (None, whole),
        };
        let common = Some(deepest(&self.root, common)).filter(|(depth, _)| *depth > 0);
        let (_, span) =
            own.into_iter().chain(common).reduce(|own, common| if common.0 > own.0 { common } else { own })?;
        Some(span)
    }

    fn entry(&self, entry: usize) -> Option<&Spanned<DeValue<'i>>> {
        self.root.get_ref().get("agents")?.get_ref().get(entry)
    }
}

/// The place of the innermost bracket, as far as that can be told of a text that was not read: brackets in texts and comments do not count.
/// Where no brackets nest, it is the line whose key has the most dots.
fn deepest_bracket(text: &str) -> Range<usize> {
    /// Scenarios have brackets nested so deeply, and parsers take more.
    const FEW: usize = 16;
    let (mut depth, mut deepest, mut place) = (0_usize, 0, 0);
    let (mut quote, mut is_comment) = (None, false);
    for (at, c) in text.char_indices() {
        match (c, quote) {
            ('\n', _) => (quote, is_comment) = (None, false),
            _ if is_comment => {}
            (c, Some(open)) => quote = quote.filter(|_| c != open),
            ('"' | '\'', None) => quote = Some(c),
            ('#', None) => is_comment = true,
            ('[' | '{', None) => depth += 1,
            (']' | '}', None) => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth > deepest {
            (deepest, place) = (depth, at);
        }
    }
    if deepest < FEW {
        let dots = |line: &str| line.matches('.').count();
        let lines =
            text.split_inclusive('\n').scan(0, |at, line| Some((std::mem::replace(at, *at + line.len()), dots(line))));
        place = lines.max_by_key(|(_, dots)| *dots).map_or(0, |(at, _)| at);
    }
    place..(place + 1).min(text.len())
}

/// How far `path` leads from `value` inwards, and the place of what is there. The simulator does not know under which key
/// of a kind a table stands in a file: a table with one key is gone through.
pub(super) fn deepest(mut value: &Spanned<DeValue<'_>>, path: &[Segment]) -> (usize, Range<usize>) {
    let mut depth = 0;
    for segment in path {
        let inner = match segment {
            Segment::Key(key) => value.get_ref().get(*key).or_else(|| only(value)?.get_ref().get(*key)),
            Segment::Index(index) => value.get_ref().get(*index),
        };
        let Some(inner) = inner else { break };
        (value, depth) = (inner, depth + 1);
    }
    (depth, value.span())
}

/// What stands under the only key of a table.
fn only<'a, 'i>(value: &'a Spanned<DeValue<'i>>) -> Option<&'a Spanned<DeValue<'i>>> {
    match value.get_ref() {
        DeValue::Table(table) if table.len() == 1 => table.values().next(),
        _ => None,
    }
}

/// What `read` makes of an empty table under `key`.
pub(super) fn with_empty<R>(
    key: &str,
    kinds: &Kinds,
    read: impl FnOnce(ValueDe<'_, '_>) -> Result<R, Fault>,
) -> Result<R, Fault> {
    let mut table = DeTable::new();
    table.insert(Spanned::new(0..0, key.into()), Spanned::new(0..0, DeValue::Table(DeTable::new())));
    read(ValueDe { value: &Spanned::new(0..0, DeValue::Table(table)), kinds }).map_err(|mut fault| {
        // It does not stand in the file.
        fault.span = None;
        fault
    })
}
