//! A program of one's own: `forwardstep` with a tank and a law that keeps its level. Scenario files name them as they name the
//! shipped kinds:
//!
//! ```toml
//! [[agents]]
//! name = "tank"
//! robot.tank = { area_m2 = 2, inflow_limit_m3_s = 0.5 }
//! law.level = { gain_per_s = 0.5 }
//! target.formulas = ["1 + 0.1*sin(t)"]
//! ```

use std::ops::Range;
use std::process::ExitCode;
use std::sync::Arc;

use forwardstep::core::LengthError;
use forwardstep::core::controller::{Asked, Balance, Controller, Given, Truth};
use forwardstep::core::plant::{Plant, check_external};
use forwardstep::core::reference::Position;
use forwardstep::core::signal::{Block as Signals, Entries, OwnSignal, Signal, Unit};
use forwardstep::io::scenario::kinds::{
    At, Body, Fault, InputFolder, KindError, Kinds, LawKind, LawReader, Mistake, RobotKind, RobotRead, RobotTemplate,
    Spread, StartReader, Stop, TargetFile, axis, fault, positive,
};
use forwardstep::sim::system::{Declaration, DeclaredClaim, Known};
use forwardstep::sim::trajectory::Trajectory;
use forwardstep::sim::{
    ActuatorLimits, Assembly, Attachments, AxisUnit, Block, Coordinates, Exchange, Interface, LagrangianRobot, Law,
    Line, LineValue, Naming, ReferenceFamily, Robot, RobotSetup, SetupError, Start,
};
use schemars::JsonSchema;
use serde::Deserialize;
use thiserror::Error;

/// The shipped kinds, the tank and its law.
pub fn kinds() -> Result<Kinds, KindError> {
    let mut kinds = Kinds::shipped();
    kinds.add_robot::<TankFile>()?;
    kinds.add_law::<LevelFile>()?;
    Ok(kinds)
}

fn main() -> ExitCode {
    match kinds() {
        Ok(kinds) => forwardstep::program(&kinds),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// What flows in.
pub static INFLOW: OwnSignal = OwnSignal {
    symbol: "inflow",
    title: "Inflow",
    letters: "u",
    unit: Unit::Fixed("m^3/s"),
    entries: Entries::One,
    may_jump: true,
};

/// The largest area that is believed.
const LARGEST_M2: f64 = 1e6;

/// A mistake that only this kind knows.
#[derive(Debug, Error)]
#[error("no tank is as large as this")]
struct TooLarge;

impl Mistake for TooLarge {
    fn help(&self) -> Option<String> {
        Some("`area_m2` is in m²".into())
    }
}

/// A tank that is open at the top.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TankFile {
    /// Its area, in m².
    pub area_m2: At<f64>,
    /// The largest inflow and outflow, in m³/s. Default: none.
    pub inflow_limit_m3_s: Option<At<f64>>,
}

impl RobotKind for TankFile {
    fn key() -> &'static str {
        "tank"
    }

    fn description() -> &'static str {
        "A tank whose inflow is controlled."
    }

    fn template() -> Option<RobotTemplate> {
        None
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        if self.area_m2.value > LARGEST_M2 {
            return Err(fault(&self.area_m2, TooLarge).into());
        }
        let limit = self.inflow_limit_m3_s.as_ref().map(|limit| positive("inflow_limit_m3_s", limit)).transpose()?;
        Ok(RobotRead::new(RobotSetup {
            kind: Arc::new(Tank { limit }),
            theta: vec![positive("area_m2", &self.area_m2)?],
            theta_names: vec!["area".into()],
            axes: vec![axis("level", AxisUnit::Metre)],
        }))
    }

    fn spread(&self, read: &RobotRead, spread: &Spread<'_>) -> Result<(RobotSetup, Body), Fault> {
        let mut robot = read.robot.clone();
        robot.theta.iter_mut().zip(spread.factors(1)).for_each(|(area, factor)| *area *= factor);
        Ok((robot, read.body.clone()))
    }

    fn start(&self, _: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        Ok(Start { q: given.position()?, dq: Vec::new(), rest: Vec::new(), reference: Vec::new() })
    }

    fn target(&self, _: &At<TargetFile>, _: &Trajectory, _: f64, _: &mut Start) -> Result<(), Fault> {
        Ok(())
    }

    fn limits_of_axes(&self) -> bool {
        false
    }

    fn usual_law(&self) -> &'static str {
        "level"
    }
}

/// Keeps the level at the target.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LevelFile {
    /// How fast the error vanishes, in 1/s.
    pub gain_per_s: At<f64>,
}

impl LawKind for LevelFile {
    fn key() -> &'static str {
        "level"
    }

    fn description() -> &'static str {
        "The level of a tank follows a target."
    }

    fn made_for() -> &'static str {
        "tanks"
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.is::<Tank>()
    }

    fn law(&self, _: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        Ok(Arc::new(Level { gain: positive("gain_per_s", &self.gain_per_s)? }))
    }

    fn place(&self, _: &SetupError) -> Option<Range<usize>> {
        None
    }
}

/// The tank as data.
#[derive(Clone, Debug)]
pub struct Tank {
    limit: Option<f64>,
}

impl Robot for Tank {
    fn velocity_len(&self, _: usize) -> usize {
        0
    }

    fn rest_len(&self) -> usize {
        0
    }

    fn moves_in_space(&self) -> bool {
        false
    }

    fn same_model(&self, _: &dyn Robot) -> bool {
        false
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        None
    }

