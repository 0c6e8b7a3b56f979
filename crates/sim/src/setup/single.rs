//! The laws of Section V-C for a single robot or spacecraft, as plain data.

use forwardstep_core::Gain;
use forwardstep_core::controller::ParameterBounds;
use forwardstep_core::robot::PlanarTip;
use forwardstep_core::robot::tree::{LinkPoint, Tree, TreeTip, Uncertain};

use super::RobotKind;

/// (80)–(82) for the tip of a robot; see [`forwardstep_core::controller::TaskSpace`].
#[derive(Clone, Debug, PartialEq)]
pub struct TaskSpaceLaw {
    /// What is to follow the target, with its true lengths.
    pub tip: TipSetup,
    /// K; a [`Gain::Bandwidth`] as in [`crate::Law::Adaptive`].
    pub damping: Gain,
    /// Γ; a [`Gain::Bandwidth`] as in [`crate::Law::Adaptive`].
    pub adaptation: Gain,
    /// ϑ̂(0).
    pub estimate_start: Vec<f64>,
    /// K*.
    pub task_gain: Gain,
    /// κ.
    pub kappa: f64,
    /// α, 1/s.
    pub alpha_per_s: f64,
    /// Λ; `None` to keep θ̂ as it is.
    pub kinematic_adaptation: Option<Gain>,
    /// A name for each entry of θ, for tables.
    pub kinematic_names: Vec<String>,
    /// θ̂(0).
    pub kinematic_start: Vec<f64>,
    /// Projection of θ̂; none by default.
    pub bounds: Option<ParameterBounds>,
    /// The run ends when det Ĵ falls below this share of its first value.
    pub determinant_floor: f64,
}

impl TaskSpaceLaw {
    /// What the coordinates of the tip are called.
    pub fn coordinate_name(&self, axis: usize) -> Option<&'static str> {
        let coordinate = match &self.tip {
            TipSetup::Planar(_) => axis,
            TipSetup::Point { coordinates, .. } => *coordinates.get(axis)?,
        };
        ["x", "y", "z"].get(coordinate).copied()
    }
}

/// A tip whose kinematics are uncertain.
#[derive(Clone, Debug, PartialEq)]
pub enum TipSetup {
    /// The end of a planar arm: θ = [l₁, l₂].
    Planar(PlanarTip),
    /// A point of a link of a tree.
    Point {
        /// The point.
        point: LinkPoint,
        /// Which coordinates are controlled: x = 0, y = 1, z = 2 of the base.
        coordinates: Vec<usize>,
        /// Which translations are θ.
        uncertain: Uncertain,
    },
}

impl TipSetup {
    /// The true θ of the tip of `robot`; nothing for a robot that has no such tip.
    pub fn parameters(&self, robot: &RobotKind) -> Option<Vec<f64>> {
        match (robot, self) {
            (RobotKind::PlanarArm, TipSetup::Planar(tip)) => Some(tip.length_m.to_vec()),
            (RobotKind::Tree(tree), TipSetup::Point { point, coordinates, uncertain }) => {
                let tip = TreeTip::new(Tree::clone(tree), point, coordinates, *uncertain).ok()?;
                Some(tip.parameters())
            }
            _ => None,
        }
    }
}

/// (97)–(105) for a spacecraft; see [`forwardstep_core::controller::AttitudeTracking`]. M and h_I are those of the spacecraft and
/// its start.
#[derive(Clone, Debug, PartialEq)]
pub struct AttitudeLaw {
    /// α₁ in 1/s², α₂ in 1/s.
    pub alpha: [f64; 2],
    /// Λ_f, 4 × 4, 1/s.
    pub filter: Gain,
    /// K, 4 × 4.
    pub damping: Gain,
}
