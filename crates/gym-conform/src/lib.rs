//! The rules of [`Env`](gym_core::Env) as checks that run against any environment: Gymnasium's
//! `check_env`, its passive checker and `check_environments_match`, and more that Rust allows.
//!
//! A plugin's tests run all checks over all of its environments in one line (see [`suite!`]),
//! `cargo xtask conform` over the environments of a workspace.
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
//!
//! Each rule is one small function. A check names the checks that it depends on, so that one fault
//! gives one finding; a panic is the finding of one check. Checks run without the wrappers of
//! `make`, which would hide faults.

mod actions;
mod allocations;
mod arguments;
mod calls;
mod checks;
mod clock;
mod close;
mod copies;
mod damage;
mod damaged;
mod drawing;
mod episodes;
mod finding;
mod info;
mod inputs;
mod long;
mod look;
mod looking;
mod matching;
mod observations;
mod options;
mod panics;
mod pictures;
mod registered;
mod report;
mod run;
mod seeding;
mod spaces;
mod subject;
mod suite;
mod threads;
mod variation;
mod verdict;

pub use checks::{CHECKS, Check};
pub use finding::{Finding, Severity};
pub use matching::{InfoComparison, Matching, environments_match};
pub use report::{Excused, Format, Report, Skipped};
pub use run::{Progress, Slow, check, reports, reports_with};
pub use suite::{assert_conforms, ids_of};
