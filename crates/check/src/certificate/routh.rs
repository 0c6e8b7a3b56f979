//! That desired dynamics of a target are Hurwitz, or are not, by the array of Routh.
//!
//! For A(p) = a_n pⁿ + … + a₀ with a_n > 0 the array begins with the rows (a_n, a_{n−2}, …) and (a_{n−1}, a_{n−3}, …); each further row is
//! the one two above it, without its first entry, less the multiple of the one above it that makes that first entry vanish. All roots
//! of A lie to the left of the axis if and only if the n + 1 first entries are positive (Routh and Hurwitz). With rational
//! coefficients they are rational numbers.

use forwardstep_sim::Setup;
use forwardstep_sim::reference::Desired;
use num_rational::BigRational;
use num_traits::{Signed, Zero};

use super::producers::Claim;
use super::proof::Proof;
use crate::Answer;
use crate::derivation::polynomial_of;

/// Of what is x less the target alone, without neighbours.
pub(super) fn of_target(setup: &Setup, claim: &Claim<'_>) -> Option<Proof> {
    let desired: &Desired = setup.reference.downcast()?;
    let linear = desired.protocol.is_none() && desired.coupling.is_none() && desired.heard.is_empty();
    if !(linear && desired.follows_target) {
        return None;
    }
    let column = first_column(polynomial_of(&desired.polynomial, true).coefficients());
    let stable = column.iter().all(BigRational::is_positive);
    match claim.answer {
        Answer::Holds => stable.then_some(Proof::Routh(column)),
        Answer::Violated => (!stable).then_some(Proof::NoRouth(column)),
        Answer::HoldsOnHorizon | Answer::Watched | Answer::NotShown | Answer::NotCovered => None,
    }
}

/// The first entries of the rows, up to the first that is not positive, of a polynomial by its coefficients from that of p⁰ on, the last
/// of which is positive.
fn first_column(ascending: &[BigRational]) -> Vec<BigRational> {
    let every_second = |skipped: usize| ascending.iter().rev().skip(skipped).step_by(2).cloned().collect::<Vec<_>>();
    let entry = |row: &[BigRational], at: usize| row.get(at).cloned().unwrap_or_else(BigRational::zero);
    let (mut above, mut row) = (every_second(0), every_second(1));
    let mut column = vec![entry(&above, 0)];
    while column.len() < ascending.len() {
        let lead = entry(&row, 0);
        column.push(lead.clone());
        if !lead.is_positive() {
            break;
        }
        let share = entry(&above, 0) / lead;
        let next = (1..above.len().max(row.len())).map(|at| entry(&above, at) - &share * entry(&row, at)).collect();
        (above, row) = (row, next);
    }
    column
}
