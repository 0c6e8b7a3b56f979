//! Scenario and URDF files in, tables, plots and reports out.
//!
//! Text comes in here and leaves as the plain structs of the rooms below; serialisation lives in this crate only.

pub mod diagnostic;
mod files;
mod foreign;
mod meant;
#[cfg(feature = "report")]
pub mod output;
pub mod robot;
pub mod scenario;
#[cfg(feature = "report")]
pub mod shapes;
mod shown;
pub mod urdf;
mod wording;

pub use diagnostic::{InputError, Problem, SourceText};
pub use files::{ReadError, Special};
pub use foreign::Foreign;
pub use meant::Meant;
pub use shown::{Shown, breaks_lines, is_invisible, one_line, shown, steers_terminals};
pub use urdf::{UrdfOptions, UrdfRobot, read_urdf};
pub use wording::{choose, for_shell, instant, unbroken};
