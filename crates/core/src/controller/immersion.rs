//! Immersion and invariance as the second step of Section IV, for (33) with χ linear in unknown parameters.
//!
//! Immersion and invariance asks for target dynamics, a manifold on which the plant behaves like them, and a law that makes
//! the manifold attractive. Usually the target dynamics are of lower order than the plant. Here they are the reference
//! dynamics of [`ReferenceModel`], of order k + ℓ − 1 ≥ k, as the end of Section IV-B proposes. The coordinates off the manifold are
//! s and the error ζ of an estimate θ̂ + β(x*), whose second part is a function of the state. With v = d^(k−1)x/dt^(k−1),
//!
//! ```text
//! d^k x/dt^k = χ₀(x*) + φ(x*)ᵀθ + ψ(x*) u,    s = v − z,    ζ = θ̂ + β − θ
//! β = Γ Φ,   ∂Φ/∂v = φ
//! u = (ż − χ₀ − φᵀ(θ̂ + β) − k s)/ψ
//! θ̂' = −Γ φ (ż − k s) − Γ Σ_{r<k−1} ∂Φ/∂x_r x_{r+1},   x_r = d^r x/dt^r
//! ```
//!
//! Since d/dt β = Γ φ (χ₀ + φᵀθ + ψ u) + Γ Σ ∂Φ/∂x_r x_{r+1} and χ₀ + φᵀθ + ψ u = ż − k s − φᵀζ,
//!
//! ```text
//! ζ' = −Γ φ φᵀζ,    ṡ = −k s − φᵀζ
//! ```
//!
//! With V = ½ s² + (1/2k) ζᵀ Γ⁻¹ ζ and η = φᵀζ,
//!
//! ```text
//! V̇ = −k s² − s η − η²/k = −(k/2) s² − (k/2)(s + η/k)² − η²/(2k)
//! ```
//!
//! so s and η are square-integrable. s is the output of a stable filter that is driven by η, hence s → 0 without any bound
//! on φ, which adaptation by the gradient (`linearising`) needs. The norm of ζ never grows, whatever z does.
//!
//! A disturbance w of the plant enters ṡ as it is and ζ' as Γ φ w, which adds (s + η/k) w to V̇. That is at most
//! (k/2)(s + η/k)² + w²/(2k), so that V̇ ≤ w²/(2k): a bounded w leaves V finite at all times.
//!
//! **Bounds.** The rate of θ̂ + β holds dv/dt, which is not known, so it cannot be slowed down at a bound: u takes Π(θ̂ + β) instead, as
//! derived in `law::clamped`, with ρ = k. The plant then has ṡ = −k s − φᵀζ with ζ = Π(θ̂ + β) − θ, the rate of θ̂ + β is
//! −Γ φ φᵀζ − k (θ̂ + β − Π(θ̂ + β)), and V = ½ s² + Σ W_j/(k γ_j) has the V̇ from above with this ζ in η, and what returning takes off.

use alloc::vec;
use alloc::vec::Vec;

use super::following::{ChainError, ChainMeasured, Following, FollowingWork, positive};
use super::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use crate::LengthError;
use crate::expression::{Expression, Graph, Interval, Intervals, Tape};
use crate::law::ParameterBounds;
use crate::plant::{Chain, Formulas, FormulasWork, Terms};
use crate::reference::Position;
use crate::signal::{Block, Signal};

#[cfg(doc)]
use super::ReferenceModel;

/// Points at which Φ is compared with φ.
const TRIED: usize = 32;
/// How far ∂Φ/∂v may be from φ, as a part of the larger of |φ| and one.
const CLOSE: f64 = 1e-9;

