//! Kinds of systems and their laws.

use forwardstep_core::expression::Gap;
use forwardstep_core::robot::tree::Uncertain;
use forwardstep_sim::ThrustKind;
use forwardstep_sim::probe::{Counterexample, Probe};

use super::numbers::{as_it_is, rounded, rounded_down};
use crate::hypothesis::{FactorEverywhere, KindEvidence, Named, Term};

/// States that are written out.
const MOST_STATES: usize = 12;

pub(super) fn words(evidence: &KindEvidence) -> String {
    match evidence {
        KindEvidence::PositiveNumbers => "checked when they were read".into(),
        KindEvidence::PositiveMatrices => "checked exactly when they were read".into(),
        KindEvidence::PositiveNumbersTrueMass => {
            "checked when they were read; an estimate that is not adapted is the true mass".into()
        }
        KindEvidence::Mixture(treated) => format!(
            "there are agents of {}; all transmit the same and follow the same reference dynamics, and what the law of each \
             leaves behind vanishes, so the argument of the theorems should carry over, but the paper does not say so",
            treated.join(", ")
        ),
        KindEvidence::Declared { requires, because } => format!("{requires}: {because} (declared, not shown)"),
        KindEvidence::Probed { requires, probe } => probed(requires, probe),
        KindEvidence::MassOfPlant => "the law has that of the vehicle".into(),
        KindEvidence::MassNotAdapted { agent } => {
            format!("{} does not adapt its estimate, which is not the true mass", agent.name)
        }
        KindEvidence::ThrustFloor { least_n } => {
            format!("the run ends where one falls to its floor, the lowest of which is {} N", rounded(*least_n))
        }
        KindEvidence::ThrustKept { agent, floor_n } => format!(
            "that of {} is kept above {} N by a saturation; where it acts the vehicle does not do what the law asks for",
            agent.name,
            rounded(*floor_n)
        ),
        KindEvidence::FallsFreely { agent, t_s, thrust_n, floor_n } => format!(
            "where all agree {} keeps its offset with a thrust of {} N at t = {} s, and again and again; its floor is {} N",
            agent.name,
            rounded(*thrust_n),
            as_it_is(*t_s),
            rounded(*floor_n)
        ),
        KindEvidence::AngularRate { agent, bandwidth_per_s, design } => rate(agent, *bandwidth_per_s, *design),
        KindEvidence::Rotors { agent, thrust_n: [least, most] } => {
            format!("the rotors of {} give {least} N to {most} N each", agent.name)
        }
        KindEvidence::ConstantFactor => "it is constant".into(),
        KindEvidence::FactorBelowFloor { agent, value, floor } => {
            format!("that of {} is {} for ever, which is less than its floor of {floor}", agent.name, rounded(*value))
        }
        KindEvidence::FactorAtStart { agent, value, floor } => {
            let value = rounded(*value);
            format!("what the law of {} divides by starts at {value}, where the run ends: its floor is {floor}", agent.name)
        }
        KindEvidence::ThrustAtStart { agent, thrust_n, floor_n } => format!(
            "that of {} starts at {} N, where the run ends: its floor is {} N",
            agent.name,
            rounded(*thrust_n),
            rounded(*floor_n)
        ),
        KindEvidence::Unmoved { agent, equation } => format!(
            "x{} does not move equation {} of {}: its slope is 0 for ever",
            equation + 2,
            equation + 1,
            agent.name
        ),
        KindEvidence::FactorSingular { agent } => format!("that of {} is a matrix without an inverse", agent.name),
        KindEvidence::FactorFloor { agent, floor, everywhere, matrix } => {
            let known = match everywhere {
                FactorEverywhere::Fades => {
                    "; it has one sign in every state, but that it keeps away from zero far away was not shown".into()
                }
                FactorEverywhere::Away { least } => {
                    format!("; in every state it is {} at least, which is less", rounded_down(*least))
                }
                FactorEverywhere::Zero(at) => format!("; it comes to zero {}", in_state(at)),
                FactorEverywhere::Slopes => {
                    "; it is ψ times the slopes of the equations along their next states, of which no bound is looked for".into()
                }
                FactorEverywhere::Unknown => String::new(),
            };
            let falls = match matrix {
                true => "comes to a smallest singular value below",
                false => "comes closer to zero than",
            };
            format!("the run ends where that of {} {falls} {floor}{known}", agent.name)
        }
        KindEvidence::FactorAway { least, matrix: false } => {
            format!("in every state it is {} at least in magnitude", rounded_down(*least))
        }
        KindEvidence::FactorAway { least, matrix: true } => {
            format!("in every state its smallest singular value is {} at least", rounded_down(*least))
        }
        KindEvidence::TermsDefined => {
            "no divisor comes to zero, and no root or logarithm is of what is not positive".into()
        }
        KindEvidence::TermFails { agent, term, at, gap } => {
            let why = match gap {
                Gap::Pole => "has a pole",
                Gap::Negative => "has no value: a root, a power or a logarithm of what is negative",
                Gap::ZeroLogarithm => "has no value: the logarithm of zero",
            };
            format!("{} of {} {why}, {}; a run may step over it", name(*term), agent.name, in_state(at))
        }
        KindEvidence::TermNotShown { agent, term } => {
            format!("that {} of {} has could be neither shown nor refuted", name(*term), agent.name)
        }
        KindEvidence::TermNotSmooth { agent, term, derivatives } => format!(
            "{} of {} has a value everywhere, but is not shown to have {derivatives} {} there: a power of what comes to zero has no more \
             than its exponent says",
            name(*term),
            agent.name,
            if *derivatives == 1 { "derivative" } else { "derivatives" }
        ),
        KindEvidence::BoundedStates { agent } => {
            format!("a run that is completed keeps the states of {} bounded, and with them its regressors", agent.name)
        }
        KindEvidence::Determinant { start, floor } => {
            format!("its determinant starts at {}; a run ends where it falls below {floor} of that", rounded(*start))
        }
        KindEvidence::SingularValue { start, floor } => {
            format!(
                "its smallest singular value starts at {}; a run ends where it falls below {floor} of that",
                rounded(*start)
            )
        }
        KindEvidence::RankDeficient { smallest, largest } => {
            format!("its singular values start from {} to {}", rounded(*smallest), rounded(*largest))
        }
        KindEvidence::AttitudeApart { scalar } => format!(
            "the scalar part of the error starts at {} at least, with the sign for the shorter way, which is kept: −q and q are one attitude",
            rounded_down(*scalar)
        ),
        KindEvidence::AttitudeNotShown { most } => format!(
            "the scalar part of the error starts at {most:.1e} at most, and may be zero but for rounding, which then chooses the way"
        ),
        KindEvidence::HalfTurn => {
            "the scalar part of the error starts at zero: both ways are equally long, and rounding chooses between them"
                .into()
        }
        KindEvidence::NoTip => "the law has no end-effector of this robot".into(),
        KindEvidence::LengthsOutsideRegressor(Uncertain::Tool) => {
            "only the tool is uncertain, which the dynamics do not contain".into()
        }
        KindEvidence::LengthsOutsideRegressor(Uncertain::Chain) => {
            "none of the lengths that are uncertain enters the dynamics".into()
        }
        KindEvidence::LengthsKnown => "all lengths are known: they are the true ones and are not adapted".into(),
        KindEvidence::LengthsInRegressor(names) => format!(
            "the regressor is that of the true {}, which the law is said not to know; their estimates enter the Jacobian alone",
            names.join(", ")
        ),
        KindEvidence::PositiveMatricesTrueLengths => {
            "checked exactly when they were read; lengths that are not adapted are the true ones".into()
        }
        KindEvidence::LengthsNotAdapted { agent } => {
            format!("{} does not adapt its lengths, which are not the true ones", agent.name)
        }
        KindEvidence::ParametersInside => "they do, so projection only speeds the proof up".into(),
        KindEvidence::ParameterOutside { agent, name, value, bounds: [low, high] } => {
            let name = name.as_deref().unwrap_or("one");
            format!("{name} of {} is {value}, which is outside {low} to {high}", agent.name)
        }
        KindEvidence::Momentum([x, y, z]) => {
            format!("h_I = [{x:.4}, {y:.4}, {z:.4}] N m s by the start, and nothing acts from outside")
        }
        KindEvidence::MomentumPushed => {
            "a torque from outside changes it, and the law goes on with what it was at the start".into()
        }
        KindEvidence::TargetStill => "it is a constant, so that V̇ = −ẏᵀΛ_f ẏ".into(),
        KindEvidence::EqualInertia => {
            "the inertia is a multiple of the identity, so that ΔωᵀM S(Δω) ω_d is zero and V̇ = −ẏᵀΛ_f ẏ".into()
        }
        KindEvidence::TurningTarget => {
            "it may turn, and wheels leave V̇ = −ẏᵀΛ_f ẏ + ΔωᵀM S(Δω) ω_d, whose last term has no sign; a run may diverge".into()
        }
        KindEvidence::AccelerationUnbiased => "they have no bias by the scenario".into(),
        KindEvidence::AccelerationBiased { agent, drift_m_s } => {
            let together = drift_m_s.map_or_else(String::new, |[slow, fast]| {
                let way = if fast > 0.0 { "rise" } else { "sink" };
                let [slow, fast] = [slow, fast].map(|speed| rounded(speed.abs()));
                format!("; vehicles with such a bias on a fixed graph {way} together for ever, at {slow} to {fast} m/s where no message is late")
            });
            format!(
                "that of {} has a bias e, which leaves V̇ = −α* m |ṡ|² − Δm wᵀe, whose last term has no sign{together}",
                agent.name
            )
        }
        KindEvidence::Matched => "they do: the power of what acts is eₙ wₙ, which leaves V finite".into(),
        KindEvidence::Unmatched { agent } => format!(
            "what disturbs {} enters where the slopes of the steps may grow with the state, so that V may not stay finite",
            agent.name
        ),
        KindEvidence::SafeCommand => {
            "otherwise a safe command replaces the law's, and the run goes on".into()
        }
        KindEvidence::NoSpacecraft => "this is no spacecraft".into(),
    }
}

