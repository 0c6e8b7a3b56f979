//! What to change in motions, kinds of systems and robots.

use forwardstep_sim::probe::Probe;

use super::super::names;
use super::super::numbers::{rounded_down, rounded_up};
use super::super::robots::edge;
use super::SHIPPED;
use crate::hypothesis::{
    Bounded, FactorEverywhere, KindEvidence, MotionEvidence, Named, ReachSide, RobotEvidence, Term,
};

pub(super) fn motion(evidence: &MotionEvidence) -> Option<String> {
    Some(match evidence {
        MotionEvidence::Derivatives(Bounded::Unbounded { derivative, .. }) => match derivative {
            0 => "a motion that stays in bounds".into(),
            1 => "a motion whose velocity stays in bounds".into(),
            _ => "a motion whose derivatives stay in bounds, such as one of sines".into(),
        },
        MotionEvidence::Derivatives(Bounded::NotShown) => {
            "a motion of sines, of points, or of formulas that repeat or settle: they can be bounded for all time"
                .into()
        }
        MotionEvidence::Derivatives(Bounded::Jumps) => "a motion of sines or of formulas".into(),
        MotionEvidence::OfAgent => "a leader whose motion is given before the run".into(),
        MotionEvidence::NormSeen { .. } => {
            "an entry that keeps its sign, so that the norm has a bound for all time".into()
        }
        MotionEvidence::NormFades { .. } | MotionEvidence::NormVanishes { .. } => {
            "a quaternion with an entry that keeps away from zero".into()
        }
        MotionEvidence::Derivatives(Bounded::ForEver)
        | MotionEvidence::EntryAway { .. }
        | MotionEvidence::NormAbove { .. } => return None,
    })
}

pub(super) fn kind(evidence: &KindEvidence) -> Option<String> {
    /// What the run shows, no text does.
    const RUN: &str = "nothing does before a run: it is watched, and a run in which it fails ends there";
    Some(match evidence {
        KindEvidence::Mixture(_) => "agents of one kind".into(),
        KindEvidence::Probed { probe: Probe { found: Some(_), .. }, .. } => {
            "a law of which what is declared is so".into()
        }
        KindEvidence::Declared { .. } | KindEvidence::Probed { probe: Probe { found: None, .. }, .. } => SHIPPED.into(),
        KindEvidence::MassNotAdapted { agent } => {
            format!("`adaptation_gain` above zero for {}, or the true mass as its estimate", agent.name)
        }
        KindEvidence::ThrustFloor { .. }
        | KindEvidence::BoundedStates { .. }
        | KindEvidence::SingularValue { .. }
        | KindEvidence::Determinant { .. } => RUN.into(),
        KindEvidence::FallsFreely { agent, .. } => {
            format!("an offset of {} whose acceleration keeps away from that of free fall", agent.name)
        }
        KindEvidence::AttitudeNotShown { .. } | KindEvidence::HalfTurn => {
            "a start, or an attitude of the target, that is not half a turn away".into()
        }
        KindEvidence::ThrustKept { agent, .. } => format!(
            "`floor.stops_n` for {} in the place of `floor.kept`: the law then does what it is asked for, and a run ends where it cannot",
            agent.name
        ),
        KindEvidence::Rotors { .. } => {
            "thrusts without ends: these belong to the vehicle, so compare the run with one in which they do not act"
                .into()
        }
        KindEvidence::AngularRate { agent, .. } => {
            format!(
                "`robot.vehicle` for {} and every other rotorcraft, whose angular velocity is that which the law asks for",
                agent.name
            )
        }
        KindEvidence::TermFails { term, at, .. } => {
            let what = match term {
                Term::Drift => "a χ",
                Term::Regressor => "a regressor",
                Term::Factor => "a ψ",
            };
            let states = if at.is_empty() { "" } else { " in every state, as 1/(1 + x^2) in the place of 1/x" };
            format!("{what} with a value{states}")
        }
        KindEvidence::TermNotShown { .. } => {
            "divisors, roots and logarithms of what is clearly positive, such as 1 + x^2".into()
        }
        KindEvidence::TermNotSmooth { derivatives, .. } => {
            format!(
                "powers with whole exponents, with exponents of {derivatives} or more, or of what is clearly positive, such as 1 + x^2"
            )
        }
        KindEvidence::FactorBelowFloor { agent, value: 0.0, .. } => away_from_zero(agent),
        KindEvidence::FactorBelowFloor { agent, value, .. } => {
            format!("`floor` below {} for {}", rounded_down(value.abs()), agent.name)
        }
        KindEvidence::FactorAtStart { agent, value, floor } => {
            let start = format!("a start of {} at which that exceeds {} in magnitude", agent.name, rounded_up(*floor));
            match value.abs() {
                0.0 => start,
                size => format!("`floor` below {} for {}, or {start}", rounded_down(size), agent.name),
            }
        }
        KindEvidence::ThrustAtStart { agent, thrust_n, floor_n } => format!(
            "`law.thrust.thrust_start_n` above {} for {}, or a `floor` below {}",
            rounded_up(*floor_n),
            agent.name,
            rounded_down(*thrust_n)
        ),
        KindEvidence::Unmoved { agent, equation } => {
            format!("a term of x{} in equation {} of {}, such as x{0} itself", equation + 2, equation + 1, agent.name)
        }
        KindEvidence::FactorSingular { agent } => {
            format!("rows of ψ for {} of which none follows from the others", agent.name)
        }
        KindEvidence::FactorFloor { agent, everywhere, matrix, .. } => match everywhere {
            FactorEverywhere::Away { least } => {
                format!("`floor` of at most {} for {}", rounded_down(*least), agent.name)
            }
            FactorEverywhere::Fades | FactorEverywhere::Zero(_) | FactorEverywhere::Unknown if *matrix => {
                format!(
                    "a ψ for {} whose diagonal outweighs the rest of its rows and columns in every state",
                    agent.name
                )
            }
            FactorEverywhere::Slopes => {
                format!(
                    "`robot.strict_feedback` for {}, where its equations allow that: its factor is ψ alone",
                    agent.name
                )
            }
            FactorEverywhere::Fades | FactorEverywhere::Zero(_) | FactorEverywhere::Unknown => away_from_zero(agent),
        },
        KindEvidence::RankDeficient { .. } => "a start at which the Jacobian is not singular".into(),
        KindEvidence::NoTip => "an `end_effector` that the robot has".into(),
        KindEvidence::LengthsInRegressor(lengths) => {
            format!("{} known, or only the tool unknown", lengths.join(", "))
        }
        KindEvidence::LengthsNotAdapted { agent } => {
            format!("`kinematic_gain` above zero for {}, or the true lengths as its estimates", agent.name)
        }
        KindEvidence::ParameterOutside { value, bounds: [low, _], .. } if value < low => {
            format!("a lower one of `bounds` of at most {}, since it is {value}", rounded_down(*value))
        }
        KindEvidence::ParameterOutside { value, .. } => {
            format!("an upper one of `bounds` of at least {}, since it is {value}", rounded_up(*value))
        }
        KindEvidence::MomentumPushed => "no torque from outside".into(),
        KindEvidence::TurningTarget => {
            "`law.attitude`, whose reference has its own dynamics, or an attitude of four constants".into()
        }
        KindEvidence::AccelerationBiased { .. } => {
            "no `bias_m_s2`, or `design.adaptive`, which reads no acceleration".into()
        }
        KindEvidence::SafeCommand => "no `safe_command`: a run then ends where the law has no value".into(),
        KindEvidence::NoSpacecraft => "`robot.spacecraft`".into(),
        KindEvidence::Unmatched { agent } => format!("what disturbs {} in its last equation alone", agent.name),
        KindEvidence::PositiveNumbers
        | KindEvidence::PositiveNumbersTrueMass
        | KindEvidence::PositiveMatrices
        | KindEvidence::MassOfPlant
        | KindEvidence::ConstantFactor
        | KindEvidence::FactorAway { .. }
        | KindEvidence::TermsDefined
        | KindEvidence::LengthsOutsideRegressor(_)
        | KindEvidence::LengthsKnown
        | KindEvidence::PositiveMatricesTrueLengths
        | KindEvidence::ParametersInside
        | KindEvidence::AttitudeApart { .. }
        | KindEvidence::TargetStill
        | KindEvidence::EqualInertia
        | KindEvidence::AccelerationUnbiased
        | KindEvidence::Matched
        | KindEvidence::Momentum(_) => return None,
    })
}

