//! What changed V along a run under digital control, cause by cause: what the proof takes away, and what everything that it does not
//! speak of put in.
//!
//! Not from the paper, derived for this software. Between two events z, ż and ϑ̂ stand still, and with s = q̇ − z the plant gives
//!
//! ```text
//! V̇ = sᵀ(τ_applied + τ_ext − Yϑ) + sᵀMż − sᵀDs
//! ```
//!
//! with Y at the q, q̇ of the instant and the z, ż that stand. Let τ_ideal = −Ks + Yϑ̂ at that instant, τ_held the same law at the
//! exact q, q̇ of the sample whose command is in force, τ_reconstructed that with q̇ as the filter makes it of exact positions, and τ_computed
//! that with what was measured. Then, with the jumps [·] at samples,
//!
//! ```text
//! dissipated      −∫ sᵀ(K + D)s
//! held             ∫ sᵀ(τ_held − τ_ideal) + ∫ sᵀMż + Σ [½ sᵀMs]
//! reconstructed    ∫ sᵀ(τ_reconstructed − τ_held)
//! measured         ∫ sᵀ(τ_computed − τ_reconstructed)
//! limited          ∫ sᵀ(τ_applied − τ_computed)
//! pushed           ∫ sᵀτ_ext
//! adaptation       ∫ sᵀYΔϑ + Σ [½ ΔϑᵀΓ⁻¹Δϑ]
//! ```
//!
//! add up to the change of V. Had z moved with ż and ϑ̂ with (7), sᵀMż and sᵀYΔϑ would cancel against the jumps; what is left of them is what
//! holding z and stepping ϑ̂ do. Where z reads positions itself, as under (3) and (aa6), their noise jumps with z and counts as held.

use forwardstep_core::agent::VelocityFilter;
use forwardstep_core::robot::TwoVelocity;
use forwardstep_sim::recording::{SampleTaken, Signal};
use forwardstep_sim::{
    AgentSetup, Evaluator, Inside, Place, ProductsAt, Setup, VelocitySensor, Watch, recorded_columns,
};
use nalgebra::{DMatrix, DVector};

use super::rates::Gains;
use crate::kinds::is_lagrangian;

/// A cause is named once it has put in this part of the largest V so far.
pub const NAMED_SHARE: f64 = 0.01;

/// Torques are the same if they differ by less, relative to the largest, N m or N.
const ROUNDING: f64 = 1e-12;

/// That V is not taken to be smaller than this, J.
const FLOOR_J: f64 = 1e-6;

/// What changes V.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Injection {
    /// sᵀ(K + D)s, as the proof says.
    Dissipated,
    /// Command and reference stand still between samples, and commands come late.
    Held,
    /// Velocities are filtered differences of positions.
    Reconstructed,
    /// Measurements have noise and are rounded.
    Measured,
    /// Torques are limited and rounded.
    Limited,
    /// Something acts from outside.
    Pushed,
    /// Estimates are stepped at samples.
    Adaptation,
}

impl Injection {
    /// All, in the order in which commands are traced from the ideal law to the plant.
    pub const ALL: [Injection; 7] = [
        Injection::Dissipated,
        Injection::Held,
        Injection::Reconstructed,
        Injection::Measured,
        Injection::Limited,
        Injection::Pushed,
        Injection::Adaptation,
    ];

    /// Its stable name.
    pub fn name(self) -> &'static str {
        match self {
            Injection::Dissipated => "dissipated",
            Injection::Held => "held",
            Injection::Reconstructed => "reconstructed",
            Injection::Measured => "measured",
            Injection::Limited => "limited",
            Injection::Pushed => "pushed",
            Injection::Adaptation => "adaptation",
        }
    }

    /// Its cause in words.
    pub fn words(self) -> &'static str {
        match self {
            Injection::Dissipated => "the damping of the law and of the robot",
            Injection::Held => "commands held between samples, and late",
            Injection::Reconstructed => "velocities from filtered differences",
            Injection::Measured => "noise and rounding of measurements",
            Injection::Limited => "limits and rounding of torques",
            Injection::Pushed => "external torques",
            Injection::Adaptation => "estimates stepped at samples",
        }
    }
}

