//! The rules of [`Env`](gym_core::Env) as checks that run against any environment: Gymnasium's
//! `check_env`, its passive checker and `check_environments_match`, and more that Rust allows.
//!
//! A plugin's tests run all checks over all of its environments in one line (see [`suite!`]),
//! `cargo xtask conform` over everything that is linked, or over a crate on disk.
//!
//! ```
//! # use gym_conform as my_envs;
//! gym_conform::suite!(my_envs);
//! ```
//!
//! One environment, registered or not, is checked by a function:
//!
//! ```
//! # use gym_core::make;
//! let findings = gym_conform::check(|| make("my_envs/Corridor-v0"));
//! assert_eq!(findings[0].check, "constructs"); // there is no such environment here
//! ```
//!
//! This crate replaces the program's allocator by one that counts, so make it a dev-dependency.
//! Without the feature `checks` it has only recorded episodes, the module [`trace`], and does not
//! replace the allocator.
//!
//! Some faults no check sees, and a test of your own should: an action that is refused in states
//! that neither random nor held actions lead to; a clock that is read, as all checks of an
//! environment take moments; a step that begins the next episode by itself, which looks like a
//! jump; a wrapper that truncates early, which some have reason to; an observation that a refused
//! step has written to, as after an error it may be anything; memory that grows outside of the
//! environment, in a static variable, or only after hundreds of steps. Where an environment says
//! that it is nondeterministic, episodes are not compared, nor its copies. Without a registration,
//! the limit of a stack is known where a `TimeLimit` is around a `BoxEnv`. The result of a step
//! after the end of an episode is unspecified, as in Gymnasium.
//!
//! Each [`Finding`] names the fault, its place, its consequence and the remedy. An environment that
//! must break a rule says so, with the reason, in
//! [`Registration::exceptions`](gym_core::Registration::exceptions).

#[cfg(feature = "checks")]
mod actions;
#[cfg(feature = "checks")]
mod allocations;
#[cfg(feature = "checks")]
mod arguments;
#[cfg(feature = "checks")]
mod calls;
#[cfg(feature = "checks")]
mod checks;
#[cfg(feature = "checks")]
mod clock;
#[cfg(feature = "checks")]
mod close;
#[cfg(feature = "checks")]
mod copies;
#[cfg(feature = "checks")]
mod damage;
#[cfg(feature = "checks")]
mod damaged;
#[cfg(feature = "checks")]
mod drawing;
#[cfg(feature = "checks")]
mod episodes;
#[cfg(feature = "checks")]
mod finding;
#[cfg(feature = "checks")]
mod info;
#[cfg(feature = "checks")]
mod inputs;
#[cfg(feature = "checks")]
mod long;
#[cfg(feature = "checks")]
mod look;
#[cfg(feature = "checks")]
mod looking;
#[cfg(feature = "checks")]
mod matching;
#[cfg(feature = "checks")]
mod observations;
#[cfg(feature = "checks")]
mod options;
#[cfg(feature = "checks")]
mod panics;
#[cfg(feature = "checks")]
mod pictures;
#[cfg(feature = "checks")]
mod registered;
#[cfg(feature = "checks")]
mod report;
#[cfg(feature = "checks")]
mod run;
#[cfg(feature = "checks")]
mod seeding;
#[cfg(feature = "checks")]
mod spaces;
#[cfg(feature = "checks")]
mod subject;
#[cfg(feature = "checks")]
mod suite;
#[cfg(feature = "checks")]
mod threads;
#[cfg(feature = "checks")]
mod variation;
#[cfg(feature = "checks")]
mod verdict;

pub mod trace;

#[cfg(feature = "checks")]
pub use checks::{CHECKS, Check};
#[cfg(feature = "checks")]
pub use finding::{Finding, Severity};
#[cfg(feature = "checks")]
pub use matching::{InfoComparison, Matching, environments_match};
#[cfg(feature = "checks")]
pub use report::{Excused, Format, Report, Skipped};
#[cfg(feature = "checks")]
pub use run::{Progress, Slow, check, reports, reports_with};
#[cfg(feature = "checks")]
pub use suite::{assert_conforms, ids_of};
