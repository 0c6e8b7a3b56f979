//! The command that stands: what the last step gave, or what is safe.

use alloc::vec;
use alloc::vec::Vec;

use super::recipe::SafeCommand;

/// A command and what replaces it when a step fails.
#[derive(Clone, Debug)]
pub(super) struct Standing {
    safe: SafeCommand,
    command: Vec<f64>,
}

impl Standing {
    /// For `inputs` numbers; the recipe has checked the safe ones.
    pub(super) fn new(safe: SafeCommand, inputs: usize) -> Self {
        let mut standing = Standing { safe, command: vec![0.0; inputs] };
        standing.fail();
        standing
    }

    /// What stands.
    pub(super) fn command(&self) -> &[f64] {
        &self.command
    }

    /// A step gave `command`.
    pub(super) fn take(&mut self, command: &[f64]) {
        self.command.copy_from_slice(command);
    }

    /// A step failed.
    pub(super) fn fail(&mut self) {
        match &self.safe {
            SafeCommand::HoldLast => {}
            SafeCommand::Zero => self.command.fill(0.0),
            SafeCommand::Values(values) => self.command.copy_from_slice(values),
        }
    }
}
