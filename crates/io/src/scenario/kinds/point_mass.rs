//! `robot.point_mass`: a mass that is pushed along every axis; and where its velocity is not measured `law.position_only`, (a8), and beside it
//! `law.model_reference`.

use std::sync::Arc;

use forwardstep_core::robot::PointMass;
use forwardstep_sim::{Law, ModelReferenceLaw, PositionOnlyLaw, RobotSetup, Start};
use schemars::JsonSchema;
use serde::Deserialize;

use super::bounds::EstimateBoundsFile;
use super::drives::{StatedFrictionFile, driven};
use super::{
    At, AxisValues, Fault, InputFolder, LawKind, LawReader, LawTable, LawTemplate, RobotKind, RobotRead, RobotTable,
    RobotTemplate, Spread, StartReader, Stop, TaskTemplate, count, number_or, positive,
};
use crate::scenario::values::{NotNegativeEach, Positive};

/// Axes a point mass may have.
const MOST_DIMENSIONS: u32 = 100;
/// Gains that suit a mass of about a kilogram.
const DAMPING_GAIN: f64 = 8.0;
const ADAPTATION_GAIN: f64 = 10.0;
/// Of the filter that stands in for a velocity.
const FILTER_PER_S: f64 = 10.0;

/// A point mass.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PointMassFile {
    /// The number of axes.
    #[schemars(range(min = 1))]
    pub dimension: At<i64>,
    /// Its mass, in kg.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mass_kg: At<f64>,
    /// Viscous damping along all axes or along each, in N s/m. Default: none.
    #[schemars(with = "Option<NotNegativeEach>")]
    pub damping: Option<At<AxisValues>>,
    /// Coulomb friction along every axis by itself, as of a stage on rails. Default: none.
    pub friction: Option<StatedFrictionFile>,
}

impl RobotKind for PointMassFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "point_mass",
            description: "A point mass that is pushed along every axis.",
            usual_law: "adaptive",
            template: Some(RobotTemplate {
                name: "mass",
                line: "robot.point_mass = { dimension = 2, mass_kg = 4.0 }".into(),
                says: "in a plane",
                starts: vec![[-2.0, 2.0]; 2],
                law: LawTemplate::Adaptive,
                dry_friction: Some("friction.dry = { coulomb = 0.5 }"),
                task: TaskTemplate::LAGRANGIAN,
            }),
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        let mass = point_mass(self)?;
        Ok(RobotRead::new(driven(mass, self.damping.as_ref(), None, self.friction.as_ref())?))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        // The mass comes first; what acts along the axes stays.
        spread.scale_each(&mut read.robot.theta[..1]);
        Ok(())
    }

    fn start(&self, _: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        given.position_and_velocity()
    }
}

fn point_mass(file: &PointMassFile) -> Result<RobotSetup, Fault> {
    let dimension = count("dimension", &file.dimension, MOST_DIMENSIONS)?;
    Ok(RobotSetup::point_mass(dimension, positive("mass_kg", &file.mass_kg)?))
}

/// The law (a8) for a point mass whose velocity is not measured.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PositionOnlyFile {
    /// The gain k, in N s/m. Default: 8.
    #[schemars(with = "Option<Positive>")]
    pub damping: Option<At<f64>>,
    /// The rate λ_f of the filter that stands in for the velocity, in 1/s. Default: 10.
    #[schemars(with = "Option<Positive>")]
    pub filter_per_s: Option<At<f64>>,
    /// The gain γ* of the mass estimate. Default: 10. Zero to keep the estimate as it is.
    #[schemars(range(min = 0))]
    pub adaptation_gain: Option<At<f64>>,
    /// The mass estimate at the start, in kg. Default: 0, or the nearest within the bounds.
    pub estimate_start_kg: Option<At<f64>>,
    /// Bounds beyond which the mass estimate is not used. Default: none.
    pub bounds: Option<EstimateBoundsFile>,
}

impl LawKind for PositionOnlyFile {
    fn table() -> LawTable {
        LawTable {
            key: "position_only",
            description: "A point mass of unknown mass whose velocity is not measured: (a8) of the paper.",
            made_for: "point masses without damping and friction, of which it knows no velocity to compensate them at",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.is::<PointMass>()
    }

    fn law(&self, reader: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        let bounds = self.bounds.as_ref().map(|bounds| bounds.of_mass(reader.robot, reader.agent)).transpose()?;
        let nearest = bounds.map_or(0.0, |range| range.nearest(0.0));
        Ok(Arc::new(PositionOnlyLaw {
            damping: number_or(&self.damping, DAMPING_GAIN),
            filter_per_s: number_or(&self.filter_per_s, FILTER_PER_S),
            adaptation: number_or(&self.adaptation_gain, ADAPTATION_GAIN),
            estimate_start: self.estimate_start_kg.as_ref().map_or(nearest, |start| start.value),
            bounds,
        }))
    }
}

/// A point mass whose velocity is not measured, by a model of two roots and a high gain, which Remark 7 of the paper compares (a8) with.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelReferenceFile {
    /// The rate λ_f of the filters that stand in for the velocity, in 1/s. Default: 10.
    #[schemars(with = "Option<Positive>")]
    pub filter_per_s: Option<At<f64>>,
    /// The gain γ* of the mass estimate. Default: 10. Zero to keep the estimate as it is.
    #[schemars(range(min = 0))]
    pub adaptation_gain: Option<At<f64>>,
    /// The mass estimate at the start, in kg. Default: 0.
    pub estimate_start_kg: Option<At<f64>>,
}

impl LawKind for ModelReferenceFile {
    fn table() -> LawTable {
        LawTable {
            key: "model_reference",
            description: "A point mass of unknown mass whose velocity is not measured, by a model and a high gain, to compare `position_only` with.",
            made_for: "point masses without damping and friction, of which it knows no velocity to compensate them at",
        }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.is::<PointMass>()
    }

    fn law(&self, _: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        Ok(Arc::new(ModelReferenceLaw {
            filter_per_s: number_or(&self.filter_per_s, FILTER_PER_S),
            adaptation: number_or(&self.adaptation_gain, ADAPTATION_GAIN),
            estimate_start: number_or(&self.estimate_start_kg, 0.0),
        }))
    }
}
