//! What the theorems promise for a given network, with certificates and witnesses, and what can be predicted before a run.
//!
//! Never "proved" outside the theorems: a hypothesis *holds* for all time, holds *on the horizon*, is *watched* during the
//! run, is *not shown*, is *not covered by the paper*, or is *violated* with a witness.
//!
//! The layers, each of which uses only those before it: [`hypothesis`], with its evidence and its words, and [`Theorem`];
//! what is found about graphs, links and the loop; a file for each kind of system; a file for each theorem.

mod agreement;
pub mod certificate;
mod conserved;
pub mod derivation;
mod finite;
mod fixed;
mod footing;
mod graphs;
pub mod hypothesis;
mod inertia;
mod instance;
mod kinds;
mod late_leader;
mod laws;
mod links;
pub mod manipulability;
mod manipulation;
mod null_vector;
mod practical;
pub mod prediction;
mod reach;
mod report;
mod shifted_laplacian;
pub mod smoothness;
mod source;
mod surroundings;
mod theorem;
mod theorems;

pub use agreement::{NoPrediction, Prediction, predict};
pub use certificate::certify;
pub use fixed::NotFixed;
pub use footing::{Footing, Ground};
pub use hypothesis::{Answer, Evidence, Hypothesis, Id, Rigour};
pub use practical::{
    AgreementBound, Along, AxisBound, ClippedCommands, FastestDamping, Finding, Hold, Injection, InjectionBalance,
    InjectionCourse, InjectionWatch, LoadReached, LoopAlong, LoopAt, LoopRate, MarginAt, MarginReached, NAMED_SHARE,
    NoReferenceGains, Over, PowerBound, PowerReached, Practical, PracticalAnswer, RECOMMENDED_MARGIN, ReferenceGains,
    SamplingMargin, StaticLoad, Swing, Trial, WholeLoop, along, fastest_damping, mean_power_w, practical,
};
pub use prediction::{Course, NoCourse, NoIdeal, course, ideal};
pub use report::Report;
pub use source::Source;
pub use theorem::{Extension, Theorem};
pub use theorems::check;
