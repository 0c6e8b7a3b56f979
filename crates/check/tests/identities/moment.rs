//! One instant of a run, as derivatives of all signals.

use forwardstep_check::derivation::cascade::Upper;
use forwardstep_check::derivation::form::{Form, Letter, Quantity, Term, Vertex};
use forwardstep_check::derivation::polynomial::Polynomial;
use forwardstep_check::derivation::reduction::{Reduced, Variable};

use crate::common::noise;

/// Derivatives of the signals of one agent on one axis.
#[derive(Clone, Debug, Default)]
pub(super) struct Jets {
    /// q, q̇, …, as far as they are known; then made of those of z and s.
    pub(super) q: Vec<f64>,
    /// z, ż, ….
    pub(super) z: Vec<f64>,
    /// s, ṡ, and numbers that stand for more.
    pub(super) s: Vec<f64>,
    /// y of a filter, where there is one.
    pub(super) y: Vec<f64>,
    /// q_d, or the leader's q₀.
    pub(super) followed: Vec<f64>,
    /// ς.
    pub(super) sign: f64,
    /// η.
    pub(super) integral: f64,
    /// η̇.
    pub(super) d_integral: f64,
}

/// More derivatives than any test has.
const MOST: usize = 12;

impl Jets {
    /// From what is known of a plant of order k: p^r q for r ≤ k, and z up to z^(ℓ).
    pub(super) fn new(seed: usize, q: &[f64], z: &[f64]) -> Jets {
        let k = q.len() - 1;
        let mut jets = Jets { q: q.to_vec(), z: z.to_vec(), ..Jets::default() };
        jets.s = (0..MOST).map(|r| if r < 2 { q[k - 1 + r] - z[r] } else { noise(seed + r) }).collect();
        jets.complete(k);
        jets
    }

    /// A leader: s is zero.
    pub(super) fn leader(q: &[f64]) -> Jets {
        let followed = q.to_vec();
        Jets { q: q.to_vec(), s: vec![0.0; MOST], followed, ..Jets::default() }
    }

    /// With s = y + ẏ/λ instead, from y and its first derivative.
    pub(super) fn filtered(mut self, seed: usize, y: [f64; 2], rate: f64) -> Jets {
        // Of a point mass.
        let k = 2;
        self.y = vec![y[0], y[1], rate * (self.s[1] - y[1])];
        self.y.extend((3..MOST).map(|r| noise(seed + 40 + r)));
        self.s = (0..MOST - 1).map(|r| self.y[r] + self.y[r + 1] / rate).collect();
        self.q.truncate(k + 1);
        self.complete(k);
        self
    }

    /// p^(k−1+r) q = p^r z + p^r s above what is known.
    fn complete(&mut self, k: usize) {
        for r in 2..self.z.len() {
            self.q.push(self.z[r] + self.s[r]);
        }
        assert_eq!(self.q.len(), k - 1 + self.z.len().max(2));
    }

    fn value(&self, letter: Letter, vertex: Vertex, r: usize) -> f64 {
        let followed = self.followed.get(r).copied();
        match (letter, vertex) {
            (Letter::Position, Vertex::Leader) | (Letter::Target, _) => followed.unwrap(),
            (Letter::Position, _) => self.q[r],
            (Letter::Deviation, _) => self.q[r] - followed.unwrap(),
            (Letter::Reference, _) => self.z[r],
            (Letter::Error, _) => self.s[r],
            (Letter::Filter, _) => self.y[r],
            (Letter::Integral, _) => [self.integral, self.d_integral][r],
            (Letter::Term(Term::Sign), _) => self.sign,
            _ => panic!("{letter:?} of {vertex:?} is not known"),
        }
    }
}

/// An agent and its neighbours at one instant.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    /// The agent.
    pub(super) own: Jets,
    /// Its neighbours when they sent what is heard now, with their weights.
    pub(super) heard: Vec<(f64, Jets)>,
}

impl Moment {
    /// The r-th derivative of a quantity, with the size of what it is made of.
    fn value(
        &self,
        variables: &[Variable],
        upper: Option<&Upper>,
        link: Option<usize>,
        of: Quantity,
        r: usize,
    ) -> [f64; 2] {
        let jets = match (of.vertex, link) {
            (Vertex::Neighbour, Some(link)) => &self.heard[link].1,
            _ => &self.own,
        };
        let Letter::Variable(number) = of.letter else {
            let value = jets.value(of.letter, of.vertex, r);
            return [value, value.abs()];
        };
        let (variable, upper) = (&variables[number], upper.unwrap());
        let mut sum = [0.0; 2];
        for (polynomial, letter, sign) in [(&variable.state, upper.state, 1.0), (&variable.input, upper.input, -1.0)] {
            for (k, c) in polynomial.coefficients().iter().enumerate() {
                let term = sign * to_f64(c) * jets.value(letter, of.vertex, k + r);
                sum = [sum[0] + term, sum[1] + term.abs()];
            }
        }
        sum
    }

    fn form(&self, form: &Form, variables: &[Variable], upper: Option<&Upper>) -> [f64; 2] {
        let weights: Vec<f64> = self.heard.iter().map(|(weight, _)| *weight).collect();
        let part = |k: usize| form.value(&weights, &|link, of, r| self.value(variables, upper, link, of, r)[k]);
        let size =
            |form: &Form| form.value(&weights, &|link, of, r| self.value(variables, upper, link, of, r)[1]).abs();
        // The size of every term by itself, not of their sum.
        let each = form
            .quantities()
            .map(|of| size(&form.replaced(&Polynomial::one(), |other| (other != of).then(Default::default))));
        [part(0), each.sum::<f64>().max(1.0)]
    }

    /// Asserts that the r-th derivative of a letter is a form.
    pub(super) fn assert(&self, what: &str, letter: Letter, r: usize, right: &Form) {
        let left = self.own.value(letter, Vertex::Own, r);
        let [value, size] = self.form(right, &[], None);
        assert!((left - value).abs() <= 1e-11 * size.max(left.abs()), "{what}: {left} is not {value} ({size})");
    }

    /// Asserts that a reduced system holds.
    pub(super) fn assert_reduced(&self, what: &str, upper: &Upper, reduced: &Reduced) {
        for (number, rate) in reduced.rates.iter().enumerate() {
            let own = Quantity::own(Letter::Variable(number));
            let [left, left_size] = self.value(&reduced.variables, Some(upper), None, own, 1);
            let [value, size] = self.form(rate, &reduced.variables, Some(upper));
            let name = reduced.variables[number].name;
            assert!(
                (left - value).abs() <= 1e-11 * size.max(left_size),
                "{what}, {name:?}: {left} is not {value} ({size})"
            );
        }
    }
}

pub(super) fn to_f64(number: &num_rational::BigRational) -> f64 {
    num_traits::ToPrimitive::to_f64(number).unwrap()
}
