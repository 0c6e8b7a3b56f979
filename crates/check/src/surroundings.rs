//! What surrounds a law: pushes, limits, sampling.

use forwardstep_core::expression::Interval;
use forwardstep_core::robot::{Friction, SMOOTHING_LOSS};
use forwardstep_sim::push::{Course, Effect, Function, Push};
use forwardstep_sim::{AgentSetup, Setup, VelocitySensor};

use crate::certificate::fades;
use crate::hypothesis::{Hypothesis, Id, Inexact, Limited, LoopEvidence, Named};
use crate::kinds::{is_lagrangian, rotors_of};
use crate::links::messages_in_time;

/// What every theorem asks of what surrounds its law.
pub(crate) fn surroundings(setup: &Setup) -> Vec<Hypothesis> {
    let mut hypotheses: Vec<Hypothesis> = pushes_end(setup).into_iter().chain([applied_torque(setup)]).collect();
    hypotheses.extend(friction(setup));
    hypotheses.extend(digital(setup));
    hypotheses
}

/// τ_ext feeds V by sᵀτ_ext, and what else acts by a factor that V bounds. What ends leaves V finite, and from then on everything
/// is as without it.
fn pushes_end(setup: &Setup) -> Option<Hypothesis> {
    let pushed = |some: fn(&AgentSetup, &Push) -> bool| -> Vec<Named> {
        let agents = setup.agents.iter().enumerate();
        let those = agents.filter(|(_, agent)| agent.pushes.iter().any(|push| acts(push) && some(agent, push)));
        those.map(|(index, _)| Named::of(setup, index)).collect()
    };
    let all = pushed(|_, _| true);
    if all.is_empty() {
        return None;
    }
    let evidence = LoopEvidence::Pushes {
        pushed: all,
        fading: pushed(is_fading),
        torques_for_ever: pushed(|agent, push| {
            endless(push) && !push.is_spring() && is_lagrangian(agent) && !is_fading(agent, push)
        }),
        others_for_ever: pushed(|agent, push| endless(push) && !push.is_spring() && !is_lagrangian(agent)),
        springs_for_ever: pushed(|_, push| endless(push) && push.is_spring()),
        unbounded: pushed(|_, push| !endless(push) && !is_bounded(push)),
        last_end_s: last_end_s(setup),
    };
    Some(Hypothesis::new(Id::PushesEnd, evidence))
}

/// When the last push ends of those that do not fade, s.
pub(crate) fn last_end_s(setup: &Setup) -> f64 {
    let all = setup.agents.iter().flat_map(|agent| agent.pushes.iter().map(move |push| (agent, push)));
    let ending = all.filter(|(agent, push)| acts(push) && !is_fading(agent, push));
    ending.map(|(_, push)| ends_s(push)).fold(0.0, f64::max)
}

/// Whether a torque on the axes of a robot under (6)–(7) never ends, and its square has a finite integral: V̇ ≤ −sᵀKs + sᵀτ then leaves V bounded
/// and s square-integrable. A force on a link comes with a factor that may depend on where the robot is.
fn is_fading(agent: &AgentSetup, push: &Push) -> bool {
    let Effect::Torque(Course::Each(functions)) = &push.effect else { return false };
    let each = |function: &Function| match function {
        Function::Constant(value) => *value == 0.0,
        Function::Formula(formula) => fades(formula),
    };
    endless(push) && is_lagrangian(agent) && functions.iter().all(each)
}

/// Whether it acts at some time.
pub(crate) fn acts(push: &Push) -> bool {
    let [begins_s, ends_s] = push.span_s();
    begins_s < ends_s
}

/// Whether it never ends, as far as is known.
pub(crate) fn endless(push: &Push) -> bool {
    ends_s(push) == f64::INFINITY
}

/// Whether it is shown to have a bounded value from when it begins until it ends, which may be after the run: only then it leaves V finite.
fn is_bounded(push: &Push) -> bool {
    let ([begins_s, _], ends_s) = (push.span_s(), ends_s(push));
    match push.course() {
        Course::Each(functions) => functions.iter().all(|function| match function {
            Function::Constant(_) => true,
            Function::Formula(formula) => formula.is_bounded(begins_s, ends_s),
        }),
        Course::Table(_) => true,
    }
}

/// Doublings of a second after which formulas are looked at.
const DOUBLINGS: i32 = 24;

/// When a push ends, s; one without an end, too, where its formulas are zero from some time on. A hand does not let go at zero.
pub(crate) fn ends_s(push: &Push) -> f64 {
    let [_, ends_s] = push.span_s();
    let zero_from = |from_s: f64| match push.course() {
        Course::Each(functions) => functions.iter().all(|function| match function {
            Function::Constant(value) => *value == 0.0,
            Function::Formula(formula) => formula.bounds(from_s, f64::INFINITY) == Interval::point(0.0),
        }),
        Course::Table(_) => false,
    };
    if ends_s < f64::INFINITY || push.is_spring() {
        return ends_s;
    }
    let times = std::iter::once(0.0).chain((0..DOUBLINGS).map(|k| libm::ldexp(1.0, k)));
    times.into_iter().find(|from_s| zero_from(*from_s)).unwrap_or(f64::INFINITY)
}

