//! `reference.consensus` and `reference.pure_integral`: agents that agree on a position.

use forwardstep_sim::Exchange;
use forwardstep_sim::reference::{Consensus, PureIntegral};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::Fault;
use super::super::super::roots::{RootFile, RootsFile};
use super::{ReferenceKind, ReferenceRead, ReferenceReader, ReferenceTable};

/// Reference dynamics that lead to agreement.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ConsensusFile {
    /// The positive numbers κ₀, κ₁, … in 1/s; as many as the order of the reference dynamics, for which a pair of complex roots, as
    /// `{ real = 0.5, imaginary = 2 }`, counts twice. The theorems need real ones. Agents may have their own.
    #[schemars(with = "Option<Vec<RootFile>>", length(min = 1))]
    pub roots_per_s: Option<RootsFile>,
    /// What the agents tell each other.
    pub exchange: At<ExchangeFile>,
    /// The gain λ of Remark 4, in 1/s to the power of the order: how much the reference gives way to the motion. Default: 0.
    pub manipulability_gain: Option<At<f64>>,
}

/// What an agent transmits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExchangeFile {
    /// Its position and velocity: (a5), of which (aa10) is order 1 and (a1) order 2.
    PositionVelocity,
    /// Its position only: (24).
    Position,
}

impl From<ExchangeFile> for Exchange {
    fn from(file: ExchangeFile) -> Self {
        match file {
            ExchangeFile::Position => Exchange::Position,
            ExchangeFile::PositionVelocity => Exchange::PositionVelocity,
        }
    }
}

impl ReferenceKind for ConsensusFile {
    fn table() -> ReferenceTable {
        ReferenceTable {
            key: "consensus",
            description: "Agreement on a position: the designs (aa10), (a1), (a5) and (24) of the paper.",
            own_roots: true,
        }
    }

    fn read(&self, _: &mut ReferenceReader<'_>) -> Result<ReferenceRead, Fault> {
        let (roots_per_s, manipulability_gain) = (self.roots_per_s.clone(), self.manipulability_gain.clone());
        Ok(ReferenceRead {
            roots_per_s,
            manipulability_gain,
            ..ReferenceRead::new(Consensus, self.exchange.value.into())
        })
    }
}

/// The same over a fixed graph.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct PureIntegralFile(ConsensusFile);

impl ReferenceKind for PureIntegralFile {
    fn table() -> ReferenceTable {
        let description =
            "Agreement over a fixed graph: (3) of the paper or, when only positions are exchanged, (23); two roots.";
        ReferenceTable { key: "pure_integral", description, own_roots: true }
    }

    fn read(&self, reader: &mut ReferenceReader<'_>) -> Result<ReferenceRead, Fault> {
        Ok(ReferenceRead { dynamics: std::sync::Arc::new(PureIntegral), ..self.0.read(reader)? })
    }
}
