//! Following a leader: Theorems 8 and 9, Remark 12, one vector to agree on, and an observer of the leader.

use forwardstep_core::controller::Jet;
use forwardstep_sim::leader::{Following, FollowingDesign};
use forwardstep_sim::push::Push;
use forwardstep_sim::{AgentSetup, Setup};

use super::own_targets::how_far;
use super::swarm;
use crate::certificate::closer_drive_bound;
use crate::graphs::{dwell_time, fixed_graph, leader_in_every_graph, leader_reaches_all};
use crate::hypothesis::numbers::rounded_up;
use crate::hypothesis::{Answer, FollowingEvidence, Hypothesis, Id, MotionEvidence, Named, ReferenceEvidence, Subject};
use crate::kinds::{is_lagrangian, starts_from_zero};
use crate::late_leader::{behind, held, sign_lags};
use crate::links::{bounded_delays, bounded_weights, constant_weights, is_late, no_delay};
use crate::report::Report;
use crate::surroundings::{acts, dry_loss_w, ends_s};
use crate::theorem::Theorem;

/// Times at which a leader is looked at whose bounds could not be shown.
const LOOKS: u32 = 20_000;

/// What a leader is followed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Over {
    /// A fixed graph without delay, as the paper has it; or what neither the paper nor our derivations speak about.
    Fixed,
    /// (110), one vector or an observer, over graphs that take turns.
    Turns,
    /// (110), one vector or an observer, over a fixed graph whose links delay.
    Late,
}

impl Over {
    fn of(setup: &Setup, design: FollowingDesign) -> Over {
        let turns = setup.network.schedule.constant_graph().is_none();
        match design {
            // With estimates, or one vector, in the place of what is measured it is (110) with s = 0.
            FollowingDesign::Continuous | FollowingDesign::Composite | FollowingDesign::Observer { .. } => {
                match (turns, is_late(setup)) {
                    (true, false) => Over::Turns,
                    (false, true) => Over::Late,
                    (false, false) | (true, true) => Over::Fixed,
                }
            }
            FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration | FollowingDesign::Swarm { .. } => {
                Over::Fixed
            }
        }
    }
}

/// What is promised to agents that follow a leader.
pub(super) fn check(setup: &Setup, following: &Following) -> Report {
    let over = Over::of(setup, following.design);
    let theorem = match following.design {
        FollowingDesign::Continuous => match over {
            Over::Fixed => Theorem::Theorem8,
            Over::Turns => Theorem::SwitchingLeader,
            Over::Late => Theorem::LateLeader,
        },
        FollowingDesign::Differentiable => Theorem::Theorem9,
        FollowingDesign::WithoutAcceleration => Theorem::Remark12,
        FollowingDesign::Swarm { .. } => Theorem::Swarm,
        FollowingDesign::Composite => Theorem::CompositeLeader,
        FollowingDesign::Observer { .. } => Theorem::LeaderObserver,
    };
    let torque = match following.design {
        FollowingDesign::Continuous | FollowingDesign::Observer { .. } => {
            "the torque is as smooth as the value of the sign that is chosen"
        }
        FollowingDesign::Composite if over != Over::Fixed => {
            "the torque is continuous with a bounded derivative, through switches and jumps of delays too"
        }
        FollowingDesign::Differentiable
        | FollowingDesign::WithoutAcceleration
        | FollowingDesign::Composite
        | FollowingDesign::Swarm { .. } => "the torque is continuous with a bounded derivative",
    };
    let mut hypotheses = vec![bounded_motion(setup, following), gain(setup, following)];
    hypotheses.extend(match over {
        Over::Fixed => [leader_reaches_all(setup), fixed_graph(setup), no_delay(setup)],
        Over::Turns => [leader_in_every_graph(setup), dwell_time(setup), no_delay(setup)],
        Over::Late => [leader_reaches_all(setup), fixed_graph(setup), bounded_delays(setup)],
    });
    match following.design {
        FollowingDesign::Swarm { coupling } => hypotheses.extend(swarm::hypotheses(setup, following, coupling)),
        // It is integrated as it stands, whatever its weights do. How far it stays behind is known of constant ones.
        FollowingDesign::Continuous | FollowingDesign::Composite | FollowingDesign::Observer { .. } => {
            hypotheses.extend((over == Over::Late).then(|| constant_weights(setup, true)));
            hypotheses.push(stable(following));
        }
        FollowingDesign::Differentiable | FollowingDesign::WithoutAcceleration => {
            hypotheses.push(constant_weights(setup, false));
            hypotheses.push(stable(following));
        }
    }
    hypotheses.extend(bounded_weights(setup));
    hypotheses.push(sign(setup, following));
    hypotheses.push(shared_design(setup, following));
    let leader = setup.leader().map_or("", |vertex| setup.vertex_name(vertex));
    let promises = match over {
        Over::Fixed | Over::Turns => format!("everybody follows {leader}: qᵢ − q₀ → 0 and q̇ᵢ − q̇₀ → 0; {torque}"),
        Over::Late => {
            // Where γ may be too small nothing comes that near.
            let drives = hypotheses.iter().any(|own| own.id == Id::SignGain && own.answer() == Answer::Holds);
            let near = match behind(setup, following).filter(|_| drives) {
                Some(bound) => {
                    format!("in the end no |qᵢ − q₀| exceeds {}", rounded_up(bound * swing(following)))
                }
                None => "in the end |qᵢ − q₀| keeps within a bound in proportion to them and to sup|ξ̇₀|".to_owned(),
            };
            format!("everybody follows {leader} as closely as the delays let it: {near}; {torque}")
        }
    };
    Report { theorem, promises, hypotheses }
}

