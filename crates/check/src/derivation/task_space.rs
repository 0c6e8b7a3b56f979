//! The end-effector of a robot, (76)–(82), in which Ĵᵀ K* Δx and z_r stand for themselves; and the same with a measured velocity of the tip.

use forwardstep_core::robot::tree::Follows;
use forwardstep_sim::TaskSpaceLaw;
use num_rational::BigRational;

use super::adaptation::{self, nonlinear};
use super::cascade::Upper;
use super::case::Case;
use super::dynamics::Dynamics;
use super::explanation::{Explained, Section, Subject};
use super::form::{Combination, Form, Letter, Quantity, Term};
use super::formula::Formula;
use super::lower::{self, Lower};
use super::polynomial::Polynomial;

/// (76): ż.
pub(super) fn reference(alpha: &BigRational) -> Dynamics {
    let alpha = Polynomial::number(alpha.clone());
    let own = Combination::of(nonlinear(Term::JointReference), &Polynomial::power(1) + &alpha)
        .plus(Quantity::own(Letter::Reference), &-&alpha)
        .plus(nonlinear(Term::TaskForce), &-&Polynomial::one());
    Dynamics { order: 1, plant: 2, right: Form::own(own) }
}

/// The rate of q̇ − z_r − s, which is z − z_r, after (a10).
pub(super) fn reduced(upper: &Upper) -> Form {
    // p (p q − z_r − s) = p² q − p z_r − p s, and p q = (p q − z_r − s) + z_r + s in what is left.
    let p = Polynomial::power(1);
    let gone = Combination::of(nonlinear(Term::JointReference), -&p).plus(Quantity::own(Letter::Error), &-&p);
    let one = Polynomial::one();
    upper.right.sum(&Form::own(gone)).replaced(&p, |quantity| {
        (quantity == Quantity::own(Letter::Position)).then(|| {
            Combination::of(Quantity::own(Letter::Deviation), one.clone())
                .plus(nonlinear(Term::JointReference), &one)
                .plus(Quantity::own(Letter::Error), &one)
        })
    })
}

/// z of the law with a measured velocity of the tip: a function, in which z_r stands for Ĵ⁻¹(ẋ_d − αΔx).
pub(super) fn function() -> Dynamics {
    let own = Combination::of(nonlinear(Term::JointReference), Polynomial::one());
    Dynamics { order: 0, plant: 2, right: Form::own(own) }
}

/// ż of it.
pub(super) fn rate() -> Form {
    Form::own(Combination::of(nonlinear(Term::JointReference), Polynomial::power(1)))
}

/// What controls the joints, and (73).
fn controller(case: &Case<'_>, lower: &Lower) -> Section {
    let notation = case.notation();
    let input = Quantity::own(Letter::Term(lower.input));
    let section = Section::new(Subject::Controller)
        .formula(lower.motion(&notation), "(73)")
        .formula(Formula::equal(notation.quantity(input, 0), notation.form(&lower.law)), "(80)");
    let adapted = adaptation::of(case, &notation).into_iter();
    adapted.fold(section, |section, (formula, place)| section.formula(formula, place))
}

/// The explanation of the law with a measured velocity of the tip.
pub(super) fn by_velocity(case: &Case<'_>, kappa: &BigRational, alpha: &BigRational) -> Explained {
    let notation = case.notation();
    let dynamics = function();
    let upper = dynamics.upper();
    let lower = lower::robot(case.outside(), false, Some(kappa));
    let [q, z] = [Letter::Position, Letter::Reference].map(Quantity::own);
    let degree = upper.degree(lower.order);
    let sections = vec![
        Section::new(Subject::VirtualControl)
            .words(
                "Not from the paper, but in the manner of the literature with which Remark 9 compares Theorem 6: the velocity of the \
                 end-effector is measured. z is what the velocity of the joints should be.",
            )
            .formula(
                Formula::equal(notation.quantity(Quantity::own(Letter::Error), 0), notation.form(&dynamics.definition_of_error())),
                "(79)",
            ),
        Section::new(Subject::ReferenceDynamics)
            .words(format!(
                "z is no state but a function: zᵣ stands for Ĵ⁻¹(ẋ_d − αΔx) with α = {alpha}, (77) for a path that leads back to the target."
            ))
            .formula(notation.equation(z, 0, &dynamics.right), "")
            .words(
                "Its derivative Ĵ⁻¹(ẍ_d − αΔẋ − (dĴ/dt)z) takes the measured ẋ in Δẋ = ẋ − ẋ_d, where Theorem 6 integrates: what is wrong \
                 with that measurement is in the torque at once.",
            )
            .formula(notation.equation(z, 1, &rate()), ""),
        controller(case, &lower),
        Section::new(Subject::Cascade)
            .system(
                vec![
                    notation.equation(q, 1, &dynamics.loop_with_reference()),
                    Formula::equal(notation.form(&lower.left), notation.form(&lower.right)),
                ],
                "",
            )
            .words(format!(
                "Times Ĵ the upper subsystem is dΔx/dt = −αΔx + Ĵs − ZΔθ. It holds s without a derivative: the cascade is of degree {degree}, and \
                 there is nothing to reduce."
            )),
        Section::new(Subject::Convergence).words(
            "V = ½ sᵀM s + ½ ΔϑᵀΓ⁻¹Δϑ + (κ/2)[ΔxᵀK*Δx + ΔθᵀΛ⁻¹Δθ] has V̇ = −sᵀK s − κ α ΔxᵀK*Δx, for as long as Ĵ stays away from singularity. \
             So s and Δx are bounded and square-integrable; z is bounded, then ẋ and the derivative of s are, and both vanish.",
        ),
    ];
    Explained { agents: case.agents.clone(), order: Some(1), degrees: Some([degree; 2]), sections }
}

