//! `forwardstep compare`

use std::path::{Path, PathBuf};

use forwardstep::check::smoothness::{NoSmoothness, Smoothness, smoothness};
use forwardstep::io::output::{Compared, Comparison, RunFolder, RunRecord, SavedRun};
use forwardstep::io::scenario::kinds::Kinds;
use forwardstep::io::scenario::{Scenario, shipped_scenario};
use forwardstep::io::shown;
use forwardstep::sim::Setup;

use super::compare_table;
use super::progress::Bar;
use super::promise::{Promise, promise};
use super::run::{Job, refused};
use super::stop::Stop;
use crate::arguments::{CompareOptions, Writing};
use crate::console::{Console, Plain, complain, remark};
use crate::status::Status;

/// The longest name of a folder that is made of the names of all runs.
const LONGEST_NAME: usize = 100;

/// One of what is to be compared, as it was given.
enum Given {
    /// The folder of a run.
    Run(PathBuf),
    /// What is run first.
    Scenario(Box<Scenario>),
    /// The same as one before, by its number.
    Again(usize),
}

/// One of them, in its folder.
struct Ready {
    name: String,
    folder: PathBuf,
    run: SavedRun,
    promise: Promise,
    notices: Vec<String>,
    jumps: Result<Smoothness, String>,
}

/// Runs what is not yet run, and writes what was promised, predicted and observed of all, side by side.
pub(crate) fn compare(options: &CompareOptions, kinds: &Kinds, console: &mut Console) -> Result<Status, Status> {
    // All of them are read before anything is run or written.
    let mut given = Vec::new();
    for (k, text) in options.runs.iter().enumerate() {
        given.push(read(&options.runs[..k], text, kinds)?);
    }
    let plain: Vec<String> = given.iter().zip(&options.runs).map(|(given, text)| plain_name(given, text)).collect();
    let names = distinct(&plain);
    let out = options.out.clone().unwrap_or_else(|| Path::new("forwardstep-runs").join(joined(&plain)));

    let stop = Stop::listen();
    let folder = RunFolder::create_for_comparison(&out, options.force).map_err(refused)?;
    let mut status = Status::Fine;
    let mut folders: Vec<PathBuf> = Vec::new();
    for (given, name) in given.iter().zip(&names) {
        let path = match given {
            Given::Run(path) => path.clone(),
            Given::Again(first) => folders[*first].clone(),
            Given::Scenario(scenario) => {
                let path = out.join(name);
                remark(format_args!("running {}", shown(name)));
                match run_first(scenario, &path, options, kinds, &stop)? {
                    Status::Fine | Status::Missed => {}
                    Status::BrokeDown => status = Status::BrokeDown,
                    other => {
                        let folder = shown(&path);
                        remark(format_args!(
                            "Nothing is compared; what was computed of {} is in {folder}.",
                            shown(name)
                        ));
                        return Ok(other);
                    }
                }
                path
            }
        };
        folders.push(path);
    }

    let mut ready = Vec::new();
    for (name, folder) in names.into_iter().zip(folders) {
        ready.push(open(name, folder, kinds, options, &stop)?);
    }
    let records: Vec<RunRecord<'_>> = ready.iter().map(Ready::record).collect();
    let compared: Vec<Compared<'_>> =
        ready.iter().zip(&records).map(|(ready, record)| ready.compared(record)).collect();
    let comparison = Comparison::of(&compared, env!("CARGO_PKG_VERSION"));
    let files = comparison.write(&folder, &compared).map_err(refused)?;
    if options.json {
        console.json(comparison.to_json().map_err(|error| complain(&Plain::new(error)))?);
    } else {
        console.text(compare_table::table(&comparison));
        console.line("");
        for file in files {
            console.whole(shown(&file));
        }
    }
    Ok(status)
}

/// Reads one of them; the same as an earlier one is not run again.
fn read(earlier: &[String], text: &str, kinds: &Kinds) -> Result<Given, Status> {
    if let Some(first) = earlier.iter().position(|before| before == text) {
        return Ok(Given::Again(first));
    }
    let path = Path::new(text);
    if shipped_scenario(text).is_some() && path.join("summary.json").is_file() {
        remark(format_args!(
            "note: `{text}` is taken as the shipped scenario; the run in the folder of that name is `./{text}`"
        ));
    }
    if shipped_scenario(text).is_none() && path.is_dir() {
        // Once for its mistakes, and again when all others have been run.
        SavedRun::look_with(path, kinds).map_err(|error| complain(&error))?;
        return Ok(Given::Run(path.to_owned()));
    }
    let scenario = kinds.open_scenario(text).map_err(|error| complain(&error))?;
    scenario.check_recording().map_err(|error| complain(&error))?;
    Ok(Given::Scenario(Box::new(scenario)))
}

