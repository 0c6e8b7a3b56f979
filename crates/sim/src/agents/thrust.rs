//! (45)–(58): the law of vehicles with one thrust, by angular velocities or, for rotorcraft, by torques.

use forwardstep_core::controller::{Floor, RateLoop, Thrust, ThrustCascade, ThrustDesign, Yaw};
use forwardstep_core::law::{ParameterBounds, Range};
use forwardstep_core::plant::Vehicle;

use super::rotorcraft::{self, RotorcraftModel};
use super::vehicle::{self, VehicleModel};
use crate::closed_loop::{Assembly, Block, SetupError};
use crate::quantity::{not_negative, positive};
use crate::recording::Signal;
use crate::reference::ReferenceFamily;
use crate::setup::RobotSetup;
use crate::system::{Interface, Known, Law, LawWords, Line, LineValue};

/// The control of a vehicle or a rotorcraft; its roots are those of its agent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThrustLaw {
    /// Which of the paper's controllers.
    pub design: ThrustKind,
    /// What ω₃ is used for.
    pub yaw: Yaw,
    /// What happens near σ = 0.
    pub floor: Floor,
    /// σ(0), N; m g, or m̂(0) g where the mass is adapted, when it is not given.
    pub thrust_start: Option<f64>,
    /// b, 1/s: how fast a rotorcraft's torques bring about its angular velocity. Vehicles have no use for it.
    pub bandwidth_per_s: f64,
}

/// Which controller of Section V-B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThrustKind {
    /// (46), of order two.
    Continuous,
    /// (50), of order three.
    Differentiable {
        /// α*, 1/s.
        alpha_star: f64,
        /// k, kg/s².
        stiffness: f64,
    },
    /// (57), (58), of order three.
    Adaptive {
        /// α*, 1/s.
        alpha_star: f64,
        /// γ*, kg s²/m²; zero to keep the estimate as it is.
        gamma_star: f64,
        /// m̂(0), kg.
        estimate_start: f64,
        /// Where m is known to be, kg; m̂ keeps to it.
        bounds: Option<Range>,
    },
}

impl ThrustKind {
    /// How many roots it needs.
    pub fn order(self) -> usize {
        match self {
            ThrustKind::Continuous => 2,
            ThrustKind::Differentiable { .. } | ThrustKind::Adaptive { .. } => 3,
        }
    }
}

impl Law for ThrustLaw {
    fn words(&self) -> LawWords {
        LawWords { name: "the thrust law", made_for: "vehicles and rotorcraft" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        let interface = if robot.kind.is::<VehicleModel>() {
            Interface::of::<Thrust>()
        } else if robot.kind.is::<RotorcraftModel>() {
            Interface::of::<ThrustCascade>()
        } else {
            return None;
        };
        Some(Interface {
            follows: &[ReferenceFamily::Consensus],
            measures_velocity: true,
            pushed: true,
            estimates: matches!(self.design, ThrustKind::Adaptive { .. }),
            lines: vec![Line { signal: Signal::Thrust, entry: 0, value: LineValue::Floor(self.floor.newtons()) }],
            ..interface
        })
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn kept_within(&self) -> Option<ParameterBounds> {
        match self.design {
            ThrustKind::Adaptive { bounds, .. } => {
                bounds.map(|Range { lower, upper }| ParameterBounds::new(vec![lower], vec![upper], 1.0))
            }
            ThrustKind::Continuous | ThrustKind::Differentiable { .. } => None,
        }
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        if let Ok(VehicleModel { gravity }) = assembly.robot() {
            let plant = vehicle::plant(assembly, *gravity)?;
            let controller = self.outer(assembly, &plant)?;
            return assembly.solo(plant, controller);
        }
        let model: &RotorcraftModel = assembly.robot()?;
        positive(assembly.of_law(), "rate_bandwidth_per_s", self.bandwidth_per_s)?;
        let plant = rotorcraft::plant(assembly, model)?;
        let outer = self.outer(assembly, &plant.vehicle)?;
        let rates = RateLoop { inertia: *plant.inertia(), bandwidth_per_s: self.bandwidth_per_s };
        assembly.solo(plant, ThrustCascade { outer, rates })
    }
}

impl ThrustLaw {
    /// The outer law, which knows the true mass unless it adapts it.
    fn outer(&self, assembly: &Assembly<'_>, vehicle: &Vehicle) -> Result<Thrust, SetupError> {
        let own = assembly.agent();
        assembly.root_count(self.design.order())?;
        let mut within = None;
        let (design, mass) = match self.design {
            ThrustKind::Continuous => (ThrustDesign::Continuous, vehicle.mass),
            ThrustKind::Differentiable { alpha_star, stiffness } => {
                let design = assembly.of_law().key("design.differentiable");
                positive(design.clone(), "stiffness", stiffness)?;
                positive(design, "damping_per_s", alpha_star)?;
                (ThrustDesign::Differentiable { alpha_star, stiffness }, vehicle.mass)
            }
            ThrustKind::Adaptive { alpha_star, gamma_star, estimate_start, bounds } => {
                let design = assembly.of_law().key("design.adaptive");
                positive(design.clone(), "damping_per_s", alpha_star)?;
                not_negative(design.clone(), "adaptation_gain", gamma_star)?;
                positive(design.clone(), "estimate_start_kg", estimate_start)?;
                assembly.range(design.key("bounds"), bounds, gamma_star)?;
                within = bounds;
                (ThrustDesign::Adaptive { alpha_star, gamma_star }, estimate_start)
            }
        };
        let law = || assembly.of_law();
        match self.floor {
            Floor::Stops(floor) => positive(law().key("floor"), "stops_n", floor)?,
            Floor::Kept { floor, approach_s } => {
                positive(law().key("floor.kept"), "thrust_n", floor)?;
                positive(law().key("floor.kept"), "approach_s", approach_s)?;
            }
        }
        not_negative(law().key("yaw"), "gain_per_s", self.yaw.gain)?;
        let mut outer = Thrust::new(design, &own.roots_per_s, mass, vehicle.gravity)
            .map_err(|error| SetupError::Roots { agent: own.name.clone(), error })?;
        positive(law(), "thrust_start_n", self.thrust_start.unwrap_or(mass * vehicle.gravity))?;
        (outer.yaw, outer.floor, outer.thrust_start) = (self.yaw, self.floor, self.thrust_start);
        outer.bounds = within;
        Ok(outer)
    }
}
