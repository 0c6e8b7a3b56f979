//! What a reader of a URDF file should know although the file was accepted.

use std::fmt;
use std::ops::Range;

use forwardstep_core::robot::tree::InertiaDefect;

use super::ignored::{IgnoredItem, write_grouped};
use crate::SourceText;
use crate::shown::{one_line, shown};
use crate::wording::{enumerate, number, rounded};

/// Something in an accepted file that the user should know about.
#[derive(Clone, Debug)]
pub struct Notice {
    /// The file.
    pub source: SourceText,
    /// Bytes of the file it is about; `None` when it is about the file as a whole, or about what was asked of it.
    pub span: Option<Range<usize>>,
    /// What it says.
    pub kind: NoticeKind,
}

impl Notice {
    /// Line and column in the file, both from one.
    pub fn place(&self) -> Option<(usize, usize)> {
        self.span.as_ref().map(|span| self.source.line_column(span.start))
    }
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.place() {
            Some((line, column)) => {
                write!(f, "{}:{line}:{column}: {}", shown(self.source.name()), one_line(&self.kind))
            }
            None => write!(f, "{}: {}", shown(self.source.name()), one_line(&self.kind)),
        }
    }
}

/// What a [`Notice`] says.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum NoticeKind {
    /// Everything in the file that does not enter the model, and why.
    Ignored {
        /// One entry per name, in the order of their first occurrence.
        items: Vec<IgnoredItem>,
    },
    /// A moving joint states no axis.
    AxisDefault {
        /// The joint.
        joint: String,
    },
    /// An axis was not of unit length.
    AxisNormalised {
        /// The joint.
        joint: String,
        /// As written.
        given: [f64; 3],
        /// As used.
        used: [f64; 3],
    },
    /// A revolute or prismatic joint has no `<limit>`, which the URDF specification requires.
    LimitMissing {
        /// The joint.
        joint: String,
    },
    /// `<limit>` lacks some of its entries.
    LimitIncomplete {
        /// The joint.
        joint: String,
        /// The attribute that is missing.
        missing: &'static str,
        /// What is assumed.
        assumed: Option<f64>,
    },
    /// `<limit>` states neither `lower` nor `upper`.
    RangeMissing {
        /// The joint.
        joint: String,
    },
    /// Lower and upper limit coincide.
    RangeEmpty {
        /// The joint.
        joint: String,
        /// Where.
        at: f64,
    },
    /// Limits of a revolute joint that are whole degrees rather than rad.
    LikeDegrees {
        /// The joint.
        joint: String,
        /// As written.
        limits: [f64; 2],
    },
    /// An effort or velocity limit of zero.
    LimitZero {
        /// The joint.
        joint: String,
        /// `effort` or `velocity`.
        quantity: &'static str,
    },
    /// A joint that should follow another moves freely.
    MimicFree {
        /// The joint.
        joint: String,
        /// The joint it should follow, where the file says so.
        leader: Option<String>,
    },
    /// Coulomb friction was left out, as asked.
    FrictionIgnored {
        /// The joints and the friction of each, in N m or N.
        joints: Vec<(String, f64)>,
    },
    /// A joint is locked outside its limits.
    LockOutside {
        /// The joint.
        joint: String,
        /// Where it is locked.
        value: f64,
        /// Its limits.
        limits: [f64; 2],
    },
    /// Links that are rigid with the base, whose inertia therefore does not enter.
    HeldByBase {
        /// The links that have an inertia.
        links: Vec<String>,
        /// Their mass together.
        mass: f64,
    },
    /// A moving body has no mass of its own.
    Massless {
        /// The link that leads the body.
        body: String,
    },
    /// A link has an inertia that no body has, or none in its place, although the mass matrix is positive definite.
    Implausible {
        /// The link.
        link: String,
        /// The failed test with its values and a plausible one.
        defect: InertiaDefect,
    },
}

