//! The polynomial (25) in factors with rational coefficients.

use forwardstep_core::expression::Number;
use forwardstep_core::reference::RootSet;
use num_rational::BigRational;

use super::polynomial::Polynomial;

/// ∏_r (p + κ_r) · ∏_k ((p + a_k)² + b_k²).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Factors {
    /// κ₀, κ₁, ….
    pub real: Vec<BigRational>,
    /// a and b of every pair of complex roots.
    pub pairs: Vec<[BigRational; 2]>,
}

impl Factors {
    /// Of roots as they are written.
    pub fn written(roots: &RootSet) -> Self {
        Factors {
            real: roots.real.iter().map(|root| Number::written(*root)).collect(),
            pairs: roots.pairs.iter().map(|pair| [pair.real, pair.imaginary].map(Number::written)).collect(),
        }
    }

    /// Of real roots.
    #[cfg(test)]
    pub fn of_real(roots: &[BigRational]) -> Self {
        Factors { real: roots.to_vec(), pairs: Vec::new() }
    }

    /// The degree of the product.
    pub fn order(&self) -> usize {
        self.real.len() + 2 * self.pairs.len()
    }

    /// All κ, where every root is real: then there is a chain of averages.
    pub fn all_real(&self) -> Option<&[BigRational]> {
        self.pairs.is_empty().then_some(&self.real)
    }

    /// The factors, real roots first.
    pub fn factors(&self) -> impl Iterator<Item = Polynomial> + '_ {
        let square =
            |[a, b]: &[BigRational; 2]| &(&Polynomial::factor(a) * &Polynomial::factor(a)) + &Polynomial::number(b * b);
        self.real.iter().map(Polynomial::factor).chain(self.pairs.iter().map(square))
    }

    /// All of them multiplied.
    pub fn product(&self) -> Polynomial {
        self.factors().fold(Polynomial::one(), |product, factor| &product * &factor)
    }

    /// The first factors up to the degree `r`, with p + a where that ends within a pair.
    pub fn first(&self, r: usize) -> Polynomial {
        let whole = self.pairs.len().min(r.saturating_sub(self.real.len()) / 2);
        let begun = Factors {
            real: self.real.iter().take(r).cloned().collect(),
            pairs: self.pairs.iter().take(whole).cloned().collect(),
        };
        let within = r.saturating_sub(self.real.len() + 2 * whole);
        match self.pairs.get(whole) {
            Some([a, _]) if within == 1 => &begun.product() * &Polynomial::factor(a),
            Some(_) | None => begun.product(),
        }
    }
}
