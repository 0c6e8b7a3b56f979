//! Reference dynamics as forms: where each begins.
//!
//! A design says first what q should do, in q alone. Then derivatives that are not measured are replaced by those of z, which are
//! constructed (Remark 6): pʳ q becomes p^(r−k+1) z for a plant of order k, z following p^(k−1) q.

use forwardstep_core::expression::Number;
use forwardstep_sim::reference::{LinearReference, LinearTerms};
use num_rational::BigRational;
use num_traits::One;

use super::factors::Factors;
use super::form::{Combination, Form, Letter, Links, Quantity, Term, Undifferentiable, Vertex};
use super::polynomial::Polynomial;

/// p^ℓ z = …, for a plant of order k.
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    /// ℓ. Zero where z is no state.
    pub order: usize,
    /// k: z follows p^(k−1) q.
    pub plant: usize,
    /// The right side.
    pub right: Form,
}

/// Where the derivatives of q come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Measured {
    /// k: z follows p^(k−1) q.
    pub plant: usize,
    /// pʳ q is measured, or integrated to something measured, for r below this.
    pub below: usize,
}

impl Measured {
    /// q and q̇ of a plant of order two.
    pub const ROBOT: Measured = Measured { plant: 2, below: 2 };
    /// q, q̇ and, under an integral, q̈: (3) and (119).
    pub const WITH_ACCELERATION: Measured = Measured { plant: 2, below: 3 };

    /// Everything below the order of the plant.
    pub fn whole(plant: usize) -> Self {
        Measured { plant, below: plant }
    }

    /// With z in the place of what is not measured.
    fn constructed(self, form: &Form) -> Form {
        let z = Polynomial::power((self.below + 1).saturating_sub(self.plant));
        form.replaced(&Polynomial::power(self.below), |quantity| {
            (quantity == Quantity::own(Letter::Position))
                .then(|| Combination::of(Quantity::own(Letter::Reference), z.clone()))
        })
    }

    pub(super) fn dynamics(self, order: usize, wanted: &Form) -> Dynamics {
        Dynamics { order, plant: self.plant, right: self.constructed(wanted) }
    }
}

/// A number times a letter.
fn term(letter: Letter, number: BigRational) -> Combination {
    Combination::of(Quantity::own(letter), Polynomial::number(number))
}

/// a(p) q_i − b(p) q_j.
fn difference(own: &Polynomial, heard: &Polynomial) -> Combination {
    Combination::of(Quantity::own(Letter::Position), own.clone()).plus(Quantity::heard(Letter::Position), &-heard)
}

/// What is heard of a neighbour: α₀ q_j, or with velocities (α₀/κ₀)(p + κ₀) q_j.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// Positions: (24), (23).
    Positions,
    /// Positions and velocities: (aa10), (a1), (a5), (3).
    Velocities,
    /// φ(q_i − q_j) with positions.
    Coupled,
}

/// The consensus family: with A(p) = ∏_r (p + κ_r), or with factors (p + a)² + b² in it,
///
/// ```text
/// p A(p) q_i = −Σ_j w_ij [ A(p) q_i − what is heard of q_j ] + λ s_i
/// ```
///
/// before z takes the place of what is not measured. (aa10), (a1), (a5) and (24) for [`Measured::ROBOT`], (3), (23) and (31) for
/// [`Measured::WITH_ACCELERATION`], (43) with (24) for others. `None` without roots, with too few for the
/// plant, or with velocities and no real one.
pub fn consensus(roots: &Factors, heard: Heard, lambda: &BigRational, measured: Measured) -> Option<Dynamics> {
    let order = (roots.order() + 2).checked_sub(measured.plant).filter(|_| roots.order() > 0)?;
    let a = roots.product();
    let alpha_0 = a.coefficient(0);
    let top = Polynomial::power(roots.order() + 1);
    let own = Combination::of(Quantity::own(Letter::Position), &top - &(&a * &Polynomial::power(1)))
        .sum(&term(Letter::Error, lambda.clone()));
    let bracket = match heard {
        Heard::Positions => difference(&a, &Polynomial::number(alpha_0)),
        Heard::Velocities => {
            let first = roots.real.first()?;
            difference(&a, &Polynomial::factor(first).scaled(&(alpha_0 / first)))
        }
        // φ(q_i − q_j) where q_i − q_j stood.
        Heard::Coupled => difference(&(&a - &Polynomial::number(alpha_0.clone())), &Polynomial::default())
            .sum(&term(Letter::Coupled, alpha_0)),
    };
    let wanted = Form::own(own).less(&Form::network(bracket));
    Some(measured.dynamics(order, &wanted))
}

/// A target q_d: A(p)(q − q_d) = 0 before z takes the place of what is not measured; (a9) and (43) for tracking. `None` without roots,
/// or with too few for the plant.
pub fn tracking(roots: &Factors, measured: Measured) -> Option<Dynamics> {
    let order = (roots.order() + 1).checked_sub(measured.plant)?;
    let a = roots.product();
    let wanted = Combination::of(Quantity::own(Letter::Position), &Polynomial::power(roots.order()) - &a)
        .plus(Quantity::own(Letter::Target), &a);
    (roots.order() > 0).then(|| measured.dynamics(order, &Form::own(wanted)))
}

/// The velocity of backstepping, before (aa6): −Σ_j w_ij (q_i − q_j).
pub fn backstepping() -> Dynamics {
    let one = Polynomial::one();
    Dynamics { order: 0, plant: 2, right: Form::network(difference(&one, &one)).negated() }
}

