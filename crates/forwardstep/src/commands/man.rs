//! `forwardstep man`

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use clap::{Command, CommandFactory};
use clap_mangen::Man;

use super::replace;
use crate::arguments::Arguments;
use crate::console::{Console, Plain, complain};
use crate::status::Status;

/// Where a page says whose it is, which is near its top.
const HEADING: &str = "\n.TH forwardstep";
const HEAD_BYTES: u64 = 400;

/// Prints the manual page of the program, or writes the pages of all commands to `folder`.
pub(crate) fn man(folder: Option<&Path>, console: &mut Console) -> Status {
    let command = Arguments::command();
    let Some(folder) = folder else {
        // Into memory first: a closed pipe is the console's business.
        return match page(&Man::new(command)) {
            Ok(page) => {
                console.verbatim(page);
                Status::Fine
            }
            Err(error) => complain(&error),
        };
    };
    match write_all(command, folder) {
        Ok(()) => Status::Fine,
        Err(error) => complain(&error),
    }
}

/// All pages or none where that is known before: none may take the place of what somebody else wrote.
fn write_all(command: Command, folder: &Path) -> Result<(), Plain<String>> {
    let mut command = command.disable_help_subcommand(true);
    command.build();
    let mut pages = Vec::new();
    collect(&command, &mut pages)?;
    for (name, _) in &pages {
        replace::may_replace(&folder.join(name), is_page)?;
    }
    pages.iter().try_for_each(|(name, page)| replace::write(&folder.join(name), page))
}

fn collect(command: &Command, pages: &mut Vec<(String, String)>) -> Result<(), Plain<String>> {
    for below in command.get_subcommands().filter(|below| !below.is_hide_set()) {
        collect(below, pages)?;
    }
    let man = Man::new(command.clone());
    pages.push((man.get_filename(), page(&man)?));
    Ok(())
}

fn page(man: &Man) -> Result<String, Plain<String>> {
    let mut page = Vec::new();
    man.render(&mut page).map_err(|error| Plain::new(error.to_string()))?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}

/// Whether this program wrote it.
fn is_page(file: BufReader<File>) -> bool {
    let mut head = Vec::new();
    file.take(HEAD_BYTES).read_to_end(&mut head).is_ok() && String::from_utf8_lossy(&head).contains(HEADING)
}
