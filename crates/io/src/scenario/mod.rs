//! Scenario files: TOML in, a [`Setup`] out.
//!
//! [`mod@file`] is the format as it is written and the source of its JSON schema ([`schema`]); the other files of this room
//! turn it into the plain structs of `forwardstep-sim`, one table each, and report what has no meaning at its place.
//!
//! ```
//! use forwardstep_io::SourceText;
//! use forwardstep_io::scenario::read_scenario;
//!
//! let text = r#"
//!     format = 2
//!     time = { end_s = 20 }
//!     [[agents]]
//!     name = "cart"
//!     count = 2
//!     robot.point_mass = { dimension = 1, mass_kg = 2 }
//!     start.position_m = [[0], [1]]
//!     [reference.consensus]
//!     roots_per_s = [1, 2]
//!     exchange = "position_velocity"
//!     [network]
//!     delay.constant_s = 0.1
//!     edges = [["cart-1", "cart-2"], ["cart-2", "cart-1"]]
//! "#;
//! let scenario = read_scenario("carts", &SourceText::new("carts.toml", text), None)?;
//! assert_eq!(scenario.setup.agents[1].start.q, [1.0]);
//!
//! let wrong = text.replace("cart-1\"]]", "card-1\"]]");
//! let error = read_scenario("carts", &SourceText::new("carts.toml", wrong), None).unwrap_err();
//! assert_eq!(error.to_string(), "carts.toml:14:47: there is no agent `card-1`");
//! # Ok::<(), forwardstep_io::scenario::ScenarioError>(())
//! ```

mod agents;
pub mod at;
mod attitude;
pub mod attitude_file;
mod choice;
mod control;
pub mod control_file;
mod de;
mod document;
mod edges;
pub mod edges_file;
mod fault;
pub mod file;
pub mod formula;
mod formula_problem;
pub mod formula_text;
mod gains;
mod goal;
mod impossible;
pub(crate) mod inputs;
pub mod kinds;
pub mod leader_file;
mod links;
pub mod links_file;
mod network;
pub mod network_file;
mod network_problem;
mod notice;
mod open;
mod others;
mod problem;
mod push_course;
pub mod push_file;
mod push_problem;
mod pushes;
mod random;
mod refusal;
mod rewired;
mod robots;
pub mod roots;
mod rows;
pub(crate) mod run_folder;
mod scope;
mod shipped;
mod spread;
mod start;
mod system_problem;
pub mod systems_file;
mod table;
mod target;
mod template;
mod unused;
mod upgrade;
mod value_problem;
pub mod values;

use std::fmt;

use forwardstep_sim::leader::Following;
use forwardstep_sim::{
    ATOL, Method, Network, RECORD_EVERY_S, RTOL, RecordAt, Setup, SetupError, Solver, TimeSpan, check_recording,
    recorded_columns,
};
use miette::Diagnostic;

pub use goal::Goal;
pub use inputs::{InputFile, Inputs};
pub use network_problem::NetworkProblem;
pub use notice::Notice;
pub use open::{OpenError, open_scenario, open_text};
pub use problem::ScenarioProblem;
pub use push_problem::PushProblem;
pub use rewired::{Rewired, StatedNetwork, rewired, stated_network};
pub use scope::nearest_here;
pub use shipped::{SHIPPED_SCENARIOS, SHIPPED_TABLES, ShippedScenario, ShippedTable, shipped_scenario};
pub use system_problem::SystemProblem;
pub use table::TableProblem;
pub use template::{LawTemplate, RobotTemplate, TaskTemplate, Template, TemplateDelay, TemplateGraph, Tuning};
pub use upgrade::{Moved, Upgraded, upgrade};
pub use value_problem::ValueProblem;

use crate::urdf::UrdfProblem;
use crate::{InputError, SourceText};
use agents::Leading;
use at::At;
use document::Document;
use fault::{Fault, fault, positive_count};
use file::{AdaptiveMethodFile, AgentFile, MethodFile, ScenarioFile, SolverFile};
use impossible::Reading;
use inputs::InputFolder;
use kinds::{Kinds, ReferenceReader};
pub use robots::Model;
use robots::Stop;