/// Control of (33) by immersion and invariance.
///
/// State: z, ż, …, z^(ℓ−1), θ̂. Shown: the reference, s, ψ, θ̂ + β, and x − x_d when it tracks.
///
/// **Source**: Section IV-B, (33)–(43). **Measures**: x, ẋ, …, d^(k−1)x/dt^(k−1). **Transmits**: x.
/// **Requires**: ψ away from zero; k and Γ positive; Φ with ∂Φ/∂v = φ in closed form; positive roots, k + ℓ − 1 to track and
/// k + ℓ − 2 to agree, ℓ ≥ 1; x_d with k + ℓ − 1 bounded derivatives, or a network as for Theorem 3 with (24).
/// **Guarantees**: x − x_d → 0; with a network x_i − x_j → 0 and all derivatives → 0.
/// **Deviates from the paper**: it names the approach and prints no law; this one is our own derivation.
///
/// Off the manifold the loop is ṡ = −k s − φᵀζ:
///
/// ```
/// use forwardstep_core::controller::{ControllerOutput, Controller, Following, ControllerInput, Jets, ReferenceModel, Immersion};
/// use forwardstep_core::expression::Expression;
/// use forwardstep_core::plant::{Chain, Formulas, Plant};
/// use forwardstep_core::reference::{Consensus, Heard};
///
/// // ẍ = θ x² + u
/// let phi = Expression::variable(0) * Expression::variable(0);
/// let (zero, one) = (Expression::number(0.0), Expression::number(1.0));
/// let terms = Formulas::new(2, &zero, vec![phi.clone()], &one)?;
/// let antiderivative = Immersion::antiderivative(2, &phi).ok_or("x² has no ẋ in it")?;
/// let guide = ReferenceModel::Consensus(Consensus::new([(&[1.0, 2.0][..], 0.0)])?);
/// let following = Following { guide, gain_per_s: 5.0, floor: 0.1 };
/// let (theta, zeta) = (0.7, 0.25);
/// let law = Immersion::new(terms.clone(), &[antiderivative], following, vec![3.0], vec![theta + zeta])?;
///
/// let x = [0.3, -0.4];
/// let given = ControllerInput { measured: law.see(&x)?, heard: Heard::new(&[0.8], &[0.8], 1)?, target: Jets::NONE };
/// let (mut state, mut d_state) = ([0.0; 3], [0.0; 3]);
/// law.start(&mut law.scratch(), given, &[vec![0.5], vec![0.1]], &mut state)?;
/// let (mut input, mut shown) = ([0.0], [0.0; 5]);
/// let asked = ControllerOutput { input: &mut input, d_state: &mut d_state, shown: &mut shown };
/// law.evaluate(&mut law.scratch(), given, &state, asked)?;
///
/// let plant = Chain { terms, theta: vec![theta] };
/// let mut dx = [0.0; 2];
/// plant.rate(&mut plant.scratch(), &x, &input, &[], &mut dx)?;
/// let s = x[1] - state[0];
/// assert!((dx[1] - d_state[0] - (-5.0 * s - x[0] * x[0] * zeta)).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Immersion {
    terms: Formulas,
    following: Following,
    adaptation: Vec<f64>,
    estimate_start: Vec<f64>,
    bounds: Option<ParameterBounds>,
    /// Φ_j, then Σ_r ∂Φ_j/∂x_r x_{r+1} of every parameter.
    tape: Tape,
}

impl Immersion {
    /// For a plant with these terms; `antiderivatives` is Φ, `adaptation` the diagonal of Γ, and `estimate_start` is θ̂ + β
    /// at the start.
    ///
    /// # Errors
    /// [`ChainError`] when the reference does not suit the plant, lengths differ, a gain is not positive, or ∂Φ/∂v is not φ, or not shown to be by
    /// the algebra of polynomials in the functions that stand in them.
    pub fn new(
        terms: Formulas,
        antiderivatives: &[Expression],
        following: Following,
        adaptation: Vec<f64>,
        estimate_start: Vec<f64>,
    ) -> Result<Self, ChainError> {
        following.check(&terms)?;
        let (k, p) = (terms.order(), terms.parameters());
        LengthError::check("adaptation gains", p, adaptation.len())?;
        LengthError::check("theta_hat", p, estimate_start.len())?;
        LengthError::check("antiderivatives", p, antiderivatives.len())?;
        positive(&adaptation)?;
        let Some(top) = k.checked_sub(1) else { return Err(LengthError { what: "order", need: 1, got: 0 }.into()) };
        let mut graph = Graph::new(k);
        let (mut values, mut turned, mut slopes) = (Vec::new(), Vec::new(), Vec::new());
        for phi in antiderivatives {
            let value = graph.import(phi)?;
            let mut sum = graph.zero();
            for r in 0..top {
                let (slope, next) = (graph.derivative(value, r)?, graph.variable(r + 1)?);
                let term = graph.times(slope, next);
                sum = graph.plus(sum, term);
            }
            values.push(value);
            turned.push(sum);
            slopes.push(graph.derivative(value, top)?);
        }
        compare(&terms, &Tape::new(&graph, &slopes)?)?;
        for (parameter, (regressor, slope)) in terms.regressor().iter().zip(&slopes).enumerate() {
            let regressor = graph.import(regressor)?;
            if !graph.agree(*slope, regressor) {
                return Err(ChainError::AntiderivativeNotShown { parameter });
            }
        }
        values.extend(turned);
        let tape = Tape::new(&graph, &values)?;
        Ok(Immersion { terms, following, adaptation, estimate_start, bounds: None, tape })
    }

