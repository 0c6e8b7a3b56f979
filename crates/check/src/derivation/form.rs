//! The one representation of all derivations: linear chains with delays.
//!
//! A [`Form`] is
//!
//! ```text
//! Σ_v A_v(p) v_i + Σ_j w_ij(t) [ Σ_v B_v(p) v_i + Σ_v C_v(p) v_j(t − T_ij(t)) ],      p = d/dt
//! ```
//!
//! with polynomials in p. The weights stand to the left of p: w_ij(t) and p do not commute, and e^(−pT) with a T that varies does not
//! commute with p either. So a form over links that vary cannot be differentiated, and [`Form::differentiated`] says so. Nothing
//! else ever multiplies from the left, which is how a derivation shows that no weight and no delay is differentiated.
//!
//! What is not linear takes part as a letter, without meaning: a sign, the torque of a regressor, a vector times a matrix.

use std::collections::BTreeMap;

use num_rational::BigRational;
use num_traits::{One, Zero};
use thiserror::Error;

use super::polynomial::Polynomial;

/// Whose a quantity is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Vertex {
    /// Agent i.
    Own,
    /// Its neighbour j, as it is heard: at t − T_ij(t).
    Neighbour,
    /// The leader, vertex 0.
    Leader,
    /// The leader at the time of which neighbour j tells: at t − T_ij(t).
    LateLeader,
}

impl Vertex {
    /// Whether it is taken at t − T_ij(t).
    pub fn is_heard(self) -> bool {
        matches!(self, Vertex::Neighbour | Vertex::LateLeader)
    }

    /// Whether it is the leader, now or then.
    pub fn is_leader(self) -> bool {
        matches!(self, Vertex::Leader | Vertex::LateLeader)
    }
}

/// A signal, or a nonlinear term that stands for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Letter {
    /// z.
    Reference,
    /// q, or x.
    Position,
    /// q less what is to be followed.
    Deviation,
    /// z less the derivative of a target that it follows.
    ReferenceDeviation,
    /// A variable of a reduced system, by its number.
    Variable(usize),
    /// The trajectory to be followed.
    Target,
    /// x̂, where an agent believes its leader to be; its derivative is v̂.
    Observed,
    /// y = ż + β z + α q, which agents tell that agree with their leader on it.
    Composite,
    /// The integrated variable of (3), (23), (119) and (122).
    Integral,
    /// s.
    Error,
    /// y, the output of a filter that stands in for s.
    Filter,
    /// φ(q_i − q_j(t − T_ij)), of a nonlinear coupling.
    Coupled,
    /// What is not linear.
    Term(Term),
}

/// A nonlinear term: nothing is known of it here but its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// ς ∈ Sgn[…].
    Sign,
    /// τ.
    Torque,
    /// g(q).
    Gravity,
    /// Y(q, q̇, z, ż) ϑ̂.
    Regressor,
    /// Y(q, q̇, z, ż) Δϑ, Δϑ = ϑ̂ − ϑ.
    RegressorError,
    /// u, or u* of a vehicle.
    Input,
    /// g e₃.
    Weight,
    /// m̂ w, w = z̈ + α* ż − α* g e₃.
    MassEstimate,
    /// Δm w, Δm = m̂ − m.
    MassError,
    /// m̂ ż.
    MassEstimateRate,
    /// Δm ż.
    MassErrorRate,
    /// Ĵᵀ K* Δx.
    TaskForce,
    /// z_r.
    JointReference,
    /// ω_d.
    DesiredRate,
    /// Rᵀ ω̇_d^I.
    DesiredAcceleration,
    /// Δq_v.
    AttitudeError,
    /// D(Δq*)ᵀ K ẏ.
    AttitudeDamping,
    /// Δq*.
    AttitudeDifference,
    /// K Δq*.
    AttitudeErrorRate,
    /// M S(Δω) ω_d.
    GyroscopicPull,
    /// τ_ext, or a force; dry friction is a part of it.
    External,
    /// w, which acts on the last equation of a chain.
    Disturbance,
    /// F tanh(q̇/ε).
    Friction,
    /// F tanh(z/ε).
    ReferenceFriction,
    /// χ(x*).
    Drift,
    /// ψ(x*) u.
    Actuation,
    /// φᵀ Δθ, Δθ = θ̂ − θ.
    ChainRegressorError,
    /// φᵀ ζ, of immersion and invariance.
    ImmersionError,
    /// What reference dynamics from outside add that does not depend on the state.
    Constant,
    /// f of desired dynamics, a nonlinear protocol.
    Protocol,
}

