//! What some systems have beyond positions, velocities, references, torques, estimates and energy: a card for each such
//! signal that was recorded.

use std::collections::BTreeSet;

use forwardstep_sim::recording::{Recording, Signal};
use forwardstep_sim::{Setup, SpacecraftModel, TaskSpaceLaw, ThrustLaw};
use serde::Serialize;

use super::super::names;
use super::super::table::Table;
use super::text;

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
        let family = |&signal: &Signal| {
            let (title, letters) = words(signal)?;
            let wanted = match signal {
                Signal::AngularVelocity => Some(Signal::AngularVelocityWanted),
                Signal::Attitude => Some(Signal::ReferenceAttitude),
                _ => None,
            };
            let wanted = wanted.filter(|wanted| signals.contains(wanted));
            Some(Family { signal, wanted, title: title.into(), letters })
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
                let column = |agent| Some(add(table.column(agent, signal, k)?, may_jump(signal)));
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
        let guide = |label| move |value| GuideIndex { value, label };
        let both = |limit: Option<f64>| {
            limit.into_iter().flat_map(|limit| [limit, -limit]).map(guide("limit")).collect::<Vec<_>>()
        };
        let wheel = || agent.robot.kind.downcast::<SpacecraftModel>()?.wheels.wheel(entry);
        match self.signal {
            Signal::WheelTorque => both(wheel().and_then(|wheel| wheel.torque_limit_n_m)),
            Signal::WheelMomentum => both(wheel().and_then(|wheel| wheel.momentum_limit_n_m_s)),
            Signal::Thrust => {
                let law = agent.law.downcast::<ThrustLaw>();
                law.map(|law| guide("floor")(law.floor.newtons())).into_iter().collect()
            }
            Signal::KinematicEstimate => {
                let law = agent.law.downcast::<TaskSpaceLaw>();
                let truth = law.and_then(|law| law.tip.parameters(&*agent.robot.kind)?.get(entry).copied());
                truth.into_iter().map(guide("truth")).collect()
            }
            _ => Vec::new(),
        }
    }
}

/// Title and letters of the card; nothing for signals that have a card in any case, or none.
fn words(signal: Signal) -> Option<(&'static str, String)> {
    let (title, letters) = match signal {
        Signal::Derivative(k) => ("Higher derivatives", format!("q⁽{}⁾", text::superscript(i32::from(k)))),
        Signal::Coordinate(k) => ("States of the chain", format!("x{k}")),
        Signal::Selection => ("Set-valued sign", "ς, within [−1, 1]".into()),
        Signal::Error => ("Distance from the target", "what is to vanish".into()),
        Signal::Offset => ("Offset in the formation", "d".into()),
        Signal::Filter => ("Filter in place of the velocity", "y".into()),
        Signal::FilterRate => ("Rate of the filter", "ẏ".into()),
        Signal::Divisor => ("What the law divides by", "must stay away from zero".into()),
        Signal::Attitude => ("Attitude", "quaternion (q_v, q_o)".into()),
        Signal::AngularVelocity => ("Angular velocity", "ω in the body’s axes".into()),
        Signal::Thrust => ("Thrust", "σ".into()),
        Signal::Heading => ("Heading", "about the vertical".into()),
        Signal::Angle => ("Angle to the target’s attitude", "from 0 to π".into()),
        Signal::WheelTorque => ("Torques of the wheels", "u, after any limit".into()),
        Signal::WheelMomentum => ("Momenta of the wheels", "h_w".into()),
        Signal::TaskPosition => ("Position of the tip", "x".into()),
        Signal::KinematicEstimate => ("Estimated lengths", "θ̂".into()),
        Signal::Determinant => ("Regularity of the estimated Jacobian", "det Ĵ".into()),
        // With another, or among those that every system has.
        Signal::ReferenceAttitude
        | Signal::AngularVelocityWanted
        | Signal::Position
        | Signal::Velocity
        | Signal::Reference(_)
        | Signal::TrackingError
        | Signal::Torque
        | Signal::Estimate
        | Signal::Lyapunov
        | Signal::Dissipation
        | Signal::External => return None,
    };
    Some((title, letters))
}

/// Whether it follows what is heard, or a limit, at once.
fn may_jump(signal: Signal) -> bool {
    matches!(signal, Signal::Selection | Signal::WheelTorque | Signal::AngularVelocity | Signal::AngularVelocityWanted)
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
