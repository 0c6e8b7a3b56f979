//! Robots with Properties 1 to 3 under (6)–(7), a batch at a time.

use std::sync::Arc;

use forwardstep_core::law::ParameterBounds;
use forwardstep_core::robot::{Definiteness, Drives, Lagrangian, TwoVelocity};
use forwardstep_core::{Gain, Kernel, Lanes, LengthError, dispatch};

use super::series::{OfKernel, Series, SeriesEvaluator};
use crate::closed_loop::{Assembly, Block, SetupError};
use crate::probe::{Probe, properties};
use crate::reference::ReferenceFamily;
use crate::setup::{Exchange, RobotSetup};
use crate::system::{Interface, Known as Knowledge, Law, LawWords, Robot};

/// A robot model whose kernels work on one robot, on eight at once, or on one with its derivatives.
pub trait RobotModel: Robot + Clone {
    /// M, C, g and the products of the regressor.
    type Kernel: Lagrangian<f64, Scratch: Send>
        + Lagrangian<Lanes<8>>
        + Lagrangian<Series>
        + Clone
        + Send
        + Sync
        + 'static;

    /// Its kernel.
    fn kernel(&self) -> Self::Kernel;

    /// Whether the kernel of `other` is the same, whatever the parameters, so that both can share it.
    fn shares_kernel(&self, other: &Self) -> bool;

    /// See [`LagrangianRobot::with_drives`].
    fn with_drives(&self, drives: Drives) -> Option<Arc<dyn Robot>>;

    /// See [`LagrangianRobot::definiteness`].
    fn definiteness(&self, theta: &[f64]) -> Option<Definiteness>;

    /// See [`LagrangianRobot::swung_axes`].
    fn swung_axes(&self) -> Option<Vec<usize>>;
}

/// What the engine and the verdicts ask of a robot under (6)–(7). Every [`RobotModel`] is one.
///
/// Behind it stands the engine, compiled for that robot's kernel. A robot that is shipped hands it out of line
/// (`#[inline(never)]` on [`Robot::lagrangian`]), so that it is compiled in this crate alone: inlined elsewhere, each program and
/// each test would compile it again, which takes ten seconds.
pub trait LagrangianRobot {
    /// Whether `other` is the same model, whatever its parameters, so that kernels can be shared.
    fn same_model(&self, other: &dyn Robot) -> bool;

