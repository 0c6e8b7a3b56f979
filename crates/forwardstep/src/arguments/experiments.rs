//! Arguments of the commands that make experiments: they run many scenarios, or one many times.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use clap_complete::engine::ArgValueCompleter;
use thiserror::Error;

use super::{NotBetween, SIX_ARMS, order, suggest};

#[derive(Debug, Args)]
pub(crate) struct CompareOptions {
    /// Two or more: shipped scenarios by name, scenario files, or folders of runs; scenarios are run first
    #[arg(value_name = "RUN|SCENARIO", required = true, num_args = 2.., add = ArgValueCompleter::new(suggest::scenarios))]
    pub(crate) runs: Vec<String>,
    /// The folder to write to, with a folder in it for each scenario that is run [default: forwardstep-runs/ and all names]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace the files of an earlier comparison, and of its runs
    #[arg(long)]
    pub(crate) force: bool,
    /// Do not look by how much inputs and their derivatives jump, which simulates every run in continuous time once more
    #[arg(long)]
    pub(crate) no_jumps: bool,
    /// Predict the course of agreement of every scenario that is run, whatever that takes
    #[arg(long)]
    pub(crate) predict: bool,
    /// Print one JSON object; `forwardstep schema compare` describes it
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
pub(crate) struct FalsifyOptions {
    /// How many scenarios
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    pub(crate) cases: u64,
    /// The number of the first
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) from: u64,
    /// The same seed draws the same scenarios
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Stop after this time
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) seconds: Option<f64>,
    /// The folder for scenarios that refute something, as small as they still do
    #[arg(long, value_name = "FOLDER", default_value = "forwardstep-refuted")]
    pub(crate) out: PathBuf,
}

/// More cannot be told apart in a picture, and each takes room.
const MOST_PIECES: i64 = 1000;

#[derive(Debug, Args)]
pub(crate) struct AttackOptions {
    /// What is attacked: a design (a1, 24, a1-first-roots, 24-complex-roots, 119-weights,
    /// 110-windows, 110-late-turns, 122-turns or swarm-turns), or a shipped scenario by its name, or a
    /// file by its path, whose delays and schedules are varied within what it states
    #[arg(value_name = "DESIGN|SCENARIO", add = ArgValueCompleter::new(suggest::scenarios))]
    pub(crate) what: String,
    /// Pieces of the delay, and phases of the schedule, at most
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=MOST_PIECES), allow_negative_numbers = true)]
    pub(crate) pieces: u32,
    /// The same seed searches the same scenarios
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// How long to search
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = positive, allow_negative_numbers = true)]
    pub(crate) seconds: f64,
    /// The file for what is found
    #[arg(long, value_name = "FILE", default_value = "forwardstep-attack.toml")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct SamplingLimitOptions {
    /// Shipped scenarios by name, or files by their paths; those in continuous time are sampled with exact measurements
    #[arg(value_name = "SCENARIO", default_value = SIX_ARMS, add = ArgValueCompleter::new(suggest::scenarios))]
    pub(crate) scenarios: Vec<String>,
    /// Let torques come late by this part of the period, from 0 to 1
    #[arg(long, value_name = "PART", value_parser = part, allow_negative_numbers = true)]
    pub(crate) late: Option<f64>,
    /// Take velocities from differences of positions, filtered at this cut-off
    #[arg(long, value_name = "HZ", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) filter_hz: Option<f64>,
    /// A run works while no |s| exceeds this, in rad/s or m/s [default: twice that of a run with an eighth of the period, or |z| there]
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) peak_error: Option<f64>,
    /// It works if no more than this remains of the disagreement, or of the error, in rad or m [default: a tenth of what there is at
    /// the start, or twice what remains in that run]
    #[arg(long, value_name = "GAP", value_parser = positive, allow_negative_numbers = true)]
    pub(crate) disagreement: Option<f64>,
    /// Print rows of a table; of scenarios in continuous time with several delays and filters
    #[arg(long)]
    pub(crate) table: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ManipulabilityOptions {
    /// Shipped scenarios by name, or files by their paths; agents are pushed at rest in agreement, for as long as the runs last
    #[arg(value_name = "SCENARIO", default_value = "remark-4", add = ArgValueCompleter::new(suggest::scenarios))]
    pub(crate) scenarios: Vec<String>,
    /// The manipulability gains of all agents, in 1/s to the power of the order
    #[arg(long, value_name = "GAINS", value_delimiter = ',', default_value = "0,0.5,1,2", value_parser = not_negative, allow_hyphen_values = true)]
    pub(crate) lambda: Vec<f64>,
    /// Push this agent [default: the first that the others follow]
    #[arg(long, value_name = "AGENT")]
    pub(crate) on: Option<String>,
    /// Push on this axis, counted from 1
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..), allow_negative_numbers = true)]
    pub(crate) axis: u32,
    /// The torque or force, in N m or N; the theory is that of small ones
    #[arg(long, value_name = "TORQUE", default_value_t = 0.01, value_parser = positive, allow_negative_numbers = true)]
    pub(crate) torque: f64,
    /// Print rows of a table
    #[arg(long)]
    pub(crate) table: bool,
}

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("comparison").args(["orders", "filters_s"])))]
pub(crate) struct SmoothnessOptions {
    /// Shipped scenarios by name, or files by their paths; they are simulated in continuous time
    #[arg(value_name = "SCENARIO", default_value = SIX_ARMS, add = ArgValueCompleter::new(suggest::scenarios))]
    pub(crate) scenarios: Vec<String>,
    /// Compare reference dynamics of these orders: agents keep their first roots, and repeat the last where there are too few
    #[arg(long, value_name = "ORDERS", value_delimiter = ',', value_parser = order_of_reference, allow_hyphen_values = true)]
    pub(crate) orders: Vec<usize>,
    /// Put the agents under the backstepping baseline with each of these time constants of its filter, in s, and give the slope
    #[arg(long = "filters", value_name = "SECONDS", value_delimiter = ',', value_parser = positive, allow_hyphen_values = true)]
    pub(crate) filters_s: Vec<f64>,
    /// Print what is found as one JSON object, which `schema smoothness` describes
    #[arg(long, conflicts_with = "table")]
    pub(crate) json: bool,
    /// Draw what --orders or --filters found of the last scenario into this file, as SVG; an older one is replaced
    #[arg(long, value_name = "FILE.svg", requires = "comparison")]
    pub(crate) plot: Option<PathBuf>,
    /// Print rows of a table
    #[arg(long)]
    pub(crate) table: bool,
}

fn order_of_reference(text: &str) -> Result<usize, NotBetween> {
    order(text).map(|order| order as usize)
}

/// Why a number cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("must be a number {0}")]
pub(crate) struct NotANumber(&'static str);

fn part(text: &str) -> Result<f64, NotANumber> {
    text.parse().ok().filter(|part| (0.0..=1.0).contains(part)).ok_or(NotANumber("from 0 to 1"))
}

fn positive(text: &str) -> Result<f64, NotANumber> {
    text.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite()).ok_or(NotANumber("above 0"))
}

fn not_negative(text: &str) -> Result<f64, NotANumber> {
    text.parse().ok().filter(|number: &f64| *number >= 0.0 && number.is_finite()).ok_or(NotANumber("of at least 0"))
}
