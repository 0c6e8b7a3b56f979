//! `reference.leader`: everybody follows a leader.

use forwardstep_core::reference::{Choice, RootPair};
use forwardstep_sim::Exchange;
use forwardstep_sim::leader::{Following, FollowingDesign};
use schemars::JsonSchema;
use serde::Deserialize;

use super::super::super::at::At;
use super::super::super::fault::{Fault, fault};
use super::super::super::roots::{RootFile, RootsFile, checked_roots};
use super::super::super::system_problem::SystemProblem;
use super::super::super::value_problem::ValueProblem;
use super::super::super::values::Positive;
use super::{ReferenceKind, ReferenceRead, ReferenceReader, ReferenceTable};

const SIGN_EVERY_S: f64 = 1e-3;

/// Reference dynamics that follow a leader, and the set-valued sign in them.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LeaderReferenceFile {
    /// Which of the designs.
    pub design: At<LeaderDesignFile>,
    /// The positive numbers κ in 1/s: one for `continuous`, α = κ₀; for `observer` α = κ₀, with which estimates come to the leader, and
    /// κ₁, with which a robot comes to its estimate; two for the others, β = κ₀ + κ₁ and α = κ₀ κ₁, or a pair
    /// of complex roots, as `{ real = 0.5, imaginary = 2 }`.
    /// Needed unless α and β are given, and for `observer`.
    #[schemars(with = "Option<Vec<RootFile>>", length(min = 1, max = 2))]
    pub roots_per_s: Option<RootsFile>,
    /// α as the paper writes it, in the place of roots: in 1/s for `continuous`, in 1/s² for the others, which need β too. For `swarm`,
    /// which the paper does not print, p² + β p + α should have real roots, β² ≥ 4 α: what it promises is derived for these. Not for
    /// `observer`.
    #[schemars(with = "Option<Positive>")]
    pub alpha: Option<At<f64>>,
    /// β as the paper writes it, in 1/s; not for `continuous` and `observer`, which have none.
    #[schemars(with = "Option<Positive>")]
    pub beta: Option<At<f64>>,
    /// The factor k of the differences to neighbours; for `swarm`, which needs it.
    #[schemars(with = "Option<Positive>")]
    pub coupling: Option<At<f64>>,
    /// The gain γ of the sign, in rad/s² or m/s² for `continuous` and `observer`, else in rad/s³ or m/s³. It must exceed what drives the
    /// leader: see what `check` says.
    #[schemars(with = "Positive")]
    pub gain: At<f64>,
    /// How a value of the sign is chosen. Default: implicit.
    pub sign: Option<At<SignFile>>,
    /// How often the sign is set when control is continuous, in s. Default: 0.001. Sampled controllers set it at every sample.
    #[schemars(with = "Option<Positive>")]
    pub sign_period_s: Option<At<f64>>,
}

/// The designs that follow a leader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LeaderDesignFile {
    /// (110), Theorem 8: the sign acts on the reference acceleration.
    Continuous,
    /// (119), Theorem 9: torques are differentiable; accelerations are transmitted.
    Differentiable,
    /// (122), Remark 12: torques are differentiable; reference accelerations are transmitted instead.
    WithoutAcceleration,
    /// Swarm tracking over an undirected graph, with differences to neighbours only; not printed in the paper.
    Swarm,
    /// Everybody agrees with the leader on one vector, y = ż + β z + α q, and tells that alone: torques are differentiable, over graphs that
    /// switch and links that delay too; not from the paper.
    Composite,
    /// A distributed observer of the leader, for comparison: agents tell where they believe the leader to be and how fast, and each
    /// follows its own estimate; not from the paper.
    Observer,
}

/// How a value of a set-valued sign is chosen.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum SignFile {
    /// Such that it suits the end of the period: no chatter.
    Implicit,
    /// By the start of the period; for comparison: it chatters.
    Explicit,
    /// A straight line between −width and width at every instant; for comparison: an error of that size stays.
    BoundaryLayer(LayerFile),
}

/// A boundary layer.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LayerFile {
    /// Its width ε, in the unit of what the sign is taken of.
    #[schemars(with = "Positive")]
    pub width: At<f64>,
}

impl ReferenceKind for LeaderReferenceFile {
    fn table() -> ReferenceTable {
        ReferenceTable {
            key: "leader",
            description: "Everybody follows a leader that only some hear: (110), (119) or (122) of the paper, or a rival.",
            own_roots: false,
        }
    }