/// The derivatives of the leader that the theorem wants bounded.
fn bounded_motion(setup: &Setup, following: &Following) -> Hypothesis {
    let evidence = match following.motion() {
        Some(leader) => MotionEvidence::Derivatives(how_far(&leader.trajectory, 1..=3, setup.time.end_s)),
        None => MotionEvidence::OfAgent,
    };
    Hypothesis::new(Id::BoundedLeader, evidence)
}

/// How far all roots of p + α, of (p + α)(p + κ) or of p² + β p + α are from the axis, 1/s. Of two real roots the smaller one is their product α over
/// the larger; a pair has the real part −β/2, and so have two equal ones, which rounding may part.
pub(crate) fn slowest_per_s(following: &Following) -> f64 {
    /// Of what rounding of α and β parts, as a part of the square of β/2.
    const EQUAL: f64 = 1e-12;
    let (alpha, beta) = (following.alpha, following.beta);
    match following.design {
        FollowingDesign::Continuous => alpha,
        FollowingDesign::Observer { kappa } => alpha.min(kappa),
        FollowingDesign::Differentiable
        | FollowingDesign::WithoutAcceleration
        | FollowingDesign::Composite
        | FollowingDesign::Swarm { .. } => {
            let half = 0.5 * beta;
            let square = half * half - alpha;
            let slowest = if square > EQUAL * half * half { alpha / (half + square.sqrt()) } else { half };
            // Without the digits that rounding left behind.
            format!("{slowest:.11e}").parse().unwrap_or(slowest)
        }
    }
}

/// The same as a bound that is certain: of roots that are nearly equal rounding knows half of the digits.
pub(crate) fn certainly_slowest_per_s(following: &Following) -> f64 {
    match following.design {
        FollowingDesign::Continuous | FollowingDesign::Observer { .. } => slowest_per_s(following),
        FollowingDesign::Differentiable
        | FollowingDesign::WithoutAcceleration
        | FollowingDesign::Composite
        | FollowingDesign::Swarm { .. } => (1.0 - 4e-6) * slowest_per_s(following),
    }
}

fn stable(following: &Following) -> Hypothesis {
    Hypothesis::new(Id::Hurwitz, ReferenceEvidence::Hurwitz { slowest_per_s: slowest_per_s(following) })
}

/// γ against sup |ξ̇₀|∞.
fn gain(setup: &Setup, following: &Following) -> Hypothesis {
    let end_s = setup.time.end_s;
    let gamma = following.gain;
    let evidence = match following.motion() {
        Some(leader) => {
            let (motion, drive) = (&leader.trajectory, following.drive());
            let known = following.drive_bound(None);
            let for_ever = if known < gamma { known } else { closer_drive_bound(following) };
            let exceeds = for_ever.is_nan() || for_ever >= gamma;
            FollowingEvidence::Gain {
                gamma,
                seen: motion.sampled_peak(&drive, end_s, LOOKS),
                on_run: following.drive_bound(Some(end_s)),
                for_ever,
                reached: exceeds.then(|| motion.seen_to_reach(&drive, gamma, end_s)).flatten(),
                unbounded: exceeds && motion.exceeds_every_bound(&drive),
                end_s,
            }
        }
        None => over_target(setup, following).unwrap_or(FollowingEvidence::GainOverAgent { gamma }),
    };
    Hypothesis::about(Id::SignGain, Subject::Drive(following.design), evidence)
}

/// That a leader which is an agent is driven away harder than γ along its target, where it reaches γ again and again.
///
/// It comes to keep to its target, q_0 − q_d → 0 and q̇_0 − q̇_d → 0. If from some time on no entry of ξ̇_0 exceeded γ, its integrals over short times
/// would not exceed γ times these, and neither would those of the target, up to what vanishes: its accelerations need not converge for
/// that. So a target that exceeds γ again and again refutes it. Before the leader arrives the run says what drives it.
fn over_target(setup: &Setup, following: &Following) -> Option<FollowingEvidence> {
    let (vertex, gamma) = (setup.leader()?, following.gain);
    let agent = setup.agents.get(vertex)?;
    let target = agent.target.as_ref().filter(|target| setup.tracks(vertex) && target.derivatives_recur())?;
    let reached =
        target.seen_to_reach(&following.drive(), gamma, setup.time.end_s).filter(|at| at.value.abs() > gamma)?;
    let ends = |push: &Push| !acts(push) || ends_s(push).is_finite();
    let arrives = is_lagrangian(agent)
        && setup.control.is_none()
        && !agent.enforce_limits
        && dry_loss_w(agent).is_none()
        && agent.pushes.iter().all(ends);
    let seen = target.sampled_peak(&following.drive(), setup.time.end_s, LOOKS).max(reached.value.abs());
    Some(FollowingEvidence::GainOverTarget { gamma, leader: Named::of(setup, vertex), reached, seen, arrives })
}

