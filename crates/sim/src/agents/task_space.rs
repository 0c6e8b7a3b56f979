//! The end-effector of a robot with uncertain lengths, without its velocity: (76)–(82), Theorem 6; or with a measured one.

use std::sync::Arc;

use forwardstep_core::controller::{NullSpace, TaskSpace, TaskSpaceByVelocity};
use forwardstep_core::law::ParameterBounds;
use forwardstep_core::plant::{Mechanical, TaskArm, WatchedTaskArm};
use forwardstep_core::robot::tree::{Follows, LinkPoint, TipError, Tree, TreeTip, Uncertain};
use forwardstep_core::robot::{Driven, Lagrangian, PlanarArm, PlanarTip, TipKinematics};
use forwardstep_core::{Gain, ResolvedGain};

use crate::closed_loop::{Assembly, Block, SetupError, tracking_law};
use crate::quantity::{finite, positive, within};
use crate::recording::Signal;
use crate::setup::{AxisUnit, RobotSetup};
use crate::system::{Coordinates, Interface, Known, Law, LawWords, Line, LineValue, Robot};

/// A floor of det Ĵ, as a share of its value at the start, that leaves room.
const LARGEST_FLOOR: f64 = 0.999;

/// The entries of a quaternion among the coordinates of a pose.
const OF_ATTITUDE: [&str; 4] = ["q_x", "q_y", "q_z", "q_o"];

/// (80)–(82) for the tip of a robot; see [`forwardstep_core::controller::TaskSpace`].
#[derive(Clone, Debug, PartialEq)]
pub struct TaskSpaceLaw {
    /// What is to follow the target, with its true lengths.
    pub tip: TipSetup,
    /// Whether the velocity of the tip is measured, and z a function of it; see [`TaskSpaceByVelocity`].
    pub by_velocity: bool,
    /// K; a [`Gain::Bandwidth`] as in [`crate::Adaptive`].
    pub damping: Gain,
    /// Γ; a [`Gain::Bandwidth`] as in [`crate::Adaptive`].
    pub adaptation: Gain,
    /// ϑ̂(0).
    pub estimate_start: Vec<f64>,
    /// Bounds that ϑ̂ is kept within; they need a Γ that is no full matrix.
    pub estimate_bounds: Option<ParameterBounds>,
    /// K*; of a pose K_p, of its position.
    pub task_gain: Gain,
    /// k_o, of poses alone.
    pub attitude_gain: f64,
    /// What redundant joints do beside; the tip of no other robot has one.
    pub null_space: Option<NullSpace>,
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
    /// The run ends when det Ĵ, or of poses and redundant joints its smallest singular value, falls below this share of its first value.
    pub determinant_floor: f64,
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
        /// What of it follows the target.
        follows: Follows,
        /// Which translations are θ.
        uncertain: Uncertain,
    },
}

impl TipSetup {
    /// The true θ of the tip of `robot`; nothing for a robot that has no such tip.
    pub fn parameters(&self, robot: &dyn Robot) -> Option<Vec<f64>> {
        match self {
            TipSetup::Planar(tip) => is_planar(robot).then(|| tip.length_m.to_vec()),
            TipSetup::Point { .. } => Some(self.of_tree(robot.downcast::<Arc<Tree>>()?)?.ok()?.parameters()),
        }
    }

    /// The tip as one of a tree; nothing for that of a planar arm.
    pub fn of_tree(&self, tree: &Tree) -> Option<Result<TreeTip, TipError>> {
        match self {
            TipSetup::Planar(_) => None,
            TipSetup::Point { point, coordinates, follows, uncertain } => {
                Some(TreeTip::new(tree.clone(), point, coordinates, *follows, *uncertain))
            }
        }
    }

    /// What of the tip follows the target.
    pub fn follows(&self) -> Follows {
        match self {
            TipSetup::Planar(_) => Follows::Position,
            TipSetup::Point { follows, .. } => *follows,
        }
    }
}

