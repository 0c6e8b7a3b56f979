//! The sampling margin σ of agents under (6)–(7): how much of the longest useful period is used.
//!
//! Not from the paper, derived for this software; `rates` derives σ and `held` the largest k. All of it is local: M and Y are those of one
//! state. At rest they miss what velocities and accelerations make of Y, which for ships is most of it; so that states on the way of the
//! references are looked at, too.

use forwardstep_sim::{Adaptive, AgentSetup, DynamicsAt, Setup, check_setup};

use super::PracticalAnswer;
use super::held::{Hold, longest_period_s};
use super::led::{Led, Pace, way};
use super::looped::degree;
use super::postures::each_posture;
use super::rates::{Gains, Rates, dynamics, fastest_damping_of};
use super::resonance::Swing;
use crate::hypothesis::Named;
use crate::inertia::Inertias;
use crate::kinds::is_lagrangian;

/// σ should not exceed this: the held damping then does not overshoot where commands act at once, and there is as much room for what
/// is not in the model.
pub const RECOMMENDED_MARGIN: f64 = 0.5;

/// A reference that answers at so large a part of K/M, or faster, is no longer slow beside s. Runs of loops with slower ones ceased to work at the
/// period of the margin within a tenth, those with faster ones at down to a tenth of it.
const RIVAL: f64 = 0.3;

/// σ of the agent and the state for which sampling is worst, at the start, between the starts of all, and on the way of the references.
#[derive(Clone, Debug, PartialEq)]
pub struct SamplingMargin {
    /// The worst at the start.
    pub start: MarginAt,
    /// The worst of all that were looked at, those of the start included.
    pub worst: MarginAt,
    /// Postures that were looked at, at rest but for the start.
    pub postures: usize,
    /// States that references lead through that were looked at.
    pub led: usize,
    /// h, s.
    pub period_s: f64,
    /// How commands reach the robot.
    pub hold: Hold,
    /// The first period at which σ is 1 in one of them, s; `None` where the delay is too long for any.
    pub longest_s: Option<f64>,
    /// The first at which it is [`RECOMMENDED_MARGIN`], s.
    pub recommended_s: Option<f64>,
    /// σ of the damping alone does not exceed this at any position of any agent, by certified bounds of M; `None` without those.
    pub anywhere: Option<f64>,
    /// Whether the loop as a whole was seen to decay, with references that answer s: with z frozen, as σ has it, a mode that is as fast as they are
    /// grows sooner than it does.
    pub held_by_references: bool,
    /// How fast the fastest reference answers, 1/s, where that is more than three tenths of the fastest mode at the start: σ freezes references, which
    /// then answer what s does before it has decayed.
    pub rival_per_s: Option<f64>,
    /// How many adaptive agents follow targets of their own. They adapt with the s of the sample that gave Y, for which no margin is
    /// known: their σ is that of the damping alone.
    pub adaptation_left_out: usize,
}

/// σ in one state.
#[derive(Clone, Debug, PartialEq)]
pub struct MarginAt {
    /// The agent.
    pub agent: Named,
    /// When references lead it there, s; `None` at rest and at the start.
    pub led_s: Option<f64>,
    /// σ.
    pub sigma: f64,
    /// The same for the damping alone.
    pub damping_sigma: f64,
    /// ½ h λ_max(M⁻¹ (K + ½ h P)), where that says something: nothing is late or filtered, and the agent adapts.
    pub frozen_sigma: Option<f64>,
    /// Whether a mode grows, by the damping alone or, with Y frozen, by damping and adaptation together.
    pub is_unstable: bool,
    /// λ_max(M⁻¹ K), the fastest mode, 1/s.
    pub fastest_per_s: f64,
}

/// How fast any agent's reference answers at most, about, 1/s: the largest distance of a root from zero, what is heard, Σ_j w_ij, and what λ, in
/// 1/s^ℓ, gives way together. With one root and λ = 0 it is that, κ₀ + Σ_j w_ij.
pub(crate) fn fastest_reference_per_s(setup: &Setup) -> f64 {
    let answers = |(index, agent): (usize, &AgentSetup)| {
        let roots = &agent.roots_per_s;
        let pairs = roots.pairs.iter().map(|pair| libm::hypot(pair.real, pair.imaginary));
        let root = roots.real.iter().copied().chain(pairs).fold(0.0, f64::max);
        root + degree(setup, index) + libm::pow(agent.manipulability, 1.0 / roots.len().max(1) as f64)
    };
    setup.agents.iter().enumerate().map(answers).fold(0.0, f64::max)
}

