//! `forwardstep new`

mod trial;

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use forwardstep::io::robot::{OpenRobotError, open_robot};
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::scenario::{
    OpenError, RobotTemplate, Scenario, TaskTemplate, Template, TemplateDelay, TemplateGraph, nearest_here,
    shipped_scenario,
};
use forwardstep::io::urdf::{FrictionPolicy, NoticeKind, SHIPPED_ROBOTS, shipped_robot};
use forwardstep::io::{SourceText, UrdfOptions};
use forwardstep::io::{choose, for_shell, shown};
use forwardstep::sim::Exchange;
use miette::Diagnostic;
use thiserror::Error;

use self::trial::{Tried, tried};
use super::ask::Asker;
use super::patience::{LOOKING, Patience};
use super::replace;
use crate::arguments::{DelayChoice, ExchangeChoice, GraphChoice, NewOptions, count_of_agents, order};
use crate::console::{Console, Plain, complain, remark};
use crate::status::Status;

/// What is said of trials that take long.
const TRYING: &str = "still trying with which gains the robots do what they should, which may take a minute; `--untried` writes it without";

/// The schema of scenarios, written beside the first of a folder.
const SCHEMA: &str = "forwardstep.schema.json";

/// Why nothing was written.
#[derive(Clone, Debug, PartialEq, Error)]
enum NewError {
    #[error("`{}` already exists", shown(.0))]
    Exists(PathBuf),
    #[error("cannot write `{}`: {reason}", shown(path))]
    Write { path: PathBuf, reason: ErrorKind },
    #[error("the path of the robot, `{}`, cannot be written down in a scenario", shown(.0))]
    NotText(PathBuf),
    #[error("the name `{}` is not UTF-8, so that no other command could read it", shown(.0))]
    NotUtf8(PathBuf),
    #[error("`{}` has no joints, so that friction has no effect", shown(.0))]
    NoJoints(String),
    #[error("one agent alone has no other to agree with")]
    Alone,
    #[error("the law of `{}` needs reference dynamics of {}, not {order}", shown(robot), orders(*.needs))]
    Order { robot: String, needs: [u32; 2], order: u32 },
    #[error("the law of `{}` needs positions of others only", shown(.0))]
    Exchange(String),
    #[error("the law of `{}` does not follow the references of leaders", shown(.0))]
    Leads(String),
    #[error("a leader is followed over links without delay")]
    LedLate,
    #[error("each `{}` follows a target of its own, and has no neighbours", shown(.0))]
    NoNeighbours(String),
    #[error("`{}` is a file, and `--like` takes the name of a scenario that is shipped", shown(.0))]
    LikeFile(String),
}

/// A name that is no kind of robot, no shipped robot and no file.
#[derive(Debug, Error)]
#[error("there is no robot `{}`, and no such file", shown(name))]
struct NoRobot {
    name: String,
    known: String,
}

impl Diagnostic for NoRobot {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        Some(Box::new(format!("{}; for a file of your own give its path, such as `my-arm.urdf`", self.known)))
    }
}

impl NewError {
    fn help(&self) -> Option<&'static str> {
        match self {
            NewError::Exists(_) => Some("give another name; nothing is ever overwritten"),
            NewError::Write { reason: ErrorKind::NotFound, .. } => Some("make its folder first"),
            NewError::Write { reason, .. } => replace::help_for(*reason),
            NewError::NoJoints(_) => Some("leave `--dry-friction` out, or take an arm"),
            NewError::NotText(_) => Some("copy the robot beside the scenario"),
            NewError::NotUtf8(_) => Some("give it another name"),
            NewError::Alone => Some("take two or more, or `--leader`, or a spacecraft, which has a target of its own"),
            NewError::Order { .. } => Some("choose another `--order`, or leave it out"),
            NewError::Exchange(_) => Some("leave `--exchange` out"),
            NewError::Leads(robot) if robot.contains("chain") || robot.contains("feedback") => Some(
                "chains follow a `target` of their own, see `reference.tracking` and `reference.desired` in `forwardstep schema`; arms, \
                 masses and ships follow leaders",
            ),
            NewError::Leads(_) => Some("see `forwardstep new --like vehicles-behind-a-leader`"),
            NewError::LedLate => {
                Some("see `forwardstep new --like leader-over-late-links`, which comes as near as the delays let it")
            }
            NewError::NoNeighbours(_) => Some("leave `--order`, `--exchange`, `--graph`, `--delay` and `--leader` out"),
            NewError::LikeFile(_) => {
                Some("copy the file instead; `forwardstep scenarios` lists those that are shipped")
            }
        }
    }
}

/// Orders in words.
fn orders([lowest, highest]: [u32; 2]) -> String {
    if lowest == highest { format!("order {lowest}") } else { format!("order {lowest} or higher") }
}

fn refused(error: NewError) -> Status {
    let help = error.help();
    complain(&Plain::with_help(error, help))
}

