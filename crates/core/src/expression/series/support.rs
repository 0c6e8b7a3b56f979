//! Which monomials a series has, and in which order: by degree first, so that those up to a degree are a prefix.

use alloc::boxed::Box;
use alloc::collections::BTreeSet;
use alloc::vec;
use alloc::vec::Vec;

/// An exponent for every variable.
pub(super) type Monomial = Box<[u8]>;

/// The degree of a monomial.
fn degree(monomial: &[u8]) -> usize {
    monomial.iter().map(|exponent| usize::from(*exponent)).sum()
}

/// The monomials of a series.
#[derive(Clone, Debug, Default)]
pub(super) struct Support {
    monomials: Vec<Monomial>,
    /// How many have a degree up to that of the entry.
    up_to: Vec<usize>,
}

impl Support {
    pub(super) fn len(&self) -> usize {
        self.monomials.len()
    }

    /// How many have at most this degree.
    pub(super) fn up_to(&self, degree: usize) -> usize {
        self.up_to.get(degree).copied().unwrap_or(self.monomials.len())
    }

    /// The largest degree, or more.
    pub(super) fn degrees(&self) -> usize {
        self.up_to.len()
    }

    pub(super) fn monomials(&self) -> &[Monomial] {
        &self.monomials
    }

    /// Monomial `index` and its degree.
    pub(super) fn with_degrees(&self) -> impl Iterator<Item = (&Monomial, usize)> {
        self.monomials.iter().map(|monomial| (monomial, degree(monomial)))
    }

    /// Where a monomial stands.
    pub(super) fn find(&self, monomial: &[u8]) -> Option<usize> {
        let degree = degree(monomial);
        let start = degree.checked_sub(1).map_or(0, |below| self.up_to(below));
        let within = self.monomials.get(start..self.up_to(degree))?;
        within.binary_search_by(|other| (**other).cmp(monomial)).ok().map(|index| start + index)
    }

    /// Without the constant.
    pub(super) fn varying(&self) -> Self {
        let constants = self.up_to(0);
        let up_to = self.up_to.iter().map(|count| count - constants).collect();
        Support { monomials: self.monomials[constants..].to_vec(), up_to }
    }
}

/// Monomials that are being gathered, by degree.
#[derive(Debug)]
pub(super) struct Gathered(Vec<BTreeSet<Monomial>>);

impl Gathered {
    /// Room for degrees up to `most`.
    pub(super) fn up_to(most: usize) -> Self {
        Gathered(vec![BTreeSet::new(); most + 1])
    }

    /// Adds one, if its degree is not beyond the room.
    pub(super) fn add(&mut self, monomial: &[u8]) {
        if let Some(known) = self.0.get_mut(degree(monomial))
            && !known.contains(monomial)
        {
            known.insert(monomial.into());
        }
    }

    pub(super) fn support(self) -> Support {
        let (mut monomials, mut up_to) = (Vec::new(), Vec::new());
        for of_degree in self.0 {
            monomials.extend(of_degree);
            up_to.push(monomials.len());
        }
        Support { monomials, up_to }
    }
}

/// The product of two monomials, into `out`.
pub(super) fn multiply(a: &[u8], b: &[u8], out: &mut [u8]) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out = a + b;
    }
}
