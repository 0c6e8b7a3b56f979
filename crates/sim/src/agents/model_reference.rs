//! A point mass whose velocity is not measured, by a model and a high gain: what Remark 7 compares (a8) with.

use std::sync::Arc;

use forwardstep_core::controller::ModelReference;
use forwardstep_core::plant::Mechanical;
use forwardstep_core::reference::polynomial;
use forwardstep_core::robot::PointMass;

use crate::closed_loop::{Assembly, Block, SetupError};
use crate::quantity::{finite, not_negative, positive};
use crate::setup::RobotSetup;
use crate::system::{Interface, Known, Law, LawWords};

/// Model reference adaptive control of a point mass, without velocity and without reference dynamics; see [`ModelReference`]. The agent's roots
/// are those of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelReferenceLaw {
    /// λ_f, 1/s.
    pub filter_per_s: f64,
    /// γ*; zero to keep the estimate as it is.
    pub adaptation: f64,
    /// m̂(0), kg.
    pub estimate_start: f64,
}

impl Law for ModelReferenceLaw {
    fn words(&self) -> LawWords {
        LawWords {
            name: "the law by a model",
            made_for: "point masses without damping and friction, of which it knows no velocity to compensate them at",
        }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        robot.kind.is::<PointMass>().then(|| Interface {
            tracks_by_roots: true,
            pushed: true,
            estimates: true,
            ..Interface::of::<ModelReference>()
        })
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn with_estimate(&self, theta: &[f64], _: &RobotSetup) -> Option<Arc<dyn Law>> {
        Some(Arc::new(ModelReferenceLaw { estimate_start: *theta.first()?, ..*self }))
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let own = assembly.agent();
        let &PointMass { dimension } = assembly.robot()?;
        let &ModelReferenceLaw { filter_per_s, adaptation, estimate_start } = self;
        positive(assembly.of_law(), "filter_per_s", filter_per_s)?;
        not_negative(assembly.of_law(), "adaptation_gain", adaptation)?;
        finite(assembly.of_law(), "estimate_start_kg", estimate_start)?;
        assembly.root_count(2)?;
        let roots = |error| SetupError::Roots { agent: own.name.clone(), error };
        let coefficients = polynomial(&own.roots_per_s).map_err(roots)?;
        // The leading one is not listed.
        let alpha = [coefficients[0], coefficients[1]];
        let plant = Mechanical { robot: PointMass { dimension }, theta: own.robot.theta.clone() };
        assembly.solo(plant, ModelReference { axes: dimension, alpha, filter_per_s, adaptation, estimate_start })
    }
}
