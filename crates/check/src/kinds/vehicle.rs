//! Vehicles with one thrust whose angular velocity is an input: (44)–(58), Theorems 4 and 5.

use forwardstep_core::controller::{Floor, Singularity};
use forwardstep_core::expression::Interval;
use forwardstep_core::reference::polynomial;
use forwardstep_sim::probe::singular_start;
use forwardstep_sim::{AgentSetup, RotorcraftModel, Setup, ThrustKind, ThrustLaw, VehicleModel};

use super::bounds::within_bounds;
use super::{Claim, KindCheck};
use crate::hypothesis::numbers::seconds;
use crate::hypothesis::{Hypothesis, Id, KindEvidence, Named};
use crate::theorem::Theorem;

pub(crate) struct Vehicle;

impl KindCheck for Vehicle {
    fn name(&self) -> &'static str {
        "vehicle"
    }

    fn treats(&self, agent: &AgentSetup) -> bool {
        agent.law.is::<ThrustLaw>() && agent.robot.kind.is::<VehicleModel>()
    }

    fn treated(&self, agent: &AgentSetup) -> &'static str {
        treated(agent)
    }

    fn claim(&self, setup: &Setup) -> Option<Claim> {
        claim(setup)
    }

    fn hypotheses(&self, setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
        outer_law(setup, agents)
    }

    fn target_derivatives(&self, agent: &AgentSetup) -> usize {
        target_derivatives(agent)
    }
}

/// The law of a vehicle or of a rotorcraft.
pub(super) fn law(agent: &AgentSetup) -> Option<&ThrustLaw> {
    agent.law.downcast()
}

/// Whether nothing leads it but itself: (46), where its own acceleration stands in the place of a reference.
pub(crate) fn is_its_own_reference(agent: &AgentSetup) -> bool {
    law(agent).is_some_and(|law| law.design == ThrustKind::Continuous)
}

/// Where a design comes from.
pub(super) fn treated(agent: &AgentSetup) -> &'static str {
    match law(agent).map(|law| law.design) {
        Some(ThrustKind::Continuous) | None => "Section V-B with (46)",
        Some(ThrustKind::Differentiable { .. }) => "Theorem 4",
        Some(ThrustKind::Adaptive { .. }) => "Theorem 5",
        Some(ThrustKind::ByAcceleration { .. }) => "thrust by a measured acceleration",
    }
}

/// The theorem about vehicles that all have the design of the first, and what it promises.
pub(super) fn claim(setup: &Setup) -> Option<Claim> {
    const JUMPS: &str = "thrust and attitude stay continuous through switches and delay jumps, angular velocities jump";
    const SMOOTH: &str = "angular velocities and the rate of the thrust stay continuous through switches and delay jumps, with \
                          bounded derivatives";
    let (theorem, smooth) = match law(setup.agents.first()?)?.design {
        ThrustKind::Continuous => (Theorem::ContinuousThrust, JUMPS),
        ThrustKind::Differentiable { .. } => (Theorem::Theorem4, SMOOTH),
        ThrustKind::Adaptive { .. } => (Theorem::Theorem5, SMOOTH),
        ThrustKind::ByAcceleration { .. } => (Theorem::ThrustByAcceleration, JUMPS),
    };
    let agreed = if setup.agents.iter().any(|agent| agent.target.is_some()) {
        "with y = x − offset all vehicles agree on y, and it comes to rest: yᵢ − yⱼ → 0 and ẏᵢ → 0"
    } else {
        "all vehicles agree and come to rest: xᵢ − xⱼ → 0 and ẋᵢ → 0"
    };
    Some(Claim { theorem, promises: format!("{agreed}; {smooth}") })
}

/// What the outer law asks for, with or without a body.
pub(super) fn outer_law(setup: &Setup, agents: &[usize]) -> Vec<Hypothesis> {
    let always = [gains(setup, agents), thrust(setup, agents)];
    always.into_iter().chain(unbiased(setup, agents)).chain(within_bounds(setup, agents)).collect()
}

/// What is known of accelerometers, where there are any.
fn unbiased(setup: &Setup, agents: &[usize]) -> Option<Hypothesis> {
    let biases = with_laws(setup, agents).filter_map(|(index, agent, law)| match law.design {
        ThrustKind::ByAcceleration { bias, .. } => Some((index, agent, bias)),
        ThrustKind::Continuous | ThrustKind::Differentiable { .. } | ThrustKind::Adaptive { .. } => None,
    });
    let mut evidence = None;
    for (index, agent, bias) in biases {
        if bias != [0.0; 3] {
            // p² + (α+β) p + αβ: ẋ₃ of the head of `accelerated` with d from zero to infinity.
            let roots = polynomial(&agent.roots_per_s).ok().filter(|of| of.len() > 1 && of[0] > 0.0 && bias[2] != 0.0);
            let drift_m_s = roots.map(|of| [bias[2] / of[1], bias[2] * of[1] / of[0]]);
            evidence = Some(KindEvidence::AccelerationBiased { agent: Named::of(setup, index), drift_m_s });
            break;
        }
        evidence = Some(KindEvidence::AccelerationUnbiased);
    }
    evidence.map(|evidence| Hypothesis::new(Id::UnbiasedAcceleration, evidence))
}

