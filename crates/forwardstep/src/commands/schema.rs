//! `forwardstep schema`

use forwardstep::io::scenario::kinds::Kinds;

use crate::console::Console;
use crate::status::Status;

/// Prints the JSON schema of scenario files.
pub(crate) fn schema(kinds: &Kinds, console: &mut Console) -> Status {
    // The alternate form is indented.
    console.line(format_args!("{:#}", kinds.schema().to_value()));
    Status::Fine
}
