//! The lower subsystem: what s obeys, from the equations of motion and the law.
//!
//! Everything is linear but for letters that stand for themselves. The law is put into the equations of motion, an estimate is split into the
//! truth and its error, and the derivative of q that z follows is replaced by z + s. What is left holds s and errors of estimates alone.

use num_rational::BigRational;
use num_traits::One;

use super::form::{Combination, Form, Letter, Operator, Quantity, Term};
use super::formula::Formula;
use super::notation::Notation;
use super::polynomial::Polynomial;

/// A second step and what it leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Lower {
    /// The equations of motion, all on one side but for the input: = input.
    pub plant: Form,
    /// The input.
    pub input: Term,
    /// What acts beside the input: = input + this.
    pub outside: Form,
    /// What the law makes the input.
    pub law: Form,
    /// What of s and its derivatives stands on the left of the lower subsystem.
    pub left: Form,
    /// The right side.
    pub right: Form,
    /// How many derivatives of s its state holds, and one: 1 for s alone.
    pub order: usize,
}

impl Lower {
    /// The input alone.
    pub fn input_alone(&self) -> Form {
        Form::own(term(self.input))
    }

    /// The right side of the equations of motion.
    pub fn moved_by(&self) -> Form {
        self.input_alone().sum(&self.outside)
    }

    /// The equations of motion as they are written.
    pub fn motion(&self, notation: &Notation) -> Formula {
        Formula::equal(notation.form(&self.plant), notation.form(&self.moved_by()))
    }
}

/// What an estimate is: the truth, which the equations of motion know, and its error.
struct Estimate {
    letter: Term,
    truth: Combination,
    error: Term,
}

fn own(letter: Letter, operator: Operator, r: usize) -> Combination {
    Combination::of(Quantity::own(letter).under(operator), Polynomial::power(r))
}

fn term(term: Term) -> Combination {
    own(Letter::Term(term), Operator::Identity, 0)
}

fn times(all: &Combination, number: &BigRational) -> Combination {
    all.times(&Polynomial::number(number.clone()))
}

fn sum(parts: &[Combination]) -> Combination {
    parts.iter().fold(Combination::default(), |sum, part| sum.sum(part))
}

fn minus(all: &Combination) -> Combination {
    times(all, &-BigRational::one())
}

/// What the paper's equations of motion leave out, and a setup may have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outside {
    /// D(q) q̇, in the regressor too.
    pub damped: bool,
    /// τ_ext, which no law knows.
    pub pushed: bool,
    /// Friction at the joints, in the regressor as F tanh(z/ε).
    pub rubbing: Option<Rubbing>,
}

/// What the friction of a robot is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rubbing {
    /// F tanh(q̇/ε).
    Smooth,
    /// F σ, which stands in τ_ext.
    Dry,
}

impl Outside {
    fn acting(self) -> Combination {
        if self.pushed { term(Term::External) } else { Combination::default() }
    }
}

/// The residual with the law put in, p^(follows) q = z + s, and estimates split.
fn lower(
    [plant, law, acting]: [Combination; 3],
    input: Term,
    estimate: Option<Estimate>,
    known: bool,
    [follows, order]: [usize; 2],
) -> Lower {
    let one = Polynomial::one();
    let residual = Form::own(plant.sum(&minus(&law)).sum(&minus(&acting)));
    let split = residual.replaced(&one, |quantity| {
        let estimate = estimate.as_ref().filter(|estimate| quantity.letter == Letter::Term(estimate.letter))?;
        Some(if known { estimate.truth.clone() } else { estimate.truth.sum(&term(estimate.error)) })
    });
    let in_z = [(Letter::Reference, one.clone()), (Letter::Error, one)];
    let residual = split.with(Letter::Position, &Polynomial::power(follows), &in_z);
    // s under a matrix of the motion, or its highest derivative, stands on the left.
    let highest = residual.highest(Letter::Error).unwrap_or(0);
    let stays = |quantity: Quantity, a: &Polynomial| {
        quantity.letter == Letter::Error
            && (a.degree() == Some(highest) || matches!(quantity.operator, Operator::Coriolis))
    };
    let side = |left: bool| {
        let terms = residual.own.terms().filter(|(quantity, a)| stays(*quantity, a) == left);
        Form::own(terms.fold(Combination::default(), |all, (quantity, a)| all.plus(quantity, a)))
    };
    // What has p^highest and lower powers under one operator keeps only the former on the left.
    let (left, low) = top_of(&side(true), highest);
    let [plant, law, outside] = [plant, law, acting].map(Form::own);
    Lower { plant, input, outside, law, left, right: side(false).sum(&low).negated(), order }
}

