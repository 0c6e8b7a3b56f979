//! Sums of products of series: which coefficient is added where.

use alloc::vec;
use alloc::vec::Vec;

use super::program::{Op, Part, PartKind, Row};
use super::support::{Gathered, Support, multiply};
use super::{ExpressionError, MOST_PRODUCTS, Register, Series};

/// A part of a sum.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Term {
    /// c a.
    Scaled(f64, Register),
    /// c a b.
    Product(f64, Register, Register),
    /// a²/2.
    HalfSquare(Register),
}

/// The pairs of a product up to a degree: for each index of the first, the range of the second.
fn pairs(
    a: &Support,
    b: &Support,
    degree: usize,
    square: bool,
) -> impl Iterator<Item = (usize, core::ops::Range<usize>)> {
    a.with_degrees().enumerate().filter_map(move |(index, (_, own))| {
        let most = b.up_to(degree.checked_sub(own)?);
        let from = if square { index } else { 0 };
        (from < most).then_some((index, from..most))
    })
}

impl Series {
    /// A sum up to a degree.
    ///
    /// # Errors
    /// [`ExpressionError::TooCostly`] when that takes more than [`MOST_PRODUCTS`].
    pub(crate) fn sum(&mut self, terms: &[Term], degree: usize) -> Result<Register, ExpressionError> {
        let mut gathered = Gathered::up_to(degree);
        for term in terms {
            self.gather(term, degree, &mut gathered)?;
        }
        let sum = self.place(gathered.support());
        if self.is_zero(sum) {
            return Ok(sum);
        }
        let first = self.parts.len();
        for term in terms {
            self.add_part(term, degree, sum);
        }
        let place = &self.placed[sum.0];
        self.ops.push(Op::Sum { to: place.at, count: place.support.len(), parts: first..self.parts.len() });
        Ok(sum)
    }

    /// The two factors, the one with fewer coefficients first, and whether they are the same one.
    fn factors(&self, term: &Term) -> Option<(Register, Register, bool)> {
        match *term {
            Term::Scaled(..) => None,
            Term::HalfSquare(a) => Some((a, a, true)),
            Term::Product(_, a, b) => {
                let fewer = self.placed[b.0].support.len() < self.placed[a.0].support.len();
                Some(if fewer { (b, a, false) } else { (a, b, false) })
            }
        }
    }

    /// Adds the monomials of a term, after counting what it takes.
    fn gather(&mut self, term: &Term, degree: usize, gathered: &mut Gathered) -> Result<(), ExpressionError> {
        let Some((a, b, square)) = self.factors(term) else {
            if let Term::Scaled(_, a) = term {
                let support = &self.placed[a.0].support;
                support.monomials()[..support.up_to(degree)].iter().for_each(|monomial| gathered.add(monomial));
            }
            return Ok(());
        };
        let (a, b) = (&self.placed[a.0].support, &self.placed[b.0].support);
        self.products += pairs(a, b, degree, square).map(|(_, range)| range.len() as u64).sum::<u64>();
        if self.products > MOST_PRODUCTS {
            return Err(ExpressionError::TooCostly);
        }
        let mut product = vec![0; self.variables];
        for (index, range) in pairs(a, b, degree, square) {
            for other in &b.monomials()[range] {
                multiply(&a.monomials()[index], other, &mut product);
                gathered.add(&product);
            }
        }
        Ok(())
    }

    /// Where the coefficients of a term go.
    fn add_part(&mut self, term: &Term, degree: usize, sum: Register) {
        let (first_row, mut rows, mut targets) = (self.rows.len(), Vec::new(), Vec::new());
        let place = |register: Register| &self.placed[register.0];
        let to = &place(sum).support;
        let start = self.targets.len();
        let (kind, factor, a, b) = match self.factors(term) {
            None => {
                let Term::Scaled(factor, a) = *term else { return };
                let from = &place(a).support;
                let kept = &from.monomials()[..from.up_to(degree)];
                targets.extend(kept.iter().filter_map(|monomial| to.find(monomial)).map(|index| index as u32));
                rows.push(Row { of: 0, count: targets.len() as u32, targets: start });
                (PartKind::Scaled, factor, place(a).at, place(a).at)
            }
            Some((a, b, square)) => {
                let (left, right) = (&place(a).support, &place(b).support);
                let mut product = vec![0; self.variables];
                for (index, range) in pairs(left, right, degree, square) {
                    let begin = targets.len();
                    for other in &right.monomials()[range] {
                        multiply(&left.monomials()[index], other, &mut product);
                        targets.extend(to.find(&product).map(|index| index as u32));
                    }
                    let count = (targets.len() - begin) as u32;
                    rows.push(Row { of: index as u32, count, targets: start + begin });
                }
                let factor = if let Term::Product(factor, ..) = term { *factor } else { 1.0 };
                let kind = if square { PartKind::HalfSquare } else { PartKind::Product };
                (kind, factor, place(a).at, place(b).at)
            }
        };
        self.rows.extend(rows);
        self.targets.extend(targets);
        self.parts.push(Part { kind, factor, a, b, rows: first_row..self.rows.len() });
    }
}
