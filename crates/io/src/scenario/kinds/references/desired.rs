//! `reference.desired`: desired dynamics of any order that a user writes down.

use std::fmt;

use forwardstep_core::reference::{RootSet, WrittenIn};
use forwardstep_sim::quantity::within;
use forwardstep_sim::reference::{Desired, DesiredPolynomial, Protocol};
use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};

use super::super::super::at::At;
use super::super::super::fault::{Fault, checked, fault, filled, values};
use super::super::super::formula::formula_in;
use super::super::super::formula_text::FormulaText;
use super::super::super::roots::{RootFile, RootsFile, checked_roots};
use super::super::super::system_problem::SystemProblem;
use super::super::super::value_problem::ValueProblem;
use super::super::chain::derivatives;
use super::{ReferenceKind, ReferenceRead, ReferenceReader, ReferenceTable};

/// The highest order of desired dynamics that is accepted.
const MOST: usize = 32;

/// Desired dynamics: what x should do, written in x and its derivatives.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DesiredFile {
    /// The polynomial in d/dt of x alone: its coefficients from that of x on, without the leading one, which is 1; or its roots. As many
    /// as the order of the desired dynamics, which is that of the plants or higher.
    pub polynomial: At<PolynomialFile>,
    /// The polynomial of x in what is multiplied by the weight of each neighbour: all coefficients from that of x on, or roots. Of a
    /// lower degree. Default: no neighbours.
    pub coupling_polynomial: Option<At<PolynomialFile>>,
    /// What a neighbour's position is multiplied by, and its velocity where velocities are exchanged. Default: the first coefficient of
    /// `coupling_polynomial`.
    #[schemars(length(min = 1, max = 2))]
    pub heard: Option<At<Vec<At<f64>>>>,
    /// Whether every agent follows its target: x less the target obeys the polynomial. Default: false.
    pub follows_target: Option<bool>,
    /// In which variables the reference dynamics are written; it makes a difference only where x does not follow them. Default: `measured`.
    pub written_in: Option<WrittenInFile>,
    /// A nonlinear protocol: a formula that is added to the right side, for chains and robots. Its variables are x, dx, d2x, … below the order,
    /// `heard` and `weights`, the sums over the neighbours of weight times position and of weights, xd, dxd, d2xd, … of a target, and t in
    /// s. With it agents may follow targets and hear neighbours. Default: none.
    pub nonlinear: Option<At<FormulaText>>,
    /// Why these dynamics do without s what they are for, exponentially and from everywhere: reported as declared, and tried.
    pub stable_because: Option<At<String>>,
    /// Why they are input-to-state stable from s: reported as declared, and tried.
    pub input_to_state_stable_because: Option<At<String>>,
}

/// A polynomial in d/dt.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged)]
pub enum PolynomialFile {
    /// Its coefficients, from the lowest on.
    Coefficients(#[schemars(length(min = 1))] Vec<At<f64>>),
    /// Its roots.
    Roots(FactorsFile),
}

/// A polynomial by its roots, with a leading coefficient of 1.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FactorsFile {
    /// How many roots are zero. Default: 0.
    #[schemars(range(min = 0, max = 32))]
    pub integrators: Option<At<i64>>,
    /// The others, as the positive numbers κ of the roots −κ and pairs of complex roots.
    #[schemars(with = "Option<Vec<RootFile>>", length(min = 1))]
    pub roots_per_s: Option<RootsFile>,
}

/// Variables of reference dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WrittenInFile {
    /// Derivatives of x as far as they are measured, derivatives of z above.
    Measured,
    /// z and its derivatives in the place of the highest derivative that is measured, and above.
    Z,
    /// x alone: derivatives that are not measured are avoided in the integration. For constant weights.
    X,
}

