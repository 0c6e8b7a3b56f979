//! Theorem 7: spacecraft that follow an attitude without a measured angular velocity.

use forwardstep_core::expression::Interval;
use forwardstep_core::plant;
use forwardstep_sim::formula::BoundedFormula;
use forwardstep_sim::trajectory::{LeastNorm, Path, Trajectory};
use forwardstep_sim::{AgentSetup, AttitudeLaw, Setup, SpacecraftModel};

use super::{Claim, KindCheck};
use crate::certificate::{Proof, vanishing};
use crate::hypothesis::{Hypothesis, Id, KindEvidence, MotionEvidence, Named, Subject};
use crate::surroundings::acts;
use crate::theorem::Theorem;

pub(crate) struct Spacecraft;

impl KindCheck for Spacecraft {
    fn name(&self) -> &'static str {
        "spacecraft"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        agent.law.is::<AttitudeLaw>()
    }

    fn treated(&self, _: &AgentSetup) -> &'static str {
        "Theorem 7"
    }

    fn claim(&self, _: &Setup) -> Option<Claim> {
        Some(Claim {
            theorem: Theorem::Theorem7,
            promises:
                "the attitude and its rate reach those of the target, Δq_v → 0 and ω − ω_d → 0, without a measured ω"
                    .into(),
        })
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        let mut hypotheses = vec![Hypothesis::new(Id::AttitudeGains, KindEvidence::PositiveMatrices)];
        for index in agents {
            let agent = &setup.agents[*index];
            let subject = || Subject::Agent(Named::of(setup, *index));
            hypotheses.push(Hypothesis::about(Id::KnownMomentum, subject(), momentum(agent)));
            let path = agent.target.as_ref().and_then(|target| never_zero(target, setup.time.end_s));
            hypotheses.extend(path.map(|evidence| Hypothesis::about(Id::NonzeroQuaternion, subject(), evidence)));
        }
        hypotheses
    }

    fn target_derivatives(&self, _: &AgentSetup) -> usize {
        2
    }
}

/// h_I is given to the controller, not measured.
pub(super) fn momentum(agent: &AgentSetup) -> KindEvidence {
    if agent.pushes.iter().any(acts) {
        return KindEvidence::MomentumPushed;
    }
    let Some(SpacecraftModel { inertia_kg_m2, wheels }) = agent.robot.kind.downcast() else {
        return KindEvidence::NoSpacecraft;
    };
    let start = [&agent.start.q[..], &agent.start.dq, &agent.start.rest].concat();
    let plant = plant::Spacecraft::new(*inertia_kg_m2, wheels.clone(), false).ok();
    let momentum = plant.and_then(|plant| plant.momentum_inertial(&start).ok());
    momentum.map_or(KindEvidence::NoSpacecraft, KindEvidence::Momentum)
}

/// More than rounding makes of a norm, as a part of it.
const ROUNDING: f64 = 1e-9;

/// The path of the desired attitude, as a quaternion of any norm, must not pass zero. It stays away from it for ever where
/// one of its entries does, or where it cannot get there between two looks, however fast it moves, and is at rest after the last of them.
pub(super) fn never_zero(target: &Trajectory, end_s: f64) -> Option<MotionEvidence> {
    let away = |axis| {
        let hull = target.hull(axis, 0, None);
        hull.low.max(-hull.high)
    };
    let away = (0..target.axes()).map(away).fold(0.0, f64::max);
    if away > 0.0 {
        return Some(MotionEvidence::EntryAway { least: away });
    }
    let rests_s: Option<Vec<f64>> = target.paths().iter().map(Path::rests_s).collect();
    let until_s = rests_s.iter().flatten().copied().fold(end_s, f64::max);
    let seen = target.least_norm(until_s);
    let square = target.squared_norm().map(|square| BoundedFormula::new(square.sqrt_of(), end_s));
    let least = square.as_ref().map_or(0.0, |norm| norm.for_ever().within.low);
    if let Some(least) = Some(least).filter(|least| *least > 0.0).or_else(|| target.least_turning_norm()) {
        return Some(MotionEvidence::NormAbove { least });
    }
    let fastest = |axis| {
        let speed = target.hull(axis, 1, Some(until_s));
        speed.high.max(-speed.low)
    };
    let speed = (0..target.axes()).map(fastest).map(|speed| speed * speed).sum::<f64>().sqrt();
    let between = speed * 0.5 * seen.every_s;
    let shown = seen.norm - between - ROUNDING * (seen.norm + between);
    let nearest = Some(seen).filter(LeastNorm::vanishes).or_else(|| target.vanishes_later(end_s)).unwrap_or(seen);
    // What comes close to zero, but for rounding, refutes nothing: what does is a proof that others can replay.
    Some(match (vanishing(target, end_s), square) {
        (Some(Proof::Fades), norm) => {
            let above = Interval { low: 0.5 * seen.norm, high: f64::INFINITY };
            MotionEvidence::NormFades { witness: norm.and_then(|norm| norm.seen_outside(above)) }
        }
        (Some(_), _) => MotionEvidence::NormVanishes { t_s: nearest.t_s },
        // Curves through points.
        (None, None) if shown > 0.0 && rests_s.is_some() => MotionEvidence::NormAbove { least: shown },
        (None, _) => MotionEvidence::NormSeen { t_s: nearest.t_s, norm: nearest.norm },
    })
}
