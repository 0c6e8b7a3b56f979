//! `forwardstep new`

use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use forwardstep::io::robot::open_robot;
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::scenario::{RobotTemplate, Template, TemplateDelay, TemplateGraph};
use forwardstep::io::shown;
use forwardstep::io::urdf::{FrictionPolicy, NoticeKind, shipped_robot};
use forwardstep::io::{SourceText, UrdfOptions};
use forwardstep::sim::Exchange;
use thiserror::Error;

use super::ask::Asker;
use crate::arguments::{DelayChoice, ExchangeChoice, GraphChoice, NewOptions, count_of_agents, order};
use crate::console::{Console, Plain, complain};
use crate::status::Status;

/// Why nothing was written.
#[derive(Clone, Debug, PartialEq, Error)]
enum NewError {
    #[error("`{}` already exists", shown(.0))]
    Exists(PathBuf),
    #[error("cannot write `{}`: {reason}", shown(path))]
    Write { path: PathBuf, reason: ErrorKind },
    #[error("the path of the robot, `{}`, cannot be written down in a scenario", shown(.0))]
    NotText(PathBuf),
    #[error("`{0}` has no joints that could rub")]
    NoJoints(String),
}

impl NewError {
    fn help(&self) -> Option<&'static str> {
        match self {
            NewError::Exists(_) => Some("give another name; nothing is ever overwritten"),
            NewError::Write { reason: ErrorKind::NotFound, .. } => Some("make its folder first"),
            NewError::Write { .. } => None,
            NewError::NoJoints(_) => Some("leave `--dry-friction` out, or take an arm"),
            NewError::NotText(_) => Some("copy the robot beside the scenario"),
        }
    }
}

fn refused(error: NewError) -> Status {
    let help = error.help();
    complain(&Plain::with_help(error, help))
}

/// Writes a commented scenario to start from.
pub(crate) fn new(options: &NewOptions, kinds: &Kinds, console: &mut Console) -> Status {
    write(options, kinds, console).err().unwrap_or(Status::Fine)
}

fn write(options: &NewOptions, kinds: &Kinds, console: &mut Console) -> Result<(), Status> {
    if let Some(file) = options.file.as_ref().filter(|file| file.exists()) {
        return Err(refused(NewError::Exists(file.clone())));
    }
    let text = template(options, kinds)?.text();
    // What is refused is no place to start from, for instance because the robot changed in between.
    let folder = options.file.as_deref().and_then(Path::parent).unwrap_or(Path::new(""));
    let source = SourceText::new("new scenario", text.as_str());
    kinds.read_scenario("new", &source, Some(folder)).map_err(|error| complain(&error))?;
    match &options.file {
        None => console.verbatim(text),
        Some(file) => {
            write_new(file, &text).map_err(refused)?;
            console.line(format_args!("wrote {0}; next: forwardstep run {0}", shown(&file)));
        }
    }
    Ok(())
}

fn template(options: &NewOptions, kinds: &Kinds) -> Result<Template, Status> {
    let asker = Asker::new();
    let NewOptions { file, name, agents, robot: given, dry_friction, order: given_order, exchange, graph, delay } =
        options;
    let stem = || file.as_ref()?.file_stem()?.to_str().map(str::to_owned);
    let offered: Vec<&str> = kinds.robot_keys().into_iter().filter(|key| kinds.template(key).is_some()).collect();
    let question = format!("robot: {}, ur5e, panda or the path of a URDF", offered.join(", "));
    let first = offered.first().copied().unwrap_or_default().to_owned();
    let given = asker.ask(given.clone(), &question, first, |answer| Ok::<_, &str>(answer.to_owned()));
    let chosen = robot(&given, file.as_deref(), kinds)?;
    let chosen =
        if *dry_friction { chosen.rubbing().ok_or_else(|| refused(NewError::NoJoints(given)))? } else { chosen };
    let usual = Template::new(chosen);
    Ok(Template {
        title: name.clone().or_else(stem).unwrap_or(usual.title),
        robot: usual.robot,
        agents: asker.ask(*agents, "number of agents", usual.agents, count_of_agents),
        order: asker.ask(*given_order, "order of the reference dynamics", usual.order, order),
        exchange: match asker.choose(*exchange, "exchange", ExchangeChoice::PositionVelocity) {
            ExchangeChoice::Position => Exchange::Position,
            ExchangeChoice::PositionVelocity => Exchange::PositionVelocity,
        },
        graph: match asker.choose(*graph, "graph", GraphChoice::Ring) {
            GraphChoice::Ring => TemplateGraph::Ring,
            GraphChoice::Path => TemplateGraph::Path,
            GraphChoice::Complete => TemplateGraph::Complete,
        },
        delay: match asker.choose(*delay, "delay", DelayChoice::Constant) {
            DelayChoice::Constant => TemplateDelay::Constant,
            DelayChoice::SawTooth => TemplateDelay::SawTooth,
            DelayChoice::None => TemplateDelay::None,
        },
    })
}

/// The robot of this key, else that in the file at this path, as the scenario at `scenario` has to name it.
fn robot(name_or_path: &str, scenario: Option<&Path>, kinds: &Kinds) -> Result<RobotTemplate, Status> {
    if let Some(known) = kinds.template(&name_or_path.replace('-', "_")) {
        return Ok(known);
    }
    let options = UrdfOptions { friction: FrictionPolicy::Ignore, ..UrdfOptions::default() };
    let robot = open_robot(name_or_path, &options).map_err(|error| complain(&error))?;
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
    Ok(RobotTemplate::urdf(&file, has_friction))
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