/// Reference dynamics from outside, for robots: what their author says that they are.
pub fn declared(linear: &LinearReference) -> Dynamics {
    let polynomial = |numbers: &[f64]| Polynomial::new(numbers.iter().map(|number| Number::written(*number)).collect());
    let terms = |terms: &LinearTerms| {
        Combination::of(Quantity::own(Letter::Position), polynomial(&terms.q))
            .plus(Quantity::own(Letter::Reference), &polynomial(&terms.z))
    };
    let constant = if linear.constant { Polynomial::one() } else { Polynomial::default() };
    let own = terms(&linear.own).plus(Quantity::own(Letter::Term(Term::Constant)), &constant);
    let network = terms(&linear.coupled).plus(Quantity::heard(Letter::Position), &-&polynomial(&linear.heard));
    Dynamics { order: linear.order, plant: Measured::ROBOT.plant, right: Form { own, network } }
}

/// −γ ς.
fn sign(gamma: &BigRational) -> Form {
    Form::own(term(Letter::Term(Term::Sign), -gamma))
}

/// (110).
pub fn following(alpha: &BigRational, gamma: &BigRational) -> Dynamics {
    let xi = Polynomial::factor(alpha);
    let own = Combination::of(Quantity::own(Letter::Position), Polynomial::power(1).scaled(&-alpha));
    let right = Form::own(own).less(&Form::network(difference(&xi, &xi))).sum(&sign(gamma));
    Dynamics { order: 1, plant: 2, right }
}

/// How a leader is followed with differentiable torques.
#[derive(Clone, Debug, PartialEq)]
pub struct Smooth {
    /// α.
    pub alpha: BigRational,
    /// β.
    pub beta: BigRational,
    /// γ.
    pub gamma: BigRational,
    /// Whether an agent uses its own position and velocity, as in (119) and (122); swarm tracking does not.
    pub by_itself: bool,
    /// The factor of differences to neighbours: 1, or k of swarm tracking.
    pub coupling: BigRational,
}

impl Smooth {
    /// p² + β p + α.
    pub fn xi(&self) -> Polynomial {
        Polynomial::new(vec![self.alpha.clone(), self.beta.clone(), BigRational::one()])
    }

    /// ż as it is integrated: with an integrated variable in it, whose rate is [`Smooth::integral_rate`].
    pub fn realised(&self) -> Dynamics {
        let p = Polynomial::power(1);
        let own = if self.by_itself { &Polynomial::power(2) - &self.xi() } else { Polynomial::default() };
        let own =
            Combination::of(Quantity::own(Letter::Position), own).sum(&term(Letter::Integral, BigRational::one()));
        let right = Form::own(own).less(&Form::network(difference(&p, &p)).scaled(&self.coupling));
        Dynamics { order: 1, plant: 2, right }
    }

    /// The rate of that variable, in which the sign stands.
    pub fn integral_rate(&self) -> Form {
        let low = &self.xi() - &Polynomial::power(2);
        Form::network(difference(&low, &low)).scaled(&-&self.coupling).sum(&sign(&self.gamma))
    }

    /// (119), or the derivative of (122): z̈ without the integrated variable. Weights and delays are constant, as the theorems have it.
    ///
    /// # Errors
    /// [`Undifferentiable`] where the links vary.
    pub fn dynamics(&self, links: Links) -> Result<Dynamics, Undifferentiable> {
        let derivative = self.realised().right.differentiated(links)?;
        let integral = Quantity::own(Letter::Integral);
        let rest = Combination::of(integral, -&derivative.own.polynomial(integral));
        Ok(Dynamics { order: 2, plant: 2, right: derivative.sum(&Form::own(rest)).sum(&self.integral_rate()) })
    }
}

/// A right side p² z as ż = H + η and η̇ = R, with what of it is a derivative of what is measured in H, and nothing that is heard: (3) and (23)
/// as they are integrated.
#[derive(Clone, Debug, PartialEq)]
pub struct Integrated {
    /// ż.
    pub dz: Form,
    /// η̇.
    pub d_eta: Form,
}

impl Dynamics {
    /// The same without derivatives of what is measured. Weights have to be constant; what is heard keeps its delay, however that varies.
    pub fn integrated(&self) -> Integrated {
        let p = Polynomial::power(1);
        let own = |quantity: Quantity| quantity.vertex == Vertex::Own && quantity.letter == Letter::Position;
        let kept = |quantity: Quantity| own(quantity).then(Combination::default);
        let d_eta = self.right.replaced(&p, kept);
        let derivatives = self.right.less(&d_eta);
        // Each is p times something.
        let lowered = |all: &Combination| {
            all.terms().fold(Combination::default(), |sum, (quantity, a)| match a.divided_by(&p) {
                Some((quotient, _)) => sum.plus(quantity, &quotient),
                None => sum,
            })
        };
        let dz = Form { own: lowered(&derivatives.own), network: lowered(&derivatives.network) };
        Integrated { dz: dz.sum(&Form::own(term(Letter::Integral, BigRational::one()))), d_eta }
    }

    /// N = ℓ + k − 1: the order of what q obeys.
    pub fn total_order(&self) -> usize {
        self.order + self.plant.saturating_sub(1)
    }

    /// Whether neighbours enter it.
    pub fn has_network(&self) -> bool {
        !self.right.network.is_zero()
    }
}