    /// Builds the agents of `assembly` as one batch; one that follows a target stands alone.
    ///
    /// # Errors
    /// [`SetupError`] when they have no meaning.
    fn batch(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError>;

    /// M, Y and the natural scale of ϑ, with the parameters `theta`, at one state with its z and ż.
    ///
    /// # Errors
    /// [`LengthError`] when a vector has the wrong length.
    fn dynamics_at(&self, theta: &[f64], motion: TwoVelocity<'_, f64>) -> Result<DynamicsAt, LengthError>;

    /// The same with `drives` in the place of what acts at its joints; `None` for a model that cannot have any, or not these.
    fn with_drives(&self, drives: Drives) -> Option<Arc<dyn Robot>>;

    /// Whether M(q) with the parameters `theta` is positive definite uniformly; `None` where nothing is known of it.
    fn definiteness(&self, theta: &[f64]) -> Option<Definiteness>;

    /// The axes whose travel may make C or g unbounded; `None` where nothing is known of them.
    fn swung_axes(&self) -> Option<Vec<usize>>;

    /// What works out products of its dynamics at state after state, without forming Y.
    fn evaluator(&self) -> Box<dyn Evaluator>;

    /// The same with derivatives of what they give.
    fn series_evaluator(&self) -> Box<dyn SeriesEvaluator>;

    /// Tries at random states, with the parameters of `robot`, whether it has the properties of Section II-B.
    ///
    /// # Errors
    /// [`LengthError`] when `robot` has the wrong number of axes or parameters.
    fn probe(&self, robot: &RobotSetup) -> Result<Probe, LengthError>;
}

/// A robot's dynamics at one state.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicsAt {
    /// M(q), row by row.
    pub mass: Vec<f64>,
    /// Y(q, q̇, z, ż), row by row.
    pub regressor: Vec<f64>,
    /// [`Lagrangian::adaptation_scale`].
    pub adaptation_scale: Vec<f64>,
}

/// A robot's dynamics with working memory of their own.
pub trait Evaluator {
    /// The products at one state with its z and ż, with the parameters `theta`.
    ///
    /// # Errors
    /// [`LengthError`] when a vector has the wrong length.
    fn at(&mut self, theta: &[f64], motion: TwoVelocity<'_, f64>, s: &[f64]) -> Result<&ProductsAt, LengthError>;

    /// M(q), row by row, with the parameters `theta`.
    ///
    /// # Errors
    /// [`LengthError`] when a vector has the wrong length.
    fn mass(&mut self, theta: &[f64], q: &[f64]) -> Result<&[f64], LengthError>;
}

/// Products of a robot's dynamics at one state.
#[derive(Clone, Debug, PartialEq)]
pub struct ProductsAt {
    /// M(q) s.
    pub momentum: Vec<f64>,
    /// [`Lagrangian::add_damping`]: D(q) s, with s = q̇ − z whatever `s` is, and what friction adds to it.
    pub damped: Vec<f64>,
    /// Y(q, q̇, z, ż) ϑ.
    pub model: Vec<f64>,
    /// Y(q, q̇, z, ż)ᵀ s.
    pub yt_s: Vec<f64>,
}

struct Evaluated<K: Lagrangian<f64>> {
    kernel: K,
    scratch: K::Scratch,
    mass: Vec<f64>,
    products: ProductsAt,
}

impl<K: Lagrangian<f64>> Evaluated<K> {
    fn new(kernel: K) -> Self {
        let m = kernel.dof();
        let products = ProductsAt {
            momentum: vec![0.0; m],
            damped: vec![0.0; m],
            model: vec![0.0; m],
            yt_s: vec![0.0; kernel.parameter_count()],
        };
        Evaluated { scratch: kernel.scratch(), kernel, mass: vec![0.0; m * m], products }
    }
}

impl<K: Lagrangian<f64>> Evaluator for Evaluated<K> {
    fn at(&mut self, theta: &[f64], motion: TwoVelocity<'_, f64>, s: &[f64]) -> Result<&ProductsAt, LengthError> {
        dispatch(Products { of: self, theta, motion, s })?;
        Ok(&self.products)
    }

    fn mass(&mut self, theta: &[f64], q: &[f64]) -> Result<&[f64], LengthError> {
        self.kernel.mass_matrix(&mut self.scratch, q, theta, &mut self.mass)?;
        Ok(&self.mass)
    }
}

struct Products<'a, K: Lagrangian<f64>> {
    of: &'a mut Evaluated<K>,
    theta: &'a [f64],
    motion: TwoVelocity<'a, f64>,
    s: &'a [f64],
}

impl<K: Lagrangian<f64>> Kernel for Products<'_, K> {
    type Output = Result<(), LengthError>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let Products { of: Evaluated { kernel, scratch, mass, products }, theta, motion, s } = self;
        let ProductsAt { momentum, damped, model, yt_s } = products;
        kernel.regressor_products(scratch, motion, theta, s, model, yt_s)?;
        damped.fill(0.0);
        kernel.add_damping(scratch, motion, theta, damped)?;
        kernel.mass_matrix(scratch, motion.q, theta, mass)?;
        for (momentum, row) in momentum.iter_mut().zip(mass.chunks_exact(s.len().max(1))) {
            *momentum = row.iter().zip(s).map(|(mass, s)| mass * s).sum();
        }
        Ok(())
    }
}

impl<M: RobotModel> LagrangianRobot for M {
    fn same_model(&self, other: &dyn Robot) -> bool {
        other.downcast().is_some_and(|other| self.shares_kernel(other))
    }

    fn batch(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        if assembly.setup().tracks(assembly.agents()[0]) { assembly.tracking(self) } else { assembly.lagrangian(self) }
    }

