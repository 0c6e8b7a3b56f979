//! How fast the fastest motion of a right-hand side is, found without its Jacobian.

/// Power iterations before the rate is taken, and over which it is taken. Even: where two fast states turn into each other,
/// one number is large in every second iterate.
const ITERATIONS: [u32; 2] = [32, 32];

/// A right-hand side at one instant: f(x) into the second argument.
pub(super) type Field<'a> = dyn FnMut(&[f64], &mut [f64]) + 'a;

/// Working memory, as long as the state.
pub(super) struct Work<'a> {
    /// f(x).
    pub(super) rate: &'a mut [f64],
    /// The iterate.
    pub(super) direction: &'a mut [f64],
    /// x a little along it, and f there.
    pub(super) moved: &'a mut [f64],
    pub(super) moved_rate: &'a mut [f64],
}

/// |λ| of the largest eigenvalue of ∂f/∂x at `x`, 1/s, and the index of the state that moves most along it, where every
/// state is measured by its own size plus `least`. `None` when something on the way is not finite.
///
/// This is the power method on differences of f. Norms of iterates are taken far apart, so that pairs of complex eigenvalues,
/// for which they go up and down, count by their size as well.
pub(super) fn dominant_rate(f: &mut Field<'_>, x: &[f64], least: f64, work: Work<'_>) -> Option<(f64, usize)> {
    let Work { rate, direction, moved, moved_rate } = work;
    let scale = |i: usize| x[i].abs() + least;
    f(x, rate);
    // Multiples of the golden section fill an interval evenly: no eigenvector is missed.
    for (i, direction) in direction.iter_mut().enumerate() {
        *direction = scale(i) * (0.25 + (i as f64 * 0.618_033_988_749_894_9).fract());
    }
    let (mut grown, mut largest) = (0.0, 0);
    let difference = f64::EPSILON.sqrt();
    for iteration in 0..ITERATIONS[0] + ITERATIONS[1] {
        let (state, size) = largest_of(direction, scale);
        if size == 0.0 {
            return Some((0.0, largest));
        }
        largest = state;
        for ((moved, x), direction) in moved.iter_mut().zip(x).zip(&*direction) {
            *moved = x + difference * (direction / size);
        }
        f(moved, moved_rate);
        for ((direction, moved_rate), rate) in direction.iter_mut().zip(&*moved_rate).zip(&*rate) {
            *direction = (moved_rate - rate) / difference;
        }
        let (_, factor) = largest_of(direction, scale);
        if !factor.is_finite() {
            return None;
        }
        if iteration >= ITERATIONS[0] {
            grown += libm::log(factor);
        }
    }
    Some((libm::exp(grown / f64::from(ITERATIONS[1])), largest))
}

/// The entry that is largest by its own scale, and its size; not-a-number when any is.
fn largest_of(vector: &[f64], scale: impl Fn(usize) -> f64) -> (usize, f64) {
    vector
        .iter()
        .enumerate()
        .map(|(i, entry)| (i, entry.abs() / scale(i)))
        .fold((0, 0.0), |most, entry| if entry.1 > most.1 || entry.1.is_nan() { entry } else { most })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "helpers of tests")]

    use super::*;

    /// The rate of ẋ = A x at `x`, A row by row.
    fn rate_of(a: &[f64], x: &[f64]) -> Option<(f64, usize)> {
        let n = x.len();
        let mut f = |x: &[f64], dx: &mut [f64]| {
            for (dx, row) in dx.iter_mut().zip(a.chunks_exact(n)) {
                *dx = row.iter().zip(x).map(|(a, x)| a * x).sum();
            }
        };
        let [mut rate, mut direction, mut moved, mut moved_rate] = [(); 4].map(|()| vec![0.0; n]);
        let work = Work { rate: &mut rate, direction: &mut direction, moved: &mut moved, moved_rate: &mut moved_rate };
        dominant_rate(&mut f, x, 0.01, work)
    }

    #[test]
    fn the_rate_is_the_size_of_the_largest_eigenvalue() {
        // Real ones; two states that turn into each other, one of them in very small units; the same damped, and coupled to
        // a slow one; eigenvalues 3, −2 and 1 of a matrix that is not normal.
        let slow_and_fast = [-1.0, 0.0, 0.0, 0.0, -1e6, 0.0, 1e3, 0.0, -50.0];
        let turning = [0.0, 1e-3, -1e15, 0.0];
        let damped = [-1e4, 1.0, 0.0, -1e8, 0.0, 5.0, 1.0, 0.0, -1.0];
        let not_normal = [3.0, 100.0, -20.0, 0.0, -2.0, 70.0, 0.0, 0.0, 1.0];
        for (a, rate) in [(&slow_and_fast[..], 1e6), (&turning, 1e6), (&damped, 1e4), (&not_normal, 3.0)] {
            let n = if a.len() == 4 { 2 } else { 3 };
            for x in [vec![0.0; n], vec![1.0; n], vec![-30.0, 2e3, 1e-3][..n].to_vec()] {
                let (found, _) = rate_of(a, &x).unwrap();
                assert!((0.7..1.4).contains(&(found / rate)), "{a:?} at {x:?}: {found} for {rate}");
            }
        }
        assert_eq!(rate_of(&slow_and_fast, &[1.0; 3]).unwrap().1, 1);
    }

    #[test]
    fn what_stands_still_has_no_rate_and_what_is_not_finite_none() {
        assert_eq!(rate_of(&[0.0; 4], &[1.0, 2.0]).unwrap().0, 0.0);
        // Nilpotent: nothing is left after two steps.
        assert_eq!(rate_of(&[0.0, 1.0, 0.0, 0.0], &[1.0, 2.0]).unwrap().0, 0.0);
        assert_eq!(rate_of(&[1e308, 1e308, 1e308, 1e308], &[1.0, 2.0]), None);
    }
}