/// V of one agent from the first sample to the end of its run, and what changed it.
#[derive(Clone, Debug, PartialEq)]
pub struct InjectionBalance {
    /// Index of the agent.
    pub agent: usize,
    /// V after the first sample, J.
    pub start_j: f64,
    /// V at the end, J.
    pub end_j: f64,
    /// The largest V at the end of a step, J.
    pub largest_j: f64,
    /// What each of [`Injection::ALL`] put in, J.
    pub terms_j: [f64; 7],
    /// The first that the proof does not allow and that put in more than [`NAMED_SHARE`] of the largest V so far, with its time, s.
    /// The proof allows what is dissipated, and pushes that end.
    pub first: Option<(Injection, f64)>,
}

impl InjectionBalance {
    /// What one of them put in, J.
    pub fn term_j(&self, injection: Injection) -> f64 {
        self.terms_j[injection as usize]
    }

    /// The change of V less all that was put in, J: the error of the quadrature.
    pub fn residual_j(&self) -> f64 {
        self.end_j - self.start_j - self.terms_j.iter().sum::<f64>()
    }
}

/// Looks at the agents of a run under (6)–(7), but for those that follow a target of their own.
pub struct InjectionWatch<'a> {
    agents: Vec<Option<Account<'a>>>,
}

impl<'a> InjectionWatch<'a> {
    /// `None` where control is continuous, or no agent is of this kind.
    pub fn of(setup: &'a Setup) -> Option<Self> {
        let control = setup.control.as_ref()?;
        let columns = recorded_columns(setup).ok()?;
        let account = |index: usize| {
            let agent = &setup.agents[index];
            if !is_lagrangian(agent) || setup.tracks(index) {
                return None;
            }
            let own: Vec<Signal> = columns.iter().filter(|c| c.agent == index).map(|c| c.signal).collect();
            let filter = match control.sensors.velocity {
                VelocitySensor::Measured => None,
                VelocitySensor::Filtered { cut_off_hz } => {
                    Some(VelocityFilter::new(core::f64::consts::TAU * cut_off_hz, agent.robot.axes.len()).ok()?)
                }
            };
            let (gains, places) = (Gains::of(agent)?, Places::of(&own)?);
            let law = Law { agent, gains, places, evaluator: agent.robot.kind.lagrangian()?.evaluator() };
            let clock = [1.0 / control.sample_hz, control.computation_delay_s];
            let pushes_end = agent.pushes.iter().all(|push| push.span_s()[1] < setup.time.end_s);
            Account::new(law, filter, clock, pushes_end)
        };
        let agents: Vec<_> = (0..setup.agents.len()).map(account).collect();
        agents.iter().any(Option::is_some).then_some(InjectionWatch { agents })
    }

    /// The balance of every agent that was looked at.
    pub fn balances(&self) -> Vec<InjectionBalance> {
        let balance = |(agent, account): (usize, &Option<Account<'_>>)| account.as_ref()?.balance(agent);
        self.agents.iter().enumerate().filter_map(balance).collect()
    }
}

impl Watch for InjectionWatch<'_> {
    fn sampled(&mut self, taken: SampleTaken<'_>) {
        if let Some(Some(account)) = self.agents.get_mut(taken.agent) {
            account.sample = Some((taken.now_s, taken.measured.to_vec()));
        }
    }

    fn inside(&mut self, at: Inside<'_>) {
        let Some(slot) = self.agents.get_mut(at.agent) else { return };
        // Better nothing than a sum that leaves something out.
        if slot.as_mut().is_some_and(|account| account.look(at).is_none()) {
            *slot = None;
        }
    }
}