    fn attachments(&self) -> Attachments<'_> {
        Attachments::Equations(1)
    }

    fn actuator_limits(&self) -> ActuatorLimits {
        ActuatorLimits::Own
    }

    fn naming(&self) -> Naming {
        Naming { numbered_axes: false, torques_on_body: false }
    }

    fn lines(&self) -> Vec<Line> {
        let line = |limit| Line { signal: Signal::Own(&INFLOW), entry: 0, value: LineValue::Clip(limit) };
        self.limit.map(line).into_iter().collect()
    }
}

/// The law as data.
#[derive(Clone, Debug)]
pub struct Level {
    gain: f64,
}

impl Law for Level {
    fn words(&self) -> &'static str {
        "the law for a level"
    }

    fn made_for(&self) -> &'static str {
        "tanks"
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        robot.kind.is::<Tank>().then_some(Interface {
            measures: LevelControl::MEASURES,
            exchanges: &[Exchange::Position],
            follows: &[ReferenceFamily::Target],
            measures_velocity: false,
            manipulability: false,
            tracks_by_roots: false,
            offsets: false,
            pushed: true,
            estimates: false,
        })
    }

    fn coordinates(&self) -> Option<Coordinates> {
        None
    }

    fn lines(&self, _: &RobotSetup) -> Vec<Line> {
        Vec::new()
    }

    fn shares_batch(&self, _: &dyn Law) -> bool {
        false
    }

    fn known(&self) -> Known {
        Known::Declared(Declaration {
            source: "V at the head of the controller".into(),
            promises: "every level reaches its target: x − x_d → 0".into(),
            claims: vec![DeclaredClaim {
                requires: "k and A are positive, and A is known".into(),
                because: "they are refused otherwise, and the law has that of the tank".into(),
            }],
        })
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let (own, tank) = (assembly.agent(), assembly.robot::<Tank>()?);
        assembly.positive("the gain", self.gain)?;
        assembly.length("the parameters", 1, own.robot.theta.len())?;
        let area = own.robot.theta[0];
        let limit = tank.limit.filter(|_| own.enforce_limits);
        assembly.solo(TankPlant { area, limit }, LevelControl { area, gain: self.gain })
    }
}

/// A ẋ = u + A w, where x is the level and A w flows in from outside.
#[derive(Clone, Debug)]
struct TankPlant {
    area: f64,
    limit: Option<f64>,
}

impl Plant for TankPlant {
    type Scratch = ();

    fn scratch(&self) {}

    fn axes(&self) -> usize {
        1
    }

    fn states(&self) -> Vec<Signals> {
        vec![(Signal::Position, 1)]
    }

    fn inputs(&self) -> Vec<Signals> {
        vec![(Signal::Own(&INFLOW), 1)]
    }

    fn outputs(&self) -> Vec<Signals> {
        self.states()
    }

    fn output_len(&self) -> usize {
        1
    }

    fn output(&self, (): &mut (), state: &[f64], output: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("state", 1, state.len())?;
        LengthError::check("output", 1, output.len())?;
        output.copy_from_slice(state);
        Ok(())
    }

    fn limit(&self, _: &[f64], input: &mut [f64]) {
        if let (Some(limit), Some(inflow)) = (self.limit, input.first_mut()) {
            *inflow = inflow.clamp(-limit, limit);
        }
    }

    fn rate(&self, (): &mut (), _: &[f64], input: &[f64], w: &[f64], d_state: &mut [f64]) -> Result<(), LengthError> {
        LengthError::check("input", 1, input.len())?;
        LengthError::check("rate", 1, d_state.len())?;
        check_external(1, w)?;
        d_state[0] = input[0] / self.area + w.first().unwrap_or(&0.0);
        Ok(())
    }
}

/// u = A (ẋ_d − k (x − x_d)), so that V = ½ A (x − x_d)² loses k A (x − x_d)².
#[derive(Clone, Debug)]
struct LevelControl {
    area: f64,
    gain: f64,
}

impl Controller for LevelControl {
    type Plant = TankPlant;
    type Exchange = Position;
    type Measured<'a> = f64;
    type Scratch = ();

    const MEASURES: &'static [&'static str] = &["level"];

    fn scratch(&self) {}

    fn states(&self) -> Vec<Signals> {
        Vec::new()
    }

    fn shown(&self) -> Vec<Signals> {
        vec![(Signal::Error, 1)]
    }

    fn reads(&self, signal: Signal) -> bool {
        signal == Signal::Position
    }

    fn see(&self, output: &[f64]) -> Result<f64, LengthError> {
        LengthError::check("output", 1, output.len())?;
        Ok(output[0])
    }

    fn start(&self, (): &mut (), _: Given<'_, Self>, _: &[Vec<f64>], _: &mut [f64]) -> Result<(), LengthError> {
        Ok(())
    }

    fn evaluate(&self, (): &mut (), given: Given<'_, Self>, _: &[f64], asked: Asked<'_>) -> Result<(), LengthError> {
        LengthError::check("the target", 1, given.target.len())?;
        LengthError::check("input", 1, asked.input.len())?;
        LengthError::check("shown", 1, asked.shown.len())?;
        let [x_d, dx_d, ..] = given.target[0];
        let error = given.measured - x_d;
        asked.input[0] = self.area * (dx_d - self.gain * error);
        asked.shown[0] = error;
        Ok(())
    }

    fn balance(
        &self,
        (): &mut (),
        truth: Truth<'_, TankPlant>,
        _: Given<'_, Self>,
        _: &[f64],
        shown: &[f64],
    ) -> Result<Balance, LengthError> {
        LengthError::check("shown", 1, shown.len())?;
        let power: f64 = truth.external.iter().map(|w| truth.plant.area * shown[0] * w).sum();
        let square = truth.plant.area * shown[0] * shown[0];
        Ok(Balance { value: 0.5 * square, dissipation: self.gain * square - power })
    }
}
