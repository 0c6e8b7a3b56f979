//! The same bits from hardware and software: a build without `std` multiplies and adds with `libm`.

use forwardstep_core::Scalar;

/// Numbers of every size and sign, always the same ones.
fn numbers(seed: u64) -> impl Iterator<Item = f64> {
    let mut state = seed;
    std::iter::repeat_with(move || {
        // SplitMix64
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from_bits(z ^ (z >> 31))
    })
    .filter(|x| x.is_finite())
}

/// Numbers a robot might see.
fn moderate(seed: u64) -> impl Iterator<Item = f64> {
    numbers(seed).map(|x| 4.0 * (x.to_bits() >> 11) as f64 / (1_u64 << 53) as f64 - 2.0)
}

#[test]
fn digest_software_multiply_add_is_that_of_the_hardware() {
    let same = |a: f64, b: f64, c: f64| {
        let (hard, soft) = (Scalar::mul_add(a, b, c), libm::fma(a, b, c));
        assert!(hard.to_bits() == soft.to_bits() || hard.is_nan() && soft.is_nan(), "{a:e} · {b:e} + {c:e}");
    };
    let (mut wide, mut narrow) = (numbers(1), moderate(2));
    for _ in 0..300_000 {
        let (a, b) = (wide.next().unwrap(), wide.next().unwrap());
        same(a, b, wide.next().unwrap());
        let (a, b) = (narrow.next().unwrap(), narrow.next().unwrap());
        same(a, b, narrow.next().unwrap());
        // What is left when almost everything cancels.
        same(a, b, -(a * b));
        same(a, b, (-(a * b)).next_up());
    }
}
