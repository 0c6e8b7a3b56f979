//! The backstepping baseline (aa6), about which the paper promises nothing.

use crate::hypothesis::{Hypothesis, Id, ReferenceEvidence};
use crate::kinds::Claim;
use crate::theorem::Theorem;

pub(super) fn claim() -> Claim {
    Claim {
        theorem: Theorem::Backstepping,
        promises: "nothing, since the torque is unbounded at switches and delay jumps but for the filter and its limit"
            .into(),
    }
}

/// The derivative of what is heard is estimated, not measured.
pub(super) fn derivative(filter_s: f64) -> Hypothesis {
    Hypothesis::new(Id::MeasuredDerivative, ReferenceEvidence::FilteredDerivative { filter_s })
}
