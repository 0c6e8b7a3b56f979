//! What else is wrong with the values of a scenario whose form is sound: out of range, too many or too few, names of unknown agents.
//!
//! A reader stops at the first of them. So what stands there is replaced by something possible and the scenario read again, until
//! nothing more is found. That is done twice, with small numbers and the first names, then with large ones and the last: what is
//! found both times is wrong whatever stands in place of the rest, and what merely follows from a replacement is found once at
//! most. `end_s = -20` replaced by a millisecond lets all pushes come too late; replaced by a thousand seconds it does not.

use std::ops::Range;

use forwardstep_sim::quantity::Requirement;
use forwardstep_sim::{LimitError, SetupError};
use toml::Spanned;
use toml::de::{DeArray, DeValue};

use super::document::Document;
use super::fault::Fault;
use super::problem::ScenarioProblem;
use super::value_problem::ValueProblem;

/// No more are told at once.
const MOST: usize = 20;
/// Whole numbers and others that are tried, the likeliest first.
const SMALL: [&[&str]; 2] = [&["1", "2", "3", "0", "0.5", "-1"], &["1e-3", "0.5", "2.0", "0.0", "-1.0"]];
const LARGE: [&[&str]; 2] =
    [&["100", "12", "2", "1", "0", "0.5", "-1"], &["1e3", "10.0", "2.0", "0.75", "0.0", "-1.0"]];
/// Lists are tried with so many entries.
const LENGTHS: Range<usize> = 1..9;
/// So many names are tried.
const NAMES: usize = 4;
/// What cannot be left out, or what others are read by: cut out, it would be missed in other words.
const KEPT: [&str; 7] = ["agents", "network", "reference", "law", "robot", "name", "time"];
/// Tables that can be left out whole.
const SPARED: [&str; 3] = ["goal", "control", "solver"];

/// What a reading came to.
pub(super) enum Reading {
    /// The scenario has a meaning.
    Sound,
    /// It has none.
    Fault(Fault),
    /// Its form is not sound, or a file that it names is not.
    Unreadable,
}

/// Numbers and names that stand in place of those that are impossible.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Small,
    Large,
}

/// A step on the way from the root of a tree inwards.
#[derive(Clone, Debug, PartialEq)]
enum Step {
    Key(String),
    Index(usize),
}

/// What is wrong besides `first`, in the order of the file. `reads` so often at most.
pub(super) fn others<'i>(
    first: &Fault,
    document: &Document<'i>,
    reads: usize,
    read: &mut dyn FnMut(&Document<'i>) -> Reading,
) -> Vec<Fault> {
    let mut chain = |side| {
        Chain { document: document.clone(), side, left: reads / 2, mended: Mended::default(), read }.follow(first)
    };
    let small = chain(Side::Small);
    // Most mistakes are the only one.
    if small.is_empty() {
        return small;
    }
    let large = chain(Side::Large);
    let mut both: Vec<Fault> = small.into_iter().filter(|one| large.iter().any(|other| same(one, other))).collect();
    both.sort_by_key(|fault| fault.span.as_ref().map_or(0, |span| span.start));
    both
}

/// The same said of the same place. What help lists may differ.
fn same(one: &Fault, other: &Fault) -> bool {
    let place = |fault: &Fault| (fault.span.clone(), fault.source.as_ref().map(|source| source.name().to_owned()));
    place(one) == place(other) && one.to_string() == other.to_string()
}

/// One mistake after the other, each replaced.
struct Chain<'i, 'r> {
    document: Document<'i>,
    side: Side,
    /// So many readings are left.
    left: usize,
    mended: Mended,
    read: &'r mut dyn FnMut(&Document<'i>) -> Reading,
}

/// What was replaced so far, and what may follow from it whatever stands there now.
#[derive(Default)]
struct Mended {
    places: Vec<Range<usize>>,
    /// Around what was cut out: it may be missed there.
    lacking: Vec<Vec<Step>>,
    /// Lists that had another length, and whose: others that are as long as they were are right where they were.
    lengths: Vec<(usize, String)>,
    /// What there is too much of: whatever else uses it has too much of it as well.
    crowds: Vec<String>,
    /// Whether an agent has another name: others may name it as it was meant.
    renamed: bool,
}

