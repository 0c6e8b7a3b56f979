//! `forwardstep schema`

use crate::console::Console;
use crate::status::Status;

/// Prints the JSON schema of scenario files.
pub(crate) fn schema(console: &mut Console) -> Status {
    // The alternate form is indented.
    console.line(format_args!("{:#}", forwardstep::io::scenario::schema().to_value()));
    Status::Fine
}
