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
//! The function [`check`] checks one environment, registered or not:
//!
//! ```
//! # use gym_core::make;
//! let findings = gym_conform::check(|| make("my_envs/Corridor-v0"));
//! assert_eq!(findings[0].check, "constructs"); // there is no such environment here
//! ```
//!
//! This crate replaces the program's allocator by one that counts, so make it a dev-dependency.
//!
//! The checks do not find some faults. Test them yourself:
//!
//! - a fault in states that neither random nor held actions reach within some 1,500 steps, such as
//!   a refused action, a wrong snapshot, or an entry of `info` that is missing there;
//! - a clock that changes less than once a second, such as the date: an episode is compared after a
//!   pause of a second, and no longer;
//! - a wrapper that truncates early now and then, which some have reason to: only where several
//!   episodes end after one number of steps, and their `TimeLimit` has not been reached, the wrapper
//!   is a finding. A wrapper that begins episodes within a step is seen by the count of a
//!   `TimeLimit`, so not in a stack that has none;
//! - a seed that is cut in a way that neither the compared pairs nor some hundreds of random seeds
//!   show;
//! - an argument that was set without effect: others may follow from it only when the environment is
//!   made;
//! - a list that `restore` fills or cuts: a list of another length may be another state;
//! - a fault that needs two arguments other than the default, an argument that is a text or a list,
//!   or a value other than the one that is tried; an observation that leaves its space with another
//!   float, as unusual physical constants may rightly cause;
//! - a fault of a vector that only many sub-environments or long episodes show: the vector of a
//!   registration is compared with a sync vector of 3 or 11 for some dozens of steps;
//! - an option that is kept over episodes without a seed, if the environment does not lend its
//!   [`generator`](gym_core::Env::generator);
//! - an observation that a refused step has written to: after an error it may be anything;
//! - memory that grows outside of the environment, in a static variable, or only after hundreds of
//!   steps;
//! - the result of a step after the end of an episode, which is unspecified, as in Gymnasium, and
//!   of a step after `close`, which the wrappers of `make` refuse.
//!
//! If an environment is registered as nondeterministic, neither its episodes nor its copies are
//! compared.
//!
//! Each [`Finding`] names the fault, its place, its consequence and the remedy. An environment that
//! must break a rule names the rule and the reason in
//! [`Registration::exceptions`](gym_core::Registration::exceptions).
//!
//! Each rule is one small function. A check names the checks that it depends on, so that one fault
//! gives one finding; one check, `no-panic`, reports all panics. Checks run without the wrappers of
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
mod goals;
mod info;
mod inputs;
mod inspected;
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
mod shown;
mod spaces;
mod subject;
mod suite;
mod threads;
mod turns;
mod variants;
mod variation;
mod vectors;
mod verdict;

pub use checks::{CHECKS, Check};
pub use finding::{Finding, Severity};
pub use matching::{InfoComparison, Matching, environments_match};
pub use report::{Excused, Format, Report, Skipped};
pub use run::{Progress, Slow, check, reports, reports_with};
pub use suite::{assert_conforms, ids_of};