impl Law for TaskSpaceLaw {
    fn words(&self) -> LawWords {
        let name = if self.by_velocity {
            "the law for an end-effector with a measured velocity"
        } else {
            "the law for an end-effector"
        };
        LawWords { name, made_for: "planar arms, and for robots from a URDF with an end-effector" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        let suits = match self.tip {
            TipSetup::Planar(_) => is_planar(&*robot.kind),
            TipSetup::Point { .. } => robot.kind.is::<Arc<Tree>>(),
        };
        let truth = self.tip.parameters(&*robot.kind).unwrap_or_default();
        let line = |(entry, truth)| Line { signal: Signal::KinematicEstimate, entry, value: LineValue::Truth(truth) };
        let controller = if self.by_velocity {
            Interface::of::<TaskSpaceByVelocity<PlanarArm, PlanarTip>>()
        } else {
            Interface::of::<TaskSpace<PlanarArm, PlanarTip>>()
        };
        suits.then(|| Interface {
            measures_velocity: true,
            pushed: true,
            estimates: true,
            coordinates: Some(self.coordinates()),
            lines: truth.into_iter().enumerate().map(line).collect(),
            ..controller
        })
    }

    fn known(&self) -> Known {
        Known::Checked
    }

    fn kept_within(&self) -> Option<ParameterBounds> {
        self.estimate_bounds.clone()
    }

    fn with_estimate(&self, theta: &[f64], robot: &RobotSetup) -> Option<Arc<dyn Law>> {
        let lengths = self.tip.parameters(&*robot.kind)?;
        Some(Arc::new(TaskSpaceLaw { estimate_start: theta.to_vec(), kinematic_start: lengths, ..self.clone() }))
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        match &self.tip {
            TipSetup::Planar(tip) => match assembly.agent().robot.kind.downcast::<Driven<PlanarArm>>() {
                Some(arm) => self.with_tip(assembly, arm.clone(), *tip, tip.length_m.to_vec()),
                None => self.with_tip(assembly, *assembly.robot::<PlanarArm>()?, *tip, tip.length_m.to_vec()),
            },
            TipSetup::Point { point, coordinates, follows, uncertain } => {
                let tree = Tree::clone(assembly.robot::<Arc<Tree>>()?);
                let tip = TreeTip::new(tree.clone(), point, coordinates, *follows, *uncertain)
                    .map_err(|error| SetupError::Tip { agent: assembly.agent().name.clone(), error })?;
                let theta = tip.parameters();
                self.with_tip(assembly, tree, tip, theta)
            }
        }
    }
}

/// Whether a robot has the tip of a planar arm.
fn is_planar(robot: &dyn Robot) -> bool {
    robot.is::<PlanarArm>() || robot.is::<Driven<PlanarArm>>()
}

impl TaskSpaceLaw {
    fn coordinates(&self) -> Coordinates {
        let list: &[usize] = match &self.tip {
            TipSetup::Planar(_) => &[0, 1],
            TipSetup::Point { coordinates, .. } => coordinates,
        };
        let names = list.iter().filter_map(|coordinate| ["x", "y", "z"].get(*coordinate));
        let mut names: Vec<String> = names.map(|name| (*name).to_owned()).collect();
        let mut units = vec![AxisUnit::Metre; names.len()];
        let quaternion = (self.tip.follows() == Follows::Pose).then_some(names.len());
        if quaternion.is_some() {
            names.extend(OF_ATTITUDE.map(str::to_owned));
            units.extend([AxisUnit::One; OF_ATTITUDE.len()]);
        }
        Coordinates { names, units, quaternion, parameters: self.kinematic_names.clone() }
    }