/// The explanation.
pub(super) fn explained(case: &Case<'_>, [kappa, alpha]: &[BigRational; 2]) -> Explained {
    let notation = case.notation();
    let dynamics = reference(alpha);
    let upper = dynamics.upper();
    let lower = lower::robot(case.outside(), false, Some(kappa));
    let q = Quantity::own(Letter::Position);
    let v = Combination::of(q, Polynomial::power(1))
        .plus(nonlinear(Term::JointReference), &-&Polynomial::one())
        .plus(Quantity::own(Letter::Error), &-&Polynomial::one());
    let rate = reduced(&upper)
        .replaced(&Polynomial::one(), |quantity| (quantity == Quantity::own(Letter::Deviation)).then(|| v.clone()));
    let v = Formula::Rate(Box::new(Formula::bracket(notation.form(&Form::own(v)))));
    let mut sections = vec![
        Section::new(Subject::VirtualControl)
            .words("z is what the velocity of the joints should be, and its derivative what the virtual control q̈ should be. zᵣ would lead the end-effector along its target if Ĵ were J.")
            .formula(Formula::equal(notation.quantity(q, 2), notation.quantity(q, 2)), "(aa3)")
            .formula(
                Formula::equal(notation.quantity(Quantity::own(Letter::Error), 0), notation.form(&dynamics.definition_of_error())),
                "(79)",
            ),
        Section::new(Subject::ReferenceDynamics)
            .formula(notation.equation(Quantity::own(Letter::Reference), 1, &dynamics.right), "(76)"),
        controller(case, &lower),
        Section::new(Subject::Cascade)
            .system(
                vec![
                    notation.equation(q, 2, &dynamics.loop_with_reference()),
                    Formula::equal(notation.form(&lower.left), notation.form(&lower.right)),
                ],
                "(a10)",
            )
            .words(format!("The upper subsystem holds s with one derivative: the cascade is of degree {}.", upper.degree(1))),
        Section::new(Subject::DegreeReduction)
            .words("q̇ − zᵣ − s absorbs the derivative of s; it is z − zᵣ.")
            .formula(Formula::equal(v, notation.form(&rate)), "after (a10)"),
        Section::new(Subject::Convergence).words(
            "V = (κ/2)[|z − zᵣ|² + ΔxᵀK*Δx + ΔθᵀΛ⁻¹Δθ] + ½ sᵀM s + ½ ΔϑᵀΓ⁻¹Δϑ has V̇ = −sᵀK s − κ α |z − zᵣ|², for as long as Ĵ stays away \
             from singularity. So s and z − zᵣ are bounded and square-integrable, and vanish; then ĴᵀK*Δx does, and Δx with it.",
        ),
    ];
    let left = reduced(&upper).highest(Letter::Error).unwrap_or(0);
    sections.extend(extension(case).map(|words| Section::new(Subject::Convergence).words(words)));
    Explained { agents: case.agents.clone(), order: Some(2), degrees: Some([upper.degree(1), left]), sections }
}

/// What a pose or redundant joints change, which is not in the paper.
fn extension(case: &Case<'_>) -> Option<&'static str> {
    let agent = case.setup.agents.get(*case.agents.first()?)?;
    match agent.law.downcast::<TaskSpaceLaw>()?.tip.follows() {
        Follows::Position => None,
        Follows::RedundantPosition => Some(
            "Not from the paper: there are more joints than coordinates, Ĵ⁻¹ stands for Ĵ⁺ = Ĵᵀ(ĴĴᵀ)⁻¹, and zᵣ = Ĵ⁺ẋ_d + (I − Ĵ⁺Ĵ)φ with \
             φₖ = −kₙ rₖ/√(1 + rₖ²), r = q − qₙ. The proof takes of zᵣ only that Ĵzᵣ = ẋ_d and that it is bounded with its \
             derivative, so V and V̇ are the same; q̇ − zᵣ → 0, and the free motion of the joints is that of φ.",
        ),
        Follows::Pose => Some(
            "Not from the paper: x is a position and an orientation. K*Δx stands for e = (K_pΔp, k_oΔq_v), Δq the quaternion of R R_dᵀ, \
             and ½ΔxᵀK*Δx for U = ½ΔpᵀK_pΔp + 2k_o(1 − Δq_o). d/dt 2(1 − Δq_o) = Δq_vᵀ(ω − ω_d) in coordinates of the base, so the \
             rate of U is eᵀ(Jq̇ − ẋ_d), ẋ_d = (ṗ_d, ω_d), and V̇ is the same. k_o is one number: with a matrix there is no U. Then e \
             vanishes: Δp → 0 and Δq_v → 0, which is the attitude reached for Δq_o = 1 and for Δq_o = −1.",
        ),
    }
}