    /// The same with an estimate that is used no farther than `bounds`; their margins are not read.
    ///
    /// # Errors
    /// [`ChainError`] when there is not an entry for each parameter.
    pub fn bounded(self, bounds: ParameterBounds) -> Result<Self, ChainError> {
        bounds.check(self.terms.parameters())?;
        Ok(Immersion { bounds: Some(bounds), ..self })
    }

    /// Φ = φ v for a φ without v, the highest derivative of a plant of order `order`.
    pub fn antiderivative(order: usize, phi: &Expression) -> Option<Expression> {
        let v = order.checked_sub(1)?;
        (!phi.has(v)).then(|| phi.clone() * Expression::variable(v))
    }

    /// How z is followed.
    pub fn following(&self) -> &Following {
        &self.following
    }

    /// Where θ̂ stands in the state.
    fn at(&self) -> usize {
        self.following.guide.vectors(self.terms.order())
    }
}

/// Compares ∂Φ/∂v with φ at points spread over [−2, 2]^k, and by intervals, which a slip that is small there does not escape,
/// at these and at points a thousand and a million times as far: so that a mistake is told with its numbers.
fn compare(terms: &Formulas, slopes: &Tape) -> Result<(), ChainError> {
    let (k, p) = (terms.order(), terms.parameters());
    let (mut work, mut workspace) = (terms.scratch(), slopes.workspace());
    let (mut x, mut phi, mut slope) = (vec![0.0; k], vec![0.0; p], vec![0.0; p]);
    for point in 0..TRIED {
        for (r, x) in x.iter_mut().enumerate() {
            // Multiples of an irrational number spread evenly.
            let share = (point + 1) as f64 * libm::sqrt((2 * r * r + 3 * r + 2) as f64 + 0.25);
            *x = 4.0 * (share - libm::floor(share)) - 2.0;
        }
        terms.terms(&mut work, &x, &mut phi)?;
        slopes.evaluate(&x, &mut workspace, &mut slope)?;
        for (parameter, (phi, slope)) in phi.iter().zip(&slope).enumerate() {
            if (phi - slope).abs() > CLOSE * phi.abs().max(1.0) {
                return Err(ChainError::Antiderivative { parameter, slope: *slope, regressor: *phi });
            }
        }
        for scale in [1.0, 1e3, 1e6] {
            let far: Vec<f64> = x.iter().map(|x| scale * x).collect();
            let at: Vec<Interval> = far.iter().map(|x| Interval::point(*x)).collect();
            for (parameter, (phi, slope)) in terms.regressor().iter().zip(slopes.enclose(&far)?).enumerate() {
                let phi = phi.fold(&mut Intervals(&at));
                if phi.low <= phi.high && (phi.high < slope.low || slope.high < phi.low) {
                    let [slope, regressor] = [slope, phi].map(|within| 0.5 * (within.low + within.high));
                    return Err(ChainError::Antiderivative { parameter, slope, regressor });
                }
            }
        }
    }
    Ok(())
}

/// Working memory of [`Immersion`].
#[derive(Clone, Debug)]
pub struct ImmersionWork {
    following: FollowingWork<FormulasWork>,
    workspace: Vec<f64>,
    out: Vec<f64>,
}

impl Controller for Immersion {
    type Plant = Chain<Formulas>;
    type Exchange = Position;
    type Measured<'a> = ChainMeasured<'a>;
    type Scratch = ImmersionWork;

