//! Inverses and singular values of small matrices.

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

/// Sweeps over all pairs of rows at most; the angles between them fall quadratically, and a handful is enough for any matrix.
const SWEEPS: usize = 30;

/// The smallest and the largest singular value of the matrix `a` of `rows` × `columns` (row by row, overwritten), `rows` at most
/// `columns`: by rotations among the rows until they are orthogonal, whose lengths are then the singular values. Not a number when
/// an entry is none or the slice is too short.
pub(crate) fn singular_values(rows: usize, columns: usize, a: &mut [f64]) -> [f64; 2] {
    if rows == 0 || a.len() < rows * columns {
        return [f64::NAN; 2];
    }
    let paired = |a: &[f64], i: usize, k: usize| -> f64 {
        a[i * columns..(i + 1) * columns].iter().zip(&a[k * columns..(k + 1) * columns]).map(|(x, y)| x * y).sum()
    };
    for _ in 0..SWEEPS {
        let mut turned = false;
        for i in 0..rows {
            for k in i + 1..rows {
                let [own, other, both] = [paired(a, i, i), paired(a, k, k), paired(a, i, k)];
                if both * both <= f64::EPSILON * f64::EPSILON * own * other {
                    continue;
                }
                turned = true;
                let zeta = (other - own) / (2.0 * both);
                let tangent = libm::copysign(1.0, zeta) / (zeta.abs() + libm::sqrt(1.0 + zeta * zeta));
                let cos = 1.0 / libm::sqrt(1.0 + tangent * tangent);
                for column in 0..columns {
                    let (x, y) = (a[i * columns + column], a[k * columns + column]);
                    a[i * columns + column] = cos * (x - tangent * y);
                    a[k * columns + column] = cos * (tangent * x + y);
                }
            }
        }
        if !turned {
            break;
        }
    }
    let mut found = [f64::INFINITY, 0.0];
    for row in 0..rows {
        let length = libm::sqrt(paired(a, row, row));
        if length.is_nan() {
            return [f64::NAN; 2];
        }
        found = [found[0].min(length), found[1].max(length)];
    }
    found
}

#[cfg(test)]
mod tests {
    use super::{invert, singular_values};

    #[test]
    fn prop_singular_values_are_those_of_a_turned_diagonal_and_vanish_with_the_determinant() {
        // Rows of a diagonal (3, 0.5, 2) turned from the left by 0.7 about z and from the right by 1.1 about x.
        let ((s, c), (t, d)) = ((libm::sin(0.7), libm::cos(0.7)), (libm::sin(1.1), libm::cos(1.1)));
        let left = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        let right = [[1.0, 0.0, 0.0], [0.0, d, -t], [0.0, t, d]];
        let of = |values: [f64; 3]| {
            let mut a = [0.0; 9];
            for (at, entry) in a.iter_mut().enumerate() {
                *entry = (0..3).map(|k| left[at / 3][k] * values[k] * right[k][at % 3]).sum();
            }
            singular_values(3, 3, &mut a)
        };
        let [least, most] = of([3.0, 0.5, 2.0]);
        assert!((least - 0.5).abs() < 1e-15 && (most - 3.0).abs() < 1e-14, "{least} {most}");
        let [least, most] = of([3.0, 1e-12, 2.0]);
        assert!((least - 1e-12).abs() < 1e-15 && (most - 3.0).abs() < 1e-14, "{least:e} {most}");
        // Wide: the third column counts.
        let [least, most] = singular_values(2, 3, &mut [1.0, 0.0, 2.0, 0.0, 2.0, 0.0]);
        assert!((least - 2.0).abs() < 1e-15 && (most - libm::sqrt(5.0)).abs() < 1e-15);
        assert!(singular_values(2, 2, &mut [1.0, 2.0, 2.0, 4.0])[0] < 1e-15);
        assert!(singular_values(2, 2, &mut [1.0, f64::NAN, 2.0, 4.0])[0].is_nan());
        assert!(singular_values(2, 2, &mut [1.0; 3])[0].is_nan());
    }

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
