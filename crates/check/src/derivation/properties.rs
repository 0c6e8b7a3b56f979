//! What is derived for any order and any roots.

use num_rational::BigRational;
use num_traits::{One, Zero};
use proptest::prelude::*;

use super::dynamics::{Heard, Measured, consensus, tracking};
use super::factors::Factors;
use super::form::{Combination, Form, Letter, Quantity};
use super::laplacian::{RootsOfAll, chain};
use super::polynomial::Polynomial;
use super::reduction::{Name, Variable};

/// Positive roots, none of which is a whole number in general.
fn any_roots() -> impl Strategy<Value = Vec<BigRational>> {
    let root = (1..60_i64, 1..9_i64).prop_map(|(n, d)| BigRational::new(n.into(), d.into()));
    proptest::collection::vec(root, 1..8)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn prop_26_is_of_degree_l_and_every_step_of_27_takes_one_from_it(roots in any_roots(), told in 0..2_usize) {
        let told = [Heard::Positions, Heard::Velocities][told];
        let upper = consensus(&Factors::of_real(&roots), told, &BigRational::zero(), Measured::ROBOT).unwrap().upper();
        let order = roots.len();
        prop_assert_eq!((upper.order, upper.degree(1)), (order + 1, order));
        let left: Vec<usize> = upper.steps(0).iter().map(|step| step.degree(1)).collect();
        prop_assert_eq!(left, (0..=order).rev().collect::<Vec<_>>());
    }

    #[test]
    fn prop_a6_and_30_are_averages_for_any_order_and_roots(roots in any_roots(), told in 0..2_usize) {
        let told = [Heard::Positions, Heard::Velocities][told];
        let upper = consensus(&Factors::of_real(&roots), told, &BigRational::zero(), Measured::ROBOT).unwrap().upper();
        for common in [RootsOfAll::Same, RootsOfAll::SameFirst] {
            let laplacian = upper.laplacian(chain(&roots, told as usize, common)).unwrap();
            // ψ̇_r = κ_r (ψ_{r+1} − ψ_r), and Σ w (ψ_j − ψ) at the end.
            let first = told as usize;
            for (row, blocks) in laplacian.blocks.iter().enumerate().take(roots.len() - first) {
                let kappa = &roots[first + row];
                prop_assert_eq!(&blocks[row].identity, &-kappa);
                prop_assert_eq!(&blocks[row + 1].identity, kappa);
            }
            let last = laplacian.blocks.last().unwrap();
            prop_assert_eq!(&last[0].weights, &BigRational::one());
            prop_assert_eq!(&last.last().unwrap().degrees, &-BigRational::one());
        }
        // Where κ₀ differs what is heard is no multiple of the neighbour's ψ (E1); positions always are.
        prop_assert_eq!(upper.laplacian(chain(&roots, told as usize, RootsOfAll::Own)).is_some(), told == Heard::Positions);
    }

    #[test]
    fn prop_what_agents_conserve_is_x_less_alpha_1_s(roots in any_roots()) {
        // d/dt (X − α₁ s) = −Σ w [X − α₀ q_j] whatever s does: the head of the consensus family.
        let upper = consensus(&Factors::of_real(&roots), Heard::Positions, &BigRational::zero(), Measured::ROBOT).unwrap().upper();
        let a = Polynomial::with_roots(&roots);
        let p = Polynomial::power(1);
        let lifted = Variable::constructed(Name::Reduced(0), a.clone(), [2, 2], true);
        let conserved = Variable { input: &lifted.input + &Polynomial::number(a.coefficient(1)), ..lifted };
        let rate = Form::own(Combination::of(Quantity::own(Letter::Position), &(&a * &p) - &Polynomial::power(upper.order))
            .plus(Quantity::own(Letter::Error), &-&(&conserved.input * &p)));
        prop_assert!(rate.sum(&upper.right).own.is_zero());
    }

    #[test]
    fn prop_tracking_reduces_to_its_polynomial_and_terms_in_s_alone(roots in any_roots(), plant in 1..6_usize) {
        prop_assume!(roots.len() >= plant);
        let dynamics = tracking(&Factors::of_real(&roots), Measured::whole(plant)).unwrap();
        let upper = dynamics.upper().relative_to([Quantity::own(Letter::Target); 2]);
        prop_assert!(upper.right.quantities().all(|quantity| quantity.letter != Letter::Target), "the target cancels");
        let steps = upper.steps(0);
        let last = steps.last().unwrap();
        let a = Polynomial::with_roots(&roots);
        if dynamics.order > 0 {
            prop_assert_eq!(last.degree(1), 0);
            let rate = last.rates.last().unwrap();
            for r in 0..roots.len() {
                let coefficient = rate.own.polynomial(Quantity::own(Letter::Variable(r))).coefficient(0);
                prop_assert_eq!(coefficient, -a.coefficient(r));
            }
            // The head of `guide`: c s with c = α_{k−1}.
            let c = rate.own.polynomial(Quantity::own(Letter::Error));
            prop_assert_eq!(c, Polynomial::number(-a.coefficient(plant - 1)));
        }
    }
}
