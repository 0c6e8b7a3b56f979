//! The program: arguments in, a command, an exit status.

use std::ffi::OsString;
use std::io;
use std::process::ExitCode;

use clap::Parser;
use forwardstep_io::scenario::kinds::Kinds;

use crate::arguments::{Arguments, Command, usage};
use crate::commands;
use crate::console::{self, Console};
use crate::status::Status;

/// The program `forwardstep` with these kinds of robots and laws: its scenario files, messages, schema and reports know them.
/// It takes its arguments from the command line.
///
/// ```no_run
/// use std::process::ExitCode;
///
/// use forwardstep::io::scenario::kinds::Kinds;
///
/// fn main() -> ExitCode {
///     let kinds = Kinds::shipped();
///     // kinds.add_robot::<TankFile>()?; kinds.add_law::<LevelFile>()?;
///     forwardstep::program(&kinds)
/// }
/// ```
pub fn program(kinds: &Kinds) -> ExitCode {
    program_with(kinds, std::env::args_os())
}

/// [`program`] with these arguments, the first of which is its name.
pub fn program_with(kinds: &Kinds, arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> ExitCode {
    // A file that may not grow any more is a write that fails, and not the end of the program.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    if let Some(status) = commands::asked(&arguments) {
        return status.into();
    }
    let command = match Arguments::try_parse_from(&arguments) {
        Ok(Arguments { command }) => command.unwrap_or_default(),
        Err(error) => {
            let error = usage::with_tips(error);
            return match console::show_usage(&error, &arguments) {
                Ok(()) => u8::try_from(error.exit_code()).map_or(ExitCode::FAILURE, ExitCode::from),
                Err(error) => unwritten(&error).into(),
            };
        }
    };
    let mut console = Console::new();
    let ended = match command {
        Command::Run(options) => commands::run(&options, kinds, &mut console),
        Command::Report { folder, out, follow: false } => {
            commands::report(&folder, out.as_deref(), kinds, &mut console)
        }
        Command::Report { folder, out, follow: true } => commands::follow(&folder, out.as_deref(), kinds, &mut console),
        Command::Compare(options) => commands::compare(&options, kinds, &mut console),
        Command::Check(options) => commands::check(&options, kinds, &mut console),
        Command::Explain(options) => commands::explain(&options, kinds, &mut console),
        Command::SamplingLimit(options) => commands::sampling_limit(&options, kinds, &mut console),
        Command::Manipulability(options) => commands::manipulability(&options, kinds, &mut console),
        Command::Smoothness(options) => commands::smoothness(&options, kinds, &mut console),
        Command::Falsify(options) => commands::falsify(&options, &mut console),
        Command::Attack(options) => commands::attack(&options, kinds, &mut console),
        Command::Scenarios { name } => Ok(commands::scenarios(name.as_deref(), &mut console)),
        Command::Schema { of } => Ok(commands::schema(of, kinds, &mut console)),
        Command::Upgrade(options) => Ok(commands::upgrade(&options, &mut console)),
        Command::New(options) => commands::new(&options, kinds, &mut console),
        Command::Robot(options) => Ok(commands::robot(&options, &mut console)),
        Command::Man { folder } => Ok(commands::man(folder.as_deref(), &mut console)),
        Command::Completions { shell } => Ok(commands::completions(shell, &mut console)),
    };
    let status = ended.unwrap_or_else(|status| status);
    // Text that could not be written is a failure of its own, but must not hide another.
    match console.finish() {
        Err(error) if status == Status::Fine => unwritten(&error).into(),
        _ => status.into(),
    }
}

/// Says that words could not be written.
fn unwritten(error: &io::Error) -> Status {
    let said = format!("cannot write to the standard output: {error}");
    let help = Some("what the command wrote into files is whole; its words are what is missing");
    console::complain(&console::Plain::with_help(said, help))
}
