//! Vectors of ℝ³ and attitudes, in the order and with the signs of the paper.
//!
//! An attitude is a quaternion (q_v, q_o), the vector part first. It turns vectors of the body into vectors of the
//! inertial frame, and ω is the angular velocity in the body's own axes:
//!
//! ```text
//! R(q) = I + 2 (q_o S(q_v) + S(q_v)²) / qᵀq        Ṙ = R S(ω)
//! q̇_v = ½ (q_o I + S(q_v)) ω                       q̇_o = −½ q_vᵀ ω
//! ```
//!
//! The division makes R a rotation for every q ≠ 0, and q̇ is linear in q: a norm that rounding has led away from one changes
//! no rotation. S(a) b = a × b.

/// A vector of ℝ³.
pub type Vector = [f64; 3];

/// A 3 × 3 matrix by its rows.
pub type Matrix = [[f64; 3]; 3];

/// (q_v, q_o).
pub type Quaternion = [f64; 4];

/// The attitude in which the axes of the body are those of the inertial frame.
pub const UPRIGHT: Quaternion = [0.0, 0.0, 0.0, 1.0];

/// aᵀ b.
pub fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a × b = S(a) b.
pub fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A v.
pub fn times(a: &Matrix, v: &Vector) -> Vector {
    [dot(&a[0], v), dot(&a[1], v), dot(&a[2], v)]
}

/// Aᵀ v.
pub fn transpose_times(a: &Matrix, v: &Vector) -> Vector {
    core::array::from_fn(|k| a[0][k] * v[0] + a[1][k] * v[1] + a[2][k] * v[2])
}

/// A⁻¹ by cofactors; not finite where A is singular.
pub fn inverse(a: &Matrix) -> Matrix {
    // The columns of the adjugate are the cross products of the rows.
    let columns = [cross(&a[1], &a[2]), cross(&a[2], &a[0]), cross(&a[0], &a[1])];
    let determinant = dot(&a[0], &columns[0]);
    core::array::from_fn(|row| core::array::from_fn(|column| columns[column][row] / determinant))
}

/// R(q), row by row.
pub fn rotation(q: &Quaternion) -> Matrix {
    let [x, y, z, w] = *q;
    let k = 2.0 / (x * x + y * y + z * z + w * w);
    [
        [1.0 - k * (y * y + z * z), k * (x * y - w * z), k * (x * z + w * y)],
        [k * (x * y + w * z), 1.0 - k * (x * x + z * z), k * (y * z - w * x)],
        [k * (x * z - w * y), k * (y * z + w * x), 1.0 - k * (x * x + y * y)],
    ]
}

/// q̇ under ω.
pub fn rate(q: &Quaternion, omega: &Vector) -> Quaternion {
    let [x, y, z, w] = *q;
    let turned = cross(&[x, y, z], omega);
    let [a, b, c] = core::array::from_fn(|k| 0.5 * (w * omega[k] + turned[k]));
    [a, b, c, -0.5 * dot(&[x, y, z], omega)]
}

/// Makes the norm one again; leaves a quaternion alone that has none.
pub fn normalise(q: &mut Quaternion) {
    let norm = libm::sqrt(q.iter().map(|x| x * x).sum());
    if norm > 0.0 && norm.is_finite() {
        for x in q {
            *x /= norm;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const Q: Quaternion = [0.3, -0.5, 0.2, 0.7];
    const OMEGA: Vector = [0.4, -1.1, 0.6];

    fn near(a: &Matrix, b: &Matrix, tolerance: f64) -> bool {
        a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < tolerance)
    }

    #[test]
    fn prop_any_quaternion_is_a_rotation() {
        for scale in [1.0, 0.9, 30.0] {
            let r = rotation(&Q.map(|x| x * scale));
            let product: Matrix = core::array::from_fn(|i| core::array::from_fn(|j| dot(&r[i], &r[j])));
            assert!(near(&product, &[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 1e-15));
            assert!((dot(&cross(&r[0], &r[1]), &r[2]) - 1.0).abs() < 1e-15, "right-handed");
        }
    }

    #[test]
    fn eq_44_attitude_turns_as_r_s_of_omega() {
        let h = 1e-6;
        let dq = rate(&Q, &OMEGA);
        let at = |t: f64| rotation(&core::array::from_fn(|k| Q[k] + t * dq[k]));
        let (ahead, behind, r) = (at(h), at(-h), rotation(&Q));
        let difference: Matrix = core::array::from_fn(|i| core::array::from_fn(|j| (ahead[i][j] - behind[i][j]) / (2.0 * h)));
        // R S(ω): row i is (row i of R) times S(ω), that is −S(ω) (row i), ω × row turned round.
        let want: Matrix = core::array::from_fn(|i| cross(&r[i], &OMEGA));
        assert!(near(&difference, &want, 1e-9));
        assert!(Q.iter().zip(dq).map(|(a, b)| a * b).sum::<f64>().abs() < 1e-16, "the norm stays");
    }

    #[test]
    fn inverse_undoes() {
        let a = [[4.0, 1.0, -0.5], [1.0, 3.0, 0.2], [-0.5, 0.2, 2.0]];
        let (v, b) = ([0.3, -0.7, 1.9], inverse(&a));
        let back = times(&b, &times(&a, &v));
        assert!((0..3).all(|k| (back[k] - v[k]).abs() < 1e-15), "{back:?}");
        assert_eq!(transpose_times(&a, &v), times(&a, &v), "a is symmetric");
    }
}
