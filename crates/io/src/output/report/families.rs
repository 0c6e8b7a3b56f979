//! What some systems have beyond positions, velocities, references, torques, estimates and energy: a card for each such
//! signal that was recorded.

use std::collections::BTreeSet;

use forwardstep_core::signal::Drawn;
use forwardstep_sim::recording::{Recording, Signal};
use forwardstep_sim::{LineValue, Setup};
use serde::Serialize;

use super::super::names;
use super::super::table::Table;
use super::super::text;

/// A signal with a card of its own.
#[derive(Debug)]
pub(crate) struct Family {
    signal: Signal,
    /// Drawn dashed on the same card.
    wanted: Option<Signal>,
    pub(crate) title: String,
    pub(crate) letters: String,
}

/// A family on the page.
#[derive(Serialize)]
pub(crate) struct FamilyIndex {
    /// Of its card.
    id: String,
    entries: Vec<EntryIndex>,
}

/// One entry of it, which can be picked.
#[derive(Serialize)]
struct EntryIndex {
    /// What all agents that have it call it, or its number.
    name: String,
    unit: String,
    /// Index of the series by agent.
    series: Vec<Option<usize>>,
    wanted: Vec<Option<usize>>,
    /// Values to compare with, each once.
    lines: Vec<GuideIndex>,
}

/// A value to compare with.
#[derive(Serialize, PartialEq)]
struct GuideIndex {
    value: f64,
    label: &'static str,
}

impl Family {
    /// Of its card.
    pub(crate) fn id(&self) -> String {
        format!("family-{}", self.signal.name())
    }

    /// All that were recorded, in the order of the signals.
    pub(crate) fn of(recording: &Recording) -> Vec<Family> {
        let signals: BTreeSet<Signal> = recording.columns.iter().map(|column| column.signal).collect();
        let family = |&signal: &Signal| match signal.row().drawn {
            Drawn::WithAll | Drawn::Beside => None,
            Drawn::Card { title, letters, beside } => {
                let wanted = beside.filter(|wanted| signals.contains(wanted));
                let letters = match wanted {
                    Some(_) => format!("{letters}, commanded dashed"),
                    None => letters,
                };
                Some(Family { signal, wanted, title: title.into(), letters })
            }
        };
        signals.iter().filter_map(family).collect()
    }

    /// Its entries, with every series handed to `add`.
    pub(crate) fn index(&self, table: &Table<'_>, add: &mut impl FnMut(&[f64], bool) -> usize) -> FamilyIndex {
        let most = (0..table.agents()).map(|agent| table.entries(agent, self.signal)).max().unwrap_or(0);
        let entry = |k: usize| {
            let owners = (0..table.agents()).filter(|agent| table.column(*agent, self.signal, k).is_some());
            let owners: Vec<usize> = owners.collect();
            let words = |agent: &usize| names::entry_name(table.setup, *agent, self.signal, k).unwrap_or_default();
            let units = owners.iter().map(|agent| names::unit(table.setup, *agent, self.signal, k));
            let mut series = |signal: Signal| {
                let column = |agent| Some(add(table.column(agent, signal, k)?, signal.row().may_jump));
                (0..table.agents()).map(column).collect()
            };
            EntryIndex {
                name: names::shared(owners.iter().map(words)).unwrap_or_else(|| (k + 1).to_string()),
                unit: text::units(units),
                series: series(self.signal),
                wanted: self.wanted.map(series).unwrap_or_default(),
                lines: distinct(owners.iter().flat_map(|agent| self.guides(table.setup, *agent, k))),
            }
        };
        FamilyIndex { id: self.id(), entries: (0..most).map(entry).collect() }
    }

    /// What its values must not leave, or fall below, or should become.
    fn guides(&self, setup: &Setup, agent: usize, entry: usize) -> Vec<GuideIndex> {
        let Some(agent) = setup.agents.get(agent) else { return Vec::new() };
        let lines =
            agent.robot.interface().lines.into_iter().chain(agent.interface().into_iter().flat_map(|law| law.lines));
        let own = lines.filter(|line| line.signal == self.signal && line.entry == entry);
        let guide = |value, label| GuideIndex { value, label };
        own.flat_map(|line| match line.value {
            LineValue::Limit(limit) | LineValue::Clip(limit) => vec![guide(limit, "limit"), guide(-limit, "limit")],
            LineValue::Floor(floor) => vec![guide(floor, "floor")],
            LineValue::Truth(truth) => vec![guide(truth, "truth")],
        })
        .collect()
    }
}

/// Each once.
fn distinct(guides: impl Iterator<Item = GuideIndex>) -> Vec<GuideIndex> {
    let mut all = Vec::new();
    guides.for_each(|guide| {
        if !all.contains(&guide) {
            all.push(guide);
        }
    });
    all
}