/// Where signals stand in a row.
#[derive(Clone, Copy)]
struct Places {
    velocity: usize,
    z: usize,
    dz: usize,
    torque: usize,
    estimate: Option<usize>,
    lyapunov: usize,
    external: Option<usize>,
}

impl Places {
    fn of(signals: &[Signal]) -> Option<Places> {
        let at = |wanted| signals.iter().position(|signal| *signal == wanted);
        Some(Places {
            velocity: at(Signal::Velocity)?,
            z: at(Signal::Reference(0))?,
            dz: at(Signal::Reference(1))?,
            torque: at(Signal::Torque)?,
            estimate: at(Signal::Estimate),
            lyapunov: at(Signal::Lyapunov)?,
            external: at(Signal::External),
        })
    }
}

/// One agent at one instant.
struct State {
    q: Vec<f64>,
    dq: Vec<f64>,
    z: Vec<f64>,
    dz: Vec<f64>,
    s: DVector<f64>,
    theta_hat: Option<Vec<f64>>,
}

/// (6) of one agent.
struct Law<'a> {
    agent: &'a AgentSetup,
    gains: Gains,
    places: Places,
    evaluator: Box<dyn Evaluator>,
}

impl Law<'_> {
    fn state(&self, values: &[f64]) -> Option<State> {
        let (m, p) = (self.agent.robot.axes.len(), self.agent.robot.theta.len());
        let part = |from: usize, n: usize| values.get(from..from + n).map(<[f64]>::to_vec);
        // Positions come first.
        let (q, dq, z) = (part(0, m)?, part(self.places.velocity, m)?, part(self.places.z, m)?);
        let s = DVector::from_iterator(m, dq.iter().zip(&z).map(|(dq, z)| dq - z));
        let theta_hat = match self.places.estimate {
            Some(from) => Some(part(from, p)?),
            None => None,
        };
        Some(State { q, dq, z, dz: part(self.places.dz, m)?, s, theta_hat })
    }

    /// The products at a state, with the parameters `theta`.
    fn products(&mut self, theta: &[f64], state: &State, s: &DVector<f64>) -> Option<&ProductsAt> {
        let State { q, dq, z, dz, .. } = state;
        self.evaluator.at(theta, TwoVelocity { q, dq, z, dz }, s.as_slice()).ok()
    }

    /// Y ϑ̂ − K s at a state, with `q` and `dq` for what is measured.
    fn torque(&mut self, state: &State, q: &[f64], dq: &[f64]) -> Option<DVector<f64>> {
        let motion = TwoVelocity { q, dq, z: &state.z, dz: &state.dz };
        let s = DVector::from_iterator(dq.len(), dq.iter().zip(&state.z).map(|(dq, z)| dq - z));
        let theta = state.theta_hat.as_ref().unwrap_or(&self.agent.robot.theta);
        let model = &self.evaluator.at(theta, motion, s.as_slice()).ok()?.model;
        Some(DVector::from_column_slice(model) - &self.gains.damping * s)
    }
}

/// What a command came from: the law at the exact state of its sample, the same with the filter's velocity, and with what was measured.
#[derive(Clone)]
struct Traced {
    held: DVector<f64>,
    reconstructed: DVector<f64>,
    computed: DVector<f64>,
}

/// V of one agent, as it goes.
struct Account<'a> {
    law: Law<'a>,
    /// Γ⁻¹.
    inverse: Option<DMatrix<f64>>,
    /// Velocities of exact positions, and of those that were measured.
    filters: Option<[VelocityFilter; 2]>,
    fed: bool,
    period_s: f64,
    delay_s: f64,
    pushes_end: bool,
    /// Time and measurements of a sample that is new.
    sample: Option<(f64, Vec<f64>)>,
    /// What the actuators hold comes from this.
    in_force: Traced,
    /// And from then on, s, from that.
    coming: Option<(f64, Traced)>,
    /// V after the first sample.
    start_j: Option<f64>,
    /// The end of the step before: V and the state.
    before: Option<(f64, State)>,
    largest_j: f64,
    terms_j: [f64; 7],
    first: Option<(Injection, f64)>,
}