/// The format of scenario files.
pub const FORMAT: i64 = 2;

/// A scenario that has been read.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The name of the shipped scenario, or of the file without its ending.
    pub name: String,
    /// Its text.
    pub source: SourceText,
    /// What it shows, in one line; its name if it does not say.
    pub title: String,
    /// What to simulate.
    pub setup: Setup,
    /// What the run is expected to show.
    pub goal: Option<Goal>,
    /// What the user should know.
    pub notices: Vec<Notice>,
    /// The files that it names, as they were read, each once; shipped robots are not among them.
    pub inputs: Vec<InputFile>,
    /// What each agent looks like, if it is from a URDF.
    pub models: Vec<Option<Model>>,
}

impl Scenario {
    /// Whether the rows of a run fit into memory. Reading does not ask: a check, an explanation or a prediction of many agents
    /// records none.
    ///
    /// # Errors
    /// That they do not, at the key that says how often rows are recorded, with what to write there.
    pub fn check_recording(&self) -> Result<(), ScenarioError> {
        check_recording(&self.setup).map_err(|error| match Document::parse(&self.source) {
            // It is about the run as a whole, so that no agent's entry is looked for.
            Ok(document) => Stop::Here(document.refused(&self.setup, &[], error)).in_file(&self.source),
            Err(fault) => Stop::Here(fault).in_file(&self.source),
        })
    }
}

/// A mistake in a scenario, or in a file that it names.
#[derive(Clone, Debug)]
pub enum ScenarioError {
    /// In the scenario, or in a table that it names.
    Scenario(Box<InputError<ScenarioProblem>>),
    /// In a robot file.
    Robot(Box<InputError<UrdfProblem>>),
}

impl ScenarioError {
    fn diagnostic(&self) -> &dyn Diagnostic {
        match self {
            ScenarioError::Scenario(error) => error.as_ref(),
            ScenarioError::Robot(error) => error.as_ref(),
        }
    }
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self.diagnostic(), f)
    }
}

impl std::error::Error for ScenarioError {}

impl Diagnostic for ScenarioError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.diagnostic().help()
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.diagnostic().source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        self.diagnostic().labels()
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        self.diagnostic().related()
    }
}

/// Reads a scenario. Files that it names are looked for in `inputs`: a folder or none, as an `Option`, or [`Inputs`] with files from
/// memory; robots and tables then among the shipped ones.
///
/// # Errors
/// The first mistake, at its place in the scenario or in a file that it names, with others as [`InputError::others`]: all of the form (keys,
/// kinds of values, choices), or where that is sound all impossible values as far as they do not depend on each other. Any text gives a
/// result; none panics.
pub fn read_scenario(name: &str, source: &SourceText, inputs: impl Into<Inputs>) -> Result<Scenario, ScenarioError> {
    Kinds::shipped().read_scenario(name, source, inputs)
}

impl Kinds {
    /// [`read_scenario`] with these kinds.
    ///
    /// # Errors
    /// As of [`read_scenario`].
    pub fn read_scenario(
        &self,
        name: &str,
        source: &SourceText,
        inputs: impl Into<Inputs>,
    ) -> Result<Scenario, ScenarioError> {
        let unread = Unread { name, source, kinds: self };
        unread.read(InputFolder::new(inputs.into())).map_err(|stop| stop.in_file(source))
    }
}

/// A scenario that is to be read.
#[derive(Clone, Copy)]
struct Unread<'a> {
    name: &'a str,
    source: &'a SourceText,
    kinds: &'a Kinds,
}

