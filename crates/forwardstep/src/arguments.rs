//! The command line.

mod experiments;
mod suggest;
pub(crate) mod usage;

pub(crate) use experiments::{
    AttackOptions, CompareOptions, FalsifyOptions, ManipulabilityOptions, SamplingLimitOptions, SmoothnessOptions,
};

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use clap_complete::engine::ArgValueCompleter;
use forwardstep_check::Id;
use forwardstep_io::shown;
use thiserror::Error;

/// Simulate and check networks of robots under forwardstepping control. Without a command, runs six arms.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100, after_help = EXIT_STATUS)]
pub(crate) struct Arguments {
    /// Without one, `run`.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// The scenario to begin with.
const SIX_ARMS: &str = "six-arms";

const EXIT_STATUS: &str = "\
Exit status:
    0  fine
    1  the answer is no. run: the goal was missed; check: a hypothesis is violated, not shown or not covered by the paper,
       and not accepted, or, with --practical, a practical verdict is inadequate; explain --along: the sides of an equation
       differ by more than rounding; falsify: a claim was refuted; attack: the same, or nothing could be tried in the time
       given; smoothness: a derivative jumps that must not; sampling-limit: no period that was tried works; new: no trial
       did what it should
    2  invalid input, or a folder that cannot be written to or is not that of a run; nothing is written, unless the journal
       failed during a run: then what was computed is kept
    3  the run broke down; what was computed is written
  130  interrupted by Ctrl-C; what was computed is written
  143  terminated (SIGTERM); what was computed is written
  129  hung up (SIGHUP); what was computed is written";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate a scenario and write tables and a report
    Run(RunOptions),
    /// Build the report and the plots of a run anew from its tables, without simulating again; of a run that was cut off, write all that it left
    Report {
        /// The folder of the run
        #[arg(value_name = "DIR")]
        folder: PathBuf,
        /// Write everything about the run into this folder instead, which is made, and leave DIR as it is
        #[arg(long, value_name = "ELSEWHERE")]
        out: Option<PathBuf>,
        /// Write the page anew, about once per second, while a run writes into DIR (one without a --follow of its own), and once more when it has ended
        #[arg(long)]
        follow: bool,
    },
    /// Put runs side by side: what was promised, predicted and observed of each, as a table and as a page
    Compare(CompareOptions),
    /// Say which theorem speaks about a scenario, and whether its hypotheses hold
    Check(CheckOptions),
    /// Derive why a scenario converges: the virtual control, the differential cascade, and how its degree is reduced
    Explain(ExplainOptions),
    /// Measure the longest period with which sampled controllers still work, beside the one that the sampling margin allows
    SamplingLimit(SamplingLimitOptions),
    /// Push an agent, and say how far that moves what all agree on for several manipulability gains, beside what theory says
    Manipulability(ManipulabilityOptions),
    /// Say by how much every derivative of the torque jumps where the graph switches and delays jump, and which is the first
    Smoothness(SmoothnessOptions),
    /// Draw random scenarios and try to refute what is claimed of them
    Falsify(FalsifyOptions),
    /// Search delays that jump and graphs that take turns for those under which a design does worst
    Attack(AttackOptions),
    /// List the shipped scenarios, or print one
    Scenarios {
        /// Print the text of this one
        #[arg(add = ArgValueCompleter::new(suggest::shipped))]
        name: Option<String>,
    },
    /// Print the JSON schema of scenario files, of the summary.json of a run, or of what `check --json`, `compare --json` or `smoothness --json` prints
    Schema {
        /// Of which documents
        #[arg(value_enum, default_value_t)]
        of: SchemaChoice,
    },
    /// Convert scenario files of an earlier format to the present one, in place, and print what is renamed
    Upgrade(UpgradeOptions),
    /// Write a commented scenario to start from
    New(NewOptions),
    /// Describe a robot, or compute its dynamics at a state
    Robot(RobotOptions),
    /// Print the manual page, or write those of all commands to a folder
    Man {
        /// The folder, which must exist [default: the page of the program, on standard output]
        folder: Option<PathBuf>,
    },
    /// Print a script that completes commands and options in a shell
    Completions {
        /// The shell
        shell: Shell,
    },
}

/// The main job: the six arms, into the default folder.
impl Default for Command {
    fn default() -> Self {
        Command::Run(RunOptions { scenario: SIX_ARMS.into(), out: None, writing: Writing::default() })
    }
}

#[derive(Debug, Args)]
pub(crate) struct RunOptions {
    /// A shipped scenario by name, or a file or the folder of a run by its path
    #[arg(default_value = SIX_ARMS, add = ArgValueCompleter::new(suggest::scenarios))]
    pub(crate) scenario: String,
    /// The folder to write to [default: forwardstep-runs/ and the scenario's name]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) writing: Writing,
}