/// What keeps the torque from being what the law asks for.
fn applied_torque(setup: &Setup) -> Hypothesis {
    let enforced: Vec<usize> = (0..setup.agents.len()).filter(|agent| setup.agents[*agent].enforce_limits).collect();
    let mut limited = setup.control.as_ref().map_or_else(Vec::new, |control| {
        let actuators = &control.actuators;
        let each = [
            (actuators.torque_limit.is_some(), Limited::Torque),
            (actuators.torque_rate_limit.is_some(), Limited::TorqueRate),
            (actuators.torque_quantum > 0.0, Limited::TorqueQuantum),
        ];
        each.into_iter().filter(|(is, _)| *is).map(|(_, limited)| limited).collect()
    });
    if setup.agents.iter().any(|agent| rotors_of(agent).is_some()) {
        limited.push(Limited::Thrust);
    }
    let evidence = LoopEvidence::Applied { limited, enforced: Named::all(setup, &enforced) };
    Hypothesis::new(Id::AppliedTorque, evidence)
}

/// Friction at the joints: what is smooth damps, of what is dry V gains at most κ Σ ε F.
fn friction(setup: &Setup) -> Option<Hypothesis> {
    let rubbing = |index: &usize| !setup.agents[*index].robot.interface().drives.friction.is_empty();
    let those: Vec<usize> = (0..setup.agents.len()).filter(rubbing).collect();
    let dry: Vec<usize> = those.iter().copied().filter(|index| dry_loss_w(&setup.agents[*index]).is_some()).collect();
    let most_w = dry.iter().filter_map(|index| dry_loss_w(&setup.agents[*index])).sum();
    let evidence = LoopEvidence::Friction { dry: Named::all(setup, &dry), most_w };
    (!those.is_empty()).then(|| Hypothesis::new(Id::SmoothFriction, evidence))
}

/// F tanh(v/ε) of an agent, joint by joint, and whether its robot has that and not F σ; `None` where nothing rubs.
pub(crate) fn smoothed_friction(agent: &AgentSetup, v: &[f64]) -> Option<(Vec<f64>, bool)> {
    let drives = agent.robot.interface().drives;
    let [.., forces] = agent.robot.drive_parameters(&drives)?;
    let mut torque = vec![0.0; v.len()];
    for (Friction { joint, width }, force) in drives.friction.iter().zip(forces) {
        *torque.get_mut(*joint)? = force * libm::tanh(v.get(*joint)? / width);
    }
    (!drives.friction.is_empty()).then_some((torque, drives.dry_s.is_none()))
}

/// κ Σ ε F of an agent whose friction is dry, W: what V gains by it at most.
pub(crate) fn dry_loss_w(agent: &AgentSetup) -> Option<f64> {
    let drives = agent.robot.interface().drives;
    drives.dry_s.filter(|_| !drives.friction.is_empty())?;
    let [.., forces] = agent.robot.drive_parameters(&drives)?;
    let losses = drives.friction.iter().zip(forces).map(|(friction, force)| friction.width * force);
    Some(SMOOTHING_LOSS * losses.sum::<f64>())
}

/// Under digital control: the theorems speak of continuous time and of exact measurements.
fn digital(setup: &Setup) -> Vec<Hypothesis> {
    let Some(control) = &setup.control else { return Vec::new() };
    let sensors = &control.sensors;
    let filtered = match sensors.velocity {
        VelocitySensor::Filtered { .. } => true,
        VelocitySensor::Measured => false,
    };
    let sampling =
        LoopEvidence::Sampling { sample_hz: control.sample_hz, computation_delay_s: control.computation_delay_s };
    let mut hypotheses = vec![Hypothesis::new(Id::ContinuousTime, sampling)];
    let each = [
        (
            sensors.position_noise > 0.0 || sensors.velocity_noise > 0.0 || sensors.tip_velocity_noise > 0.0,
            Inexact::Noise,
        ),
        (sensors.position_quantum > 0.0 || sensors.velocity_quantum > 0.0, Inexact::Quantum),
        (filtered, Inexact::Filter),
    ];
    let inexact: Vec<Inexact> = each.into_iter().filter(|(is, _)| *is).map(|(_, inexact)| inexact).collect();
    if !inexact.is_empty() {
        hypotheses.push(Hypothesis::new(Id::ExactMeasurements, LoopEvidence::Measurements(inexact)));
    }
    hypotheses.extend(messages_in_time(setup));
    hypotheses
}