/// A linear map without a number that acts on a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Operator {
    /// None.
    Identity,
    /// M(q), or the constant M of a spacecraft.
    Inertia,
    /// C(q, q̇).
    Coriolis,
    /// K.
    Damping,
    /// m.
    Mass,
    /// S(h).
    Momentum,
    /// S(·) ω_d.
    Gyroscopic,
    /// Λ_f.
    Filter,
    /// D(q), what the joints of a robot lose.
    Viscous,
    /// D(Δq*) of (98), D(Δq) where a law has no reference attitude.
    AttitudeMap,
}

impl Operator {
    /// Whether it commutes with p.
    pub fn is_constant(self) -> bool {
        match self {
            Operator::Identity | Operator::Damping | Operator::Mass | Operator::Filter => true,
            Operator::Inertia
            | Operator::Coriolis
            | Operator::Momentum
            | Operator::Gyroscopic
            | Operator::Viscous
            | Operator::AttitudeMap => false,
        }
    }
}

/// A letter of an agent, under an operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quantity {
    /// What acts on it.
    pub operator: Operator,
    /// What it is.
    pub letter: Letter,
    /// Whose it is.
    pub vertex: Vertex,
}

impl Quantity {
    /// Agent i's own.
    pub fn own(letter: Letter) -> Self {
        Quantity { operator: Operator::Identity, letter, vertex: Vertex::Own }
    }

    /// That of neighbour j, as it is heard.
    pub fn heard(letter: Letter) -> Self {
        Quantity { vertex: Vertex::Neighbour, ..Quantity::own(letter) }
    }

    /// That of the leader.
    pub fn of_leader(letter: Letter) -> Self {
        Quantity { vertex: Vertex::Leader, ..Quantity::own(letter) }
    }

    /// The same under an operator.
    pub fn under(self, operator: Operator) -> Self {
        Quantity { operator, ..self }
    }
}

/// Σ A_v(p) v over quantities v, none of which has the polynomial zero.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Combination(BTreeMap<Quantity, Polynomial>);

impl Combination {
    /// A(p) v.
    pub fn of(quantity: Quantity, polynomial: Polynomial) -> Self {
        Combination::default().plus(quantity, &polynomial)
    }

    /// With A(p) v more.
    pub fn plus(mut self, quantity: Quantity, polynomial: &Polynomial) -> Self {
        let sum = self.0.get(&quantity).map_or_else(|| polynomial.clone(), |old| old + polynomial);
        if sum.is_zero() {
            self.0.remove(&quantity);
        } else {
            self.0.insert(quantity, sum);
        }
        self
    }

    /// Its terms, in a fixed order.
    pub fn terms(&self) -> impl Iterator<Item = (Quantity, &Polynomial)> {
        self.0.iter().map(|(quantity, polynomial)| (*quantity, polynomial))
    }

    /// A_v(p), zero where v is not in it.
    pub fn polynomial(&self, quantity: Quantity) -> Polynomial {
        self.0.get(&quantity).cloned().unwrap_or_default()
    }

    /// Whether nothing is in it.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// The sum of two.
    pub fn sum(&self, other: &Combination) -> Combination {
        other.terms().fold(self.clone(), |sum, (quantity, polynomial)| sum.plus(quantity, polynomial))
    }

    /// Everything times a polynomial.
    pub fn times(&self, factor: &Polynomial) -> Combination {
        self.terms().fold(Combination::default(), |all, (quantity, a)| all.plus(quantity, &(a * factor)))
    }

    /// With D(p) v replaced: A(p) v = Q(p) D(p) v + R(p) v becomes Q(p) applied to `by(v)`, and R(p) v stays. `by` gives `None` for
    /// quantities that stay as they are.
    pub fn replaced(&self, divisor: &Polynomial, by: impl Fn(Quantity) -> Option<Combination>) -> Combination {
        self.terms().fold(Combination::default(), |all, (quantity, a)| {
            match by(quantity).and_then(|by| Some((by, a.divided_by(divisor)?))) {
                Some((by, (quotient, rest))) => all.sum(&by.times(&quotient)).plus(quantity, &rest),
                None => all.plus(quantity, a),
            }
        })
    }

    /// The highest power of p on a letter, whoever's; `None` where it is not in it.
    pub fn highest(&self, letter: Letter) -> Option<usize> {
        self.terms().filter(|(quantity, _)| quantity.letter == letter).filter_map(|(_, a)| a.degree()).max()
    }
}

/// Whether links can be differentiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Links {
    /// A fixed graph with constant weights and constant delays.
    Constant,
    /// Anything else.
    Varying,
}

