//! A law of your own on a shipped robot: the two-link planar arm follows a trajectory under PD+ control of B. Paden and
//! R. Panja, *Globally asymptotically stable 'PD+' controller for robot manipulators*, 1988, in continuous time and sampled.
//! Run it with `cargo run --example own_law`.
//!
//! With e = q − q_d and u = M(q) q̈_d + C(q, q̇) q̇_d + g(q) − k e − d ė, V = ½ ėᵀM(q) ė + ½ k eᵀe loses d ėᵀė.

use std::error::Error;

use forwardstep::core::LengthError;
use forwardstep::core::controller::{Balance, Controller, ControllerInput, ControllerOutput, Singularity, Truth};
use forwardstep::core::plant::Mechanical;
use forwardstep::core::reference::Position;
use forwardstep::core::robot::{Lagrangian, PlanarArm, PlanarLinks, TwoVelocity};
use forwardstep::core::signal::{Block as Signals, Signal};
use forwardstep::sim::quantity;
use forwardstep::sim::system::{Declaration, DeclaredClaim, Known};
use forwardstep::sim::trajectory::{Path, Sinusoid, Trajectory};
use forwardstep::sim::{
    AgentSetup, Assembly, Block, Interface, Law, LawWords, Recording, RobotSetup, Setup, SetupError, run,
};

fn main() -> Result<(), Box<dyn Error>> {
    let wave = |amplitude, rad_per_s| Path::Sinusoids {
        offset: 0.2,
        waves: vec![Sinusoid { amplitude, rad_per_s, phase_rad: 0.0 }],
    };
    let target = Trajectory::new(vec![wave(0.5, 1.0), wave(0.3, 2.0)])?;
    let robot = RobotSetup::planar_arm(&PlanarLinks::uniform([2.0, 1.5], [1.0, 0.8]));
    let law = PdPlus { stiffness: 40.0, damping: 20.0 };
    let setup = Setup::tracking([AgentSetup::new("arm", robot, law).at(&[1.0, -0.5]).following(target)], 10.0);
    let error = |recording: &Recording| recording.last(0, Signal::Error, 0).hypot(recording.last(0, Signal::Error, 1));

    let recording = run(&setup)?.recording;
    println!("continuous: the error is {:.1e} rad at the end", error(&recording));
    assert!(error(&recording) < 1e-3);
    // V and the integral of what it loses are recorded: their sum stays what it was.
    let [v, lost] = [Signal::Lyapunov, Signal::Dissipation].map(|signal| recording.values(0, signal, 0).unwrap_or(&[]));
    let residual = v.iter().zip(lost).map(|(now, lost)| (now + lost - v[0]).abs()).fold(0.0, f64::max);
    println!("the Lyapunov balance closes to {:.1e} of V(0)", residual / v[0]);
    assert!(residual < 1e-5 * v[0]);

    let recording = run(&setup.sampled(500.0))?.recording;
    println!("at 500 Hz:  the error is {:.1e} rad at the end", error(&recording));
    assert!(error(&recording) < 1e-2);
    Ok(())
}

/// The law as data.
#[derive(Clone, Debug)]
pub struct PdPlus {
    /// k, N m/rad.
    pub stiffness: f64,
    /// d, N m s/rad.
    pub damping: f64,
}

