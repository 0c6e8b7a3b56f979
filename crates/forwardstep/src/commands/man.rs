//! `forwardstep man`

use std::path::Path;

use clap::CommandFactory;
use clap_mangen::{Man, generate_to};

use crate::arguments::Arguments;
use crate::console::{Console, Plain, complain};
use crate::status::Status;

/// Prints the manual page of the program, or writes the pages of all commands to `folder`.
pub(crate) fn man(folder: Option<&Path>, console: &mut Console) -> Status {
    let command = Arguments::command();
    let Some(folder) = folder else {
        // Into memory first: a closed pipe is the console's business.
        let mut page = Vec::new();
        return match Man::new(command).render(&mut page) {
            Ok(()) => {
                console.verbatim(String::from_utf8_lossy(&page));
                Status::Fine
            }
            Err(error) => complain(&Plain::new(error)),
        };
    };
    match generate_to(command, folder) {
        Ok(()) => Status::Fine,
        Err(error) => complain(&Plain::with_help(error, Some("the folder must exist, and files must fit into it"))),
    }
}