impl Mended {
    /// Whether a mistake may be there only because of what was replaced.
    fn explains(&self, fault: &Fault, path: Option<&[Step]>) -> bool {
        let contains =
            |outer: &Range<usize>, inner: &Range<usize>| outer.start <= inner.start && inner.end <= outer.end;
        let is_around = |span: &Range<usize>| self.places.iter().any(|place| contains(span, place));
        let lacks = |path: &[Step]| self.lacking.iter().any(|around| path.starts_with(around));
        let follows = match &*fault.problem {
            ScenarioProblem::NoSuchAgent { .. } => self.renamed,
            problem => match length_of(problem) {
                Some((found, of)) => self.lengths.iter().any(|(length, whose)| *length == found && whose != of),
                None => self.crowds.contains(&fault.to_string()),
            },
        };
        follows || fault.source.is_none() && fault.span.as_ref().is_some_and(is_around) || path.is_some_and(lacks)
    }

    fn add(&mut self, fault: &Fault, path: &[Step], is_cut: bool) {
        self.places.extend(fault.span.clone());
        match &*fault.problem {
            ScenarioProblem::AgentName { .. } | ScenarioProblem::AgentTwice { .. } => self.renamed = true,
            ScenarioProblem::Value(ValueProblem::Quantity(error))
                if matches!(error.requirement, Requirement::Few { .. }) =>
            {
                self.crowds.push(fault.to_string());
            }
            problem => self.lengths.extend(length_of(problem).map(|(found, whose)| (found, whose.to_owned()))),
        }
        if let Some((_, around @ [_, ..])) = path.split_last().filter(|_| is_cut) {
            self.lacking.push(around.to_vec());
        }
    }
}

/// How many entries a list has that should have others, and whose it is.
fn length_of(problem: &ScenarioProblem) -> Option<(usize, &str)> {
    match problem {
        ScenarioProblem::Value(ValueProblem::VectorLength { found, agent, .. }) => Some((*found, agent)),
        ScenarioProblem::Setup(SetupError::Entries { got, agent, .. }) => Some((*got, agent)),
        _ => None,
    }
}

/// Whether what was chosen does not go together, so that all else depends on which of it is chosen otherwise.
fn is_at_odds(fault: &Fault) -> bool {
    let ScenarioProblem::Setup(error) = &*fault.problem else { return false };
    !matches!(
        error,
        SetupError::Length { .. }
            | SetupError::Entries { .. }
            | SetupError::Limit { .. }
            | SetupError::NoManipulability { .. }
            | SetupError::Gain { .. }
            | SetupError::Push { .. }
            | SetupError::NotPushed { .. }
            | SetupError::StartOfReference { .. }
            | SetupError::Memory { .. }
            | SetupError::RecordingTooLarge { .. }
    )
}

impl<'i> Chain<'i, '_> {
    fn follow(mut self, first: &Fault) -> Vec<Fault> {
        // Those that are not told are replaced too.
        let mut found: Vec<(Fault, bool)> = Vec::new();
        while found.len() < MOST {
            let last = found.last().map_or(first, |(fault, _)| fault);
            if is_at_odds(last) {
                break;
            }
            let Some(fault) = self.mend(last) else { break };
            if same(first, &fault) || found.iter().any(|(known, _)| same(known, &fault)) {
                break;
            }
            let span = fault.span.clone().filter(|_| fault.source.is_none());
            let path = span.and_then(|span| path_to(self.document.root_mut(), &span));
            let follows = self.mended.explains(&fault, path.as_deref());
            found.push((fault, follows));
        }
        found.into_iter().filter(|(_, follows)| !follows).map(|(fault, _)| fault).collect()
    }

    /// Replaces what is wrong by the first thing with which it is not; what is wrong then.
    fn mend(&mut self, fault: &Fault) -> Option<Fault> {
        if fault.source.is_some() {
            return None;
        }
        let span = fault.span.as_ref()?;
        let path = path_to(self.document.root_mut(), span)?;
        let around = spans(self.document.root_mut(), &path);
        let node = inner(self.document.root_mut(), &path)?;
        let substitutes = substitutes(node, fault, self.side).into_iter().map(|value| (path.clone(), Some(value)));
        let cuts = cuts(&path).into_iter().map(|path| (path, None));
        for (path, value) in substitutes.chain(cuts) {
            self.left = self.left.checked_sub(1)?;
            let mut document = self.document.clone();
            let is_cut = value.is_none();
            match value {
                Some(value) => *inner(document.root_mut(), &path)? = value,
                None => cut(document.root_mut(), &path)?,
            }
            let next = match (self.read)(&document) {
                Reading::Sound => None,
                Reading::Fault(next) if is_elsewhere(&next, &around) => Some(next),
                Reading::Fault(_) | Reading::Unreadable => continue,
            };
            self.document = document;
            self.mended.add(fault, &path, is_cut);
            return next;
        }
        None
    }
}