// A comment of its own would become that of the command.
#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct Writing {
    /// Replace the files of an earlier run
    #[arg(long)]
    pub(crate) force: bool,
    /// Write the trajectory as CSV too
    #[arg(long)]
    pub(crate) csv: bool,
    /// Say what changed V, cause by cause, where controllers sample: every step is then looked at, which takes as long again as the run with
    /// small networks of arms, and ten to twenty times as long with chains and vehicles
    #[arg(long)]
    pub(crate) balance: bool,
    /// Predict the course of agreement whatever that takes; otherwise large networks over long times are run without
    #[arg(long)]
    pub(crate) predict: bool,
    /// Write the page while the run goes on too, from its first second on and for a few percent of its time; a browser loads it again by itself
    #[arg(long)]
    pub(crate) follow: bool,
    /// Draw robots as their URDFs describe them: boxes, cylinders, balls, and STL, OBJ and DAE inside the URDF's own folder or package (a folder above it with
    /// the name of the package), as
    /// fine as 1 MB holds
    #[arg(long)]
    pub(crate) meshes: bool,
}

#[derive(Debug, Args)]
pub(crate) struct CheckOptions {
    /// A shipped scenario by name, or a file or the folder of a run by its path
    #[arg(default_value = SIX_ARMS, add = ArgValueCompleter::new(suggest::scenarios))]
    pub(crate) scenario: String,
    /// Waive a hypothesis by its name, which stands in brackets behind it; may be given several times
    #[arg(long, value_name = "NAME", value_parser = hypothesis())]
    pub(crate) accept: Vec<Id>,
    /// Exit with 1 too where a practical verdict is `inadequate`: those are not from the paper and speak of single states
    #[arg(long)]
    pub(crate) practical: bool,
    /// Print one JSON object; `forwardstep schema check` describes it
    #[arg(long)]
    pub(crate) json: bool,
    /// Also predict the course of agreement, its rate and peak torques, which simulates the reference dynamics for a few seconds at most
    #[arg(long)]
    pub(crate) predict: bool,
    /// With `--predict`: go on where that takes longer than a few seconds, as for large networks, stiff designs and many packets
    #[arg(long, requires = "predict")]
    pub(crate) thorough: bool,
    /// Write the answers with their proofs to this file, for `checker/forwardstep_checker.py`; an older one is replaced
    #[arg(long, value_name = "FILE.json")]
    pub(crate) certificate: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct ExplainOptions {
    /// A shipped scenario by name, or a file or the folder of a run by its path
    #[arg(default_value = SIX_ARMS, add = ArgValueCompleter::new(suggest::scenarios))]
    pub(crate) scenario: String,
    /// Print the equations as LaTeX, which needs amsmath; the words are comments
    #[arg(long, conflicts_with = "json")]
    pub(crate) latex: bool,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Simulate the scenario in continuous time, and print how well every equation holds along the run: its largest residual, with agent and time
    #[arg(long, conflicts_with = "latex")]
    pub(crate) along: bool,
}

/// Documents that have a schema.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum SchemaChoice {
    /// Scenario files
    #[default]
    Scenario,
    /// What `check --json` prints
    Check,
    /// What `compare --json` prints
    Compare,
    /// What `smoothness --json` prints
    Smoothness,
    /// The summary.json of a run
    Summary,
}

/// The names of hypotheses, with near matches for slips.
fn hypothesis() -> impl TypedValueParser<Value = Id> {
    let names = PossibleValuesParser::new(Id::ALL.iter().map(|id| PossibleValue::new(id.name()).help(id.place())));
    names.try_map(|name| Id::ALL.iter().copied().find(|id| id.name() == name).ok_or("no hypothesis has this name"))
}

#[derive(Debug, Args)]
pub(crate) struct UpgradeOptions {
    /// The files; those of the present format stay as they are
    #[arg(value_name = "FILE", required = true, add = ArgValueCompleter::new(suggest::scenario_files))]
    pub(crate) files: Vec<PathBuf>,
    /// Write to this file instead; for a single FILE
    #[arg(long, value_name = "NEW", conflicts_with = "stdout")]
    pub(crate) out: Option<PathBuf>,
    /// Print the new text to standard output, and what is renamed to standard error
    #[arg(long)]
    pub(crate) stdout: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RobotOptions {
    /// A URDF by its path, or a shipped robot by name
    #[arg(value_name = "FILE.urdf", add = ArgValueCompleter::new(suggest::robots))]
    pub(crate) robot: String,
    /// Hold a joint at a position, in rad or m; may be given several times
    #[arg(long, value_name = "JOINT=VALUE", value_parser = lock)]
    pub(crate) lock: Vec<(String, f64)>,
    /// Leave Coulomb friction out; `--at` always does
    #[arg(long)]
    pub(crate) ignore_friction: bool,
    /// Print one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// Compute M, g, tau = M dz + C(q, dq) z + g and the acceleration ddq under tau, without friction and damping, at the
    /// state in this file: { "joint": { "q": 0, "dq": 0, "z": 0, "dz": 0 }, ... } in rad or m and s; all but q may be
    /// left out and are then 0
    #[arg(long, value_name = "STATE.json")]
    pub(crate) at: Option<PathBuf>,
}

/// Why a lock cannot be understood.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum LockError {
    /// No joint, or no value.
    #[error("a lock is written JOINT=VALUE, such as wrist_3_joint=0.5")]
    Form,
    /// The value is not a number.
    #[error("`{}` is not a number; give rad or m", shown(.0))]
    NotANumber(String),
}

