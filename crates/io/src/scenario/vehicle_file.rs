//! Vehicles with one thrust in a scenario, as they are written. The doc comments of this file are descriptions of the published
//! JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;

use super::at::At;
use super::values::{GainFile, NotNegative, Positive};

/// A vehicle with one thrust. Its third axis points down.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VehicleFile {
    /// Its mass, in kg.
    #[schemars(with = "Positive")]
    pub mass_kg: At<f64>,
    /// Gravity, in m/s². Default: 9.81.
    #[schemars(with = "Option<Positive>")]
    pub gravity_m_s2: Option<At<f64>>,
}

/// A vehicle with one thrust as a rigid body. Its third axis points down.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotorcraftFile {
    /// Its mass, in kg.
    #[schemars(with = "Positive")]
    pub mass_kg: At<f64>,
    /// Gravity, in m/s². Default: 9.81.
    #[schemars(with = "Option<Positive>")]
    pub gravity_m_s2: Option<At<f64>>,
    /// Inertia about the centre of mass in the axes of the body, in kg m²: a number, the diagonal, or the rows of a symmetric
    /// matrix.
    pub inertia_kg_m2: At<GainFile>,
    /// Four rotors on the corners of a square. Default: every thrust and every torque can be had.
    pub rotors: Option<At<RotorsFile>>,
}

/// Four rotors, each as far from the two axes of the body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RotorsFile {
    /// How far a rotor is from each of the two axes, in m.
    #[schemars(with = "Positive")]
    pub offset_m: At<f64>,
    /// The torque of its drag for each N of thrust, in m.
    #[schemars(with = "Positive")]
    pub drag_m: At<f64>,
    /// The least and the greatest thrust of one rotor, in N.
    #[schemars(with = "[NotNegative; 2]")]
    pub thrust_n: At<[f64; 2]>,
}

/// The control of a vehicle with one thrust. Agents agree by positions, with two roots for the continuous design and three for
/// the others.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThrustFile {
    /// Which of the paper's controllers. Default: differentiable.
    pub design: Option<ThrustDesignFile>,
    /// What it does about its heading, which the rest leaves free. Default: keeps it at zero.
    pub yaw: Option<YawFile>,
    /// What happens when the thrust, by which the law divides, comes down to a floor. Default: the run stops at a tenth of the
    /// weight.
    pub floor: Option<FloorFile>,
    /// The thrust at the start, in N. Default: the weight, as the law knows it.
    #[schemars(with = "Option<Positive>")]
    pub thrust_start_n: Option<At<f64>>,
    /// How fast the torques of a rotorcraft bring about the angular velocity that is wanted, in 1/s. Default: 30.
    #[schemars(with = "Option<Positive>")]
    pub rate_bandwidth_per_s: Option<At<f64>>,
}

/// The controllers of Section V-B.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ThrustDesignFile {
    /// (45), (46): of order two; angular velocities jump where the network switches.
    Continuous,
    /// (49), (50), Theorem 4: of order three, for a known mass.
    Differentiable(DifferentiableFile),
    /// (49), (57), (58), Theorem 5: of order three, for an unknown mass.
    Adaptive(AdaptiveThrustFile),
}

/// The gains of (50).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DifferentiableFile {
    /// The gain α*, in 1/s. Default: 3.
    #[schemars(with = "Option<Positive>")]
    pub damping_per_s: Option<At<f64>>,
    /// The gain k, in kg/s² = N/m. Default: 4.
    #[schemars(with = "Option<Positive>")]
    pub stiffness: Option<At<f64>>,
}

/// The gains of (57) and (58).
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AdaptiveThrustFile {
    /// The gain α*, in 1/s. Default: 3.
    #[schemars(with = "Option<Positive>")]
    pub damping_per_s: Option<At<f64>>,
    /// The gain γ* of the mass estimate. Default: 0.2. Zero to keep the estimate as it is.
    #[schemars(range(min = 0))]
    pub adaptation_gain: Option<At<f64>>,
    /// The mass estimate at the start, in kg; positive, for the thrust starts with it.
    #[schemars(with = "Positive")]
    pub estimate_start_kg: At<f64>,
}

/// The heading of a vehicle.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct YawFile {
    /// The heading at the start, in rad from the first axis towards the second. Default: 0.
    pub heading_rad: Option<f64>,
    /// How fast it turns, in rad/s. Default: 0.
    pub rate_rad_s: Option<f64>,
    /// How fast the vehicle is led to it, in 1/s. Default: 1. Zero to let it be.
    #[schemars(range(min = 0))]
    pub gain_per_s: Option<At<f64>>,
}

/// What happens when the thrust comes down to a floor.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FloorFile {
    /// The run stops at this thrust, in N.
    StopsN(#[schemars(with = "Positive")] At<f64>),
    /// The thrust is kept above a floor; no theorem covers that.
    Kept(KeptFloorFile),
}

/// A floor that the thrust stays above.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct KeptFloorFile {
    /// The floor, in N.
    #[schemars(with = "Positive")]
    pub thrust_n: At<f64>,
    /// The time constant with which it is approached at the fastest, in s. Default: 0.1.
    #[schemars(with = "Option<Positive>")]
    pub approach_s: Option<At<f64>>,
}