/// Whether a mistake is at none of these places, nor at a part of the first two.
fn is_elsewhere(fault: &Fault, around: &[Range<usize>]) -> bool {
    let Some(span) = fault.span.as_ref().filter(|_| fault.source.is_none()) else { return true };
    let apart = |other: &Range<usize>| span.end <= other.start || other.end <= span.start;
    around.iter().take(2).all(apart) && around.iter().all(|other| span != other)
}

/// The way to what has its key or its value at `span`, the innermost.
fn path_to(value: &DeValue<'_>, span: &Range<usize>) -> Option<Vec<Step>> {
    let is_here = |value: &Spanned<DeValue<'_>>| {
        let own = value.span();
        own == *span || value.get_ref().is_str() && own.start <= span.start && span.end <= own.end
    };
    let mut entries: Vec<(Step, bool, &Spanned<DeValue<'_>>)> = Vec::new();
    match value {
        DeValue::Table(table) => {
            entries.extend(table.iter().map(|(key, value)| {
                (Step::Key(key.get_ref().to_string()), key.span() == *span || is_here(value), value)
            }))
        }
        DeValue::Array(list) => {
            entries.extend(list.iter().enumerate().map(|(k, value)| (Step::Index(k), is_here(value), value)));
        }
        _ => {}
    }
    let deeper = entries.iter().find_map(|(step, _, value)| {
        let mut path = path_to(value.get_ref(), span)?;
        path.insert(0, step.clone());
        Some(path)
    });
    deeper.or_else(|| entries.into_iter().find(|(_, here, _)| *here).map(|(step, ..)| vec![step]))
}

/// The places of the value at `path` and of its key, then of all that is around it but the root.
fn spans(root: &DeValue<'_>, path: &[Step]) -> Vec<Range<usize>> {
    let mut spans = Vec::new();
    let mut value = root;
    for step in path {
        let (key, next) = match (value, step) {
            (DeValue::Table(table), Step::Key(key)) => match table.iter().find(|(own, _)| own.get_ref() == key) {
                Some((own, next)) => (own.span(), next),
                None => break,
            },
            (DeValue::Array(list), Step::Index(k)) => match list.get(*k) {
                Some(next) => (next.span(), next),
                None => break,
            },
            _ => break,
        };
        spans.extend([key, next.span()]);
        value = next.get_ref();
    }
    spans.reverse();
    spans
}

fn inner<'a, 'i>(root: &'a mut DeValue<'i>, path: &[Step]) -> Option<&'a mut DeValue<'i>> {
    let Some((step, rest)) = path.split_first() else { return Some(root) };
    let next = match (root, step) {
        (DeValue::Table(table), Step::Key(key)) => table.get_mut(key.as_str()),
        (DeValue::Array(list), Step::Index(k)) => list.get_mut(*k),
        _ => None,
    };
    inner(next?.get_mut(), rest)
}

/// Cuts out what stands at `path`.
fn cut(root: &mut DeValue<'_>, path: &[Step]) -> Option<()> {
    let (step, above) = path.split_last()?;
    match (inner(root, above)?, step) {
        (DeValue::Table(table), Step::Key(key)) => table.remove(key.as_str()).map(|_| ()),
        (DeValue::Array(list), Step::Index(at)) => {
            let kept = list.iter().enumerate().filter(|(k, _)| k != at).map(|(_, entry)| entry.clone());
            *list = kept.collect::<DeArray<'_>>();
            Some(())
        }
        _ => None,
    }
}

