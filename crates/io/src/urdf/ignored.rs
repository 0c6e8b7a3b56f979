//! A tally of what a file says that does not enter the model: nothing is dropped without notice.

use std::fmt;

/// Why something in a file does not enter the model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum IgnoreReason {
    /// Shapes and colours.
    Shape,
    /// Transmissions.
    Transmission,
    /// Sensors.
    Sensor,
    /// Settings of a controller of the real robot.
    Controller,
    /// For a simulator.
    Simulator,
    /// Means nothing on a joint that does not move.
    FixedJoint,
    /// Means nothing on a joint without end.
    ContinuousJoint,
    /// Of another XML namespace.
    Foreign,
    /// Not URDF.
    Unknown {
        /// What was perhaps meant.
        nearest: Option<String>,
    },
}

impl fmt::Display for IgnoreReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            IgnoreReason::Shape => "shape and colour do not enter the dynamics",
            IgnoreReason::Transmission => "gears and rotors are not modelled",
            IgnoreReason::Sensor => "sensors are not modelled",
            IgnoreReason::Controller => "for the controller of the real robot",
            IgnoreReason::Simulator => "for another simulator",
            IgnoreReason::FixedJoint => "without meaning on a fixed joint",
            IgnoreReason::ContinuousJoint => "without meaning on a continuous joint",
            IgnoreReason::Foreign => "of another XML namespace",
            IgnoreReason::Unknown { nearest: None } => "unknown to URDF",
            IgnoreReason::Unknown { nearest: Some(name) } => {
                return write!(f, "unknown to URDF; did you mean `{name}`?");
            }
        };
        f.write_str(text)
    }
}

/// A kind of element or attribute that was ignored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IgnoredItem {
    /// `element`, or `element@attribute`.
    pub name: String,
    /// How often it occurs.
    pub count: usize,
    /// The line of its first occurrence.
    pub first_line: usize,
    /// Why.
    pub reason: IgnoreReason,
}

impl fmt::Display for IgnoredItem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let IgnoredItem { name, count, first_line, .. } = self;
        match count {
            1 => write!(f, "{name} on line {first_line}"),
            _ => write!(f, "{name} {count} times from line {first_line}"),
        }
    }
}

/// All items, those with one reason together.
pub(super) fn write_grouped(f: &mut fmt::Formatter<'_>, items: &[IgnoredItem]) -> fmt::Result {
    let is_first = |k: usize| items[..k].iter().all(|earlier| earlier.reason != items[k].reason);
    for (group, k) in (0..items.len()).filter(|k| is_first(*k)).enumerate() {
        let reason = &items[k].reason;
        f.write_str(if group == 0 { "" } else { "; " })?;
        for (member, item) in items.iter().filter(|item| item.reason == *reason).enumerate() {
            f.write_str(if member == 0 { "" } else { ", " })?;
            write!(f, "{item}")?;
        }
        write!(f, " ({reason})")?;
    }
    Ok(())
}

/// Counts what was ignored.
#[derive(Debug, Default)]
pub(super) struct Tally {
    items: Vec<TallyItem>,
}

#[derive(Debug)]
struct TallyItem {
    name: String,
    reason: IgnoreReason,
    count: usize,
    first: usize,
}

impl Tally {
    /// Names listed apart; the rest is counted together, so that a hostile file gives a short message.
    const MOST_NAMES: usize = 40;

    /// Notes one occurrence of `name` at byte `offset`.
    pub(super) fn add(&mut self, name: String, offset: usize, reason: IgnoreReason) {
        let full = self.items.len() >= Self::MOST_NAMES;
        match self.items.iter_mut().find(|item| item.name == name && item.reason == reason) {
            Some(item) => item.count += 1,
            None if full => {
                let rest = "others".to_owned();
                let unknown = IgnoreReason::Unknown { nearest: None };
                match self.items.iter_mut().find(|item| item.name == rest) {
                    Some(item) => item.count += 1,
                    _ => self.items.push(TallyItem { name: rest, reason: unknown, count: 1, first: offset }),
                }
            }
            None => self.items.push(TallyItem { name, reason, count: 1, first: offset }),
        }
    }

    /// What was counted, with lines in place of byte offsets.
    pub(super) fn into_items(mut self, line_of: impl Fn(usize) -> usize) -> Vec<IgnoredItem> {
        self.items.sort_by_key(|item| item.first);
        self.items
            .into_iter()
            .map(|TallyItem { name, reason, count, first }| IgnoredItem {
                name,
                count,
                first_line: line_of(first),
                reason,
            })
            .collect()
    }
}