/// Agents with their laws.
pub(super) fn with_laws<'a>(
    setup: &'a Setup,
    agents: &'a [usize],
) -> impl Iterator<Item = (usize, &'a AgentSetup, &'a ThrustLaw)> {
    agents.iter().filter_map(|index| {
        let agent = &setup.agents[*index];
        Some((*index, agent, law(agent)?))
    })
}

fn gains(setup: &Setup, agents: &[usize]) -> Hypothesis {
    let keeps_a_wrong_mass = |agent: &AgentSetup, law: &ThrustLaw| {
        law.design.adaptation() == Some(0.0) && agent.robot.theta.first().copied() != law.design.estimate_start()
    };
    if with_laws(setup, agents).all(|(_, _, law)| law.design == ThrustKind::Continuous) {
        return Hypothesis::new(Id::KnownMasses, KindEvidence::MassOfPlant);
    }
    let wrong = with_laws(setup, agents).find(|(_, agent, law)| keeps_a_wrong_mass(agent, law));
    let evidence = wrong.map_or(KindEvidence::PositiveNumbers, |(index, ..)| KindEvidence::MassNotAdapted {
        agent: Named::of(setup, index),
    });
    Hypothesis::new(Id::ThrustGains, evidence)
}

fn thrust(setup: &Setup, agents: &[usize]) -> Hypothesis {
    let kept = with_laws(setup, agents).find_map(|(index, _, law)| match law.floor {
        Floor::Kept { floor, .. } => Some((index, floor)),
        Floor::Stops(_) => None,
    });
    let floors = with_laws(setup, agents).map(|(_, _, law)| law.floor.newtons());
    let starts = with_laws(setup, agents).find_map(|(index, ..)| {
        let Singularity::Vanishes { value, floor, .. } = singular_start(setup, index).ok()??;
        Some(KindEvidence::ThrustAtStart { agent: Named::of(setup, index), thrust_n: value, floor_n: floor })
    });
    let falls =
        with_laws(setup, agents).find_map(|(index, agent, law)| falls(setup, index, agent, law.floor.newtons()));
    let evidence = starts.or(falls).unwrap_or_else(|| match kept {
        Some((index, floor_n)) => KindEvidence::ThrustKept { agent: Named::of(setup, index), floor_n },
        None => KindEvidence::ThrustFloor { least_n: floors.fold(f64::INFINITY, f64::min) },
    });
    Hypothesis::new(Id::NonzeroThrust, evidence)
}

/// Looks at the acceleration of an offset during a run.
const LOOKS: u32 = 4000;

/// That an offset d takes its thrust below the floor. x − d comes to rest where all agree, and its derivatives vanish, so that σ R e₃ comes to
/// m (g e₃ − d̈): what that is at one time it is again and again, if d̈ comes back. A d̈ that does not may be over before anybody agrees.
fn falls(setup: &Setup, index: usize, agent: &AgentSetup, floor_n: f64) -> Option<KindEvidence> {
    let kind = &agent.robot.kind;
    let of_vehicle = kind.downcast().map(|VehicleModel { gravity }| *gravity);
    let gravity = of_vehicle.or_else(|| kind.downcast().map(|RotorcraftModel { gravity, .. }| *gravity))?;
    let (mass, offset) = (*agent.robot.theta.first()?, agent.target.as_ref()?);
    let weight = [0.0, 0.0, gravity];
    let nearest = |(axis, weight): (usize, &f64)| {
        let within = Interval::point(*weight) - offset.hull(axis, 2, None);
        within.low.max(-within.high).max(0.0)
    };
    let least = mass * norm(weight.iter().enumerate().map(nearest));
    if offset.axes() != weight.len() || least > floor_n || !offset.derivatives_recur() {
        return None;
    }
    let thrust_n = |t_s: f64| {
        let mut jets = [[0.0; 5]; 3];
        offset.jets(t_s, &mut jets);
        mass * norm(jets.iter().zip(weight).map(|(jet, weight)| weight - jet[2]))
    };
    let time = |look: u32| setup.time.end_s * f64::from(look) / f64::from(LOOKS);
    (0..=LOOKS).find_map(|look| {
        let [mut left, mut right] = [time(look.saturating_sub(1)), time(look + 1)];
        // What is not lowest here is looked at where it is.
        if thrust_n(time(look)) > thrust_n(left).min(thrust_n(right)) {
            return None;
        }
        for _ in 0..60 {
            let third = (right - left) / 3.0;
            if thrust_n(left + third) < thrust_n(right - third) { right -= third } else { left += third }
        }
        let t_s = seconds(left);
        let found = KindEvidence::FallsFreely { agent: Named::of(setup, index), t_s, thrust_n: thrust_n(t_s), floor_n };
        // By more than rounding.
        (thrust_n(t_s) < floor_n * (1.0 - 1e-9)).then_some(found)
    })
}

fn norm(entries: impl Iterator<Item = f64>) -> f64 {
    entries.map(|entry| entry * entry).sum::<f64>().sqrt()
}

/// Those that the reference dynamics are differentiated into.
pub(super) fn target_derivatives(agent: &AgentSetup) -> usize {
    law(agent).map_or(2, |law| law.design.order()) + 1
}
