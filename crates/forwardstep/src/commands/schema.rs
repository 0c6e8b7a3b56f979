//! `forwardstep schema`

use forwardstep::io::output::summary::Summary;
use forwardstep::io::output::{Comparison, Findings, SmoothnessDocument};
use forwardstep::io::scenario::kinds::Kinds;

use crate::arguments::SchemaChoice;
use crate::console::Console;
use crate::status::Status;

/// Prints a JSON schema.
pub(crate) fn schema(of: SchemaChoice, kinds: &Kinds, console: &mut Console) -> Status {
    let schema = match of {
        SchemaChoice::Scenario => kinds.schema(),
        SchemaChoice::Check => Findings::schema(),
        SchemaChoice::Compare => Comparison::schema(),
        SchemaChoice::Summary => Summary::schema(),
        SchemaChoice::Smoothness => SmoothnessDocument::schema(),
    };
    // The alternate form is indented.
    console.json(format_args!("{:#}", schema.to_value()));
    Status::Fine
}