/// What may be cut out so that what stands at `path` is gone, the least first.
fn cuts(path: &[Step]) -> Vec<Vec<Step>> {
    let mut cuts = Vec::new();
    let can_go = match path {
        [.., Step::Key(key)] => !KEPT.contains(&key.as_str()),
        // Of numbers in a list none is left out.
        [Step::Key(key), ..] => !["agents", "law", "reference"].contains(&key.as_str()),
        _ => false,
    };
    if can_go {
        cuts.push(path.to_vec());
    }
    match path {
        // An entry of a list of tables, such as a push.
        [Step::Key(list), Step::Index(_), _, ..] if list != "agents" => cuts.push(path[..2].to_vec()),
        [Step::Key(key), _, ..] if SPARED.contains(&key.as_str()) => cuts.push(path[..1].to_vec()),
        _ => {}
    }
    cuts
}

/// What may stand in place of `value`, the likeliest first.
fn substitutes<'i>(value: &DeValue<'i>, fault: &Fault, side: Side) -> Vec<DeValue<'i>> {
    let [whole, other] = if side == Side::Small { SMALL } else { LARGE };
    match value {
        DeValue::Integer(_) => whole.iter().filter_map(|text| parsed(text)).collect(),
        DeValue::Float(_) => other.iter().filter_map(|text| parsed(text)).collect(),
        DeValue::Boolean(value) => vec![DeValue::Boolean(!value)],
        DeValue::String(_) => texts(fault, side, other),
        // With fewer and with more entries, which repeat.
        DeValue::Array(list) if !list.is_empty() && is_of_length(&fault.problem) => {
            let lengths = LENGTHS.filter(|length| *length != list.len());
            lengths.map(|length| DeValue::Array(list.iter().cycle().take(length).cloned().collect())).collect()
        }
        // Where a list may stand a number may too, as often as not; or it is an interval.
        DeValue::Array(list) if !list.is_empty() => {
            let place = list.first().map_or(0..0, Spanned::span);
            let entry = |text| parsed(text).map(|value| Spanned::new(place.clone(), value));
            let interval = ["0.25", if side == Side::Small { "0.5" } else { "3.0" }];
            let interval = DeValue::Array(interval.into_iter().filter_map(entry).collect());
            let numbers = other.iter().take(2).filter_map(|text| parsed(text));
            numbers.chain([interval]).collect()
        }
        _ => Vec::new(),
    }
}

/// Whether a list is too long or too short.
fn is_of_length(problem: &ScenarioProblem) -> bool {
    let is_of_lists = |problem: &ValueProblem| {
        matches!(
            problem,
            ValueProblem::ListPerAgent { .. } | ValueProblem::NotSquare { .. } | ValueProblem::Order { .. }
        )
    };
    match problem {
        ScenarioProblem::Value(value) if is_of_lists(value) => true,
        ScenarioProblem::System(_) | ScenarioProblem::Push(_) | ScenarioProblem::Derivatives { .. } => true,
        ScenarioProblem::Setup(
            SetupError::Length { .. } | SetupError::Limit { error: LimitError::Torques(_) | LimitError::Rates(_), .. },
        ) => true,
        problem => length_of(problem).is_some(),
    }
}

/// Names of agents that there are, or a name of a new one, or a formula.
fn texts<'i>(fault: &Fault, side: Side, numbers: &[&'static str]) -> Vec<DeValue<'i>> {
    let text = |text: &str| DeValue::String(text.to_owned().into());
    match &*fault.problem {
        ScenarioProblem::NoSuchAgent { agents, .. } if side == Side::Small => {
            agents.iter().take(NAMES).map(|name| text(name)).collect()
        }
        ScenarioProblem::NoSuchAgent { agents, .. } => agents.iter().rev().take(NAMES).map(|name| text(name)).collect(),
        ScenarioProblem::AgentName { .. } | ScenarioProblem::AgentTwice { .. } => {
            let start = fault.span.as_ref().map_or(0, |span| span.start);
            vec![text(&format!("{}{start}", if side == Side::Small { "some" } else { "other" }))]
        }
        _ => numbers.iter().take(3).filter_map(|number| parsed(number)).collect(),
    }
}

fn parsed(text: &'static str) -> Option<DeValue<'static>> {
    DeValue::parse(text).ok().map(Spanned::into_inner)
}