impl<'a> Account<'a> {
    fn new(
        law: Law<'a>,
        filter: Option<VelocityFilter>,
        [period_s, delay_s]: [f64; 2],
        pushes_end: bool,
    ) -> Option<Self> {
        let inverse = match &law.gains.adaptation {
            None => None,
            Some(gamma) => Some(gamma.clone().cholesky()?.inverse()),
        };
        let nothing = DVector::zeros(law.agent.robot.axes.len());
        Some(Account {
            law,
            inverse,
            filters: filter.map(|filter| [filter.clone(), filter]),
            fed: false,
            period_s,
            delay_s,
            pushes_end,
            sample: None,
            in_force: Traced { held: nothing.clone(), reconstructed: nothing.clone(), computed: nothing },
            coming: None,
            start_j: None,
            before: None,
            largest_j: FLOOR_J,
            terms_j: [0.0; 7],
            first: None,
        })
    }

    fn balance(&self, agent: usize) -> Option<InjectionBalance> {
        let (end_j, _) = self.before.as_ref()?;
        let (terms_j, first) = (self.terms_j, self.first);
        Some(InjectionBalance {
            agent,
            start_j: self.start_j?,
            end_j: *end_j,
            largest_j: self.largest_j,
            terms_j,
            first,
        })
    }

    /// `None` only where a vector has the wrong length.
    fn look(&mut self, Inside { t_s, place, values, .. }: Inside<'_>) -> Option<()> {
        let state = self.law.state(values)?;
        match place {
            Place::Start => {
                let v_j = *values.get(self.law.places.lyapunov)?;
                self.start_j.get_or_insert(v_j);
                self.jump(&state)?;
                self.trace(t_s, &state)?;
            }
            Place::Node { weight_s } => {
                self.arrive(t_s);
                self.node(weight_s, &state, values)?;
            }
            Place::End => {
                let v_j = *values.get(self.law.places.lyapunov)?;
                self.largest_j = self.largest_j.max(v_j);
                self.before = Some((v_j, state));
                self.name_first(t_s);
            }
        }
        Some(())
    }

    fn add(&mut self, injection: Injection, energy_j: f64) {
        self.terms_j[injection as usize] += energy_j;
    }

    /// What z and ϑ̂ do to V where they jump.
    fn jump(&mut self, state: &State) -> Option<()> {
        let Some((_, before)) = &self.before else { return Some(()) };
        if state.z == before.z && state.theta_hat == before.theta_hat {
            return Some(());
        }
        let (sum, change) = (&state.s + &before.s, &state.s - &before.s);
        let momentum = &self.law.products(&self.law.agent.robot.theta, state, &sum)?.momentum;
        let held_j = 0.5 * dot(change.as_slice(), momentum);
        let learned_j = self.estimate_j(state) - self.estimate_j(before);
        self.add(Injection::Held, held_j);
        self.add(Injection::Adaptation, learned_j);
        Some(())
    }

    /// ½ ΔϑᵀΓ⁻¹Δϑ, J.
    fn estimate_j(&self, state: &State) -> f64 {
        let (Some(inverse), Some(theta_hat)) = (&self.inverse, &state.theta_hat) else { return 0.0 };
        let theta = &self.law.agent.robot.theta;
        let error = DVector::from_iterator(theta.len(), theta_hat.iter().zip(theta).map(|(hat, theta)| hat - theta));
        0.5 * error.dot(&(inverse * &error))
    }