/// Writes a commented scenario to start from.
pub(crate) fn new(options: &NewOptions, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    if let Some(file) = options.file.as_ref().filter(|file| file.exists()) {
        return Err(refused(NewError::Exists(file.clone())));
    }
    // Before gains are tried, which may take a minute.
    if let Some(file) = &options.file {
        if file.to_str().is_none() {
            return Err(refused(NewError::NotUtf8(file.clone())));
        }
        replace::may_replace(file, |_| false).map_err(|error| complain(&error))?;
    }
    let (text, tried) = match &options.like {
        Some(name) => (copied(name)?, None),
        None => {
            let template = template(options, kinds)?;
            let read = |template: &Template| read(template, options, kinds);
            let patience = Patience::with(LOOKING);
            // What is refused is no place to start from, for instance because the robot changed in between.
            read(&template)?;
            drop(patience);
            match options.untried {
                true => (template.text(), None),
                false => {
                    let _patience = Patience::with(TRYING);
                    tried(template, &read).map(|tried| (tried.template.text(), Some(tried)))?
                }
            }
        }
    };
    match &options.file {
        None => console.verbatim(text),
        Some(file) => {
            write_new(file, &format!("#:schema ./{SCHEMA}\n{text}")).map_err(refused)?;
            beside(file, &format!("{:#}\n", kinds.schema().to_value()));
        }
    }
    let status = tried.map_or(Status::Fine, |tried| told(&tried));
    if let Some(file) = &options.file {
        let (file, pasted) = (shown(file), for_shell(&shown(file).to_string()));
        match status {
            Status::Fine => console.line(format_args!("wrote {file}; next: forwardstep run {pasted}")),
            _ => console.line(format_args!(
                "wrote {file}; next: change what its first lines say, then forwardstep run {pasted}"
            )),
        }
    }
    Ok(status)
}

/// Says what the trials came to.
fn told(tried: &Tried) -> Status {
    if tried.works {
        return Status::Fine;
    }
    remark("no trial did what it should; it is written with the default gains, so that you can look at it");
    Status::Missed
}

fn read(template: &Template, options: &NewOptions, kinds: &Kinds) -> Result<Scenario, Status> {
    let folder = options.file.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    let source = SourceText::new("new scenario", template.text());
    kinds.read_scenario("new", &source, Some(folder)).map_err(|error| complain(&error))
}

/// The text of a shipped scenario. Tables that it names are found wherever it is.
fn copied(name: &str) -> Result<String, Status> {
    let shipped = shipped_scenario(name.trim_end_matches(".toml"));
    let unknown = || match Path::new(name).exists() {
        true => refused(NewError::LikeFile(name.to_owned())),
        false => complain(&OpenError::Unknown { name: name.to_owned() }),
    };
    shipped.map(|shipped| shipped.text.to_owned()).ok_or_else(unknown)
}

fn template(options: &NewOptions, kinds: &Kinds) -> Result<Template, Status> {
    let asker = Asker::new();
    let stem = || options.file.as_ref()?.file_stem()?.to_str().map(str::to_owned);
    let offered: Vec<&str> = kinds.robot_keys().into_iter().filter(|key| kinds.template(key).is_some()).collect();
    let question = format!("robot: {}, ur5e, panda, gantry or the path of a URDF", offered.join(", "));
    let first = offered.first().copied().unwrap_or_default().to_owned();
    let given = asker.ask(options.robot.clone(), &question, first, |answer| Ok::<_, &str>(answer.to_owned()));
    let mut chosen = robot(&given, options.file.as_deref(), kinds)?;
    let rubs = options.dry_friction || (chosen.dry_friction.is_some() && asker.confirm("dry friction at the joints"));
    if rubs {
        chosen = chosen.rubbing().ok_or_else(|| refused(NewError::NoJoints(given.clone())))?;
    }
    let without_friction = chosen.leaves_friction_out();
    let mut template = Template::new(chosen);
    if without_friction {
        let left_out =
            "The URDF states friction of its joints, which is left out; `forwardstep new --dry-friction` simulates it.";
        remark(left_out);
        template.remarks.push(left_out.to_owned());
    }
    template.title = options.name.clone().or_else(stem).unwrap_or(template.title);
    template.agents = asker.ask(options.agents, "number of agents", template.agents, count_of_agents);
    let (needs, exchange, follows) = match template.robot.task {
        TaskTemplate::Agree { orders, exchange, follows } => (orders, exchange, follows),
        TaskTemplate::Track { .. } => {
            let NewOptions { order, exchange, leader, graph, delay, .. } = options;
            let networked = order.is_some() || exchange.is_some() || *leader || graph.is_some() || delay.is_some();
            return if networked { Err(refused(NewError::NoNeighbours(given))) } else { Ok(template) };
        }
    };
    template.leader = options.leader;
    if template.leader && !follows {
        return Err(refused(NewError::Leads(given)));
    }
    if template.agents < 2 && !template.leader {
        return Err(refused(NewError::Alone));
    }
    if !template.leader {
        template.order = asker.ask(options.order, "order of the reference dynamics", template.order, order);
        if !(needs[0]..=needs[1]).contains(&template.order) {
            return Err(refused(NewError::Order { robot: given, needs, order: template.order }));
        }
        let stated = options.exchange.or_else(|| exchange.map(choice));
        template.exchange = match asker.choose(stated, "exchange", ExchangeChoice::PositionVelocity) {
            ExchangeChoice::Position => Exchange::Position,
            ExchangeChoice::PositionVelocity => Exchange::PositionVelocity,
        };
        if exchange.is_some_and(|only| only != template.exchange) {
            return Err(refused(NewError::Exchange(given)));
        }
    }
    template.graph = match asker.choose(options.graph, "graph", GraphChoice::Ring) {
        GraphChoice::Ring => TemplateGraph::Ring,
        GraphChoice::Path => TemplateGraph::Path,
        GraphChoice::Star => TemplateGraph::Star,
        GraphChoice::Complete => TemplateGraph::Complete,
        GraphChoice::Random => TemplateGraph::Random,
        GraphChoice::Switching => TemplateGraph::Switching,
    };
    let usual = if template.leader { DelayChoice::None } else { DelayChoice::Constant };
    template.delay = match asker.choose(options.delay, "delay", usual) {
        DelayChoice::Constant => TemplateDelay::Constant,
        DelayChoice::SawTooth => TemplateDelay::SawTooth,
        DelayChoice::Radio => TemplateDelay::Radio,
        DelayChoice::None => TemplateDelay::None,
    };
    if template.leader && template.delay != TemplateDelay::None {
        return Err(refused(NewError::LedLate));
    }
    Ok(template)
}