    const MEASURES: &'static [&'static str] = &["position", "its derivatives below the order of the plant"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        self.following.guide.target_derivatives()
    }

    fn scratch(&self) -> ImmersionWork {
        ImmersionWork {
            following: self.following.work(&self.terms),
            workspace: self.tape.workspace(),
            out: vec![0.0; self.tape.outputs()],
        }
    }

    fn states(&self) -> Vec<Block> {
        let mut states = self.following.states(self.terms.order());
        states.push((Signal::Estimate, self.terms.parameters()));
        states
    }

    fn shown(&self) -> Vec<Block> {
        self.following.shown(self.terms.order(), self.terms.parameters())
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity | Signal::Derivative(_))
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<ChainMeasured<'a>, LengthError> {
        LengthError::check("output", self.terms.order(), output.len())?;
        Ok(ChainMeasured { x: output })
    }

    fn start(
        &self,
        work: &mut ImmersionWork,
        given: ControllerInput<'_, Self>,
        wanted: &[Vec<f64>],
        state: &mut [f64],
    ) -> Result<(), LengthError> {
        LengthError::check("state", self.at() + self.terms.parameters(), state.len())?;
        let x = given.measured.x;
        self.following.start(self.terms.order(), (x, given.heard.degree), wanted, state)?;
        self.tape.evaluate(x, &mut work.workspace, &mut work.out)?;
        for (j, theta_hat) in state[self.at()..].iter_mut().enumerate() {
            *theta_hat = self.estimate_start[j] - self.adaptation[j] * work.out[j];
        }
        Ok(())
    }

    fn evaluate(
        &self,
        work: &mut ImmersionWork,
        given: ControllerInput<'_, Self>,
        state: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        let ControllerOutput { input, d_state, shown } = asked;
        let (p, at, x) = (self.terms.parameters(), self.at(), given.measured.x);
        self.following.lengths(&self.terms, p, [state.len(), d_state.len(), input.len(), shown.len()])?;
        let ImmersionWork { following, workspace, out } = work;
        let found = self.following.evaluate(&self.terms, following, given, x, state, (d_state, shown))?;
        self.tape.evaluate(x, workspace, out)?;
        // What v does on the manifold ζ = 0.
        let dv = found.dz - self.following.gain_per_s * found.s;
        let mut chi = found.chi;
        for j in 0..p {
            let (phi, gamma) = (following.phi[j], self.adaptation[j]);
            let mut estimate = state[at + j] + gamma * out[j];
            d_state[at + j] = -gamma * (phi * dv + out[p + j]);
            if let Some(bounds) = &self.bounds {
                let range = bounds.range(j);
                d_state[at + j] -= self.following.gain_per_s * range.beyond(estimate);
                estimate = range.nearest(estimate);
            }
            chi += phi * estimate;
            shown[at + 2 + j] = estimate;
        }
        input[0] = (dv - chi) / found.psi;
        Ok(())
    }

    fn trouble(&self, _: &[f64], shown: &[f64]) -> Option<Singularity> {
        self.following.trouble(self.terms.order(), shown)
    }

    fn settle(&self, _: &mut [f64]) {}

    fn balance(
        &self,
        work: &mut ImmersionWork,
        truth: Truth<'_, Self::Plant>,
        _: ControllerInput<'_, Self>,
        state: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        let (p, k) = (self.terms.parameters(), self.following.gain_per_s);
        LengthError::check("theta", p, truth.plant.theta.len())?;
        let s = self.following.s(&self.terms, p, shown)?;
        let FollowingWork { terms, phi, .. } = &mut work.following;
        self.terms.terms(terms, truth.state, phi)?;
        let (mut value, mut eta, mut withheld) = (0.5 * s * s, 0.0, 0.0);
        for j in 0..p {
            let zeta = shown[self.at() + 2 + j] - truth.plant.theta[j];
            eta += phi[j] * zeta;
            let mut learnt = 0.5 * zeta * zeta;
            if let Some(bounds) = &self.bounds {
                self.tape.evaluate(truth.state, &mut work.workspace, &mut work.out)?;
                let (range, theta) = (bounds.range(j), truth.plant.theta[j]);
                let mu = state.get(self.at() + j).copied().unwrap_or(f64::NAN) + self.adaptation[j] * work.out[j];
                learnt = range.potential(mu, theta);
                withheld += range.withheld(mu, theta) / self.adaptation[j];
            }
            value += learnt / (k * self.adaptation[j]);
        }
        let power: f64 = truth.external.iter().map(|w| (s + eta / k) * w).sum();
        Ok(Balance { value, dissipation: k * s * s + s * eta + eta * eta / k + withheld - power })
    }
}