impl<'de> Deserialize<'de> for PolynomialFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct PolynomialVisitor;
        impl<'de> Visitor<'de> for PolynomialVisitor {
            type Value = PolynomialFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of coefficients, or a table { integrators = …, roots_per_s = […] }")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<PolynomialFile, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(PolynomialFile::Coefficients)
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PolynomialFile, A::Error> {
                FactorsFile::deserialize(MapAccessDeserializer::new(map)).map(PolynomialFile::Roots)
            }
        }
        deserializer.deserialize_any(PolynomialVisitor)
    }
}

impl PolynomialFile {
    /// The polynomial, of a degree that is accepted.
    fn read(key: &'static str, place: &At<Self>) -> Result<DesiredPolynomial, Fault> {
        let polynomial = match &place.value {
            PolynomialFile::Coefficients(list) if list.is_empty() => {
                return Err(fault(place, ValueProblem::Empty { key }));
            }
            PolynomialFile::Coefficients(list) => DesiredPolynomial::Coefficients(values(list)),
            PolynomialFile::Roots(FactorsFile { integrators, roots_per_s }) => {
                let integrators = integrators.as_ref().map_or(Ok(0), |count| {
                    checked(count, within("", "integrators", count.value as f64, 0.0, MOST as f64))
                        .map(|()| count.value)
                })?;
                DesiredPolynomial::Roots {
                    // Within these bounds nothing is lost.
                    integrators: integrators as usize,
                    roots: match roots_per_s {
                        Some(list) => checked_roots(filled("roots_per_s", list)?)?,
                        None => RootSet::default(),
                    },
                }
            }
        };
        let found = polynomial.order();
        if found > MOST { Err(fault(place, ValueProblem::Order { key, found, most: MOST })) } else { Ok(polynomial) }
    }
}

impl DesiredFile {
    /// The nonlinear protocol of dynamics of this order, with what is said of it.
    fn protocol(&self, order: usize) -> Result<Option<Protocol>, Fault> {
        let because = |text: &Option<At<String>>| text.as_ref().map(|text| text.value.clone());
        let Some(text) = &self.nonlinear else {
            return match self.stable_because.as_ref().or(self.input_to_state_stable_because.as_ref()) {
                Some(unused) => Err(fault(unused, SystemProblem::SaidOfLinear)),
                None => Ok(None),
            };
        };
        let mut names = derivatives(order, "x");
        names.extend(["heard", "weights"].map(str::to_owned));
        if self.follows_target == Some(true) {
            names.extend(derivatives(order + 1, "xd"));
        }
        names.push("t".to_owned());
        Ok(Some(Protocol {
            term: formula_in(text, &names)?,
            stable_because: because(&self.stable_because),
            input_to_state_stable_because: because(&self.input_to_state_stable_because),
        }))
    }
}

impl ReferenceKind for DesiredFile {
    fn table() -> ReferenceTable {
        ReferenceTable {
            key: "desired",
            description: "Desired dynamics of any order that the file states, linear or with a nonlinear protocol: the general framework of Section IV-B.",
            own_roots: false,
        }
    }

    fn read(&self, _: &mut ReferenceReader<'_>) -> Result<ReferenceRead, Fault> {
        let heard = match &self.heard {
            Some(list) => match filled("heard", list)? {
                [_, _, _, ..] => {
                    return Err(fault(list, ValueProblem::Order { key: "heard", found: list.value.len(), most: 2 }));
                }
                entries => values(entries),
            },
            None => Vec::new(),
        };
        let coupling = self.coupling_polynomial.as_ref();
        let polynomial = PolynomialFile::read("polynomial", &self.polynomial)?;
        let protocol = self.protocol(polynomial.order())?;
        let desired = Desired {
            polynomial,
            protocol,
            coupling: coupling.map(|place| PolynomialFile::read("coupling_polynomial", place)).transpose()?,
            heard,
            follows_target: self.follows_target.unwrap_or(false),
            written: match self.written_in {
                None | Some(WrittenInFile::Measured) => WrittenIn::Measured,
                Some(WrittenInFile::Z) => WrittenIn::Z,
                Some(WrittenInFile::X) => WrittenIn::X,
            },
        };
        let exchange = desired.exchange();
        Ok(ReferenceRead::new(desired, exchange))
    }
}