/// A name without the rest of its path.
fn plain_name(given: &Given, text: &str) -> String {
    let last = |path: &Path| path.canonicalize().ok()?.file_name().map(|name| name.to_string_lossy().into_owned());
    match given {
        Given::Scenario(scenario) => scenario.name.clone(),
        Given::Again(_) if shipped_scenario(text).is_some() => text.to_owned(),
        Given::Again(_) if !Path::new(text).is_dir() => {
            Path::new(text).file_stem().map_or_else(|| text.to_owned(), |stem| stem.to_string_lossy().into_owned())
        }
        Given::Run(_) | Given::Again(_) => last(Path::new(text)).unwrap_or_else(|| text.to_owned()),
    }
}

/// The same names, numbered where several are the same.
fn distinct(names: &[String]) -> Vec<String> {
    let mut taken: Vec<String> = Vec::new();
    for name in names {
        let free = |candidate: &String| !taken.contains(candidate);
        let numbered = (2..).map(|k| format!("{name}-{k}"));
        taken.extend(std::iter::once(name.clone()).chain(numbered).find(free));
    }
    taken
}

/// All names in one, which a file system takes.
fn joined(names: &[String]) -> String {
    let all = names.join("-and-");
    match names {
        [first, second, ..] if all.len() > LONGEST_NAME => {
            let cut = |name: &str| name.chars().take(LONGEST_NAME / 4).collect::<String>();
            format!("{}-and-{}-and-more", cut(first), cut(second))
        }
        _ => all,
    }
}

/// Simulates a scenario, as `run` does, without its words.
fn run_first(
    scenario: &Scenario,
    path: &Path,
    options: &CompareOptions,
    kinds: &Kinds,
    stop: &Stop,
) -> Result<Status, Status> {
    let writing = Writing { force: options.force, predict: options.predict, ..Writing::default() };
    let promise = promise(&scenario.setup);
    Job { scenario, promise: &promise, path, writing, kinds, stop }.execute(&mut Console::muted())
}

/// Reads a run back, and looks at its jumps.
fn open(name: String, folder: PathBuf, kinds: &Kinds, options: &CompareOptions, stop: &Stop) -> Result<Ready, Status> {
    let run = SavedRun::look_with(&folder, kinds).map_err(|error| complain(&error))?;
    let promise = promise(run.setup());
    let notices: Vec<String> = promise.remarks(&run).iter().map(ToString::to_string).collect();
    for sentence in &notices {
        remark(format_args!("note on {}: {sentence}", shown(&name)));
    }
    let jumps = if options.no_jumps {
        Err("they were not looked for, as `--no-jumps` asks".to_owned())
    } else {
        jumps_of(run.setup(), stop)?
    };
    // As it is shown: names of files may hold anything.
    Ok(Ready { name: shown(&name).to_string(), folder, run, promise, notices, jumps })
}

fn jumps_of(setup: &Setup, stop: &Stop) -> Result<Result<Smoothness, String>, Status> {
    let mut bar = Bar::new();
    let found = smoothness(setup, &mut |progress| {
        bar.update(progress);
        stop.flow()
    });
    bar.clear();
    match (found, stop.asked()) {
        (_, Some(status)) => {
            remark("Nothing is compared; the runs are whole.");
            Err(status)
        }
        (found, None) => Ok(found.map_err(|error: NoSmoothness| error.to_string())),
    }
}

impl Ready {
    fn record(&self) -> RunRecord<'_> {
        self.promise.record(&self.run, &[])
    }

    fn compared<'a>(&'a self, record: &'a RunRecord<'a>) -> Compared<'a> {
        Compared {
            name: &self.name,
            folder: &self.folder,
            record,
            jumps: self.jumps.as_ref().map_err(String::as_str),
            notices: &self.notices,
        }
    }
}
