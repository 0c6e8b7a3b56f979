//! One file per command.

mod check;
mod progress;
mod promise;
mod run;
mod scenarios;
mod schema;
mod summary;

pub(crate) use check::check;
pub(crate) use run::run;
pub(crate) use scenarios::scenarios;
pub(crate) use schema::schema;
