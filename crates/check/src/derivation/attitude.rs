//! Attitude tracking, (97)–(108), in which nothing is linear but how ω, z and ω − z enter; and the passivity filter beside it, without z.

use num_rational::BigRational;

use super::adaptation::{self, nonlinear};
use super::case::Case;
use super::explanation::{Explained, Section, Subject};
use super::form::{Combination, Form, Letter, Operator, Quantity, Term};
use super::formula::{Formula, Sign, Symbol};
use super::lower;
use super::polynomial::Polynomial;
use super::quaternion::{self, Factor, Products};
use super::words;

/// (97): ż.
pub(super) fn reference([alpha_1, alpha_2]: &[BigRational; 2]) -> Form {
    let number = |number: &BigRational| Polynomial::number(number.clone());
    let z = Quantity::own(Letter::Reference);
    let own = Combination::of(nonlinear(Term::DesiredAcceleration), Polynomial::one())
        .plus(z.under(Operator::Gyroscopic), &-&Polynomial::one())
        .plus(z, &number(&-alpha_2))
        .plus(nonlinear(Term::DesiredRate), &number(alpha_2))
        .plus(nonlinear(Term::AttitudeError), &number(&-alpha_1));
    Form::own(own)
}

/// The first line of (107): the rate of Δω = ω − ω_d, from (97), ω = z + s and ω̇_d = Rᵀω̇_d^I − S(ω) ω_d.
pub(super) fn error(reference: &Form) -> Form {
    let one = Polynomial::one();
    let omega = Quantity::own(Letter::Position);
    let desired = Combination::of(nonlinear(Term::DesiredAcceleration), one.clone())
        .plus(omega.under(Operator::Gyroscopic), &-&one);
    let s = Combination::of(Quantity::own(Letter::Error), Polynomial::power(1));
    let rate = reference.sum(&Form::own(s)).less(&Form::own(desired));
    let minus = -&one;
    // z = ω − s, under S(·) ω_d too; then ω by itself is Δω + ω_d.
    let rate = rate.with(Letter::Reference, &one, &[(Letter::Position, one.clone()), (Letter::Error, minus)]);
    rate.replaced(&one, |quantity| {
        (quantity == omega).then(|| {
            Combination::of(Quantity::own(Letter::Deviation), one.clone()).plus(nonlinear(Term::DesiredRate), &one)
        })
    })
}

/// (100): ẏ + Λ_f y = K Δq*.
pub(super) fn filter() -> (Form, Form) {
    let y = Quantity::own(Letter::Filter);
    let left = Combination::of(y, Polynomial::power(1)).plus(y.under(Operator::Filter), &Polynomial::one());
    (Form::own(left), Form::own(Combination::of(nonlinear(Term::AttitudeErrorRate), Polynomial::one())))
}

/// (106): Δq̇* = D(Δq*) (ω − z), where s = ω − z and D(Δq*) v is ½ Δq* v, a product of quaternions.
pub(super) fn difference_rate() -> Form {
    let s = Quantity::own(Letter::Error).under(Operator::AttitudeMap);
    Form::own(Combination::of(s, Polynomial::one()))
}

/// How (106) follows: the derivative of Δq* = q_z⁻¹ q, and what stands behind Δq* in it.
fn kinematics(mut section: Section) -> Section {
    let symbol = |below: &'static str| Symbol::new("q").below(below);
    for (factor, left) in [(Factor::Attitude, symbol("")), (Factor::ReferenceAttitude, symbol("z"))] {
        if let Some(rate) = Products::of(&[factor]).differentiated() {
            section = section.formula(Formula::equal(left.derivative(1), rate.formula()), "");
        }
    }
    let delta = Symbol::new("Δq").above("∗");
    section = section.formula(Formula::equal(delta.clone(), Products::of(&quaternion::difference()).formula()), "");
    if let Some(behind) = quaternion::turning() {
        let product = Formula::product([delta.clone().into(), Formula::bracket(behind.formula())]);
        section = section.formula(Formula::equal(delta.derivative(1), product), "");
    }
    section
}

/// Δq̇ = D(Δq) Δω, where a law has no reference attitude.
pub(super) fn error_rate() -> Form {
    let delta = Quantity::own(Letter::Deviation).under(Operator::AttitudeMap);
    Form::own(Combination::of(delta, Polynomial::one()))
}

/// (108): the derivative of ẏ + Λ_f y = K Δq*, with (106) in it.
pub(super) fn filter_rate() -> Option<(Form, Form)> {
    let (left, right) = filter();
    let differentiated = |form: Form| form.differentiated(super::form::Links::Constant).ok();
    Some((differentiated(left)?, differentiated(right)?))
}

