//! What acts beside the torques and forces about axes: the thrust of a body, its rotors, its wheels.

use forwardstep_core::plant::Rotors;
use forwardstep_sim::recording::Signal;
use forwardstep_sim::setup::{AgentSetup, Setup};
use forwardstep_sim::{LineValue, RotorcraftModel};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::metrics::{LimitKind, Peak, peak};
use super::names;
use super::table::Table;

/// What a plant is driven by, or takes up, without an axis.
const SIGNALS: [Signal; 4] = [Signal::Thrust, Signal::ThrustRate, Signal::WheelTorque, Signal::WheelMomentum];

/// The largest magnitude of one entry of such a signal, or of one rotor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Load {
    /// Of what: the symbol of the signal, or `rotor`.
    #[schemars(with = "String")]
    pub kind: LimitKind,
    /// Where and when; the axis is the entry of the signal, or the rotor.
    #[serde(flatten)]
    pub peak: Peak,
    /// What it must not exceed, where that is known.
    pub limit: Option<f64>,
}

impl Load {
    /// Of what, in words: `thrust`, `rotor 2`, `torque of wheel 1`.
    pub fn words(&self) -> String {
        let number = self.peak.axis + 1;
        match self.kind {
            LimitKind::Rotor => format!("rotor {number}"),
            LimitKind::Signal(Signal::Thrust) => "thrust".into(),
            LimitKind::Signal(Signal::ThrustRate) => "rate of the thrust".into(),
            LimitKind::Signal(Signal::WheelTorque) => format!("torque of wheel {number}"),
            LimitKind::Signal(Signal::WheelMomentum) => format!("momentum of wheel {number}"),
            kind => format!("{kind:?} {number}"),
        }
    }

    /// The unit of its value.
    pub fn unit(&self, setup: &Setup) -> String {
        let signal = if let LimitKind::Signal(signal) = self.kind { signal } else { Signal::Thrust };
        names::unit(setup, self.peak.agent, signal, self.peak.axis)
    }
}

/// All of them, by agents.
pub(super) fn loads(table: &Table<'_>) -> Vec<Load> {
    let mut found = Vec::new();
    for (agent, setup) in table.setup.agents.iter().enumerate() {
        for signal in SIGNALS {
            let entries = (0..).map_while(|entry| Some((entry, table.column(agent, signal, entry)?)));
            found.extend(entries.filter_map(|(entry, values)| {
                let (kind, limit) = (LimitKind::Signal(signal), limit(setup, signal, entry));
                Some(Load { kind, peak: peak(table, agent, entry, values)?, limit })
            }));
        }
        if let Some((rotors, thrusts)) = rotor_thrusts(table, agent) {
            let limit = Some(rotors.thrust[1]);
            let of = |(rotor, values): (usize, &Vec<f64>)| peak(table, agent, rotor, values);
            found.extend(thrusts.iter().enumerate().filter_map(of).map(|peak| Load {
                kind: LimitKind::Rotor,
                peak,
                limit,
            }));
        }
    }
    found
}

fn limit(agent: &AgentSetup, signal: Signal, entry: usize) -> Option<f64> {
    let lines = agent.robot.interface().lines;
    let mut own = lines.iter().filter(|line| (line.signal, line.entry) == (signal, entry));
    own.find_map(|line| match line.value {
        LineValue::Limit(limit) | LineValue::Clip(limit) => Some(limit),
        LineValue::Floor(_) | LineValue::Truth(_) => None,
    })
}

/// The thrust of every rotor of a rotorcraft at every row, which is worked out from σ and τ; `None` for what has no rotors.
pub(super) fn rotor_thrusts(table: &Table<'_>, agent: usize) -> Option<(Rotors, [Vec<f64>; 4])> {
    let model = table.setup.agents.get(agent)?.robot.kind.downcast::<RotorcraftModel>()?;
    let rotors = model.rotors?;
    let column = |signal, entry| table.column(agent, signal, entry);
    let (sigma, x) = (column(Signal::Thrust, 0)?, column(Signal::Torque, 0)?);
    let (y, z) = (column(Signal::Torque, 1)?, column(Signal::Torque, 2)?);
    let [least, most] = rotors.thrust;
    let mut thrusts = [const { Vec::new() }; 4];
    for (((sigma, x), y), z) in sigma.iter().zip(x).zip(y).zip(z) {
        let found = rotors.thrusts(*sigma, [*x, *y, *z]);
        thrusts.iter_mut().zip(found).for_each(|(values, value)| values.push(value.clamp(least, most)));
    }
    Some((rotors, thrusts))
}