impl Unread<'_> {
    fn read(self, mut folder: InputFolder) -> Result<Scenario, Stop> {
        let Unread { source, kinds, .. } = self;
        let document = Document::parse(source)?;
        Document::readable(&document.format()?, source)?;
        let file = document.file(kinds).map_err(|fault| {
            let mut others = others::others(&fault, source, kinds);
            // Where nothing but keys is wrong, values are looked at as well.
            let mended = others.mended.take().and_then(|mended| Some((mended.file(kinds).ok()?, mended)));
            let values = mended.map(|(file, mended)| self.valued(&mended, file, &mut folder));
            fault.beside(match values {
                Some(Err(Stop::Here(values))) => others.with(values),
                _ => others.found,
            })
        })?;
        let mut scenario = self.valued(&document, file, &mut folder)?;
        scenario.inputs = folder.into_read();
        Ok(scenario)
    }

    /// What the tables of a scenario mean, else all that is wrong with its values.
    fn valued(self, document: &Document<'_>, file: ScenarioFile, folder: &mut InputFolder) -> Result<Scenario, Stop> {
        self.meaning(document, file, folder).map_err(|stop| match stop {
            Stop::Here(fault) => {
                let reads = affordable(self.source, document, folder, self.kinds);
                let others = impossible::others(&fault, document, reads, &mut |document| {
                    let Ok(file) = document.file(self.kinds) else { return Reading::Unreadable };
                    match self.meaning(document, file, folder) {
                        Ok(_) => Reading::Sound,
                        Err(Stop::Here(fault)) => Reading::Fault(fault),
                        Err(Stop::Robot(_)) => Reading::Unreadable,
                    }
                });
                Stop::Here(fault.beside(others))
            }
            robot @ Stop::Robot(_) => robot,
        })
    }

    /// What the tables of a scenario mean.
    fn meaning(self, document: &Document<'_>, file: ScenarioFile, folder: &mut InputFolder) -> Result<Scenario, Stop> {
        let Unread { name, source, kinds } = self;
        let mut notices = Vec::new();
        let record_every_s = file.time.record_every_s.as_ref().map_or(RECORD_EVERY_S, |every| every.value);
        let end_s = file.time.end_s.value;
        let mut time = TimeSpan { end_s, record_every_s, record_at: RecordAt::Intervals };
        document.checked(time.check())?;
        time.record_at = rows::record_at(&file.time, file.control.as_ref(), folder)?;
        let from = agents::Source { file: &file, document, kinds, text: source, end_s };
        let populations = agents::populations(&from, folder)?;
        let axes = populations.first().map_or_else(Vec::new, |population| population.axis_names());
        let names: Vec<String> = populations.iter().flat_map(|population| population.names()).cloned().collect();
        let leading = reference(&file, (document, kinds), [&names, &axes], folder)?;
        let mut read = agents::agents(&from, &populations, &leading, folder, &mut notices)?;
        pushes::pushes(&file.external_wrenches, &mut read, end_s, source, folder, &mut notices)?;
        let agents = read.agents;
        let mut names = names;
        let dynamics = leading.read.dynamics;
        if let (Some(leader), Some(place)) = (dynamics.downcast().and_then(Following::motion), &file.leader) {
            let name = leader.name.clone();
            if names.contains(&name) {
                let first_line = file.agents.span.start;
                let (first_line, _) = source.line_column(first_line);
                return Err(fault(place, ScenarioProblem::AgentTwice { name, first_line }).into());
            }
            names.push(name);
        }
        let vertices = (&names[..], agents.len());
        let network = match &file.network {
            Some(network) => {
                network::network(&network.value, (document, kinds), vertices, end_s, source, folder, &mut notices)
                    .map_err(|fault| fault.at(&network.span))?
            }
            None if dynamics.interface().family.has_targets() => Network::silent(names.len()),
            None => return Err(fault(&file.reference, NetworkProblem::Missing).into()),
        };
        let control = file.control.as_ref().map(|file| control::control(file, axes.len())).transpose()?;
        let (reference, exchange) = (dynamics, leading.read.exchange);
        let setup =
            Setup { agents, reference, exchange, network, time, solver: solver(file.solver.as_ref())?, control };
        // What a notice simulates has a meaning then.
        recorded_columns(&setup).map_err(|error| {
            let edge = match (&error, &file.network) {
                (SetupError::LeaderHears { leader }, Some(network)) => network.value.edge_to(leader),
                _ => None,
            };
            match edge {
                Some(edge) => Fault::new(ScenarioProblem::Setup(error)).at(&edge),
                None => document.refused(&setup, &read.entries, error),
            }
        })?;
        notices.extend(Notice::coarse_sampling(&setup));
        notices.extend(Notice::targets_beyond_limits(&setup));
        notices.extend(Notice::starts_beyond_limits(&setup));
        notices.extend(Notice::rotation(&setup));
        notices.extend(Notice::stiff(&setup));
        let goal = file.goal.as_ref().map(|file| goal::goal(file, &setup)).transpose()?;
        Ok(Scenario {
            name: name.to_owned(),
            source: source.clone(),
            title: file.title.unwrap_or_else(|| name.to_owned()),
            setup,
            goal,
            notices,
            inputs: Vec::new(),
            models: read.bodies.iter().map(Model::of).collect(),
        })
    }
}

