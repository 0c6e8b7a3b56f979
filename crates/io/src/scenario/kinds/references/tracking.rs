//! `reference.tracking`: a target for every agent.

use forwardstep_sim::Exchange;
use forwardstep_sim::reference::Tracking;
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::fault::Fault;
use super::super::super::roots::{RootFile, RootsFile};
use super::{ReferenceKind, ReferenceRead, ReferenceReader, ReferenceTable};

/// Every agent follows a target of its own.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TrackingFile {
    /// The positive numbers κ₀, κ₁, … in 1/s of reference dynamics that have roots: three for the law without velocity. A
    /// pair of complex roots, as `{ real = 0.5, imaginary = 2 }`, counts twice.
    #[schemars(with = "Option<Vec<RootFile>>", length(min = 1))]
    pub roots_per_s: Option<RootsFile>,
}

impl ReferenceKind for TrackingFile {
    fn table() -> ReferenceTable {
        ReferenceTable {
            key: "tracking",
            description: "No agreement: every agent follows a target of its own.",
            own_roots: true,
        }
    }

    fn read(&self, _: &mut ReferenceReader<'_>) -> Result<ReferenceRead, Fault> {
        let roots_per_s = self.roots_per_s.clone();
        Ok(ReferenceRead { roots_per_s, ..ReferenceRead::new(Tracking, Exchange::Position) })
    }
}
