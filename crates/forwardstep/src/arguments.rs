//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

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
    1  check: a hypothesis does not hold, or the paper does not cover the case; run: the goal was missed
    2  input without meaning, or a folder that cannot be written to
    3  the run broke down; what was computed is written
  130  interrupted by Ctrl-C; what was computed is written";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulate a scenario and write tables and a report
    Run(RunOptions),
    /// Say which theorem speaks about a scenario, and whether its hypotheses hold
    Check {
        /// A shipped scenario by name, or a file by its path
        #[arg(default_value = SIX_ARMS)]
        scenario: String,
    },
    /// List the shipped scenarios, or print one
    Scenarios {
        /// Print the text of this one
        name: Option<String>,
    },
    /// Print the JSON schema of scenario files
    Schema,
}

/// The main job: the six arms, into the usual folder.
impl Default for Command {
    fn default() -> Self {
        Command::Run(RunOptions { scenario: SIX_ARMS.into(), out: None, force: false, csv: false })
    }
}

#[derive(Debug, Args)]
pub(crate) struct RunOptions {
    /// A shipped scenario by name, or a file by its path
    #[arg(default_value = SIX_ARMS)]
    pub(crate) scenario: String,
    /// The folder to write to [default: forwardstep-runs/ and the scenario's name]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace the files of an earlier run
    #[arg(long)]
    pub(crate) force: bool,
    /// Write the trajectory as CSV too
    #[arg(long)]
    pub(crate) csv: bool,
}
