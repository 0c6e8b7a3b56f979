//! The same over time: V of all agents together, and what each cause has put in by then.

use super::InjectionBalance;

/// Points of a course, some more or fewer where steps are long.
const POINTS: f64 = 120.0;

/// V of all agents that were looked at, and what changed it, from the first sample on. At each time the sums of a cause up to then add up to
/// V(t) − V(0), but for the error of the quadrature.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InjectionCourse {
    /// Times, s, rising.
    pub t_s: Vec<f64>,
    /// V then, J or the unit of V.
    pub v_j: Vec<f64>,
    /// What each of [`Injection::ALL`](super::Injection::ALL) has put in by then.
    pub terms_j: [Vec<f64>; 8],
}

/// A course as it is taken.
#[derive(Debug)]
pub(super) struct Taken {
    course: InjectionCourse,
    every_s: f64,
}

impl Taken {
    pub(super) fn new(end_s: f64) -> Self {
        Taken { course: InjectionCourse::default(), every_s: end_s / POINTS }
    }

    /// Whether a point is due.
    pub(super) fn is_due(&self, t_s: f64) -> bool {
        self.course.t_s.last().is_none_or(|last| t_s >= last + self.every_s)
    }

    /// A point, from the balances up to then.
    pub(super) fn point(&mut self, t_s: f64, balances: &[InjectionBalance]) {
        self.course.push(t_s, balances);
    }

    /// The course up to now.
    pub(super) fn until(&self, t_s: f64, balances: &[InjectionBalance]) -> InjectionCourse {
        let mut course = self.course.clone();
        if course.t_s.last().is_none_or(|last| t_s > *last) {
            course.push(t_s, balances);
        }
        course
    }
}

impl InjectionCourse {
    /// Nothing before the end of the first step, when no balance has begun.
    fn push(&mut self, t_s: f64, balances: &[InjectionBalance]) {
        if balances.is_empty() {
            return;
        }
        let sum = |part: &dyn Fn(&InjectionBalance) -> f64| balances.iter().map(part).sum::<f64>();
        if self.t_s.is_empty() {
            self.put(0.0, sum(&|balance| balance.start_j), [0.0; 8]);
        }
        self.put(t_s, sum(&|balance| balance.end_j), core::array::from_fn(|k| sum(&|balance| balance.terms_j[k])));
    }

    fn put(&mut self, t_s: f64, v_j: f64, terms_j: [f64; 8]) {
        self.t_s.push(t_s);
        self.v_j.push(v_j);
        self.terms_j.iter_mut().zip(terms_j).for_each(|(all, term)| all.push(term));
    }
}