    /// Which command is in force from `t_s` on, and what it came from. Commands that were on their way arrive before a sample is taken.
    fn trace(&mut self, t_s: f64, state: &State) -> Option<()> {
        self.arrive(t_s);
        if let Some((now_s, measured)) = self.sample.take() {
            let m = state.q.len();
            let q = measured.get(..m)?;
            let passed_s = if self.fed { self.period_s } else { 0.0 };
            self.fed = true;
            let [exact, seen] = match &mut self.filters {
                None => [state.dq.clone(), measured.get(m..2 * m)?.to_vec()],
                Some([exact, seen]) => {
                    [exact.feed(passed_s, &state.q).ok()?.to_vec(), seen.feed(passed_s, q).ok()?.to_vec()]
                }
            };
            let held = self.law.torque(state, &state.q, &state.dq)?;
            let reconstructed =
                if exact == state.dq { held.clone() } else { self.law.torque(state, &state.q, &exact)? };
            let computed =
                if q == state.q && seen == exact { reconstructed.clone() } else { self.law.torque(state, q, &seen)? };
            self.coming = Some((now_s + self.delay_s, Traced { held, reconstructed, computed }));
            self.arrive(t_s);
        }
        Some(())
    }

    /// Puts a command in force that has arrived; instants are the same within rounding.
    fn arrive(&mut self, t_s: f64) {
        let rounding_s = 1e-9 * self.period_s;
        if let Some((_, traced)) = self.coming.take_if(|(arrives_s, _)| *arrives_s <= t_s + rounding_s) {
            self.in_force = traced;
        }
    }

    /// Adds what acts at a node of the quadrature.
    fn node(&mut self, weight_s: f64, state: &State, values: &[f64]) -> Option<()> {
        let s = &state.s;
        let part = |from: usize| Some(DVector::from_column_slice(values.get(from..from + s.len())?));
        let theta = &self.law.agent.robot.theta;
        let ProductsAt { momentum, damped, yt_s, .. } = self.law.products(theta, state, s)?;
        let (advance_w, lost_w) = (dot(&state.dz, momentum), dot(s.as_slice(), damped));
        let estimated_w = dot(state.theta_hat.as_ref().unwrap_or(theta), yt_s);
        let error_w = estimated_w - dot(theta, yt_s);
        let damping_w = s.dot(&(&self.law.gains.damping * s));
        let pushed_w = self.law.places.external.map_or(Some(0.0), |from| Some(s.dot(&part(from)?)))?;
        let Traced { held, reconstructed, computed } = &self.in_force;
        let powers_w = [
            (Injection::Dissipated, -damping_w - lost_w),
            (Injection::Held, s.dot(held) - (estimated_w - damping_w) + advance_w),
            (Injection::Reconstructed, s.dot(&(reconstructed - held))),
            (Injection::Measured, s.dot(&(computed - reconstructed))),
            (Injection::Limited, s.dot(&taken_away(computed, &part(self.law.places.torque)?))),
            (Injection::Pushed, pushed_w),
            (Injection::Adaptation, error_w),
        ];
        for (injection, power_w) in powers_w {
            self.add(injection, weight_s * power_w);
        }
        Some(())
    }

    /// Names what the proof does not allow, the largest where several come at once.
    fn name_first(&mut self, t_s: f64) {
        if self.first.is_some() {
            return;
        }
        let allowed = |injection: Injection| match injection {
            Injection::Dissipated => true,
            Injection::Pushed => self.pushes_end,
            Injection::Held
            | Injection::Reconstructed
            | Injection::Measured
            | Injection::Limited
            | Injection::Adaptation => false,
        };
        let put_in = Injection::ALL.into_iter().filter(|injection| !allowed(*injection));
        let largest = put_in.max_by(|a, b| self.terms_j[*a as usize].total_cmp(&self.terms_j[*b as usize]));
        self.first = largest
            .filter(|injection| self.terms_j[*injection as usize] > NAMED_SHARE * self.largest_j)
            .map(|injection| (injection, t_s));
    }
}

/// What limits and rounding add to a torque; nothing where the two differ as sums in another order do.
fn taken_away(computed: &DVector<f64>, applied: &DVector<f64>) -> DVector<f64> {
    let rounding = ROUNDING * computed.amax().max(1.0);
    (applied - computed).map(|change| if change.abs() > rounding { change } else { 0.0 })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
