//! `robot.ship`: a fully actuated surface ship in the earth frame.

use forwardstep_core::expression::Number;
use forwardstep_sim::quantity::{QuantityError, Requirement};
use forwardstep_sim::{RobotSetup, Start};
use schemars::JsonSchema;
use serde::Deserialize;

use super::{
    At, Fault, InputFolder, LawTemplate, RobotKind, RobotRead, RobotTable, RobotTemplate, Spread, StartReader, Stop,
    TaskTemplate, fault, not_negative, positive,
};
use crate::scenario::value_problem::ValueProblem;

/// A surface ship with three degrees of freedom, pushed and turned at will; its position is (x, y, ψ) in the earth frame, ψ is not
/// wrapped, and there is no current.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShipFile {
    /// Inertia with added mass, in the axes of the body.
    pub inertia: At<ShipInertiaFile>,
    /// Linear damping in the axes of the body. Default: none.
    #[serde(default)]
    pub damping: Option<At<ShipDampingFile>>,
}

/// m₁₁, m₂₂, m₂₃ and m₃₃; m₂₂ m₃₃ must exceed m₂₃².
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShipInertiaFile {
    /// Surge, in kg.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub surge_kg: At<f64>,
    /// Sway, in kg.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub sway_kg: At<f64>,
    /// Between sway and yaw, in kg m. Default: 0.
    pub sway_yaw_kg_m: Option<At<f64>>,
    /// Yaw, in kg m².
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub yaw_kg_m2: At<f64>,
}

/// d₁₁, d₂₂, d₂₃, d₃₂ and d₃₃; D + Dᵀ must be positive semidefinite: 4 d₂₂ d₃₃ not below (d₂₃ + d₃₂)².
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShipDampingFile {
    /// Surge, in N s/m.
    #[schemars(range(min = 0))]
    pub surge_n_s_m: At<f64>,
    /// Sway, in N s/m.
    #[schemars(range(min = 0))]
    pub sway_n_s_m: At<f64>,
    /// Of sway by yaw, in N s. Default: 0.
    pub sway_yaw_n_s: Option<At<f64>>,
    /// Of yaw by sway, in N s. Default: 0.
    pub yaw_sway_n_s: Option<At<f64>>,
    /// Yaw, in N m s.
    #[schemars(range(min = 0))]
    pub yaw_n_m_s: At<f64>,
}

impl RobotKind for ShipFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "ship",
            description: "A fully actuated surface ship: its position is (x, y, ψ) in the earth frame.",
            usual_law: "adaptive",
            template: Some(RobotTemplate {
                name: "ship",
                line: "robot.ship = { inertia = { surge_kg = 25.8, sway_kg = 33.8, sway_yaw_kg_m = 1.1, yaw_kg_m2 = 2.8 }, damping = { surge_n_s_m = 12.0, sway_n_s_m = 17.0, sway_yaw_n_s = 0.4, yaw_sway_n_s = 0.7, yaw_n_m_s = 1.5 } }".into(),
                says: "x, y and the heading",
                starts: vec![[-2.0, 2.0], [-2.0, 2.0], [-1.0, 1.0]],
                law: LawTemplate::Adaptive,
                dry_friction: None,
                task: TaskTemplate::LAGRANGIAN,
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        Ok(RobotRead::new(RobotSetup::ship(theta(self)?)))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        // The inertia scales as a whole and so does the damping: both keep their signs.
        let factors = spread.factors(2);
        let (inertia, damping) = read.robot.theta.split_at_mut(4);
        for (entries, factor) in [inertia, damping].into_iter().zip(factors) {
            entries.iter_mut().for_each(|entry| *entry *= factor);
        }
        Ok(())
    }

    fn start(&self, _: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        given.position_and_velocity()
    }
}

fn out_of_range(key: &'static str, value: f64, most: f64) -> ValueProblem {
    let requirement = Requirement::Within { low: 0.0 - most, high: most };
    ValueProblem::Quantity(QuantityError { path: key.into(), value, requirement })
}

/// ϑ, with M ≻ 0 and D + Dᵀ ⪰ 0.
fn theta(file: &ShipFile) -> Result<[f64; 9], Fault> {
    let given = |value: &Option<At<f64>>| value.as_ref().map_or(0.0, |value| value.value);
    let ShipInertiaFile { surge_kg, sway_kg, sway_yaw_kg_m, yaw_kg_m2 } = &file.inertia.value;
    let (m11, m22) = (positive("surge_kg", surge_kg)?, positive("sway_kg", sway_kg)?);
    let (m23, m33) = (given(sway_yaw_kg_m), positive("yaw_kg_m2", yaw_kg_m2)?);
    // As the decimals are written: 0.1 · 0.9 is 0.3².
    let written = |value: f64| Number::written(value);
    if written(m22) * written(m33) <= written(m23) * written(m23) {
        let most = (m22 * m33).sqrt();
        // The edge itself is singular.
        let within = most.min(m23.abs()) * (1.0 - f64::EPSILON);
        let problem = out_of_range("sway_yaw_kg_m", m23, within);
        return Err(fault(sway_yaw_kg_m.as_ref().unwrap_or(sway_kg), problem));
    }
    let Some(At { value: damping, .. }) = &file.damping else {
        return Ok([m11, m22, m23, m33, 0.0, 0.0, 0.0, 0.0, 0.0]);
    };
    let ShipDampingFile { surge_n_s_m, sway_n_s_m, sway_yaw_n_s, yaw_sway_n_s, yaw_n_m_s } = damping;
    let d11 = not_negative("surge_n_s_m", surge_n_s_m)?;
    let (d22, d33) = (not_negative("sway_n_s_m", sway_n_s_m)?, not_negative("yaw_n_m_s", yaw_n_m_s)?);
    let (d23, d32) = (given(sway_yaw_n_s), given(yaw_sway_n_s));
    if (d23 + d32) * (d23 + d32) > 4.0 * d22 * d33 {
        let most = 2.0 * (d22 * d33).sqrt();
        let key = "sway_yaw_n_s + yaw_sway_n_s";
        let problem = out_of_range(key, d23 + d32, most);
        return Err(fault(sway_yaw_n_s.as_ref().or(yaw_sway_n_s.as_ref()).unwrap_or(sway_n_s_m), problem));
    }
    Ok([m11, m22, m23, m33, d11, d22, d23, d32, d33])
}
