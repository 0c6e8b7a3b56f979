//! `forwardstep man`

use std::io;
use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap_mangen::{Man, generate_to};
use forwardstep::io::shown;
use thiserror::Error;

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
        Err(source) => {
            let error = NoPages { folder: folder.to_owned(), source };
            complain(&Plain::with_help(error, Some("the folder must exist, and files must fit into it")))
        }
    }
}

#[derive(Debug, Error)]
#[error("cannot write manual pages into `{}`: {source}", shown(folder))]
struct NoPages {
    folder: PathBuf,
    source: io::Error,
}