/// The highest powers of what is under an operator that has them, and what is left; C s stays whole.
fn top_of(left: &Form, highest: usize) -> (Form, Form) {
    let (mut top, mut low) = (Combination::default(), Combination::default());
    for (quantity, a) in left.own.terms() {
        let lead = Polynomial::power(highest).scaled(&a.coefficient(highest));
        let (keep, rest) = if lead.is_zero() { (a.clone(), Polynomial::default()) } else { (lead.clone(), a - &lead) };
        (top, low) = (top.plus(quantity, &keep), low.plus(quantity, &rest));
    }
    (Form::own(top), Form::own(low))
}

/// M p v + C v + g = Y ϑ for a velocity v, which is Property 3, and D v and the friction where the robot has them.
fn motion(damped: bool, friction: Option<Term>, velocity: impl Fn(Operator, usize) -> Combination) -> Combination {
    let lost = if damped { velocity(Operator::Viscous, 0) } else { Combination::default() };
    let rubs = friction.map(term).unwrap_or_default();
    sum(&[velocity(Operator::Inertia, 1), velocity(Operator::Coriolis, 0), lost, rubs, term(Term::Gravity)])
}

/// (1) under (6)–(7), or with known parameters; with a force of the task space times κ for (80).
pub fn robot(outside: Outside, known: bool, task_force: Option<&BigRational>) -> Lower {
    let rubs = outside.rubbing.filter(|rubbing| *rubbing == Rubbing::Smooth).map(|_| Term::Friction);
    let plant = motion(outside.damped, rubs, |operator, r| own(Letter::Position, operator, r + 1));
    let rubs = outside.rubbing.map(|_| Term::ReferenceFriction);
    let truth = motion(outside.damped, rubs, |operator, r| own(Letter::Reference, operator, r));
    let damping = minus(&own(Letter::Error, Operator::Damping, 0));
    let force = task_force.map(|kappa| minus(&times(&term(Term::TaskForce), kappa))).unwrap_or_default();
    let law = sum(&[damping, force, term(Term::Regressor)]);
    let estimate = Estimate { letter: Term::Regressor, truth, error: Term::RegressorError };
    lower([plant, law, outside.acting()], Term::Torque, Some(estimate), known, [1, 1])
}

/// A point mass under (a8).
pub fn position_only(outside: Outside, k: &BigRational) -> Lower {
    let plant = own(Letter::Position, Operator::Mass, 2);
    let law = sum(&[term(Term::MassEstimateRate), minus(&times(&own(Letter::Filter, Operator::Identity, 0), k))]);
    let truth = own(Letter::Reference, Operator::Mass, 1);
    let estimate = Estimate { letter: Term::MassEstimateRate, truth, error: Term::MassErrorRate };
    lower([plant, law, outside.acting()], Term::Input, Some(estimate), false, [1, 1])
}

/// m (p² v + α* p v) − α* m g e₃ for a velocity v: (47), and what (50) and (57) make of z.
fn vehicle(alpha: &BigRational, velocity: impl Fn(usize) -> Combination) -> Combination {
    let weight = own(Letter::Term(Term::Weight), Operator::Mass, 0);
    sum(&[velocity(2), times(&velocity(1), alpha), minus(&times(&weight, alpha))])
}