/// As the command line has it.
fn choice(exchange: Exchange) -> ExchangeChoice {
    // What is told of leaders alone leaves no choice.
    if exchange.has_velocities() { ExchangeChoice::PositionVelocity } else { ExchangeChoice::Position }
}

/// The robot of this key, else that in the file at this path, as the scenario at `scenario` has to name it.
fn robot(name_or_path: &str, scenario: Option<&Path>, kinds: &Kinds) -> Result<RobotTemplate, Status> {
    if let Some(known) = kinds.template(&name_or_path.replace('-', "_")) {
        return Ok(known);
    }
    let options = UrdfOptions { friction: FrictionPolicy::Ignore, ..UrdfOptions::default() };
    let robot = open_robot(name_or_path, &options).map_err(|error| match error {
        OpenRobotError::Unknown { name } => {
            let kinds = kinds.robot_keys().into_iter().filter(|key| kinds.template(key).is_some());
            let all: Vec<&str> = kinds.chain(SHIPPED_ROBOTS.map(|(name, _)| name)).collect();
            let known = match nearest_here(&name) {
                Some(here) => format!("{here}; {}", choose("", "robots are", &all)),
                None => choose(&name.replace('-', "_"), "robots are", &all),
            };
            complain(&NoRobot { name, known })
        }
        error => complain(&error),
    })?;
    let has_friction = robot.notices.iter().any(|notice| matches!(notice.kind, NoticeKind::FrictionIgnored { .. }));
    let path = Path::new(name_or_path);
    let is_elsewhere = scenario.and_then(Path::parent).is_some_and(|folder| !folder.as_os_str().is_empty());
    let file = match path.exists() {
        false => match shipped_robot(name_or_path) {
            Some(_) => format!("{}.urdf", name_or_path.trim_end_matches(".urdf")),
            None => name_or_path.to_owned(),
        },
        true if is_elsewhere => {
            let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
            let text = absolute.to_str().map(str::to_owned);
            text.ok_or_else(|| refused(NewError::NotText(absolute)))?
        }
        true => name_or_path.to_owned(),
    };
    Ok(RobotTemplate::urdf(&file, has_friction, &robot.robot))
}

/// Writes a file that must not exist yet.
fn write_new(path: &Path, text: &str) -> Result<(), NewError> {
    let failed = |error: std::io::Error| match error.kind() {
        ErrorKind::AlreadyExists => NewError::Exists(path.to_owned()),
        reason => NewError::Write { path: path.to_owned(), reason },
    };
    let mut file = OpenOptions::new().write(true).create_new(true).open(path).map_err(failed)?;
    file.write_all(text.as_bytes()).map_err(|error| {
        drop(std::fs::remove_file(path));
        failed(error)
    })
}

/// Writes the schema beside a scenario, for editors, where there is none yet.
fn beside(scenario: &Path, schema: &str) {
    match write_new(&scenario.with_file_name(SCHEMA), schema) {
        Ok(()) | Err(NewError::Exists(_)) => {}
        Err(error) => remark(format_args!("{error}; the scenario is complete without it")),
    }
}
