//! The rules of [`Env`] as checks that run against any environment: Gymnasium's `check_env`, its passive
//! checker and `check_environments_match`, and what Rust allows beyond them.
//!
//! A plugin's tests run all checks over all of its environments in one line (see [`suite!`]), `cargo xtask
//! conform` over everything that is linked, or over a crate on disk.
//!
//! ```text
//! gym_core::conform::suite!(my_envs);
//! ```
//!
//! One environment, registered or not, is checked by a function:
//!
//! ```
//! # use gym_core::{conform, make};
//! let findings = conform::check(|| make("my_envs/Corridor-v0"));
//! assert_eq!(findings[0].check, "constructs"); // there is no such environment here
//! ```
//!
//! Each [`Finding`] says what is wrong and where, why it matters, and how to mend it. An environment that must
//! break a rule says so, with the reason, in [`Registration::exceptions`](crate::Registration::exceptions).

mod actions;
mod allocations;
mod arguments;
mod copies;
mod drawing;
mod episodes;
mod info;
mod long;
mod matching;
mod observations;
mod panics;
mod registered;
mod report;
mod seeding;
mod spaces;
mod subject;
mod threads;

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::Serialize;

use crate::{BoxEnv, Env, EnvSpec, Error, Result};

pub use crate::__conform_suite as suite;
pub use matching::{InfoComparison, Matching, environments_match};
pub use registered::{assert_conforms, ids_of, reports, reports_with};
pub use report::{Excused, Format, Report, Skipped};
use subject::{SEEDS, Subject};

/// How bad a broken rule is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Something that users rely on does not hold.
    Error,
    /// It works, and is harder to use than it has to be.
    Warning,
}

/// A broken rule.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The name of the check, one of [`CHECKS`].
    pub check: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// What was seen, and where.
    pub message: String,
    /// Why it matters.
    pub why: &'static str,
    /// How to mend it.
    pub mend: &'static str,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        writeln!(f, "{severity}: {}: {}", self.check, self.message)?;
        writeln!(f, "  why: {}", self.why)?;
        write!(f, "  mend: {}", self.mend)
    }
}

/// One rule.
#[derive(Debug)]
pub struct Check {
    /// A short name.
    pub name: &'static str,
    /// How bad it is to break it.
    pub severity: Severity,
    /// Why it matters to those who use the environment.
    pub why: &'static str,
    /// How to mend an environment that breaks it.
    pub mend: &'static str,
    /// The checks without which this one means nothing.
    needs: &'static [&'static str],
    run: fn(&Subject<'_>) -> Verdict,
}

/// What a check found.
type Verdict<T = ()> = std::result::Result<T, Trouble>;

/// Why a check did not pass.
enum Trouble {
    /// The rule is broken: what was seen, and where.
    Broken(String),
    /// There was nothing to check, or nothing to check it with.
    Skipped(String),
    /// A call failed that another check is about.
    Error(Error),
}