fn lock(text: &str) -> Result<(String, f64), LockError> {
    match text.rsplit_once('=') {
        Some((joint, value)) if !joint.is_empty() => match value.trim().parse() {
            Ok(number) => Ok((joint.to_owned(), number)),
            Err(_) => Err(LockError::NotANumber(value.to_owned())),
        },
        _ => Err(LockError::Form),
    }
}

// What is not given is asked for when there is a person to ask, and is the default otherwise.
#[derive(Debug, Args)]
pub(crate) struct NewOptions {
    /// The file to write, which must not exist yet [default: standard output]
    pub(crate) file: Option<PathBuf>,
    /// The title of the scenario [default: the name of the file]
    #[arg(long)]
    pub(crate) name: Option<String>,
    /// A shipped scenario to copy instead of all that follows: see `forwardstep scenarios`
    #[arg(long, value_name = "SCENARIO", conflicts_with_all = ["name", "agents", "robot", "dry_friction", "order", "exchange", "leader", "graph", "delay"], add = ArgValueCompleter::new(suggest::shipped))]
    pub(crate) like: Option<String>,
    /// How many agents there are, 1 to 100; two or more where they are to agree [default: 4]
    #[arg(long, value_name = "N", value_parser = count_of_agents, allow_negative_numbers = true)]
    pub(crate) agents: Option<u32>,
    /// Their robot: a kind (planar_arm, point_mass, ship, vehicle, rotorcraft, spacecraft, chain, vector_chain, strict_feedback,
    /// pure_feedback), ur5e, panda, gantry or the path of a URDF [default: planar_arm]
    #[arg(long, value_name = "ROBOT", add = ArgValueCompleter::new(suggest::kinds_and_robots))]
    pub(crate) robot: Option<String>,
    /// Give every joint dry friction, and keep estimates within bounds
    #[arg(long)]
    pub(crate) dry_friction: bool,
    /// The order of the reference dynamics, 1 to 8 [default: 2]
    #[arg(long, value_name = "L", value_parser = order, allow_negative_numbers = true)]
    pub(crate) order: Option<u32>,
    /// What agents tell each other [default: position_velocity]
    #[arg(long, value_enum)]
    pub(crate) exchange: Option<ExchangeChoice>,
    /// Let all follow a leader whom the first of them hears, instead of agreeing
    #[arg(long, conflicts_with_all = ["order", "exchange"])]
    pub(crate) leader: bool,
    /// Who hears whom [default: ring]
    #[arg(long, value_enum)]
    pub(crate) graph: Option<GraphChoice>,
    /// How late [default: constant; none where there is a leader]
    #[arg(long, value_enum)]
    pub(crate) delay: Option<DelayChoice>,
    /// Write it without trying it
    #[arg(long)]
    pub(crate) untried: bool,
}

/// As scenarios spell it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum ExchangeChoice {
    #[value(alias = "position-velocity")]
    PositionVelocity,
    Position,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum GraphChoice {
    /// One way round
    Ring,
    /// Both ways between neighbours in a row
    Path,
    /// Both ways between the first and every other
    Star,
    /// Everybody hears everybody
    Complete,
    /// A ring in random order and as many random edges
    Random,
    /// A ring, of which one half is there while the other is not
    Switching,
}

/// As scenarios spell it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub(crate) enum DelayChoice {
    /// Always as old
    Constant,
    /// Growing older until the next message arrives
    #[value(alias = "saw-tooth")]
    SawTooth,
    /// Packets that are late and get lost, between controllers at 500 Hz
    Radio,
    /// Messages arrive at once
    None,
}

/// Why a number cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("must be a whole number from {low} to {high}")]
pub(crate) struct NotBetween {
    low: u32,
    high: u32,
}

fn between(text: &str, low: u32, high: u32) -> Result<u32, NotBetween> {
    text.parse().ok().filter(|number| (low..=high).contains(number)).ok_or(NotBetween { low, high })
}

/// A complete graph of more agents makes a file too long to read.
pub(crate) fn count_of_agents(text: &str) -> Result<u32, NotBetween> {
    between(text, 1, 100)
}

pub(crate) fn order(text: &str) -> Result<u32, NotBetween> {
    between(text, 1, 8)
}