    fn with_tip<R, T>(
        &self,
        assembly: &Assembly<'_>,
        robot: R,
        tip: T,
        tip_theta: Vec<f64>,
    ) -> Result<Block, SetupError>
    where
        R: Lagrangian<f64, Scratch: Send> + Clone + Send + Sync + 'static,
        T: TipKinematics + Clone,
    {
        let own = assembly.agent();
        let (n, m, p) = (tip.joints(), tip.axes(), tip.parameter_count());
        let law = assembly.of_law();
        assembly.length(law.clone(), "end_effector", own.robot.axes.len(), n)?;
        assembly.length(law.clone(), "the names of the kinematic parameters", p, self.kinematic_names.len())?;
        assembly.estimate("estimate_start.given", &self.estimate_start, robot.parameter_count())?;
        assembly.estimate("kinematic_start.given", &self.kinematic_start, p)?;
        if self.by_velocity && self.tip.follows() != Follows::Position {
            return Err(SetupError::TipVelocity { agent: own.name.clone() });
        }
        if tip.turns() {
            positive(law.clone(), "attitude_gain", self.attitude_gain)?;
        }
        match (&self.null_space, n > tip.rows()) {
            (Some(NullSpace { rate_per_s, posture }), true) => {
                positive(law.clone(), "null_space.rate_per_s", *rate_per_s)?;
                assembly.length(law.clone(), "null_space.posture", n, posture.len())?;
                posture.iter().try_for_each(|entry| finite(law.clone(), "null_space.posture", *entry))?;
            }
            (None, false) => {}
            (null_space, _) => {
                let (agent, has) = (own.name.clone(), null_space.is_some());
                return Err(SetupError::NullSpace { agent, has });
            }
        }
        positive(law.clone(), "torque_share", self.kappa)?;
        positive(law.clone(), "reference_gain_per_s", self.alpha_per_s)?;
        within(law, "determinant_floor", self.determinant_floor, 0.0, LARGEST_FLOOR)?;
        let adapts = self.kinematic_adaptation.as_ref();
        let kinematic_adaptation = adapts.map(|gain| assembly.gain(gain, "kinematic_gain", p)).transpose()?;
        if let Some(bounds) = &self.bounds {
            assembly.bounds(bounds, ["lower_m", "upper_m", "margin_m"], p)?;
            match kinematic_adaptation {
                None => return Err(SetupError::BoundsOfKnown { agent: own.name.clone() }),
                Some(ResolvedGain::Matrix { .. }) => {
                    return Err(SetupError::ProjectionOfMatrix { agent: own.name.clone() });
                }
                Some(ResolvedGain::Diagonal(_)) => {}
            }
        }
        let mut law = tracking_law(&robot, assembly, &self.damping, Some(&self.adaptation))?;
        if let Some(bounds) = &self.estimate_bounds {
            let place = assembly.of_law().key("estimate_bounds");
            assembly.bounds_at(place, bounds, ["lower", "upper", "margin"], own.robot.theta.len())?;
            if !matches!(law.adaptation, Some(ResolvedGain::Diagonal(_))) {
                return Err(SetupError::ProjectionOfMatrix { agent: own.name.clone() });
            }
            law.bounds = Some(bounds.clone());
        }
        let controller = TaskSpace {
            law,
            task_gain: assembly.gain(&self.task_gain, "task_gain", m)?,
            attitude_gain: self.attitude_gain,
            null_space: self.null_space.clone(),
            kappa: self.kappa,
            alpha: self.alpha_per_s,
            kinematic_adaptation,
            bounds: self.bounds.clone(),
            estimate_start: self.estimate_start.clone(),
            kinematic_start: self.kinematic_start.clone(),
            determinant_floor: self.determinant_floor,
            robot: robot.clone(),
            tip: tip.clone(),
        };
        let plant = TaskArm { arm: Mechanical { robot, theta: own.robot.theta.clone() }, tip, tip_theta };
        if self.by_velocity {
            return assembly.solo(WatchedTaskArm(plant), TaskSpaceByVelocity(controller));
        }
        assembly.solo(plant, controller)
    }
}
