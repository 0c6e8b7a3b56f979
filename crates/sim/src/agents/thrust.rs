//! (45)–(58): the law of vehicles with one thrust, by angular velocities or, for rotorcraft, by torques.

use std::sync::Arc;

use forwardstep_core::controller::{Floor, RateLoop, Thrust, ThrustByAcceleration, ThrustCascade, ThrustDesign, Yaw};
use forwardstep_core::law::{ParameterBounds, Range};
use forwardstep_core::plant::{AcceleratedVehicle, Vehicle};

use super::rotorcraft::{self, RotorcraftModel};
use super::vehicle::{self, VehicleModel};
use crate::closed_loop::{Assembly, Block, SetupError};
use crate::quantity::{Path, each, finite, not_negative, positive};
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
    /// The same with a measured acceleration, of order two; see [`ThrustByAcceleration`].
    ByAcceleration {
        /// α*, 1/s.
        alpha_star: f64,
        /// γ*, kg s²/m²; zero to keep the estimate as it is.
        gamma_star: f64,
        /// m̂(0), kg.
        estimate_start: f64,
        /// Where m is known to be, kg; m̂ keeps to it.
        bounds: Option<Range>,
        /// What the accelerometer gives too much on each axis, m/s².
        bias: [f64; 3],
    },
}

impl ThrustKind {
    /// How many roots it needs.
    pub fn order(self) -> usize {
        match self {
            ThrustKind::Continuous | ThrustKind::ByAcceleration { .. } => 2,
            ThrustKind::Differentiable { .. } | ThrustKind::Adaptive { .. } => 3,
        }
    }

    /// m̂(0), where the mass is adapted.
    pub fn estimate_start(self) -> Option<f64> {
        match self {
            ThrustKind::Adaptive { estimate_start, .. } | ThrustKind::ByAcceleration { estimate_start, .. } => {
                Some(estimate_start)
            }
            ThrustKind::Continuous | ThrustKind::Differentiable { .. } => None,
        }
    }

    /// γ*, where the mass is adapted.
    pub fn adaptation(self) -> Option<f64> {
        match self {
            ThrustKind::Adaptive { gamma_star, .. } | ThrustKind::ByAcceleration { gamma_star, .. } => Some(gamma_star),
            ThrustKind::Continuous | ThrustKind::Differentiable { .. } => None,
        }
    }

    /// The bounds of the mass.
    pub fn bounds(self) -> Option<Range> {
        match self {
            ThrustKind::Adaptive { bounds, .. } | ThrustKind::ByAcceleration { bounds, .. } => bounds,
            ThrustKind::Continuous | ThrustKind::Differentiable { .. } => None,
        }
    }

    /// What an accelerometer gives too much on each axis, m/s²; zero where there is none.
    pub fn bias(self) -> [f64; 3] {
        match self {
            ThrustKind::ByAcceleration { bias, .. } => bias,
            ThrustKind::Continuous | ThrustKind::Differentiable { .. } | ThrustKind::Adaptive { .. } => [0.0; 3],
        }
    }

    fn is_by_acceleration(self) -> bool {
        matches!(self, ThrustKind::ByAcceleration { .. })
    }
}