/// Why something has no derivative, or not one that can be had.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Undifferentiable {
    /// ẇ_ij or Ṫ_ij would be needed.
    #[error(
        "its derivative would contain that of w_ij(t), which is not bounded where the graph switches, and that of T_ij(t)"
    )]
    Links,
    /// The derivative of a matrix that varies would be needed.
    #[error("its derivative would contain that of a matrix that depends on the state")]
    Operator,
}

/// What agent i has by itself, and Σ_j w_ij of what stands in the bracket.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Form {
    /// A_v(p) v_i.
    pub own: Combination,
    /// What stands in Σ_j w_ij […].
    pub network: Combination,
}

impl Form {
    /// Without neighbours.
    pub fn own(own: Combination) -> Self {
        Form { own, network: Combination::default() }
    }

    /// Σ_j w_ij […] alone.
    pub fn network(network: Combination) -> Self {
        Form { own: Combination::default(), network }
    }

    /// The sum of two.
    pub fn sum(&self, other: &Form) -> Form {
        Form { own: self.own.sum(&other.own), network: self.network.sum(&other.network) }
    }

    /// Everything times a number, which commutes with all.
    pub fn scaled(&self, number: &BigRational) -> Form {
        let number = Polynomial::number(number.clone());
        Form { own: self.own.times(&number), network: self.network.times(&number) }
    }

    /// With the opposite sign.
    pub fn negated(&self) -> Form {
        self.scaled(&-BigRational::one())
    }

    /// What is left of it less another.
    pub fn less(&self, other: &Form) -> Form {
        self.sum(&other.negated())
    }

    /// Its derivative.
    ///
    /// # Errors
    /// [`Undifferentiable`] where it holds links that vary, or a matrix that does.
    pub fn differentiated(&self, links: Links) -> Result<Form, Undifferentiable> {
        if links == Links::Varying && !self.network.is_zero() {
            return Err(Undifferentiable::Links);
        }
        if self.quantities().any(|quantity| !quantity.operator.is_constant()) {
            return Err(Undifferentiable::Operator);
        }
        let p = Polynomial::power(1);
        Ok(Form { own: self.own.times(&p), network: self.network.times(&p) })
    }

    /// With D(p) v replaced on both sides of the bracket, as [`Combination::replaced`] has it: whatever the weights do, since they
    /// stand to the left.
    pub fn replaced(&self, divisor: &Polynomial, by: impl Fn(Quantity) -> Option<Combination>) -> Form {
        Form { own: self.own.replaced(divisor, &by), network: self.network.replaced(divisor, &by) }
    }

    /// With a letter of every agent replaced by other letters of the same agent, under the same operator.
    pub fn with(&self, letter: Letter, divisor: &Polynomial, by: &[(Letter, Polynomial)]) -> Form {
        self.replaced(divisor, |quantity| {
            let each = |all: Combination, (letter, a): &(Letter, Polynomial)| {
                all.plus(Quantity { letter: *letter, ..quantity }, a)
            };
            (quantity.letter == letter).then(|| by.iter().fold(Combination::default(), each))
        })
    }

    /// Without a letter: what is left once it has vanished.
    pub fn without(&self, letter: Letter) -> Form {
        self.with(letter, &Polynomial::one(), &[])
    }

    /// The highest power of p on a letter, whoever's.
    pub fn highest(&self, letter: Letter) -> Option<usize> {
        self.own.highest(letter).max(self.network.highest(letter))
    }

    /// Whether it is zero.
    pub fn is_zero(&self) -> bool {
        self.own.is_zero() && self.network.is_zero()
    }

    /// All quantities in it.
    pub fn quantities(&self) -> impl Iterator<Item = Quantity> {
        self.own.terms().chain(self.network.terms()).map(|(quantity, _)| quantity)
    }

    /// Its value, from those of the k-th derivatives of all quantities: `value` has the number of the link for what stands in the
    /// bracket, and `weights` the weight of every link.
    pub fn value(&self, weights: &[f64], value: &dyn Fn(Option<usize>, Quantity, usize) -> f64) -> f64 {
        let sum = |all: &Combination, link: Option<usize>| -> f64 {
            let each = |(quantity, a): (Quantity, &Polynomial)| -> f64 {
                let terms = a.coefficients().iter().enumerate().filter(|(_, c)| !c.is_zero());
                terms.map(|(k, c)| number(c) * value(link, quantity, k)).sum()
            };
            all.terms().map(each).sum()
        };
        let links = weights.iter().enumerate().map(|(link, weight)| weight * sum(&self.network, Some(link)));
        sum(&self.own, None) + links.sum::<f64>()
    }
}

/// The nearest `f64`.
pub(crate) fn number(exact: &BigRational) -> f64 {
    num_traits::ToPrimitive::to_f64(exact).unwrap_or(f64::NAN)
}
