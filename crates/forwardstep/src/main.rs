//! The program `forwardstep`.

mod arguments;
mod commands;
mod console;
mod status;

use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
use console::Console;
use status::Status;

fn main() -> ExitCode {
    let Arguments { command } = Arguments::parse();
    let mut console = Console::new();
    let status = match command.unwrap_or_default() {
        Command::Run(options) => commands::run(&options, &mut console),
        Command::Report { folder } => commands::report(&folder, &mut console),
        Command::Check { scenario } => commands::check(&scenario, &mut console),
        Command::Scenarios { name } => commands::scenarios(name.as_deref(), &mut console),
        Command::Schema => commands::schema(&mut console),
        Command::New(options) => commands::new(&options, &mut console),
        Command::Robot(options) => commands::robot(&options, &mut console),
        Command::Completions { shell } => commands::completions(shell, &mut console),
    };
    // Text that could not be written is a failure of its own, but must not hide another.
    match console.finish() {
        Err(error) if status == Status::Fine => console::complain(&console::Plain::new(error)).into(),
        _ => status.into(),
    }
}
