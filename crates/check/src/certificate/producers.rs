//! The list of producers: which hypotheses have one.

use forwardstep_core::expression::Number;
use forwardstep_sim::Setup;

use super::proof::Proof;
use super::{delays, gains, motions, numbers, routh, windows};
use crate::kinds::task_space::left_null;
use crate::{Answer, Id};

/// Looks for a proof of an answer about a hypothesis of some agents.
type Producer = fn(&Setup, &Claim<'_>) -> Option<Proof>;

/// What is to be proved.
pub(super) struct Claim<'a> {
    pub(super) id: Id,
    pub(super) agents: &'a [usize],
    pub(super) answer: Answer,
}

const PRODUCERS: &[(Id, Producer)] = &[
    (Id::SpanningTree, windows::spanning_tree),
    (Id::LeaderReachesAll, windows::spanning_tree),
    (Id::LeaderInEveryGraph, windows::in_every_graph),
    (Id::DwellTime, windows::dwell_time),
    (Id::FixedGraph, windows::fixed_graph),
    (Id::BoundedDelays, delays::bounded),
    (Id::MessagesInTime, delays::in_time),
    (Id::BoundedWeights, delays::weights),
    (Id::CouplingSector, delays::coupling),
    (Id::RealRoots, numbers::real_roots),
    (Id::Hurwitz, numbers::hurwitz),
    (Id::DesiredDesign, text),
    (Id::DesiredDynamics, routh::of_target),
    (Id::CommonOrder, numbers::common_order),
    (Id::CommonFirstRoot, numbers::common_first_root),
    (Id::Manipulability, numbers::manipulability),
    (Id::PushesEnd, numbers::pushes_end),
    (Id::PositiveGains, gains::definite),
    (Id::TaskSpaceGains, gains::definite),
    (Id::AttitudeGains, gains::definite),
    (Id::PassivityFilterGains, gains::definite),
    (Id::PositionOnlyGains, gains::definite),
    (Id::ModelReferenceGains, gains::definite),
    (Id::ThrustGains, gains::definite),
    (Id::ChainGains, gains::definite),
    (Id::ChainAdaptation, gains::definite),
    (Id::SwarmCoupling, gains::swarm),
    (Id::InputFactor, numbers::input_factor),
    (Id::NonzeroThrust, |_, claim| (claim.answer == Answer::Violated).then_some(Proof::StartsBelow)),
    (Id::BoundedTarget, motions::bounded),
    (Id::BoundedLeader, motions::bounded),
    (Id::SignGain, motions::sign_gain),
    (Id::NonzeroQuaternion, motions::nonzero_quaternion),
    (Id::StartAttitude, motions::start_attitude),
    (Id::RegularJacobian, regular_jacobian),
    (Id::UniformInertia, text),
    (Id::BoundedDynamics, text),
    (Id::DefinedTerms, numbers::defined_terms),
    (Id::TargetWithinReach, motions::within_reach),
    (Id::OwnOrders, text),
    (Id::CertainRegressor, text),
    (Id::LengthsWithinBounds, bounds),
    (Id::ConstantWeights, text),
    (Id::MutualWeights, text),
    (Id::NoDelay, text),
    (Id::SharedDesign, text),
    (Id::SetValuedSign, text),
    (Id::AppliedTorque, text),
    (Id::KnownMasses, text),
    (Id::KnownMomentum, text),
    (Id::TargetAtRest, text),
    (Id::UnbiasedAcceleration, text),
    (Id::SmoothFriction, text),
    (Id::ParametersWithinBounds, bounds),
];

/// A proof of `answer`, which is a claim, if there is a producer and it finds one.
pub(super) fn proof(setup: &Setup, id: Id, agents: &[usize], answer: Answer) -> Option<Proof> {
    let (_, produce) = PRODUCERS.iter().find(|(known, _)| *known == id)?;
    produce(setup, &Claim { id, agents, answer })
}

/// What the text of a scenario says at once. Whether a hypothesis is violated it does not say.
fn text(_: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    (claim.answer == Answer::Holds).then_some(Proof::Text)
}

/// What the text says about bounds, either way.
fn bounds(_: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    match claim.answer {
        Answer::Holds => Some(Proof::Text),
        Answer::Violated => Some(Proof::Outside),
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

/// That Ĵ is singular at the start. That it stays regular, a run watches.
fn regular_jacobian(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    if claim.answer != Answer::Violated {
        return None;
    }
    let agent = setup.agents.get(*claim.agents.first()?)?;
    let vector = left_null(agent, agent.law.downcast()?)?;
    Some(Proof::LeftNull(vector.into_iter().map(Number::written).collect()))
}
