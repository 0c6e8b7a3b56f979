//! V of one agent along its run, and what changed it.

use forwardstep_core::agent::VelocityFilter;
use forwardstep_sim::{Inside, Place, ProductsAt};
use nalgebra::{DMatrix, DVector};

use super::state::{Law, State};
use super::{FLOOR_J, Injection, InjectionBalance, name_first};

/// Torques are the same if they differ by less, relative to the largest, N m or N.
const ROUNDING: f64 = 1e-12;

/// What a command came from: the law at the exact state of its sample, the same with the filter's velocity, and with what was measured.
#[derive(Clone)]
struct Traced {
    held: DVector<f64>,
    reconstructed: DVector<f64>,
    computed: DVector<f64>,
}

/// V of one agent, as it goes.
pub(super) struct Account<'a> {
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
    pub(super) sample: Option<(f64, Vec<f64>)>,
    /// What the actuators hold comes from this.
    in_force: Traced,
    /// And from then on, s, from that.
    coming: Option<(f64, Traced)>,
    /// V after the first sample.
    start_j: Option<f64>,
    /// The end of the step before: V and the state.
    before: Option<(f64, State)>,
    largest_j: f64,
    terms_j: [f64; 8],
    first: Option<(Injection, f64)>,
}

impl<'a> Account<'a> {
    pub(super) fn new(
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
            terms_j: [0.0; 8],
            first: None,
        })
    }

    pub(super) fn balance(&self, agent: usize) -> Option<InjectionBalance> {
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
    pub(super) fn look(&mut self, Inside { t_s, place, values, rubs, .. }: Inside<'_>) -> Option<()> {
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
                self.node(weight_s, &state, values, rubs)?;
            }
            Place::End => {
                let v_j = *values.get(self.law.places.lyapunov)?;
                self.largest_j = self.largest_j.max(v_j);
                self.before = Some((v_j, state));
                self.first = self.first.or_else(|| name_first(&self.terms_j, self.largest_j, self.pushes_end, t_s));
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
    fn node(&mut self, weight_s: f64, state: &State, values: &[f64], rubs: &[f64]) -> Option<()> {
        let s = &state.s;
        let part = |from: usize| Some(DVector::from_column_slice(values.get(from..from + s.len())?));
        let theta = &self.law.agent.robot.theta;
        let ProductsAt { momentum, damped, yt_s, .. } = self.law.products(theta, state, s)?;
        let (advance_w, lost_w) = (dot(&state.dz, momentum), dot(s.as_slice(), damped));
        let estimated_w = dot(state.theta_hat.as_ref().unwrap_or(theta), yt_s);
        let error_w = estimated_w - dot(theta, yt_s);
        let damping_w = s.dot(&(&self.law.gains.damping * s));
        // What Y has in place of dry friction counts against it: `lost_w` has it with its sign turned.
        let (smooth_w, rubs_w) = (self.law.smoothed_w(state), dot(s.as_slice(), rubs));
        let external_w = self.law.places.external.map_or(Some(0.0), |from| Some(s.dot(&part(from)?)))?;
        let Traced { held, reconstructed, computed } = &self.in_force;
        let powers_w = [
            (Injection::Dissipated, -damping_w - lost_w - smooth_w),
            (Injection::Held, s.dot(held) - (estimated_w - damping_w) + advance_w),
            (Injection::Reconstructed, s.dot(&(reconstructed - held))),
            (Injection::Measured, s.dot(&(computed - reconstructed))),
            (Injection::Limited, s.dot(&taken_away(computed, &part(self.law.places.torque)?))),
            (Injection::Rubbed, smooth_w - rubs_w),
            (Injection::Pushed, external_w + rubs_w),
            (Injection::Adaptation, error_w),
        ];
        for (injection, power_w) in powers_w {
            self.add(injection, weight_s * power_w);
        }
        Some(())
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