/// A sign that is solved for every h seconds is held in between, while the leader is driven away at ξ̇₀: ξ_i − ξ_0 comes back to
/// h sup |ξ̇₀|, whatever γ is. q_i − q_0 follows it through 1/(p + α), or 1/(p² + β p + α) with real roots, whose largest
/// response is 1/α: h sup |ξ̇₀| / α is left. With roots −a ± b i the response swings, and its absolute integral is
/// coth(π a/(2 b))/α, which is below (1 + b/a)/α, since coth x < 1 + 1/x.
fn sign(setup: &Setup, following: &Following) -> Hypothesis {
    let (sampled, period_s) = match &setup.control {
        None => (false, following.period_s),
        Some(control) => (true, 1.0 / control.sample_hz),
    };
    let swing = swing(following);
    let alpha_per_s = match following.design {
        FollowingDesign::Continuous | FollowingDesign::Observer { .. } => following.alpha,
        // α is the product of the two roots there.
        FollowingDesign::Differentiable
        | FollowingDesign::WithoutAcceleration
        | FollowingDesign::Composite
        | FollowingDesign::Swarm { .. } => (following.alpha * swing).sqrt(),
    };
    let lags = sign_lags(setup, following);
    // Signs that are set at once with their neighbours' leave no more of many than of one.
    let left = if lags {
        f64::INFINITY
    } else if sampled || is_late(setup) {
        held(setup, following).unwrap_or(f64::INFINITY) * swing
    } else {
        period_s * following.drive_bound(None) / following.alpha * swing
    };
    let (end_s, scale) = (setup.time.end_s, scale(setup, following));
    let (choice, rate_per_s) = (following.choice, alpha_per_s);
    let evidence = FollowingEvidence::Sign { choice, sampled, lags, period_s, rate_per_s, left, scale, end_s };
    Hypothesis::new(Id::SetValuedSign, evidence)
}

/// How far the leader moves along an axis on this run, or an agent starts away from it, whichever is more; infinity where its motion is not known.
fn scale(setup: &Setup, following: &Following) -> f64 {
    let Some(leader) = following.motion() else { return f64::INFINITY };
    let motion = &leader.trajectory;
    let mut jets = vec![Jet::default(); motion.axes()];
    motion.jets(0.0, &mut jets);
    let away =
        |agent: &AgentSetup| agent.start.q.iter().zip(&jets).map(|(q, jet)| (q - jet[0]).abs()).fold(0.0, f64::max);
    let gap = setup.agents.iter().map(away).fold(0.0, f64::max);
    let mut ends: Vec<[f64; 2]> = jets.iter().map(|jet| [jet[0]; 2]).collect();
    for look in 1..=LOOKS {
        motion.jets(setup.time.end_s * f64::from(look) / f64::from(LOOKS), &mut jets);
        for ([low, high], jet) in ends.iter_mut().zip(&jets) {
            (*low, *high) = (low.min(jet[0]), high.max(jet[0]));
        }
    }
    ends.iter().map(|[low, high]| high - low).fold(gap, f64::max)
}

/// 1 + b/a for roots −a ± b i, else one.
fn swing(following: &Following) -> f64 {
    match following.design {
        FollowingDesign::Continuous | FollowingDesign::Observer { .. } => 1.0,
        FollowingDesign::Differentiable
        | FollowingDesign::WithoutAcceleration
        | FollowingDesign::Composite
        | FollowingDesign::Swarm { .. } => {
            let half = 0.5 * following.beta;
            let turns = following.alpha / (half * half) - 1.0;
            // Two equal real roots, but for rounding.
            if turns > 1e-12 { 1.0 + turns.sqrt() } else { 1.0 }
        }
    }
}

/// α and β are common by what a scenario can say; what is slow is said here.
fn shared_design(setup: &Setup, following: &Following) -> Hypothesis {
    let accelerations = following.design == FollowingDesign::Differentiable;
    let follows = |agent: &usize| !setup.tracks(*agent);
    let followers = (0..setup.agents.len()).filter(follows);
    let slow = accelerations && followers.map(|agent| &setup.agents[agent]).any(starts_from_zero);
    Hypothesis::new(Id::SharedDesign, FollowingEvidence::Shared { slow })
}
