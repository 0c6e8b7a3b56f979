//! What a sign that is held between its instants leaves.

use forwardstep_check::hypothesis::{Evidence, FollowingEvidence};
use forwardstep_check::{Id, check};
use forwardstep_sim::leader::{Following, FollowingDesign};

use super::{setup, wave};

/// h sup |ξ̇₀| / α, and 1 + b/a times as much with roots −a ± b i.
#[test]
fn thm9_what_a_held_sign_leaves_grows_with_how_the_roots_swing() {
    for (alpha, beta, swing) in [(1.0, 2.0, 1.0), (2.0, 3.0, 1.0), (2.0, 2.0, 2.0), (10.0, 2.0, 4.0)] {
        let (mut setup, mut drive) = (setup(FollowingDesign::Differentiable, wave(), 90.0), 0.0);
        assert!(setup.change_reference(|following: &mut Following| {
            (following.alpha, following.beta) = (alpha, beta);
            drive = following.drive_bound(None);
        }));
        let sign = check(&setup).hypotheses.into_iter().find(|hypothesis| hypothesis.id == Id::SetValuedSign).unwrap();
        let Evidence::Following(FollowingEvidence::Sign { left, .. }) = sign.evidence else { panic!() };
        let expected = 1e-3 * drive / alpha * swing;
        assert!(drive > 1.0 && (left - expected).abs() < 1e-12, "{alpha} {beta}: {left} {expected}");
    }
}
