//! Evidence of what surrounds a law: gains, pushes, limits, sampling.

use crate::hypothesis::{Answer, Named, Rigour};

/// What was found of the loop around a law.
#[derive(Clone, Debug, PartialEq)]
pub enum LoopEvidence {
    /// K and Γ are positive definite in exact arithmetic, refused otherwise when they were read.
    Gains {
        /// To how many agents the parameters are known; the others adapt.
        known: usize,
        /// All agents.
        agents: usize,
    },
    /// What is pushed, and until when.
    Pushes {
        /// Everybody whom something acts on.
        pushed: Vec<Named>,
        /// Which robots under (6)–(7) a torque acts on for ever whose square has a finite integral.
        fading: Vec<Named>,
        /// Which robots under (6)–(7) a force or a torque acts on for ever.
        torques_for_ever: Vec<Named>,
        /// Whom else something acts on for ever.
        others_for_ever: Vec<Named>,
        /// On whom a virtual spring acts for ever.
        springs_for_ever: Vec<Named>,
        /// Whom something acts on that ends, and is not shown to have a bounded value until then.
        unbounded: Vec<Named>,
        /// When the last push ends that does not fade, s; infinite where one does not end.
        last_end_s: f64,
    },
    /// What keeps a torque from being applied as asked for.
    Applied {
        /// Actuators that do.
        limited: Vec<Limited>,
        /// Agents with enforced limits.
        enforced: Vec<Named>,
    },
    /// The controllers sample.
    Sampling {
        /// At this rate, Hz.
        sample_hz: f64,
        /// Torques come so much later, s.
        computation_delay_s: f64,
    },
    /// How measurements are inexact.
    Measurements(Vec<Inexact>),
    /// The joints of some rub, and by what.
    Friction {
        /// Those whose friction is set-valued.
        dry: Vec<Named>,
        /// κ Σ ε F of them: what V may gain at most, W.
        most_w: f64,
    },
}

/// What an actuator does not do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limited {
    /// Give any torque.
    Torque,
    /// Change it at any rate.
    TorqueRate,
    /// Resolve it.
    TorqueQuantum,
    /// Turn rotors at any speed: of these `every-wrench` tells more.
    Thrust,
}

/// What makes a measurement inexact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inexact {
    /// Noise.
    Noise,
    /// Quantisation.
    Quantum,
    /// Velocities from filtered differences.
    Filter,
}

impl LoopEvidence {
    pub(super) fn answer(&self) -> Answer {
        let unless = |spoiled: bool| if spoiled { Answer::NotCovered } else { Answer::Holds };
        match self {
            LoopEvidence::Gains { .. } => Answer::Holds,
            LoopEvidence::Pushes { torques_for_ever, others_for_ever, springs_for_ever, unbounded, .. } => {
                match unless([torques_for_ever, others_for_ever, springs_for_ever].iter().any(|all| !all.is_empty())) {
                    Answer::Holds if !unbounded.is_empty() => Answer::NotShown,
                    answer => answer,
                }
            }
            LoopEvidence::Applied { limited, enforced } => unless(!limited.is_empty() || !enforced.is_empty()),
            LoopEvidence::Sampling { .. } => Answer::NotCovered,
            LoopEvidence::Measurements(inexact) => unless(!inexact.is_empty()),
            LoopEvidence::Friction { dry, .. } => unless(!dry.is_empty()),
        }
    }

    pub(super) fn rigour(&self) -> Rigour {
        match self {
            LoopEvidence::Gains { .. }
            | LoopEvidence::Pushes { .. }
            | LoopEvidence::Applied { .. }
            | LoopEvidence::Sampling { .. }
            | LoopEvidence::Measurements(_)
            | LoopEvidence::Friction { .. } => Rigour::Exact,
        }
    }
}
