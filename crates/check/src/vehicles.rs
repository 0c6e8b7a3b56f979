//! What Section V-B asks for: vehicles with one thrust, and what the paper does not have: rotorcraft.

use forwardstep_core::controller::Floor;
use forwardstep_sim::{AgentSetup, RotorcraftModel, Setup, ThrustKind, ThrustLaw};

use crate::verdict::{Answer, Hypothesis, rounded};

/// Where a design comes from.
pub(crate) fn source(design: ThrustKind) -> &'static str {
    match design {
        ThrustKind::Continuous => "Section V-B with (46)",
        ThrustKind::Differentiable { .. } => "Theorem 4",
        ThrustKind::Adaptive { .. } => "Theorem 5",
    }
}

/// The theorem about vehicles that all have this design, and what it promises.
pub(crate) fn theorem(setup: &Setup, design: ThrustKind) -> (String, String) {
    let theorem = match design {
        ThrustKind::Continuous => "Section V-B, continuous control (45), (46)",
        ThrustKind::Differentiable { .. } => "Theorem 4, (50) with the reference dynamics (49)",
        ThrustKind::Adaptive { .. } => "Theorem 5, (57) and (58) with the reference dynamics (49)",
    };
    let agreed = if setup.agents.iter().any(|agent| agent.target.is_some()) {
        "with y = x − offset all vehicles agree on y, and it comes to rest: y_i − y_j → 0 and dy_i → 0"
    } else {
        "all vehicles agree and come to rest: x_i − x_j → 0 and dx_i → 0"
    };
    let smooth = match design {
        ThrustKind::Continuous => {
            "thrust and attitude stay continuous through switches and delay jumps, angular velocities jump"
        }
        _ => "angular velocities and the rate of the thrust stay differentiable through switches and delay jumps",
    };
    (theorem.into(), format!("{agreed}; {smooth}"))
}

/// Vehicles with their laws.
fn flown(setup: &Setup) -> impl Iterator<Item = (&AgentSetup, &ThrustLaw)> {
    setup.agents.iter().filter_map(|agent| Some((agent, agent.law.downcast()?)))
}

/// What the control of vehicles asks for.
pub(crate) fn of_vehicles(setup: &Setup) -> Vec<Hypothesis> {
    if flown(setup).next().is_none() {
        return Vec::new();
    }
    let mut hypotheses = vec![gains(setup), thrust(setup)];
    hypotheses.extend(rates(setup));
    hypotheses.extend(rotors(setup));
    hypotheses
}

fn gains(setup: &Setup) -> Hypothesis {
    let alone = flown(setup).all(|(_, law)| matches!(law.design, ThrustKind::Continuous));
    let requires = if alone {
        "the masses are known"
    } else {
        "α*, k and γ* are positive, and a mass that is not adapted is known"
    };
    let requires = requires.into();
    let wrong = flown(setup).find(|(agent, law)| match law.design {
        ThrustKind::Adaptive { gamma_star, estimate_start, .. } => {
            gamma_star == 0.0 && agent.robot.theta.first() != Some(&estimate_start)
        }
        _ => false,
    });
    match wrong {
        Some((agent, _)) => Hypothesis {
            requires,
            answer: Answer::NotCovered,
            because: format!("{} does not adapt its estimate, which is not the true mass", agent.name),
        },
        None => Hypothesis {
            requires,
            answer: Answer::Holds,
            because: if alone { "the law has that of the vehicle" } else { "checked when they were read" }.into(),
        },
    }
}

fn thrust(setup: &Setup) -> Hypothesis {
    let requires = "no thrust comes to zero".into();
    let kept = flown(setup).find_map(|(agent, law)| match law.floor {
        Floor::Kept { floor, .. } => Some((agent, floor)),
        Floor::Stops(_) => None,
    });
    let lowest = flown(setup).map(|(_, law)| law.floor.newtons()).fold(f64::INFINITY, f64::min);
    match kept {
        Some((agent, floor)) => Hypothesis {
            requires,
            answer: Answer::NotCovered,
            because: format!(
                "that of {} is kept above {} N by a saturation; where it acts the vehicle does not do what the law asks for",
                agent.name,
                rounded(floor)
            ),
        },
        None => Hypothesis {
            requires,
            answer: Answer::Watched,
            because: format!("the run ends where one falls to its floor, the lowest of which is {} N", rounded(lowest)),
        },
    }
}

fn rates(setup: &Setup) -> Option<Hypothesis> {
    let slowest = flown(setup).filter(|(agent, _)| agent.robot.kind.is::<RotorcraftModel>());
    let (agent, law) = slowest.min_by(|a, b| a.1.bandwidth_per_s.total_cmp(&b.1.bandwidth_per_s))?;
    let foreseen = match law.design {
        ThrustKind::Continuous => "its rate cannot be foreseen, so the body lags behind",
        ThrustKind::Differentiable { .. } => "its rate is foreseen, so what the body misses dies out",
        ThrustKind::Adaptive { .. } => "its rate is foreseen as well as the mass is known",
    };
    Some(Hypothesis {
        requires: "the angular velocity is the one that the law asks for".into(),
        answer: Answer::NotCovered,
        because: format!(
            "{} is a rigid body that torques turn with a bandwidth of {} per second; {foreseen}",
            agent.name, law.bandwidth_per_s
        ),
    })
}

fn rotors(setup: &Setup) -> Option<Hypothesis> {
    let limited = flown(setup).find_map(|(agent, _)| {
        let RotorcraftModel { rotors, .. } = agent.robot.kind.downcast()?;
        Some((agent, rotors.as_ref()?.thrust))
    });
    limited.map(|(agent, [least, most])| Hypothesis {
        requires: "every thrust and every torque can be had".into(),
        answer: Answer::NotCovered,
        because: format!("the rotors of {} give {least} N to {most} N each", agent.name),
    })
}
