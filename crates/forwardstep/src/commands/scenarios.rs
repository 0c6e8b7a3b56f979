//! `forwardstep scenarios`

use forwardstep::io::scenario::{OpenError, SHIPPED_SCENARIOS, open_scenario, shipped_scenario};

use crate::console::{BOLD, Console, complain};
use crate::status::Status;

/// Lists the shipped scenarios with a line each, or prints the text of one.
pub(crate) fn scenarios(name: Option<&str>, console: &mut Console) -> Status {
    match name {
        None => {
            let widest = SHIPPED_SCENARIOS.iter().map(|shipped| shipped.name.len()).max().unwrap_or_default();
            for shipped in SHIPPED_SCENARIOS {
                let title = match open_scenario(shipped.name) {
                    Ok(scenario) => scenario.title,
                    Err(error) => return complain(&error),
                };
                console.line(format_args!("{BOLD}{:widest$}{BOLD:#} {title}", shipped.name));
            }
            Status::Fine
        }
        Some(name) => match shipped_scenario(name.trim_end_matches(".toml")) {
            Some(shipped) => {
                console.verbatim(shipped.text);
                Status::Fine
            }
            None => complain(&OpenError::Unknown { name: name.to_owned() }),
        },
    }
}