/// Where a margin is looked at.
struct Looked {
    agent: usize,
    rates: Rates,
    at: At,
}

#[derive(PartialEq)]
enum At {
    Start,
    Rest,
    Led { t_s: f64 },
}

impl SamplingMargin {
    /// Of the agents of a setup under (6)–(7); `None` when control is continuous, there are none, or no mass matrix can be factored.
    pub fn of(setup: &Setup) -> Option<SamplingMargin> {
        setup.control.as_ref()?;
        check_setup(setup).ok()?;
        SamplingMargin::on(setup, &way(setup, Pace::Even))
    }

    /// Whether it speaks of every agent, and no reference is a rival of it: all are under (6)–(7), with references that are slow beside their damping.
    pub fn is_enough(setup: &Setup) -> bool {
        let outrun = || SamplingMargin::of(setup).is_none_or(|margin| margin.rival_per_s.is_some());
        setup.agents.iter().all(is_lagrangian) && !outrun()
    }

    /// The same with states on the way of the agents.
    pub(super) fn on(setup: &Setup, way: &[Led]) -> Option<SamplingMargin> {
        let control = setup.control.as_ref()?;
        let (hold, period_s) = (Hold::of(control), 1.0 / control.sample_hz);
        let looked = looked(setup, way);
        let sigma = |looked: &Looked| looked.rates.sigma(hold, period_s);
        let worst_of = |those: &mut dyn Iterator<Item = &Looked>| -> Option<MarginAt> {
            let worst = those.map(|looked| (looked, sigma(looked))).reduce(|a, b| if b.1 > a.1 { b } else { a })?;
            Some(MarginAt::of(setup, worst.0, hold, period_s))
        };
        let start = worst_of(&mut looked.iter().filter(|looked| looked.at == At::Start))?;
        let worst = worst_of(&mut looked.iter())?;
        let all: Vec<usize> = (0..setup.agents.len()).collect();
        let fastest = fastest_damping_of(setup, &all, &mut Inertias::default());
        let anywhere_per_s = fastest.and_then(|found| found.anywhere_per_s);
        let learners = (0..setup.agents.len()).filter(|agent| setup.tracks(*agent));
        let led = looked.iter().filter(|looked| matches!(looked.at, At::Led { .. })).count();
        let longest = |at_most: f64| longest(&looked, period_s, &|_| hold, at_most);
        Some(SamplingMargin {
            postures: looked.len() - led,
            led,
            period_s,
            hold,
            longest_s: longest(1.0),
            recommended_s: longest(RECOMMENDED_MARGIN),
            anywhere: anywhere_per_s.map(|rate| period_s * rate / hold.largest_gain(period_s)),
            held_by_references: false,
            rival_per_s: Some(fastest_reference_per_s(setup)).filter(|rate| *rate > RIVAL * start.fastest_per_s),
            adaptation_left_out: learners.filter(|agent| setup.agents[*agent].law.is::<Adaptive>()).count(),
            start,
            worst,
        })
    }

    /// The period at which σ of a setup is 1, as [`SamplingMargin::longest_s`], where one near `near_s` is held as `hold` says, whatever its own
    /// control is.
    pub fn longest_period_s(setup: &Setup, near_s: f64, hold: impl Fn(f64) -> Hold) -> Option<f64> {
        check_setup(setup).ok()?;
        let looked = looked(setup, &way(setup, Pace::Even));
        if looked.is_empty() { None } else { longest(&looked, near_s, &hold, 1.0) }
    }

    /// What commands that are late or velocities that are filtered multiply powers by, at most, in the states that were looked at.
    pub(super) fn swing(&self) -> Swing {
        let of = |at: &MarginAt| self.hold.swing_at(self.period_s, at.fastest_per_s, at.sigma);
        of(&self.start).max(of(&self.worst))
    }