impl From<Error> for Trouble {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

fn broken<T>(message: impl Into<String>) -> Verdict<T> {
    Err(Trouble::Broken(message.into()))
}

fn skipped<T>(reason: impl Into<String>) -> Verdict<T> {
    Err(Trouble::Skipped(reason.into()))
}

/// A [`Check`] of severity `Error`.
macro_rules! error {
    ($name:literal, $run:path, $needs:expr, $why:literal, $mend:literal $(,)?) => {
        Check { name: $name, severity: Severity::Error, why: $why, mend: $mend, needs: &$needs, run: $run }
    };
}

/// A [`Check`] of severity `Warning`.
macro_rules! warning {
    ($name:literal, $run:path, $needs:expr, $why:literal, $mend:literal $(,)?) => {
        Check { name: $name, severity: Severity::Warning, why: $why, mend: $mend, needs: &$needs, run: $run }
    };
}

/// What an episode rests on.
const EPISODES: [&str; 2] = ["resets", "action-accepted"];
/// What a comparison of episodes rests on.
const REPEATABLE: [&str; 2] = ["same-seed-same-episode", "reset-forgets"];

/// Every rule, in the order in which they are checked.
pub const CHECKS: &[Check] = &[
    error!(
        "constructs",
        registered::constructs,
        [],
        "nothing works without it",
        "let `make` succeed with the arguments it is registered with",
    ),
    warning!(
        "described",
        registered::described,
        [],
        "people choose environments from a list",
        "add `.description(\"What the agent has to do.\")` to the registration",
    ),
    warning!(
        "versioned",
        registered::versioned,
        [],
        "results are compared by id, and a task that changes needs a new one",
        "end the id with a version: `my_envs/Corridor-v0`",
    ),
    error!(
        "exceptions-known",
        registered::exceptions_known,
        [],
        "an exception for a check that does not exist excuses nothing",
        "name a check of `conform::CHECKS` in `.exceptions(...)`",
    ),
    error!(
        "space-not-empty",
        spaces::not_empty,
        ["constructs"],
        "a space without room holds no information, and networks have no layer of size 0",
        "leave the empty member out of the space",
    ),
    warning!(
        "space-width",
        spaces::width,
        ["constructs"],
        "a number that never changes tells an agent nothing, and normalising it divides by zero",
        "leave the constant element out of the `Box`, or correct its bounds",
    ),
    warning!(
        "space-bounded",
        spaces::bounded,
        ["constructs"],
        "agents scale what they see by its bounds",
        "give finite bounds to each element of the `Box`, if it has any",
    ),
    warning!(
        "action-normalised",
        spaces::action_normalised,
        ["constructs"],
        "most agents for continuous actions put out numbers around 0 of size 1",
        "take actions from -1 to 1, and scale them inside `step`",
    ),
    error!(
        "resets",
        seeding::resets,
        ["constructs"],
        "every episode starts with it, and as in Gymnasium a seed is a whole number of any size",
        "let `reset` succeed with each seed and without one: `Generator::new(seed)` takes all",
    ),
    error!(
        "space-constant",
        spaces::constant,
        ["resets"],
        "agents look at the spaces once, before they start",
        "return the same spaces before and after `reset` and `step`",
    ),
    error!(
        "action-accepted",
        actions::accepted,
        ["resets"],
        "agents act at random from the action space to explore",
        "accept each element of the action space, its corners included, or narrow the space",
    ),
    error!(
        "action-validated",
        actions::validated,
        ["resets"],
        "an invalid action must be an error, not a guess",
        "return Err(Error::InvalidAction { .. }) for actions of another kind, type or shape, and for NaN",
    ),
    error!(
        "observation-in-space",
        observations::in_space,
        EPISODES,
        "agents size their networks and tables by the space",
        "widen the observation space, or bring the observation into its kind, shape and bounds",
    ),
    warning!(
        "observation-dtype",
        observations::dtype,
        EPISODES,
        "buffers are allocated by the space's type, and each observation would be converted",
        "observe arrays of the type that the space names",
    ),
    error!(
        "observation-finite",
        observations::finite,
        EPISODES,
        "one NaN or infinity ruins a training run",
        "keep the state finite, or end the episode before it is not",
    ),
    error!(
        "reward-finite",
        observations::reward_finite,
        EPISODES,
        "one NaN ruins a training run",
        "give a finite number as reward",
    ),
    error!(
        "info-consistent",
        info::consistent,
        EPISODES,
        "wrappers and vectors gather entries by name, whenever they ask",
        "show each entry of `info` once, from the state alone",
    ),
    error!(
        "reset-needed",
        episodes::reset_needed,
        ["constructs"],
        "an agent that forgets to reset must be told, not trained on nonsense",
        "return Err(Error::ResetNeeded(\"step\")) before the first reset",
    ),
    error!(
        "time-limit",
        episodes::time_limit,
        EPISODES,
        "an episode must last as long as is registered, so that returns can be compared",
        "leave `truncated` to the time limit: `.max_episode_steps(n)` in the registration",
    ),
    error!(
        "same-seed-same-episode",
        seeding::same_seed,
        EPISODES,
        "experiments must be repeatable",
        "draw all randomness from one `Generator` seeded by `reset`; keep no state outside the environment",
    ),
    error!(
        "options-ignored",
        episodes::options_ignored,
        ["same-seed-same-episode"],
        "options are for those environments that know them, as in Gymnasium",
        "ignore reset options of names that are not known",
    ),
    error!(
        "reset-forgets",
        seeding::reset_forgets,
        ["same-seed-same-episode"],
        "an episode must not depend on those before it",
        "set the whole state in `reset`",
    ),
    error!(
        "other-seed-other-episode",
        seeding::other_seed,
        ["same-seed-same-episode"],
        "a seed that changes nothing gives the same training data again and again",
        "seed the generator from `reset.seed`",
    ),
    error!(
        "reset-carries-on",
        seeding::carries_on,
        ["same-seed-same-episode", "other-seed-other-episode", "reset-forgets"],
        "agents seed once and then train on many episodes, which must differ",
        "carry the generator on where `reset.seed` is None",
    ),
    warning!(
        "generator-lent",
        seeding::generator_lent,
        ["same-seed-same-episode", "other-seed-other-episode", "reset-forgets"],
        "wrappers with randomness, such as StickyAction, draw from the environment's generator",
        "return the generator from `Env::generator`, seeded as `reset` says",
    ),
    error!(
        "observation-whole",
        observations::whole,
        REPEATABLE,
        "callers reuse their buffers, and old numbers must not shine through",
        "write every element of the observation in `reset_into` and `step_into`",
    ),
    error!(
        "refusal-changes-nothing",
        actions::refusal,
        ["same-seed-same-episode", "reset-forgets", "action-validated"],
        "after an error the caller corrects the action and goes on",
        "check the action before anything else in `step`",
    ),
    error!(
        "clone-apart",
        copies::clone_apart,
        REPEATABLE,
        "planners and vectors step clones, and the original must not notice",
        "share nothing that changes between clones: no Arc<Mutex<_>>, no Rc<Cell<_>>",
    ),
    error!(
        "clone-continues",
        copies::clone_continues,
        ["same-seed-same-episode", "reset-forgets", "clone-apart"],
        "planners branch from clones",
        "derive `Clone`, or copy the whole state, generator included",
    ),
    error!(
        "snapshot-continues",
        copies::snapshot_continues,
        ["same-seed-same-episode", "reset-forgets", "clone-apart"],
        "checkpoints must resume where they were taken",
        "store the whole state, generator included, and read all of it back",
    ),
    error!(
        "snapshot-refused",
        copies::snapshot_refused,
        ["same-seed-same-episode", "reset-forgets", "snapshot-continues", "clone-continues"],
        "a file from somewhere else must not become a state that nobody meant",
        "return Err(Error::Snapshot(..)) for what `snapshot` cannot have written, before anything changes",
    ),
    error!(
        "any-thread",
        threads::any_thread,
        ["same-seed-same-episode", "reset-forgets", "clone-continues"],
        "vectors step environments on whichever thread is free",
        "use no thread-local state",
    ),
    error!(
        "metadata-complete",
        drawing::metadata_complete,
        ["resets"],
        "recorders need to know how fast and how large",
        "name each mode once without its `_list` form, with frames per second and a size above 0",
    ),
    warning!(
        "frame-rate",
        drawing::frame_rate,
        ["metadata-complete"],
        "no screen shows so many frames, and recordings are played as slowly as players can",
        "give the steps per second of real time in `Metadata`, at most 240",
    ),
    error!(
        "drawing-sound",
        drawing::sound,
        EPISODES,
        "whoever draws after it must find the canvas as it was, and NaN has no place on it",
        "draw something, at finite coordinates, with a `pop` for each `push`",
    ),
    error!(
        "drawing-pure",
        drawing::pure,
        ["same-seed-same-episode", "reset-forgets", "clone-continues"],
        "an episode must not depend on whether somebody watches",
        "draw from the state alone, and change nothing",
    ),
    error!(
        "render-modes",
        drawing::render_modes,
        ["resets", "metadata-complete", "drawing-sound"],
        "a mode that is named has to work",
        "implement `draw` for the modes human and rgb_array and `ansi` for ansi, or do not name them",
    ),
    error!(
        "arguments-round-trip",
        arguments::round_trip,
        REPEATABLE,
        "a spec stored with its arguments must rebuild the same environment",
        "let the `Config` read what it writes: the same names and values in Serialize and Deserialize",
    ),
    error!(
        "arguments-refused",
        arguments::refused,
        ["constructs", "arguments-round-trip"],
        "a misspelt argument that is ignored costs a day of training",
        "put #[serde(default, deny_unknown_fields)] on the `Config`",
    ),
    error!(
        "no-allocation",
        allocations::none,
        EPISODES,
        "a step takes nanoseconds, and an allocation takes as long again",
        "keep buffers in the environment, or give the reason in `.exceptions(&[(\"no-allocation\", \"...\")])`",
    ),
    error!(
        "no-panic",
        panics::none,
        ["constructs"],
        "a panic takes the whole training run with it",
        "return an Err for what cannot be done; index and convert with care",
    ),
];

/// Runs every check against the environments that `make` makes. No finding means that it conforms.
///
/// What [`make`](crate::make) gives is checked without `OrderEnforcing` and `PassiveEnvChecker`, which would hide what
/// the environment itself does. All others are checked as they come.
pub fn check(make: impl Fn() -> Result<BoxEnv>) -> Vec<Finding> {
    match bare(&make) {
        Some(spec) => run(&Subject::of_spec(&|| spec.make(), spec.clone())).0,
        None => run(&Subject::new(&make)).0,
    }
}

/// How to make an environment without what hides its faults, if its spec makes just what `make` does.
fn bare(make: &dyn Fn() -> Result<BoxEnv>) -> Option<EnvSpec> {
    // a panic shows again, and is told, when the first check makes an environment
    let stacks = catch_unwind(AssertUnwindSafe(|| {
        let made = make().ok()?;
        let spec = made.spec()?;
        let again = spec.make().ok()?;
        (made.describe() == again.describe()).then_some(spec)
    }));
    stacks.ok().flatten().map(|spec| registered::bare(&spec))
}

/// The findings, and what was not checked for which reason.
fn run(subject: &Subject<'_>) -> (Vec<Finding>, Vec<Skipped>) {
    let (mut findings, mut skipped, mut passed) = (Vec::new(), Vec::new(), Vec::new());
    let (mut errors, mut panics) = (Vec::new(), Vec::new());
    let finding = |check: &Check, message: String| {
        let Check { name, severity, why, mend, .. } = *check;
        Finding { check: name, severity, message, why, mend }
    };
    for check in CHECKS {
        if let Some(needed) = check.needs.iter().find(|needed| !passed.contains(*needed)) {
            skipped.push(Skipped { check: check.name, reason: format!("it rests on {needed}") });
            continue;
        }
        let panicked = match catch_unwind(AssertUnwindSafe(|| (check.run)(subject))) {
            Ok(verdict) => match verdict {
                Ok(()) => {
                    passed.push(check.name);
                    continue;
                }
                Err(Trouble::Broken(message)) => {
                    findings.push(finding(check, message));
                    continue;
                }
                Err(Trouble::Skipped(reason)) => {
                    // what has nothing to say stands in nobody's way
                    passed.push(check.name);
                    skipped.push(Skipped { check: check.name, reason });
                    continue;
                }
                Err(Trouble::Error(error)) => {
                    errors.push((check, error));
                    continue;
                }
            },
            Err(payload) => panics::message(&*payload),
        };
        panics.push((check, panicked));
    }
    // A panic anywhere breaks one and the same rule.
    if let (Some((check, panicked)), Some(no_panic)) = (panics.first(), CHECKS.last())
        && findings.iter().all(|finding| finding.check != no_panic.name)
    {
        findings.push(finding(no_panic, format!("during {}: {panicked}", check.name)));
    }
    // A call that fails is told by the check that is about it; where none is, it is told here.
    let is_explained = findings.iter().any(|finding| finding.severity == Severity::Error);
    for (check, error) in errors {
        if is_explained {
            skipped.push(Skipped { check: check.name, reason: error.to_string() });
        } else {
            findings.push(finding(check, format!("it cannot be checked: {error}")));
        }
    }
    (findings, skipped)
}