impl Law for ThrustLaw {
    fn words(&self) -> LawWords {
        if self.design.is_by_acceleration() {
            return LawWords {
                name: "the thrust law by a measured acceleration",
                made_for: "vehicles, not for rotorcraft",
            };
        }
        LawWords { name: "the thrust law", made_for: "vehicles and rotorcraft" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        let by_acceleration = self.design.is_by_acceleration();
        let model: Option<&VehicleModel> = robot.kind.downcast();
        let interface = match model {
            Some(_) if by_acceleration => Interface::of::<ThrustByAcceleration>(),
            Some(_) => Interface::of::<Thrust>(),
            None if robot.kind.is::<RotorcraftModel>() && !by_acceleration => Interface::of::<ThrustCascade>(),
            None => return None,
        };
        let start = model.zip(self.design.estimate_start()).map(|(model, mass)| mass * model.gravity);
        Some(Interface {
            follows: &[ReferenceFamily::Consensus],
            measures_velocity: true,
            // An accelerometer measures what a push does too, and that is not modelled.
            pushed: !by_acceleration,
            estimates: self.design.estimate_start().is_some(),
            actuator_start: if by_acceleration {
                self.thrust_start.or(start).into_iter().collect()
            } else {
                Vec::new()
            },
            lines: vec![Line { signal: Signal::Thrust, entry: 0, value: LineValue::Floor(self.floor.newtons()) }],
            ..interface
        })
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn kept_within(&self) -> Option<ParameterBounds> {
        self.design.bounds().map(|Range { lower, upper }| ParameterBounds::new(vec![lower], vec![upper], 1.0))
    }

    fn with_estimate(&self, theta: &[f64], _: &RobotSetup) -> Option<Arc<dyn Law>> {
        let mut law = *self;
        match &mut law.design {
            ThrustKind::Continuous | ThrustKind::Differentiable { .. } => return None,
            ThrustKind::Adaptive { estimate_start, .. } | ThrustKind::ByAcceleration { estimate_start, .. } => {
                *estimate_start = *theta.first()?;
            }
        }
        Some(Arc::new(law))
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        if let Ok(VehicleModel { gravity }) = assembly.robot() {
            let plant = vehicle::plant(assembly, *gravity)?;
            if let ThrustKind::ByAcceleration { bias, .. } = self.design {
                let law = self.by_acceleration(assembly, &plant)?;
                return assembly.solo(AcceleratedVehicle { vehicle: plant, bias }, law);
            }
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
    /// The law by a measured acceleration.
    fn by_acceleration(&self, assembly: &Assembly<'_>, vehicle: &Vehicle) -> Result<ThrustByAcceleration, SetupError> {
        let own = assembly.agent();
        let ThrustKind::ByAcceleration { alpha_star, gamma_star, estimate_start, bounds, bias } = self.design else {
            return Err(assembly.law_of_another());
        };
        let design = assembly.of_law().key("design.by_acceleration");
        let gains = [alpha_star, gamma_star];
        self.adapts(assembly, &design, (gains, estimate_start, bounds))?;
        each(design, "bias_m_s2", &bias, finite)?;
        self.common(assembly, estimate_start * vehicle.gravity)?;
        let mut law = ThrustByAcceleration::new(gains, &own.roots_per_s, estimate_start, vehicle.gravity)
            .map_err(|error| SetupError::Roots { agent: own.name.clone(), error })?;
        (law.yaw, law.floor, law.bounds) = (self.yaw, self.floor, bounds);
        Ok(law)
    }

    /// Checks α*, γ*, m̂(0) and the bounds of a mass that is adapted.
    fn adapts(
        &self,
        assembly: &Assembly<'_>,
        design: &Path,
        ([alpha_star, gamma_star], estimate_start, bounds): ([f64; 2], f64, Option<Range>),
    ) -> Result<(), SetupError> {
        positive(design.clone(), "damping_per_s", alpha_star)?;
        not_negative(design.clone(), "adaptation_gain", gamma_star)?;
        positive(design.clone(), "estimate_start_kg", estimate_start)?;
        assembly.range(design.clone().key("bounds"), bounds, gamma_star)
    }

    /// Checks how many roots there are, floor, heading and the thrust at the start, which is `weight` when it is not given.
    fn common(&self, assembly: &Assembly<'_>, weight: f64) -> Result<(), SetupError> {
        assembly.root_count(self.design.order())?;
        let law = || assembly.of_law();
        match self.floor {
            Floor::Stops(floor) => positive(law().key("floor"), "stops_n", floor)?,
            Floor::Kept { floor, approach_s } => {
                positive(law().key("floor.kept"), "thrust_n", floor)?;
                positive(law().key("floor.kept"), "approach_s", approach_s)?;
            }
        }
        not_negative(law().key("yaw"), "gain_per_s", self.yaw.gain)?;
        Ok(positive(law(), "thrust_start_n", self.thrust_start.unwrap_or(weight))?)
    }

    /// The outer law, which knows the true mass unless it adapts it.
    fn outer(&self, assembly: &Assembly<'_>, vehicle: &Vehicle) -> Result<Thrust, SetupError> {
        let own = assembly.agent();
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
                self.adapts(assembly, &design, ([alpha_star, gamma_star], estimate_start, bounds))?;
                (ThrustDesign::Adaptive { alpha_star, gamma_star }, estimate_start)
            }
            ThrustKind::ByAcceleration { .. } => return Err(assembly.law_of_another()),
        };
        self.common(assembly, mass * vehicle.gravity)?;
        let mut outer = Thrust::new(design, &own.roots_per_s, mass, vehicle.gravity)
            .map_err(|error| SetupError::Roots { agent: own.name.clone(), error })?;
        (outer.yaw, outer.floor, outer.thrust_start) = (self.yaw, self.floor, self.thrust_start);
        outer.bounds = self.design.bounds();
        Ok(outer)
    }
}