/// The explanation.
pub(super) fn explained(case: &Case<'_>, gains: &[BigRational; 2]) -> Explained {
    let notation = case.notation();
    let reference = reference(gains);
    let lower = lower::attitude(case.outside());
    let (z, s) = (Quantity::own(Letter::Reference), Quantity::own(Letter::Error));
    let definition = Formula::sum([
        (Sign::Plus, notation.quantity(Quantity::own(Letter::Position), 0)),
        (Sign::Minus, notation.quantity(z, 0)),
    ]);
    let delta = notation.quantity(Quantity::own(Letter::Deviation), 1);
    let input = Quantity::own(Letter::Term(lower.input));
    let mut controller = Section::new(Subject::Controller)
        .formula(lower.motion(&notation), "(94)")
        .formula(Formula::equal(notation.quantity(input, 0), notation.form(&lower.law)), "(99)");
    for (formula, place) in adaptation::of(case, &notation) {
        controller = controller.formula(formula, place);
    }
    controller = controller.words(
        "Δq* is the quaternion of R_zᵀR, and R and R_z turn with ω and z. With products of quaternions, in which a velocity stands \
         for a quaternion without a scalar part, and z in coordinates of the body:",
    );
    let difference = nonlinear(Term::AttitudeDifference);
    controller = kinematics(controller)
        .words("Half the product with a velocity behind it is the matrix D of (98), so that")
        .formula(notation.equation(difference, 1, &difference_rate()), "(106)");
    let cascade = Section::new(Subject::Cascade)
        .words("Δω = ω − ω_d. The kinematics are not linear, and stand for themselves; ω, z and s enter linearly.")
        .system(vec![Formula::equal(delta, notation.form(&error(&reference)))], "(107), first line")
        .system(vec![Formula::equal(notation.form(&lower.left), notation.form(&lower.right))], "(107), second line")
        .words("(The paper prints two of these signs otherwise, E13.) The upper subsystem holds s with one derivative: the cascade is of degree 1.");
    let mut reduction = Section::new(Subject::DegreeReduction).words(
        "Nothing has to be absorbed: s and its derivative vanish, which the filter shows, and what is left is linear in Δω but for the \
         attitude.",
    );
    if let Some((left, right)) = filter_rate() {
        reduction = reduction.formula(Formula::equal(notation.form(&left), notation.form(&right)), "(108)");
    }
    let sections = vec![
        Section::new(Subject::VirtualControl)
            .words("z is what the angular velocity ω should be; its derivative is what the virtual control ω̇ should be.")
            .formula(Formula::equal(notation.quantity(s, 0), definition), ""),
        Section::new(Subject::ReferenceDynamics).formula(notation.equation(z, 1, &reference), "(97)"),
        controller,
        cascade,
        reduction,
        Section::new(Subject::Convergence).words(words::of_s(case)).words(
            "Then Δω̇ = −α₂ Δω − α₁ Δq_v is what is left, for which ½ ΔωᵀΔω + 2 α₁ (1 − Δq_o) falls: Δω → 0 and Δq_v → 0.",
        ),
    ];
    Explained { agents: case.agents.clone(), order: Some(2), degrees: Some([1, 1]), sections }
}

/// The explanation of a passivity filter.
pub(super) fn filtered(case: &Case<'_>, k: &BigRational) -> Explained {
    let notation = case.notation();
    let lower = lower::passivity_filter(case.outside(), k);
    let input = Quantity::own(Letter::Term(lower.input));
    let mut controller = Section::new(Subject::Controller)
        .formula(lower.motion(&notation), "(94)")
        .formula(Formula::equal(notation.quantity(input, 0), notation.form(&lower.law)), "");
    for (formula, place) in adaptation::of(case, &notation) {
        controller = controller.formula(formula, place);
    }
    let difference = nonlinear(Term::AttitudeDifference);
    controller = controller
        .words("Δq is the quaternion of R_dᵀR, and Δω = ω − ω_d. No angular velocity is measured: ẏ stands in for Δω, since")
        .formula(notation.equation(difference, 1, &error_rate()), "");
    let cascade = Section::new(Subject::Cascade)
        .words(
            "There is no virtual control and no reference velocity, and so no cascade: with ω̇_d = Rᵀω̇_d^I − S(Δω) ω_d the error obeys",
        )
        .system(vec![Formula::equal(notation.form(&lower.left), notation.form(&lower.right))], "");
    let sections = vec![controller, cascade, Section::new(Subject::Convergence).words(words::of_s(case))];
    Explained { agents: case.agents.clone(), order: None, degrees: None, sections }
}
