//! The Laplacian form: (17), (a4), (a6), (30). Without s, every entry of ψ moves towards a weighted average of entries of ψ, own and heard.

use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use super::cascade::Upper;
use super::form::{Form, Letter, Quantity};
use super::polynomial::Polynomial;
use super::reduction::{Name, Reduced, Variable};

/// A chain of averages.
#[derive(Clone, Debug, PartialEq)]
pub struct Laplacian {
    /// The entries of ψ, with their rates.
    pub chain: Reduced,
    /// The coefficients of all agents stacked, without delay, block by block.
    pub blocks: Vec<Vec<Block>>,
}

/// a I + b D_w + c W, with D_w the diagonal of Σ_j w_ij and W the matrix of w_ij.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// a.
    pub identity: BigRational,
    /// b.
    pub degrees: BigRational,
    /// c.
    pub weights: BigRational,
}

/// What the agents' roots have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RootsOfAll {
    /// All of them.
    Same,
    /// κ₀.
    SameFirst,
    /// Nothing.
    Own,
}

/// ψ with its first entry at the power `from` of the chain: 0 for q, 1 for (p + κ₀) q. Scaled so that all entries agree where all are at
/// rest at the same place: as in (a6) and (30) by α₀ where all agents have the same roots, else by one. The first entry is then common if it
/// is q, or if κ₀ is.
pub fn chain(roots: &[BigRational], from: usize, roots_of_all: RootsOfAll) -> Vec<Variable> {
    let whole: BigRational = roots.iter().skip(from).fold(BigRational::one(), |all, kappa| all * kappa);
    let first: BigRational = roots.iter().take(from).fold(BigRational::one(), |all, kappa| all * kappa);
    let mut scale = if roots_of_all == RootsOfAll::Same { whole } else { first.recip() };
    (from..=roots.len())
        .map(|r| {
            if r > from {
                scale = &scale / &roots[r - 1];
            }
            let state = Polynomial::with_roots(&roots[..r]).scaled(&scale);
            let common = match roots_of_all {
                RootsOfAll::Same => true,
                RootsOfAll::SameFirst => r == from && from < 2,
                RootsOfAll::Own => r == from && from == 0,
            };
            Variable { name: Name::Psi(r), state, input: Polynomial::default(), common }
        })
        .collect()
}

impl Upper {
    /// The system without s as a chain of averages; `None` where these variables do not give one.
    pub fn laplacian(&self, chain: Vec<Variable>) -> Option<Laplacian> {
        let chain = self.undisturbed().reduced(chain)?;
        let blocks: Option<Vec<Vec<Block>>> =
            chain.rates.iter().map(|rate| blocks(rate, chain.variables.len())).collect();
        let blocks = blocks?;
        (blocks.iter().enumerate().all(|(row, blocks)| is_average(row, blocks))).then_some(Laplacian { chain, blocks })
    }
}

/// The blocks of one row; `None` where a rate holds anything but the variables.
fn blocks(rate: &Form, variables: usize) -> Option<Vec<Block>> {
    let plain = |all: &super::form::Combination| {
        all.terms().all(|(quantity, a)| matches!(quantity.letter, Letter::Variable(_)) && a.degree() == Some(0))
    };
    if !plain(&rate.own) || !plain(&rate.network) {
        return None;
    }
    let block = |m: usize| {
        let number = |all: &super::form::Combination, quantity: Quantity| all.polynomial(quantity).coefficient(0);
        let letter = Letter::Variable(m);
        Block {
            identity: number(&rate.own, Quantity::own(letter)),
            degrees: number(&rate.network, Quantity::own(letter)),
            weights: number(&rate.network, Quantity::heard(letter)),
        }
    };
    Some((0..variables).map(block).collect())
}

/// Whether a row is one of a Laplacian with the opposite sign: nothing negative off the diagonal, and sums of zero.
fn is_average(row: usize, blocks: &[Block]) -> bool {
    let sum = |of: fn(&Block) -> &BigRational| blocks.iter().fold(BigRational::zero(), |sum, block| sum + of(block));
    let off = |(column, block): (usize, &Block)| {
        !block.weights.is_negative()
            && (column == row || (!block.identity.is_negative() && !block.degrees.is_negative()))
    };
    blocks.iter().enumerate().all(off)
        && sum(|block| &block.identity).is_zero()
        && (sum(|block| &block.degrees) + sum(|block| &block.weights)).is_zero()
}