impl fmt::Display for NoticeKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NoticeKind::Ignored { items } => {
                f.write_str("ignored: ")?;
                write_grouped(f, items)
            }
            NoticeKind::AxisDefault { joint } => write!(f, "joint `{joint}` states no axis; x is taken, as URDF says"),
            NoticeKind::AxisNormalised { joint, given, used } => {
                let ([x, y, z], [ux, uy, uz]) = (given.map(number), used.map(number));
                write!(f, "the axis of joint `{joint}` is {x} {y} {z}; {ux} {uy} {uz} of unit length is used")
            }
            NoticeKind::LimitMissing { joint } => {
                write!(f, "joint `{joint}` has no <limit>, which URDF requires; it is taken to be unlimited")
            }
            NoticeKind::LimitIncomplete { joint, missing, assumed: Some(value) } => {
                write!(f, "<limit> of joint `{joint}` has no `{missing}`; {} is taken, as URDF says", number(*value))
            }
            NoticeKind::LimitIncomplete { joint, missing, assumed: None } => {
                write!(f, "<limit> of joint `{joint}` has no `{missing}`; it is taken to be unlimited")
            }
            NoticeKind::RangeMissing { joint } => {
                write!(
                    f,
                    "<limit> of joint `{joint}` has neither `lower` nor `upper`; any position is taken to be allowed"
                )
            }
            NoticeKind::RangeEmpty { joint, at } => {
                write!(f, "the limits of joint `{joint}` allow the position {} only", number(*at))
            }
            NoticeKind::LikeDegrees { joint, limits: [lower, upper] } => {
                let (lower_rad, upper_rad) = (rounded(lower.to_radians()), rounded(upper.to_radians()));
                let [lower, upper, lower_rad, upper_rad] = [*lower, *upper, lower_rad, upper_rad].map(number);
                write!(
                    f,
                    "the limits of joint `{joint}`, {lower} to {upper} rad, look like degrees; in rad those are {lower_rad} to {upper_rad}"
                )
            }
            NoticeKind::LimitZero { joint, quantity } => {
                write!(f, "joint `{joint}` has the {quantity} limit 0; it could not move where limits are enforced")
            }
            NoticeKind::MimicFree { joint, leader: Some(leader) } => {
                write!(
                    f,
                    "joint `{joint}` should follow `{leader}` (<mimic>), but moves freely; lock it, or drive it alike"
                )
            }
            NoticeKind::MimicFree { joint, leader: None } => {
                write!(
                    f,
                    "joint `{joint}` should follow another (<mimic>), but moves freely; lock it, or drive it alike"
                )
            }
            NoticeKind::FrictionIgnored { joints } => {
                let shown = joints.iter().map(|(joint, friction)| format!("{} of `{joint}`", number(*friction)));
                write!(f, "Coulomb friction is left out, as asked: {}", enumerate(shown))
            }
            NoticeKind::LockOutside { joint, value, limits } => {
                let (value, [lower, upper]) = (number(*value), limits.map(number));
                write!(f, "joint `{joint}` is locked at {value}, outside its limits {lower} to {upper}")
            }
            NoticeKind::HeldByBase { links, mass } => write!(
                f,
                "the base does not move, so the inertia of what is rigid with it ({} kg: {}) does not enter",
                number(rounded(*mass)),
                enumerate(links.iter().map(|link| format!("`{link}`")))
            ),
            NoticeKind::Massless { body } => {
                write!(f, "the body of link `{body}` has no mass, although a joint moves it")
            }
            NoticeKind::Implausible { link, defect } => {
                write!(f, "the inertia of link `{link}` is implausible: {}", without_noise(defect))
            }
        }
    }
}

/// The same defect with its computed numbers rounded.
fn without_noise(defect: &InertiaDefect) -> InertiaDefect {
    let mut defect = defect.clone();
    let numbers: &mut [&mut f64] = match &mut defect {
        InertiaDefect::NegativeMass { mass_kg } => &mut [mass_kg],
        InertiaDefect::WithoutMass { first_moment_kg_m, inertia_kg_m2 } => &mut [first_moment_kg_m, inertia_kg_m2],
        InertiaDefect::FarCentre { distance_m, size_m, plausible_m } => &mut [distance_m, size_m, plausible_m],
        InertiaDefect::ZeroInertia { mass_kg, plausible_kg_m2 } => &mut [mass_kg, plausible_kg_m2],
        InertiaDefect::NegativeMoment { moments_kg_m2: [a, b, c], plausible_kg_m2 }
        | InertiaDefect::TriangleInequality { moments_kg_m2: [a, b, c], plausible_kg_m2 } => {
            &mut [a, b, c, plausible_kg_m2]
        }
    };
    for number in numbers {
        **number = rounded(**number);
    }
    defect
}