    /// Which gain makes σ what it is, as it is to be made smaller: `K`, `Γ`, or both.
    pub fn too_large(&self) -> &'static str {
        let MarginAt { sigma, damping_sigma, .. } = self.worst;
        match damping_sigma {
            alone if alone > 0.9 * sigma => "K",
            alone if alone > RECOMMENDED_MARGIN => "K and Γ",
            _ => "Γ",
        }
    }

    /// Inadequate only where a mode is unstable at the start of an agent; not shown where one is in another state, or
    /// where V may grow from sample to sample though none is.
    pub fn answer(&self) -> PracticalAnswer {
        if self.held_by_references {
            PracticalAnswer::Marginal
        } else if self.start.is_unstable {
            PracticalAnswer::Inadequate
        } else if self.worst.sigma >= 1.0 {
            PracticalAnswer::NotShown
        } else if self.worst.sigma > RECOMMENDED_MARGIN {
            PracticalAnswer::Marginal
        } else {
            PracticalAnswer::Adequate
        }
    }
}

impl MarginAt {
    fn of(setup: &Setup, looked: &Looked, hold: Hold, period_s: f64) -> MarginAt {
        let Looked { agent, rates, at } = looked;
        let damping_sigma = period_s * rates.damping_per_s / hold.largest_gain(period_s);
        MarginAt {
            agent: Named::of(setup, *agent),
            led_s: if let At::Led { t_s } = at { Some(*t_s) } else { None },
            sigma: rates.sigma(hold, period_s),
            damping_sigma,
            frozen_sigma: if hold.is_ideal() { rates.frozen(period_s) } else { None },
            is_unstable: damping_sigma >= 1.0 || rates.grows(hold, period_s),
            fastest_per_s: rates.damping_per_s,
        }
    }
}

/// All states at which margins are looked at; of an agent whose M cannot be factored there, none.
fn looked(setup: &Setup, way: &[Led]) -> Vec<Looked> {
    let gains: Vec<Option<Gains>> = (0..setup.agents.len()).map(|agent| gains(setup, agent)).collect();
    let those: Vec<usize> = (0..gains.len()).filter(|agent| gains[*agent].is_some()).collect();
    let mut found = Vec::new();
    let mut look = |agent: usize, dynamics: Option<DynamicsAt>, at: At| {
        let rates = gains[agent].as_ref().zip(dynamics).and_then(|(gains, dynamics)| gains.rates(&dynamics));
        found.extend(rates.map(|rates| Looked { agent, rates, at }));
    };
    each_posture(setup, &those, |agent, q, at_start| {
        let at = if at_start { At::Start } else { At::Rest };
        look(agent, resting(setup, agent, q, at_start), at);
    });
    for Led { agent, t_s, q, dq, dz, has_sign, .. } in way {
        let jumps = if *has_sign { 0.0 } else { sign(setup, *agent) };
        let dz: Vec<f64> = dz.iter().map(|dz| dz + jumps.copysign(*dz)).collect();
        look(*agent, dynamics(&setup.agents[*agent], q, dq, &dz), At::Led { t_s: *t_s });
    }
    found
}

/// The first period from zero on at which σ of one of them is `at_most`; infinity where there is none, `None` where the delay is too long.
fn longest(looked: &[Looked], near_s: f64, hold: &impl Fn(f64) -> Hold, at_most: f64) -> Option<f64> {
    let mut longest_s = f64::INFINITY;
    for Looked { rates, .. } in looked {
        let decays = |period_s: f64| rates.sigma(hold(period_s), period_s) < at_most;
        if longest_s.is_infinite() || !decays(longest_s) {
            longest_s = longest_s.min(longest_period_s(near_s.min(longest_s), hold, decays)?);
        }
    }
    Some(longest_s)
}

/// How far the sign lets ż of an agent jump where a leader is followed.
fn sign(setup: &Setup, agent: usize) -> f64 {
    setup.following().filter(|_| !setup.tracks(agent)).map_or(0.0, |following| following.gain)
}

/// M and Y of an agent at `q`: with z = q̇, which is zero but at the start, and ż as large as the sign makes it where a leader is followed.
fn resting(setup: &Setup, agent: usize, q: &[f64], at_start: bool) -> Option<DynamicsAt> {
    let own = &setup.agents[agent];
    let rest = vec![0.0; q.len()];
    let dq = if at_start { &own.start.dq } else { &rest };
    dynamics(own, q, dq, &vec![sign(setup, agent); q.len()])
}

/// K and Γ of an agent as far as a margin counts them.
pub(super) fn gains(setup: &Setup, agent: usize) -> Option<Gains> {
    let gains = Gains::of(&setup.agents[agent])?;
    Some(if setup.tracks(agent) { gains.damping_alone() } else { gains })
}
