//! Products of quaternions that do not commute, with rational coefficients: how attitudes turn, and with them (106).
//!
//! An angular velocity stands for the quaternion (ω, 0). What is known is how the attitude turns with ω in coordinates of the body, and q_z
//! with z, of which the law holds the coordinates in the body too:
//!
//! ```text
//! q̇ = ½ q ω        q̇_z = ½ (q z q⁻¹) q_z        Δq* = q_z⁻¹ q
//! ```

use num_rational::BigRational;
use num_traits::{One, Zero};

use super::formula::{Formula, Sign, Symbol};

/// What products are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Factor {
    /// q.
    Attitude,
    /// q⁻¹.
    AttitudeInverse,
    /// q_z.
    ReferenceAttitude,
    /// q_z⁻¹.
    ReferenceInverse,
    /// ω.
    Rate,
    /// z.
    Reference,
}

impl Factor {
    fn inverse_of(self, other: Factor) -> bool {
        use Factor::{Attitude, AttitudeInverse, ReferenceAttitude, ReferenceInverse};
        matches!(
            (self, other),
            (Attitude, AttitudeInverse)
                | (AttitudeInverse, Attitude)
                | (ReferenceAttitude, ReferenceInverse)
                | (ReferenceInverse, ReferenceAttitude)
        )
    }

    /// Its derivative; `None` of an angular velocity, of which none is known here.
    fn rate(self) -> Option<Products> {
        use Factor::{Attitude, AttitudeInverse, Rate, Reference, ReferenceAttitude, ReferenceInverse};
        let half = BigRational::new(1.into(), 2.into());
        // (x⁻¹)' = −x⁻¹ x' x⁻¹
        let inverse = |x: Factor, inverse: Factor| {
            let around = Products::of(&[inverse]);
            Some(around.times(&x.rate()?).times(&around).scaled(&-BigRational::one()))
        };
        match self {
            Attitude => Some(Products::of(&[Attitude, Rate]).scaled(&half)),
            ReferenceAttitude => {
                Some(Products::of(&[Attitude, Reference, AttitudeInverse, ReferenceAttitude]).scaled(&half))
            }
            AttitudeInverse => inverse(Attitude, self),
            ReferenceInverse => inverse(ReferenceAttitude, self),
            Rate | Reference => None,
        }
    }
}

/// A sum of products in a fixed order, none of which has the coefficient zero, with what is inverse to its neighbour cancelled.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Products(Vec<(BigRational, Vec<Factor>)>);

impl Products {
    /// One product.
    pub(super) fn of(factors: &[Factor]) -> Products {
        Products::default().plus(BigRational::one(), factors.to_vec())
    }

    fn plus(mut self, number: BigRational, factors: Vec<Factor>) -> Products {
        let mut reduced: Vec<Factor> = Vec::new();
        for factor in factors {
            match reduced.last() {
                Some(last) if last.inverse_of(factor) => drop(reduced.pop()),
                _ => reduced.push(factor),
            }
        }
        match self.0.iter_mut().find(|(_, product)| *product == reduced) {
            Some((sum, _)) => *sum += number,
            None => self.0.push((number, reduced)),
        }
        self.0.retain(|(number, _)| !number.is_zero());
        self.0.sort_by(|(_, one), (_, other)| one.cmp(other));
        self
    }

    pub(super) fn sum(&self, other: &Products) -> Products {
        other.0.iter().fold(self.clone(), |sum, (number, product)| sum.plus(number.clone(), product.clone()))
    }

    pub(super) fn scaled(&self, factor: &BigRational) -> Products {
        self.0.iter().fold(Products::default(), |all, (number, product)| all.plus(number * factor, product.clone()))
    }

    pub(super) fn times(&self, other: &Products) -> Products {
        let pairs = self.0.iter().flat_map(|one| other.0.iter().map(move |two| (one, two)));
        pairs.fold(Products::default(), |all, ((a, left), (b, right))| {
            all.plus(a * b, left.iter().chain(right).copied().collect())
        })
    }

    /// Its derivative, factor by factor.
    pub(super) fn differentiated(&self) -> Option<Products> {
        let mut sum = Products::default();
        for (number, product) in &self.0 {
            for (k, factor) in product.iter().enumerate() {
                let (before, after) = (Products::of(&product[..k]), Products::of(&product[k + 1..]));
                sum = sum.sum(&before.times(&factor.rate()?).times(&after).scaled(number));
            }
        }
        Some(sum)
    }

    /// What has to stand behind `head` to give this; `None` where a product does not begin with it.
    pub(super) fn behind(&self, head: &[Factor]) -> Option<Products> {
        let each = |all: Products, (number, product): &(BigRational, Vec<Factor>)| {
            Some(all.plus(number.clone(), product.strip_prefix(head)?.to_vec()))
        };
        self.0.iter().try_fold(Products::default(), each)
    }

    /// As it is written.
    pub(super) fn formula(&self) -> Formula {
        let symbol = |factor: &Factor| -> Formula {
            match factor {
                Factor::Attitude => Symbol::new("q"),
                Factor::AttitudeInverse => Symbol::new("q").above("−1"),
                Factor::ReferenceAttitude => Symbol::new("q").below("z"),
                Factor::ReferenceInverse => Symbol::new("q").below("z").above("−1"),
                Factor::Rate => Symbol::new("ω"),
                Factor::Reference => Symbol::new("z"),
            }
            .into()
        };
        let term = |(number, product): &(BigRational, Vec<Factor>)| -> (Sign, Formula) {
            match Formula::term(number, Formula::Number(BigRational::one())) {
                (sign, Formula::Product(parts)) => {
                    let size = parts.into_iter().take(1);
                    (sign, Formula::Product(size.chain(product.iter().map(symbol)).collect()))
                }
                (sign, _) => (sign, Formula::Product(product.iter().map(symbol).collect())),
            }
        };
        Formula::sum(self.0.iter().map(term))
    }
}

/// Δq* = q_z⁻¹ q.
pub(super) fn difference() -> [Factor; 2] {
    [Factor::ReferenceInverse, Factor::Attitude]
}

/// (106): what stands behind Δq* in its derivative, ½ (ω − z).
pub(super) fn turning() -> Option<Products> {
    Products::of(&difference()).differentiated()?.behind(&difference())
}