/// (47) under (50) with stiffness k, or under (57).
///
/// A force f_ext makes m ẍ = … + f_ext, so that (p + α*) f_ext stands beside u* in (47).
pub fn thrust(outside: Outside, alpha: &BigRational, stiffness: Option<&BigRational>) -> Lower {
    let acting = outside.acting().times(&Polynomial::factor(alpha));
    let plant = vehicle(alpha, |r| own(Letter::Position, Operator::Mass, r + 1));
    let truth = vehicle(alpha, |r| own(Letter::Reference, Operator::Mass, r));
    match stiffness {
        Some(k) => {
            let law = truth.sum(&minus(&times(&own(Letter::Error, Operator::Identity, 0), k)));
            lower([plant, law, acting], Term::Input, None, true, [1, 2])
        }
        None => {
            let estimate = Estimate { letter: Term::MassEstimate, truth, error: Term::MassError };
            lower([plant, term(Term::MassEstimate), acting], Term::Input, Some(estimate), false, [1, 2])
        }
    }
}

/// (94) under (99). z follows ω, which stands for q here.
pub fn attitude(outside: Outside) -> Lower {
    let motion = |letter| own(letter, Operator::Inertia, 1).sum(&minus(&own(letter, Operator::Momentum, 0)));
    let law = motion(Letter::Reference).sum(&minus(&term(Term::AttitudeDamping)));
    lower([motion(Letter::Position), law, outside.acting()], Term::Torque, None, true, [0, 1])
}

/// (94) under a filter of the attitude error: what is left holds Δω = ω − ω_d, and ω̇_d = Rᵀω̇_d^I − S(Δω) ω_d.
pub fn passivity_filter(outside: Outside, k: &BigRational) -> Lower {
    let desired = |term, operator| own(Letter::Term(term), operator, 0);
    let motion = own(Letter::Position, Operator::Inertia, 1).sum(&minus(&own(Letter::Position, Operator::Momentum, 0)));
    let law = sum(&[
        desired(Term::DesiredAcceleration, Operator::Inertia),
        minus(&desired(Term::DesiredRate, Operator::Momentum)),
        minus(&times(&term(Term::AttitudeError), k)),
        minus(&term(Term::AttitudeDamping)),
    ]);
    let one = Polynomial::one();
    let residual = Form::own(motion.sum(&minus(&law)).sum(&minus(&outside.acting())));
    let rate = Letter::Term(Term::DesiredRate);
    let residual = residual.with(Letter::Position, &one, &[(Letter::Deviation, one.clone()), (rate, one.clone())]);
    let pulled = || desired(Term::DesiredAcceleration, Operator::Inertia).sum(&minus(&term(Term::GyroscopicPull)));
    let carried = Quantity::own(rate).under(Operator::Inertia);
    let residual = residual.replaced(&Polynomial::power(1), |quantity| (quantity == carried).then(pulled));
    let left = Form::own(own(Letter::Deviation, Operator::Inertia, 1));
    let right = left.less(&residual);
    let [plant, law, outside] = [motion, law, outside.acting()].map(Form::own);
    Lower { plant, input: Term::Torque, outside, law, left, right, order: 1 }
}

/// How the second line of (43) is stabilised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChainError {
    /// χ is known.
    None,
    /// φᵀ Δθ is left.
    Adapted,
    /// φᵀ ζ is left.
    Immersed,
}

/// (33) of order k with ψ u = ż − χ̂ − c s: by feedback linearisation, adaptation or immersion.
pub fn chain(outside: Outside, order: usize, gain: &BigRational, error: ChainError) -> Lower {
    let plant = own(Letter::Position, Operator::Identity, order).sum(&minus(&term(Term::Drift)));
    let left_over = match error {
        ChainError::None => Combination::default(),
        ChainError::Adapted => minus(&term(Term::ChainRegressorError)),
        ChainError::Immersed => minus(&term(Term::ImmersionError)),
    };
    let damping = minus(&times(&own(Letter::Error, Operator::Identity, 0), gain));
    let law = sum(&[own(Letter::Reference, Operator::Identity, 1), minus(&term(Term::Drift)), damping, left_over]);
    let acting = if outside.pushed { term(Term::Disturbance) } else { Combination::default() };
    lower([plant, law, acting], Term::Actuation, None, true, [order.saturating_sub(1), 1])
}