fn away_from_zero(agent: &Named) -> String {
    format!("a factor for {} that keeps away from zero in every state, such as 2 and the cosine of a state", agent.name)
}

pub(super) fn robot(evidence: &RobotEvidence) -> Option<String> {
    Some(match evidence {
        RobotEvidence::Swung { agents, joint, .. } => format!(
            "`{joint}` of {} locked, or parallel to the joints that turn it: its travel then changes no lever",
            names(agents)
        ),
        RobotEvidence::UnknownInertia { agents, .. } => {
            format!("mass and inertia of its own for every link of {} that moves", names(agents))
        }
        RobotEvidence::SingularInertia { agent, .. } => {
            format!("mass and inertia of its own for the last link of {}", agent.name)
        }
        RobotEvidence::ReachNotShown { seen, reach } => match edge(seen, reach) {
            Some(limit_m) if limit_m == reach.most => {
                format!("a target that keeps clearly closer than {} m", rounded_down(limit_m))
            }
            Some(limit_m) => format!("a target that keeps clearly farther than {} m", rounded_up(limit_m)),
            None => {
                "a target whose coordinates repeat with one period, clearly inside of what the end-effector can reach"
                    .into()
            }
        },
        RobotEvidence::OutOfReach { side, limit_m, .. } => match side {
            ReachSide::Beyond => format!("a target that keeps closer than {} m at all times", rounded_down(*limit_m)),
            ReachSide::Inside => {
                format!("a target that keeps farther than {} m at all times", rounded_up(*limit_m))
            }
        },
        RobotEvidence::UniformInertia { .. }
        | RobotEvidence::BoundedDynamics { .. }
        | RobotEvidence::WithinReach { .. } => return None,
    })
}