    fn read(&self, reader: &mut ReferenceReader<'_>) -> Result<ReferenceRead, Fault> {
        let leader = reader.leader()?;
        let design = match self.design.value {
            LeaderDesignFile::Continuous => FollowingDesign::Continuous,
            LeaderDesignFile::Differentiable => FollowingDesign::Differentiable,
            LeaderDesignFile::WithoutAcceleration => FollowingDesign::WithoutAcceleration,
            LeaderDesignFile::Swarm => match &self.coupling {
                Some(coupling) => FollowingDesign::Swarm { coupling: coupling.value },
                None => return Err(fault(&self.design, ValueProblem::MissingKey { key: "coupling" })),
            },
            LeaderDesignFile::Composite => FollowingDesign::Composite,
            LeaderDesignFile::Observer => FollowingDesign::Observer { kappa: second_root(self)? },
        };
        if let (Some(coupling), false) = (&self.coupling, matches!(design, FollowingDesign::Swarm { .. })) {
            return Err(fault(coupling, SystemProblem::CouplingUnused));
        }
        let (alpha, beta) = coefficients(self, design)?;
        let choice = match self.sign.as_ref().map(|sign| &sign.value) {
            None | Some(SignFile::Implicit) => Choice::Implicit,
            Some(SignFile::Explicit) => Choice::Explicit,
            Some(SignFile::BoundaryLayer(layer)) => Choice::Layer { width: layer.width.value },
        };
        let layer = matches!(choice, Choice::Layer { .. });
        if let (Some(every), true) = (&self.sign_period_s, layer || reader.sampled()) {
            return Err(fault(every, SystemProblem::SignPeriodUnused { layer }));
        }
        let period_s = self.sign_period_s.as_ref().map_or(SIGN_EVERY_S, |every| every.value);
        let following = Following { leader, design, alpha, beta, gain: self.gain.value, choice, period_s };
        let exchange = match design {
            FollowingDesign::Observer { .. } => Exchange::Estimates,
            FollowingDesign::Composite => Exchange::Composite,
            FollowingDesign::Continuous
            | FollowingDesign::Differentiable
            | FollowingDesign::WithoutAcceleration
            | FollowingDesign::Swarm { .. } => Exchange::PositionVelocity,
        };
        Ok(ReferenceRead::new(following, exchange))
    }
}

/// κ of an observer, which has nothing but roots.
fn second_root(file: &LeaderReferenceFile) -> Result<f64, Fault> {
    if let Some(stated) = file.alpha.as_ref().or(file.beta.as_ref()) {
        return Err(fault(stated, SystemProblem::RootsAlone));
    }
    let Some(list) = &file.roots_per_s else {
        return Err(Fault::new(ValueProblem::MissingKey { key: "roots_per_s" }));
    };
    let roots = checked_roots(&list.value[..list.value.len().min(3)])?;
    match (roots.real.as_slice(), roots.pairs.as_slice()) {
        ([_, kappa], []) => Ok(*kappa),
        _ => Err(fault(list, SystemProblem::LeaderRoots { found: list.value.len(), need: 2 })),
    }
}

/// α and β: as they are stated, else those of the roots.
fn coefficients(file: &LeaderReferenceFile, design: FollowingDesign) -> Result<(f64, f64), Fault> {
    let LeaderReferenceFile { roots_per_s, alpha, beta, .. } = file;
    let twice =
        |place: &At<f64>, second| Err(fault(place, ValueProblem::SameQuantity { first: "roots_per_s", second }));
    let continuous = design == FollowingDesign::Continuous;
    match (roots_per_s, alpha, beta) {
        (Some(_), Some(alpha), _) => twice(alpha, "alpha"),
        (Some(_), None, Some(beta)) => twice(beta, "beta"),
        (Some(list), None, None) => of_roots(list, design),
        (None, Some(_), Some(beta)) if continuous => Err(fault(beta, SystemProblem::BetaUnused)),
        // p + α.
        (None, Some(alpha), None) if continuous => Ok((alpha.value, 1.0)),
        (None, Some(alpha), Some(beta)) => Ok((alpha.value, beta.value)),
        (None, Some(_), None) => Err(Fault::new(ValueProblem::MissingKey { key: "beta" })),
        (None, None, Some(_)) => Err(Fault::new(ValueProblem::MissingKey { key: "alpha" })),
        (None, None, None) => Err(Fault::new(ValueProblem::MissingKey { key: "roots_per_s" })),
    }
}

/// α and β of roots.
fn of_roots(list: &RootsFile, design: FollowingDesign) -> Result<(f64, f64), Fault> {
    // Three are too many already.
    let roots = checked_roots(&list.value[..list.value.len().min(3)])?;
    let wrong = |need| Err(fault(list, SystemProblem::LeaderRoots { found: roots.len().max(list.value.len()), need }));
    match (design, roots.real.as_slice(), roots.pairs.as_slice()) {
        (FollowingDesign::Continuous, [root], []) => Ok((*root, 1.0)),
        (FollowingDesign::Continuous, ..) => wrong(1),
        (FollowingDesign::Observer { .. }, [alpha, _], []) => Ok((*alpha, 1.0)),
        (FollowingDesign::Observer { .. }, ..) => wrong(2),
        (_, [first, second], []) => Ok((first * second, first + second)),
        (_, [], [RootPair { real, imaginary }]) => Ok((real * real + imaginary * imaginary, real + real)),
        _ => wrong(2),
    }
}
