//! A point mass whose velocity is not measured: (a7)–(a9) and Remark 7.

use std::sync::Arc;

use forwardstep_core::controller::{PositionOnly, ReferenceModel};
use forwardstep_core::law::{ParameterBounds, Range};
use forwardstep_core::plant::Mechanical;
use forwardstep_core::reference::{Consensus, Position, polynomial};
use forwardstep_core::robot::PointMass;

use crate::closed_loop::{Assembly, Block, SetupError};
use crate::quantity::{not_negative, positive};
use crate::reference::ReferenceFamily;
use crate::setup::RobotSetup;
use crate::system::{Interface, Known, Law, LawWords};

/// (a8) for a point mass, without velocity; see [`PositionOnly`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionOnlyLaw {
    /// k, N s/m.
    pub damping: f64,
    /// λ_f, 1/s.
    pub filter_per_s: f64,
    /// γ*; zero to keep the estimate as it is.
    pub adaptation: f64,
    /// m̂(0), kg.
    pub estimate_start: f64,
    /// Where m is known to be, kg; m̂ keeps to it.
    pub bounds: Option<Range>,
}

impl Law for PositionOnlyLaw {
    fn words(&self) -> LawWords {
        LawWords {
            name: "the law without velocity",
            made_for: "point masses without damping and friction, of which it knows no velocity to compensate them at",
        }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        robot.kind.is::<PointMass>().then(|| Interface {
            follows: &[ReferenceFamily::Consensus, ReferenceFamily::Target],
            tracks_by_roots: true,
            pushed: true,
            estimates: true,
            ..Interface::of::<PositionOnly>()
        })
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn kept_within(&self) -> Option<ParameterBounds> {
        self.bounds.map(|Range { lower, upper }| ParameterBounds::new(vec![lower], vec![upper], 1.0))
    }

    fn with_estimate(&self, theta: &[f64], _: &RobotSetup) -> Option<Arc<dyn Law>> {
        Some(Arc::new(PositionOnlyLaw { estimate_start: *theta.first()?, ..*self }))
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let own = assembly.agent();
        let &PointMass { dimension } = assembly.robot()?;
        let &PositionOnlyLaw { damping, filter_per_s, adaptation, estimate_start, bounds } = self;
        positive(assembly.of_law(), "damping", damping)?;
        positive(assembly.of_law(), "filter_per_s", filter_per_s)?;
        not_negative(assembly.of_law(), "adaptation_gain", adaptation)?;
        assembly.range(assembly.of_law().key("bounds"), bounds, adaptation)?;
        let guide = guide(assembly)?;
        let plant = Mechanical { robot: PointMass { dimension }, theta: own.robot.theta.clone() };
        let axes = dimension;
        let law = PositionOnly { axes, guide, damping, filter_per_s, adaptation, estimate_start, bounds };
        assembly.solo(plant, law)
    }
}

/// Where z leads: to a target, or to agreement.
fn guide(assembly: &Assembly<'_>) -> Result<ReferenceModel, SetupError> {
    let own = assembly.agent();
    let roots = |error| SetupError::Roots { agent: own.name.clone(), error };
    match assembly.reference().interface().family {
        ReferenceFamily::Target => {
            assembly.root_count(3)?;
            let mut alpha = polynomial(&own.roots_per_s).map_err(roots)?;
            // The leading one is not listed.
            alpha.pop();
            Ok(ReferenceModel::Tracking { alpha })
        }
        ReferenceFamily::Consensus if own.roots_per_s.len() < 2 => {
            Err(SetupError::OrderTooLow { agent: own.name.clone(), order: own.roots_per_s.len(), least: 2 })
        }
        ReferenceFamily::Consensus => {
            Ok(ReferenceModel::Consensus(Consensus::<Position>::new([(&own.roots_per_s, 0.0)]).map_err(roots)?))
        }
        _ => Err(assembly.wrong_reference()),
    }
}