/// How often a scenario that has no meaning may be read again to find out what else is wrong.
fn affordable(source: &SourceText, document: &Document<'_>, folder: &InputFolder, kinds: &Kinds) -> usize {
    const MOST: usize = 240;
    // About what a hundred readings of six arms from a file take.
    const WORK: usize = 20_000_000;
    let agents = document.file(kinds).map_or(0, |file| {
        // A number that is not possible is replaced by a small one.
        let possible = |count: &&At<i64>| (1..=i64::from(agents::MOST_AGENTS)).contains(&count.value);
        let count = |entry: &At<AgentFile>| entry.value.count.as_ref().filter(possible).map_or(1, |count| count.value);
        file.agents.value.iter().map(count).sum::<i64>()
    });
    let work = source.text().len() + folder.bytes() + 1000 * usize::try_from(agents).unwrap_or(usize::MAX / 2000);
    (WORK / work.max(1)).min(MOST)
}

/// What produces the reference velocities of agents with these names and axes, and what is exchanged for it.
fn reference(
    file: &ScenarioFile,
    (document, kinds): (&Document<'_>, &Kinds),
    names_and_axes: [&[String]; 2],
    folder: &mut InputFolder,
) -> Result<Leading, Fault> {
    let span = &file.reference.span;
    let (key, kind) = document.reference(kinds)?;
    let mut reader = ReferenceReader::new(file, names_and_axes, file.time.end_s.value, folder);
    let read = kind.read(&mut reader).map_err(|fault| fault.at(span))?;
    reader.refuse_unused(key)?;
    Ok(Leading { key, read, own_roots: kinds.agents_may_state(key), span: span.clone() })
}

fn solver(file: Option<&SolverFile>) -> Result<Solver, Fault> {
    let default = Solver::default();
    let Some(file) = file else { return Ok(default) };
    let or = |number: &Option<At<f64>>, usual: f64| number.as_ref().map_or(usual, |number| number.value);
    let method = match &file.method {
        None => default.method,
        Some(MethodFile::Fixed(fixed)) => Method::Fixed { step_s: fixed.step_s.value },
        Some(MethodFile::Adaptive(AdaptiveMethodFile { rtol, atol })) => {
            Method::Adaptive { rtol: or(rtol, RTOL), atol: or(atol, ATOL) }
        }
    };
    Ok(Solver {
        method,
        max_step_s: file.max_step_s.as_ref().map(|step| step.value),
        min_step_s: or(&file.min_step_s, default.min_step_s),
        memory_budget_bytes: match &file.memory_budget_bytes {
            Some(bytes) => positive_count("memory_budget_bytes", bytes)?,
            None => default.memory_budget_bytes,
        },
        balance: file.lyapunov_balance.unwrap_or(default.balance),
    })
}

/// The JSON schema of the format with the shipped kinds, for editors.
pub fn schema() -> schemars::Schema {
    Kinds::shipped().schema()
}
