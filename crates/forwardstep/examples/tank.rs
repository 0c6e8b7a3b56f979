//! A program of your own: `forwardstep` with a tank and a law that keeps its level. Scenario files name them as they name the
//! shipped kinds:
//!
//! ```toml
//! [[agents]]
//! name = "tank"
//! robot.tank = { area_m2 = 2, inflow_limit_m3_s = 0.5 }
//! law.level = { gain_per_s = 0.5 }
//! target.formulas = ["1 + 0.1*sin(t)"]
//! ```

use std::process::ExitCode;

use forwardstep::own::*;
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

fn main() -> Result<ExitCode, KindError> {
    Ok(forwardstep::program(&kinds()?))
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

/// A tank that is open at the top.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TankFile {
    /// Its area, in m².
    pub area_m2: At<f64>,
    /// The largest inflow and outflow, in m³/s. Default: none.
    pub inflow_limit_m3_s: Option<At<f64>>,
}

/// The largest area that is believed, in m².
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

impl RobotKind for TankFile {
    fn table() -> RobotTable {
        RobotTable {
            key: "tank",
            description: "A tank whose inflow is controlled.",
            usual_law: "level",
            template: None,
        }
    }

    fn read(&self, _: &mut InputFolder) -> Result<RobotRead, Stop> {
        let area = positive("area_m2", &self.area_m2)?;
        if area > LARGEST_M2 {
            return Err(fault(&self.area_m2, TooLarge).into());
        }
        let limit = self.inflow_limit_m3_s.as_ref().map(|limit| positive("inflow_limit_m3_s", limit)).transpose()?;
        let robot = RobotSetup::new(Tank { limit }, [area], [Axis::new("level", AxisUnit::Metre)]);
        Ok(RobotRead::new(robot.named(&["area"])))
    }

    fn spread(&self, read: &mut RobotRead, spread: &Spread<'_>) -> Result<(), Fault> {
        spread.scale_each(&mut read.robot.theta);
        Ok(())
    }

    fn start(&self, _: &RobotSetup, given: &mut StartReader<'_>) -> Result<Start, Fault> {
        given.position_alone()
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
    fn table() -> LawTable {
        LawTable { key: "level", description: "The level of a tank follows a target.", made_for: "tanks" }
    }

    fn suits(robot: &RobotSetup) -> bool {
        robot.kind.is::<Tank>()
    }

    fn law(&self, _: &LawReader<'_>) -> Result<Arc<dyn Law>, Fault> {
        Ok(Arc::new(Level { gain: positive("gain_per_s", &self.gain_per_s)? }))
    }
}

/// The tank as data.
#[derive(Clone, Debug)]
pub struct Tank {
    limit: Option<f64>,
}

impl Robot for Tank {
    fn interface(&self, axes: usize) -> RobotInterface {
        let line = |limit| Line { signal: Signal::Own(&INFLOW), entry: 0, value: LineValue::Clip(limit) };
        RobotInterface {
            velocity_len: 0,
            attachments: Attachments::Equations(1),
            actuator_limits: ActuatorLimits::Own,
            lines: self.limit.map(line).into_iter().collect(),
            ..RobotInterface::mechanical(axes)
        }
    }

    fn lagrangian(&self) -> Option<&dyn LagrangianRobot> {
        None
    }
}

/// The law as data.
#[derive(Clone, Debug)]
pub struct Level {
    gain: f64,
}

impl Law for Level {
    fn words(&self) -> LawWords {
        LawWords { name: "the law for a level", made_for: "tanks" }
    }

    fn interface(&self, robot: &RobotSetup) -> Option<Interface> {
        robot.kind.is::<Tank>().then(|| Interface { pushed: true, ..Interface::tracking(&["level"]) })
    }

    fn known(&self) -> Known {
        Known::Declared(Declaration {
            source: "V at the controller".into(),
            promises: "every level reaches its target: x − x_d → 0".into(),
            claims: vec![DeclaredClaim {
                requires: "k and A are positive, and A is known".into(),
                because: "they are refused otherwise, and the law has that of the tank".into(),
            }],
        })
    }

    fn block(&self, assembly: &Assembly<'_>) -> Result<Block, SetupError> {
        let (k, own, tank) = (self.gain, assembly.agent(), assembly.robot::<Tank>()?);
        quantity::positive(assembly.of_law(), "gain_per_s", k)?;
        assembly.length(assembly.of_robot(), "parameters", 1, own.robot.theta.len())?;
        let (area, limit) = (own.robot.theta[0], tank.limit.filter(|_| own.enforce_limits));
        // A ẋ = u + A w, where x is the level and A w flows in from outside.
        let plant = VectorField::new(1, [(Signal::Position, 1)], [(Signal::Own(&INFLOW), 1)], move |_, u, dx| {
            dx[0] = u[0] / area;
        });
        let plant = plant.limited(limit.map_or_else(Vec::new, |limit| vec![limit]));
        // u = A (ẋ_d − k (x − x_d)), so that V = ½ A (x − x_d)² loses k A (x − x_d)².
        let law = move |given: FeedbackInput<'_>, asked: ControllerOutput<'_>| {
            let [x_d, dx_d, ..] = given.target(0);
            asked.shown[0] = given.output[0] - x_d;
            asked.input[0] = area * (dx_d - k * asked.shown[0]);
        };
        let balance = move |truth: Truth<'_, _>, _: FeedbackInput<'_>, shown: &[f64]| {
            let (square, power) = (area * shown[0] * shown[0], truth.external.iter().map(|w| area * shown[0] * w));
            Balance { value: 0.5 * square, dissipation: k * square - power.sum::<f64>() }
        };
        let controller = Feedback::new(&plant, [(Signal::Error, 1)], law, balance);
        assembly.solo(plant, controller)
    }
}
