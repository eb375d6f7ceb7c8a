//! The rules of [`Env`](gym_core::Env) as checks that run against any environment: Gymnasium's `check_env`, its passive
//! checker and `check_environments_match`, and what Rust allows beyond them.
//!
//! A plugin's tests run all checks over all of its environments in one line (see [`suite!`]), `cargo xtask
//! conform` over everything that is linked, or over a crate on disk.
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
//! Whoever links this crate counts allocations: it replaces the program's allocator by one that counts, so it belongs
//! among the `[dev-dependencies]`.
//!
//! Each [`Finding`] says what is wrong and where, why it matters, and how to mend it. An environment that must
//! break a rule says so, with the reason, in [`Registration::exceptions`](gym_core::Registration::exceptions).

mod actions;
mod allocations;
mod arguments;
mod checks;
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
pub use run::{check, reports, reports_with};
pub use suite::{assert_conforms, ids_of};