fn name(term: Term) -> &'static str {
    match term {
        Term::Drift => "χ",
        Term::Regressor => "a regressor",
        Term::Factor => "ψ",
    }
}

fn in_state(at: &[f64]) -> String {
    let numbers: Vec<String> = at.iter().take(MOST_STATES).map(|x| rounded(*x).to_string()).collect();
    let more = if at.len() > MOST_STATES { ", …" } else { "" };
    format!("in the state ({}{more})", numbers.join(", "))
}

/// What became of what is declared, at random states.
fn probed(requires: &str, Probe { states, found }: &Probe) -> String {
    let Some(found) = found else {
        return match states {
            0 => format!("{requires}: declared, not shown, and it could not be tried"),
            states => format!("{requires}: declared, not shown; it was so at {states} random states"),
        };
    };
    format!("{requires}: but {}", counterexample(found))
}

/// Where an identity fails.
pub(crate) fn counterexample(found: &Counterexample) -> String {
    let Counterexample { identity, t_s, state, value, expected } = found;
    let at = format!("at {} s, {}", rounded(*t_s), in_state(state));
    // As short as it tells the two apart.
    let short = [value, expected].map(|x| rounded(*x).to_string());
    let [value, expected] = if short[0] == short[1] { [value, expected].map(ToString::to_string) } else { short };
    let identity = identity.words();
    format!("it is not so that {identity} {at}: {value} in place of {expected}")
}

fn rate(agent: &Named, bandwidth_per_s: f64, design: ThrustKind) -> String {
    let foreseen = match design {
        ThrustKind::Continuous => "its rate cannot be foreseen, so the body lags behind",
        ThrustKind::Differentiable { .. } => "its rate is foreseen, so what the body misses dies out",
        ThrustKind::Adaptive { .. } | ThrustKind::ByAcceleration { .. } => {
            "its rate is foreseen as well as the mass is known"
        }
    };
    format!(
        "{} is a rigid body that torques turn with a bandwidth of {bandwidth_per_s} per second; {foreseen}",
        agent.name
    )
}
