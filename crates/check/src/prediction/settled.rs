//! When a disagreement has settled.

/// What is left of the disagreement at the start once it has settled.
pub const SHARE: f64 = 0.01;

/// When the disagreement exceeds 1 % of what it is at the start for the last time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Settled {
    /// Then, s; between two rows the logarithm is taken to be a straight line.
    At(f64),
    /// It still does at the last row.
    NotYet,
    /// There is no disagreement at the start to compare with.
    NoStart,
}

impl Settled {
    /// The time, s, if it has settled.
    pub fn time_s(self) -> Option<f64> {
        match self {
            Settled::At(t_s) => Some(t_s),
            Settled::NotYet | Settled::NoStart => None,
        }
    }
}

/// When `disagreement`, row by row at `t_s`, has settled.
pub fn settled(t_s: &[f64], disagreement: &[f64]) -> Settled {
    let Some(start) = disagreement.first().copied().filter(|start| *start > 0.0) else { return Settled::NoStart };
    let bound = SHARE * start;
    // What is no number exceeds every bound.
    let exceeds = |d: &f64| d.is_nan() || *d > bound;
    let Some(last) = disagreement.iter().rposition(exceeds) else { return Settled::NoStart };
    let rows = t_s.get(last).zip(t_s.get(last + 1)).zip(disagreement.get(last + 1));
    let Some(((from_s, to_s), below)) = rows else { return Settled::NotYet };
    let share = libm::log(disagreement[last] / bound) / libm::log(disagreement[last] / below);
    // Where the disagreement vanishes at a row the logarithm has no straight line.
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    Settled::At(from_s + share * (to_s - from_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_last_time_above_one_percent_of_the_start() {
        let exponential: Vec<f64> = (0..100).map(|k| 3.0 * (-0.1 * k as f64).exp()).collect();
        let t_s: Vec<f64> = (0..100).map(f64::from).collect();
        let Settled::At(at) = settled(&t_s, &exponential) else { panic!("it has settled") };
        assert!((at - 10.0 * 100.0_f64.ln()).abs() < 1e-9, "{at}");
        let again = [1.0, 0.001, 0.5, 0.001, 0.0];
        assert!(matches!(settled(&t_s, &again), Settled::At(t) if t > 2.0 && t < 3.0));
        assert_eq!(settled(&t_s, &[1.0, 0.0]), Settled::At(0.0));
        assert_eq!(settled(&t_s, &[1.0, 0.011]), Settled::NotYet);
        assert_eq!(settled(&t_s, &[1.0, f64::NAN]), Settled::NotYet);
        assert_eq!(settled(&t_s, &[1.0, f64::NAN, 0.0]), Settled::At(1.0));
        assert_eq!(settled(&t_s, &[0.0, 0.5]), Settled::NoStart);
        assert_eq!(settled(&t_s, &[]), Settled::NoStart);
    }
}