impl Law for PdPlus {
    fn words(&self) -> LawWords {
        LawWords { name: "PD+", made_for: "planar arms" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        let interface = Interface { measures_velocity: true, ..Interface::of::<PdPlusControl>() };
        robot.kind.is::<PlanarArm>().then_some(interface)
    }

    fn known(&self) -> Known {
        Known::Declared(Declaration {
            source: "Paden and Panja, 1988".into(),
            promises: "the arm follows its target: q − q_d → 0".into(),
            claims: vec![DeclaredClaim {
                requires: "k and d are positive, and the parameters of the arm are known".into(),
                because: "others are refused, and the law has those of the arm".into(),
            }],
        })
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        quantity::positive(assembly.of_law(), "stiffness", self.stiffness)?;
        quantity::positive(assembly.of_law(), "damping", self.damping)?;
        let &robot = assembly.robot::<PlanarArm>()?;
        let plant = Mechanical { robot, theta: assembly.agent().robot.theta.clone() };
        assembly.solo(plant.clone(), PdPlusControl { arm: plant, law: self.clone() })
    }
}

/// The law at work: what it knows of its arm, and its gains.
#[derive(Clone, Debug)]
struct PdPlusControl {
    arm: Mechanical<PlanarArm>,
    law: PdPlus,
}

/// The error and its rate.
fn errors(given: ControllerInput<'_, PdPlusControl>) -> Result<([f64; 2], [f64; 2]), LengthError> {
    LengthError::check("the target", 2, given.target.len())?;
    let (q, dq) = given.measured.split_at(2);
    let desired = [0, 1].map(|k| given.target.jet(k));
    Ok(([0, 1].map(|k| q[k] - desired[k][0]), [0, 1].map(|k| dq[k] - desired[k][1])))
}

impl Controller for PdPlusControl {
    type Plant = Mechanical<PlanarArm>;
    type Exchange = Position;
    /// q and q̇, four numbers.
    type Measured<'a> = &'a [f64];
    type Scratch = ();

    const MEASURES: &'static [&'static str] = &["position", "velocity"];
    const KNOWS_OFFSETS: bool = false;

    fn target_derivatives(&self) -> usize {
        2
    }

    fn scratch(&self) {}

    fn states(&self) -> Vec<Signals> {
        Vec::new()
    }

    fn shown(&self) -> Vec<Signals> {
        vec![(Signal::Error, 2)]
    }

    fn reads(&self, signal: Signal) -> bool {
        matches!(signal, Signal::Position | Signal::Velocity)
    }

    fn see<'a>(&self, output: &'a [f64]) -> Result<&'a [f64], LengthError> {
        LengthError::check("output", 4, output.len())?;
        Ok(output)
    }

    fn start(
        &self,
        (): &mut (),
        _: ControllerInput<'_, Self>,
        _: &[Vec<f64>],
        _: &mut [f64],
    ) -> Result<(), LengthError> {
        Ok(())
    }

    fn evaluate(
        &self,
        (): &mut (),
        given: ControllerInput<'_, Self>,
        _: &[f64],
        asked: ControllerOutput<'_>,
    ) -> Result<(), LengthError> {
        LengthError::check("shown", 2, asked.shown.len())?;
        let (e, de) = errors(given)?;
        let (q, dq) = given.measured.split_at(2);
        // Y(q, q̇, q̇_d, q̈_d) ϑ; the other product is not needed.
        let [dq_d, ddq_d] = [1, 2].map(|order| [0, 1].map(|k| given.target.jet(k)[order]));
        let motion = TwoVelocity { q, dq, z: &dq_d, dz: &ddq_d };
        self.arm.robot.regressor_products(&mut (), motion, &self.arm.theta, &e, asked.input, &mut [0.0; 5])?;
        for k in 0..2 {
            asked.input[k] -= self.law.stiffness * e[k] + self.law.damping * de[k];
        }
        asked.shown.copy_from_slice(&e);
        Ok(())
    }

    fn settle(&self, _: &mut [f64]) {}

    fn trouble(&self, _: &[f64], _: &[f64]) -> Option<Singularity> {
        None
    }

    fn balance(
        &self,
        (): &mut (),
        truth: Truth<'_, Mechanical<PlanarArm>>,
        given: ControllerInput<'_, Self>,
        _: &[f64],
        _: &[f64],
    ) -> Result<Balance, LengthError> {
        let (e, de) = errors(given)?;
        let mut mass = [0.0; 4];
        truth.plant.robot.mass_matrix(&mut (), &given.measured[..2], &truth.plant.theta, &mut mass)?;
        let energy = de[0] * (mass[0] * de[0] + mass[1] * de[1]) + de[1] * (mass[2] * de[0] + mass[3] * de[1]);
        let square = |v: [f64; 2]| v[0] * v[0] + v[1] * v[1];
        Ok(Balance {
            value: 0.5 * energy + 0.5 * self.law.stiffness * square(e),
            dissipation: self.law.damping * square(de),
        })
    }
}
