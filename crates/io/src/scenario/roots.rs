//! `roots_per_s`: the roots of reference dynamics, real ones as numbers and complex ones as pairs.

use std::fmt;

use forwardstep_core::reference::{RootPair, RootSet};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, MapAccess, Visitor};

use super::at::At;
use super::fault::{Fault, filled, positive};
use super::values::Positive;

/// A list of roots.
pub type RootsFile = At<Vec<At<RootFile>>>;

/// A real root −κ as the number κ, or a pair of complex ones.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum RootFile {
    /// κ in 1/s.
    Real(#[schemars(with = "Positive")] f64),
    /// Two roots.
    Pair(PairFile),
}

/// The two complex roots −real ± imaginary i.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PairFile {
    /// How fast what they describe decays, in 1/s.
    #[schemars(with = "Positive")]
    pub real: At<f64>,
    /// How fast it turns, in 1/s.
    #[schemars(with = "Positive")]
    pub imaginary: At<f64>,
}

impl RootFile {
    /// The number, if it is one.
    fn number(&self) -> Option<f64> {
        match self {
            RootFile::Real(kappa) => Some(*kappa),
            RootFile::Pair(_) => None,
        }
    }
}

impl<'de> Deserialize<'de> for RootFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct RootVisitor;
        impl<'de> Visitor<'de> for RootVisitor {
            type Value = RootFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a pair of complex roots { real = …, imaginary = … }")
            }

            fn visit_f64<E>(self, value: f64) -> Result<RootFile, E> {
                Ok(RootFile::Real(value))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RootFile, A::Error> {
                PairFile::deserialize(MapAccessDeserializer::new(map)).map(RootFile::Pair)
            }
        }
        deserializer.deserialize_any(RootVisitor)
    }
}

/// Roots. How many there may be depends on how far apart they are, and is checked where the polynomial is made. A list of numbers alone is checked where it is used; beside pairs each is checked here, where its place
/// is known.
pub(super) fn roots(list: &RootsFile) -> Result<RootSet, Fault> {
    let entries = filled("roots_per_s", list)?;
    let numbers: Option<Vec<f64>> = entries.iter().map(|root| root.value.number()).collect();
    numbers.map_or_else(|| checked_roots(entries), |numbers| Ok(numbers.into()))
}

/// Roots whose real parts are below zero.
pub(super) fn checked_roots(entries: &[At<RootFile>]) -> Result<RootSet, Fault> {
    let mut roots = RootSet::default();
    for root in entries {
        match &root.value {
            RootFile::Real(value) => {
                roots.real.push(positive("roots_per_s", &At { value: *value, span: root.span.clone() })?);
            }
            RootFile::Pair(pair) => {
                let [real, imaginary] = [positive("real", &pair.real)?, positive("imaginary", &pair.imaginary)?];
                roots.pairs.push(RootPair { real, imaginary });
            }
        }
    }
    Ok(roots)
}