    fn dynamics_at(&self, theta: &[f64], motion: TwoVelocity<'_, f64>) -> Result<DynamicsAt, LengthError> {
        fn at<K: Lagrangian<f64>>(
            kernel: &K,
            theta: &[f64],
            motion: TwoVelocity<'_, f64>,
        ) -> Result<DynamicsAt, LengthError> {
            let (m, p) = (kernel.dof(), kernel.parameter_count());
            let (mut mass, mut regressor) = (vec![0.0; m * m], vec![0.0; m * p]);
            kernel.mass_matrix(&mut kernel.scratch(), motion.q, theta, &mut mass)?;
            kernel.regressor(&mut kernel.scratch(), motion, &mut regressor)?;
            Ok(DynamicsAt { mass, regressor, adaptation_scale: kernel.adaptation_scale(motion.q, theta) })
        }
        at(&self.kernel(), theta, motion)
    }

    fn with_drives(&self, drives: Drives) -> Option<Arc<dyn Robot>> {
        RobotModel::with_drives(self, drives)
    }

    fn definiteness(&self, theta: &[f64]) -> Option<Definiteness> {
        RobotModel::definiteness(self, theta)
    }

    fn swung_axes(&self) -> Option<Vec<usize>> {
        RobotModel::swung_axes(self)
    }

    fn evaluator(&self) -> Box<dyn Evaluator> {
        Box::new(Evaluated::new(self.kernel()))
    }

    fn series_evaluator(&self) -> Box<dyn SeriesEvaluator> {
        Box::new(OfKernel::new(self.kernel()))
    }

    fn probe(&self, robot: &RobotSetup) -> Result<Probe, LengthError> {
        properties(&self.kernel(), robot)
    }
}

/// τ = −K s + Y ϑ̂ with ϑ̂' = −Γ Yᵀ s: (6) and (7).
#[derive(Clone, Debug, PartialEq)]
pub struct Adaptive {
    /// K; a [`Gain::Bandwidth`] is multiplied by diag M(q₀).
    pub damping: Gain,
    /// Γ; a [`Gain::Bandwidth`] ω gives ω² · [`Lagrangian::adaptation_scale`].
    pub adaptation: Gain,
    /// ϑ̂(0).
    pub estimate_start: Vec<f64>,
    /// Bounds that ϑ̂ is kept within; they need a Γ that is no full matrix.
    pub bounds: Option<ParameterBounds>,
}

/// τ = −K s + Y ϑ with the true parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// K; a [`Gain::Bandwidth`] is multiplied by diag M(q₀).
    pub damping: Gain,
}

/// What both can do.
fn interface(robot: &RobotSetup, estimates: bool) -> Option<Interface> {
    robot.kind.lagrangian()?;
    Some(Interface {
        measures: &["position", "velocity"],
        exchanges: &[Exchange::Position, Exchange::PositionVelocity, Exchange::Estimates, Exchange::Composite],
        follows: &[
            ReferenceFamily::Consensus,
            ReferenceFamily::PureIntegral,
            ReferenceFamily::Backstepping,
            ReferenceFamily::Leader,
            ReferenceFamily::Target,
            ReferenceFamily::Desired,
            ReferenceFamily::DesiredTarget,
            ReferenceFamily::Own,
        ],
        measures_velocity: true,
        manipulability: true,
        tracks_by_roots: true,
        offsets: false,
        pushed: true,
        estimates,
        in_batches: true,
        coordinates: None,
        actuator_start: Vec::new(),
        further_starts: &[],
        lines: Vec::new(),
    })
}

fn block(assembly: &Assembly<'_>) -> Result<Block, SetupError> {
    let robot = assembly.agent().robot.kind.lagrangian();
    robot.ok_or_else(|| assembly.law_of_another())?.batch(assembly)
}

impl Law for Adaptive {
    fn words(&self) -> LawWords {
        LawWords { name: "the adaptive law", made_for: "Lagrangian robots" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        interface(robot, true)
    }

    fn known(&self) -> Knowledge {
        Knowledge::Checked
    }

    fn kept_within(&self) -> Option<ParameterBounds> {
        self.bounds.clone()
    }

    fn with_estimate(&self, theta: &[f64], _: &RobotSetup) -> Option<Arc<dyn Law>> {
        Some(Arc::new(Adaptive { estimate_start: theta.to_vec(), ..self.clone() }))
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        block(assembly)
    }
}

impl Law for Known {
    fn words(&self) -> LawWords {
        LawWords { name: "the law with known parameters", made_for: "Lagrangian robots" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        interface(robot, false)
    }

    fn known(&self) -> Knowledge {
        Knowledge::Checked
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        block(assembly)
    }
}
