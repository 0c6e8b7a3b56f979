//! Inverses of small matrices.

/// Writes the inverse of the n × n matrix `a` (row by row, overwritten) and returns its determinant. A singular matrix has
/// determinant zero and an inverse that is not finite. Nothing happens, and the determinant is not a number, when a slice is
/// too short.
pub(crate) fn invert(n: usize, a: &mut [f64], inverse: &mut [f64]) -> f64 {
    if a.len() < n * n || inverse.len() < n * n {
        return f64::NAN;
    }
    inverse.fill(0.0);
    for k in 0..n {
        inverse[k * n + k] = 1.0;
    }
    let mut determinant = 1.0;
    for column in 0..n {
        // The largest entry below keeps the factors below one.
        let mut pivot = column;
        for row in column + 1..n {
            if a[row * n + column].abs() > a[pivot * n + column].abs() {
                pivot = row;
            }
        }
        if pivot != column {
            for k in 0..n {
                a.swap(pivot * n + k, column * n + k);
                inverse.swap(pivot * n + k, column * n + k);
            }
            determinant = -determinant;
        }
        let head = a[column * n + column];
        determinant *= head;
        for k in 0..n {
            a[column * n + k] /= head;
            inverse[column * n + k] /= head;
        }
        for row in 0..n {
            let factor = a[row * n + column];
            if row == column || factor == 0.0 {
                continue;
            }
            for k in 0..n {
                a[row * n + k] -= factor * a[column * n + k];
                inverse[row * n + k] -= factor * inverse[column * n + k];
            }
        }
    }
    determinant
}

#[cfg(test)]
mod tests {
    use super::invert;

    #[test]
    fn prop_inverse_times_matrix_is_one_and_the_determinant_is_that_of_the_matrix() {
        let a = [0.0, 2.0, 1.0, 1.0, -1.0, 0.5, 3.0, 0.25, -2.0];
        let mut inverse = [0.0; 9];
        // Along the first row.
        let want = -2.0 * (1.0 * -2.0 - 0.5 * 3.0) + (1.0 * 0.25 + 3.0);
        let determinant = invert(3, &mut a.clone(), &mut inverse);
        assert!((determinant - want).abs() < 1e-14, "{determinant} for {want}");
        for row in 0..3 {
            for column in 0..3 {
                let entry: f64 = (0..3).map(|k| inverse[3 * row + k] * a[3 * k + column]).sum();
                assert!((entry - f64::from(u8::from(row == column))).abs() < 1e-14);
            }
        }
        assert_eq!(invert(2, &mut [1.0, 2.0, 2.0, 4.0], &mut [0.0; 4]), 0.0);
        assert!(invert(3, &mut [1.0], &mut inverse).is_nan());
    }
}
