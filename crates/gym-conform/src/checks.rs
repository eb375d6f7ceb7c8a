//! The list of all checks.

use crate::finding::Severity;
use crate::subject::Subject;
use crate::verdict::{Verdict, broken, skipped};
use crate::{
    actions, allocations, arguments, clock, close, copies, drawing, episodes, goals, info,
    inspected, looking, observations, options, panics, pictures, registered, seeding, shown,
    spaces, threads, vectors,
};

/// A rule, and the function that checks it.
#[derive(Debug)]
pub struct Check {
    /// The name of the check.
    pub name: &'static str,
    /// The severity of a broken rule.
    pub severity: Severity,
    /// The reason for the rule.
    pub why: &'static str,
    /// The remedy for an environment that breaks it.
    pub mend: &'static str,
    /// The checks that must pass before this check runs.
    pub(crate) needs: &'static [&'static str],
    pub(crate) run: fn(&Subject<'_>) -> Verdict,
}

/// Makes a [`Check`] of severity `Error`.
const fn error(
    name: &'static str,
    run: fn(&Subject<'_>) -> Verdict,
    needs: &'static [&'static str],
    why: &'static str,
    mend: &'static str,
) -> Check {
    Check {
        name,
        severity: Severity::Error,
        why,
        mend,
        needs,
        run,
    }
}

/// Makes a [`Check`] of severity `Warning`.
const fn warning(
    name: &'static str,
    run: fn(&Subject<'_>) -> Verdict,
    needs: &'static [&'static str],
    why: &'static str,
    mend: &'static str,
) -> Check {
    Check {
        severity: Severity::Warning,
        ..error(name, run, needs, why, mend)
    }
}

/// The checks that every check of episodes needs.
const EPISODES: [&str; 2] = ["resets", "action-accepted"];
/// The checks that every comparison of episodes needs.
pub(crate) const REPEATABLE: [&str; 2] = ["same-seed-same-episode", "reset-forgets"];

/// Every rule, in the order in which they are checked.
pub const CHECKS: &[Check] = &[
    error(
        "constructs",
        registered::constructs,
        &[],
        "nothing works without it",
        "let `make` succeed with the registered arguments",
    ),
    warning(
        "described",
        registered::described,
        &[],
        "users choose environments from a list",
        "add `.description(\"What the agent has to do.\")` to the registration",
    ),
    warning(
        "versioned",
        registered::versioned,
        &[],
        "results are compared by id, and a task that changes needs a new one",
        "end the id with a version: `my_envs/Corridor-v0`",
    ),
    error(
        "exceptions-known",
        exceptions_known,
        &[],
        "an exception for a check that does not exist excuses nothing",
        "name a check of `conform::CHECKS` in `.exceptions(...)`",
    ),
    error(
        "space-not-empty",
        spaces::not_empty,
        &["constructs"],
        "an empty space has no information, and networks have no layer of size 0",
        "leave the empty member out of the space",
    ),
    warning(
        "space-width",
        spaces::width,
        &["constructs"],
        "a constant number has no information, and normalising it divides by zero",
        "leave the constant element out of the `Box`, or correct its bounds",
    ),
    warning(
        "space-bounded",
        spaces::bounded,
        &["constructs"],
        "agents scale observations by their bounds",
        "give finite bounds to each element of the `Box`, if it has any",
    ),
    warning(
        "action-normalised",
        spaces::action_normalised,
        &["constructs"],
        "most agents for continuous actions output numbers around 0 of size 1",
        "accept actions from -1 to 1, and scale them inside `step`",
    ),
    error(
        "resets",
        seeding::resets,
        &["constructs"],
        "every episode starts with `reset`, and as in Gymnasium a seed is a whole number of any size",
        "let `reset` succeed with each seed and without one: `Generator::new(seed)` accepts all",
    ),
    error(
        "space-constant",
        spaces::constant,
        &["resets"],
        "agents read the spaces once, before they start",
        "return the same spaces before and after `reset` and `step`",
    ),
    error(
        "action-accepted",
        actions::accepted,
        &["resets"],
        "agents act at random from the action space to explore",
        "accept each element of the action space, its corners included, or narrow the space",
    ),
    error(
        "action-validated",
        actions::validated,
        &["resets"],
        "an invalid action must be an error",
        "return Err(Error::InvalidAction { .. }) for actions of another kind, type or shape, and for NaN",
    ),
    error(
        "observation-in-space",
        observations::in_space,
        &EPISODES,
        "agents size their networks and tables by the space",
        "widen the observation space, or bring the observation into its kind, shape and bounds",
    ),
    warning(
        "observation-dtype",
        observations::dtype,
        &EPISODES,
        "buffers are allocated by the space's type, and each observation would be converted",
        "observe arrays of the type that the space names",
    ),
    error(
        "observation-finite",
        observations::finite,
        &EPISODES,
        "one NaN or infinity ruins a training run",
        "keep the state finite, or end the episode before it is not",
    ),
    error(
        "reward-finite",
        observations::reward_finite,
        &EPISODES,
        "one NaN ruins a training run",
        "give a finite number as reward",
    ),
    error(
        "goals-agree",
        goals::agree,
        &EPISODES,
        "hindsight learners compute the rewards of other goals, and mix them with those of steps",
        "give a step the reward and the flags of the goals that it observes: those of `Goals`",
    ),
    error(
        "registration-sound",
        registered::sound,
        &EPISODES,
        "pages, plots and demos use what a registration says",
        "give a finite threshold, a name per action and per number, and a policy whose actions lie in the space",
    ),
    error(
        "info-consistent",
        info::consistent,
        &EPISODES,
        "wrappers and vectors collect entries by name, at any time",
        "visit each entry of `info` once, computed from the state",
    ),
    error(
        "info-constant",
        info::constant,
        &EPISODES,
        "a vector collects each entry in a column of one type, and loggers read it after every step",
        "visit the same entries with the same types after every step, and after every reset",
    ),
    warning(
        "info-without-nan",
        info::no_nan,
        &EPISODES,
        "loggers take means of entries, and one NaN makes NaN of all",
        "leave the entry out where there is nothing to tell, or give a number",
    ),
    error(
        "reset-needed",
        episodes::reset_needed,
        &["constructs"],
        "an agent that forgets to reset must get an error",
        "return Err(Error::ResetNeeded(\"step\")) before the first reset",
    ),
    error(
        "time-limit",
        episodes::time_limit,
        &EPISODES,
        "an episode must last as long as registered, so that returns can be compared",
        "leave `truncated` to the time limit: `.max_episode_steps(n)` in the registration",
    ),
    error(
        "same-seed-same-episode",
        seeding::same_seed,
        &EPISODES,
        "experiments must be repeatable",
        "draw all randomness from one `Generator` seeded by `reset`; keep no state outside the environment",
    ),
    error(
        "options-ignored",
        options::unknown,
        &["same-seed-same-episode"],
        "unknown options are ignored, as in Gymnasium",
        "ignore unknown reset options, or name the known ones with `.reset_options(...)`",
    ),
    error(
        "options-accepted",
        options::accepted,
        &EPISODES,
        "users copy the options that a registration names",
        "name the options of `.reset_options(...)` as `reset` reads them, each with an accepted example",
    ),
    warning(
        "options-in-space",
        options::in_space,
        &["options-accepted", "observation-in-space"],
        "an option must not lead the observations out of their space",
        "refuse values of the option from which an episode cannot start",
    ),
    error(
        "reset-forgets",
        seeding::reset_forgets,
        &["same-seed-same-episode"],
        "an episode must not depend on those before it",
        "set the whole state in `reset`",
    ),
    error(
        "other-seed-other-episode",
        seeding::other_seed,
        &["same-seed-same-episode"],
        "a seed that changes nothing gives the same training data again and again",
        "seed the generator from `reset.seed`",
    ),
    error(
        "reset-carries-on",
        seeding::carries_on,
        &[
            "same-seed-same-episode",
            "other-seed-other-episode",
            "reset-forgets",
        ],
        "agents seed once and then train on many episodes, which must differ",
        "continue the generator if `reset.seed` is None",
    ),
    warning(
        "generator-lent",
        seeding::generator_lent,
        &[
            "same-seed-same-episode",
            "other-seed-other-episode",
            "reset-forgets",
            "reset-carries-on",
        ],
        "wrappers with randomness, such as StickyAction, draw from the environment's generator",
        "return the generator from `Env::generator`, seeded as `reset` says",
    ),
    error(
        "observation-whole",
        observations::whole,
        &REPEATABLE,
        "callers reuse their buffers, and no old number may remain",
        "write every element of the observation in `reset_into` and `step_into`",
    ),
    error(
        "clone-apart",
        copies::clone_apart,
        &REPEATABLE,
        "planners and vectors step clones, and the original must not change",
        "share nothing that changes between clones: no Arc<Mutex<_>>, no Rc<Cell<_>>",
    ),
    error(
        "refusal-changes-nothing",
        actions::refusal,
        &[
            "same-seed-same-episode",
            "reset-forgets",
            "action-validated",
            "clone-apart",
        ],
        "after an error the caller corrects the action and goes on",
        "check the action before anything else in `step`",
    ),
    error(
        "clone-continues",
        copies::clone_continues,
        &["same-seed-same-episode", "reset-forgets", "clone-apart"],
        "planners branch from clones",
        "derive `Clone`, or copy the whole state, generator included",
    ),
    error(
        "snapshot-continues",
        copies::snapshot_continues,
        &["same-seed-same-episode", "reset-forgets", "clone-apart"],
        "checkpoints must resume where they were taken",
        "store the whole state, generator included, and read all of it back",
    ),
    error(
        "snapshot-refused",
        copies::snapshot_refused,
        &[
            "same-seed-same-episode",
            "reset-forgets",
            "snapshot-continues",
            "clone-continues",
        ],
        "a foreign file must not become a wrong state",
        "return Err(Error::Snapshot(..)) for content that `snapshot` does not write, before anything changes",
    ),
    error(
        "snapshot-legal",
        copies::snapshot_legal,
        &[
            "same-seed-same-episode",
            "reset-forgets",
            "snapshot-continues",
            "observation-in-space",
            "reward-finite",
        ],
        "a damaged file must not become a state that no episode reaches",
        "check in `restore` that each field is in its range, and return Err(Error::Snapshot(..)) if not",
    ),
    error(
        "any-thread",
        threads::any_thread,
        &["same-seed-same-episode", "reset-forgets", "clone-continues"],
        "vectors step environments on any thread",
        "use no thread-local state",
    ),
    error(
        "metadata-complete",
        drawing::metadata_complete,
        &["resets"],
        "recorders need the frame rate and size",
        "name each mode once without its `_list` form, with frames per second and a size above 0",
    ),
    warning(
        "frame-rate",
        drawing::frame_rate,
        &["metadata-complete"],
        "no screen shows so many frames",
        "give the steps per second of real time in `Metadata`, at most 240",
    ),
    error(
        "drawing-sound",
        drawing::sound,
        &EPISODES,
        "`draw` must balance push and pop and use finite coordinates",
        "draw something, at finite coordinates, with a `pop` for each `push`",
    ),
    error(
        "drawing-pure",
        drawing::pure,
        &["same-seed-same-episode", "reset-forgets", "clone-continues"],
        "an episode must not depend on rendering",
        "draw only from the state, and change nothing",
    ),
    error(
        "looking-pure",
        looking::pure,
        &[
            "same-seed-same-episode",
            "reset-forgets",
            "clone-continues",
            "snapshot-continues",
            "drawing-pure",
        ],
        "wrappers, vectors and loggers ask at any time for spaces, metadata, info and the generator",
        "compute what is asked for from the state, and change nothing",
    ),
    error(
        "state-shown",
        shown::follows,
        &[
            "same-seed-same-episode",
            "reset-forgets",
            "clone-continues",
            "snapshot-continues",
            "refusal-changes-nothing",
            "info-consistent",
            "drawing-pure",
            "looking-pure",
        ],
        "planners, recorders and loggers look at an environment after `reset`, `restore` and `clone`",
        "compute info, text and drawing from the state that `reset` sets and `snapshot` stores",
    ),
    error(
        "inspect-checked",
        inspected::checked,
        &["resets", "observation-in-space", "reward-finite"],
        "programs change the state and the arguments by name, and a mistake must be an error",
        "check the value in `set_state` and `set_argument` before anything changes, and then show it",
    ),
    error(
        "render-modes",
        drawing::render_modes,
        &["resets", "metadata-complete", "drawing-sound"],
        "a declared mode must work",
        "implement `draw` for the modes human and rgb_array and `ansi` for ansi, or do not declare them",
    ),
    error(
        "drawing-visible",
        pictures::visible,
        &["render-modes"],
        "a frame of one colour shows nothing",
        "draw within the canvas, from (0, 0) to `render_size`, in a colour other than the background",
    ),
    error(
        "drawing-follows",
        pictures::follows,
        &["render-modes", "drawing-visible"],
        "a frame that never changes does not show the state",
        "draw what the observation contains",
    ),
    error(
        "arguments-refused",
        arguments::refused,
        &["constructs"],
        "accepting an argument of the wrong type hides a mistake",
        "give the argument its type",
    ),
    error(
        "arguments-matter",
        arguments::matter,
        &[
            "arguments-refused",
            "same-seed-same-episode",
            "reset-forgets",
        ],
        "an experiment with an ignored argument compares nothing",
        "use the argument, or remove it",
    ),
    error(
        "options-matter",
        options::matter,
        &[
            "options-accepted",
            "same-seed-same-episode",
            "reset-forgets",
        ],
        "an ignored option gives another start than requested",
        "use the option in `reset`, or remove it from `.reset_options(...)`",
    ),
    error(
        "no-allocation",
        allocations::none,
        &EPISODES,
        "a step takes nanoseconds, and an allocation as long again",
        "keep buffers in the environment, or give the reason in `.exceptions(&[(\"no-allocation\", \"...\")])`",
    ),
    error(
        "close-harmless",
        close::harmless,
        &[
            "same-seed-same-episode",
            "reset-forgets",
            "clone-apart",
            "reset-needed",
        ],
        "programs close environments twice, by hand and when they end, and others go on",
        "free in `close` only what is the environment's own, and remember that it was freed",
    ),
    error(
        "clock-unread",
        clock::unread,
        &[
            "same-seed-same-episode",
            "reset-forgets",
            "clone-continues",
            "close-harmless",
        ],
        "an episode must not depend on the speed of the machine, nor on the time of day",
        "count steps in place of seconds",
    ),
    error(
        "vector-equal",
        vectors::equal,
        &[
            "same-seed-same-episode",
            "reset-forgets",
            "clone-continues",
            "snapshot-continues",
        ],
        "users get the vector of the registration wherever they ask for many environments",
        "let the vector of `.vector_entry_point(...)` reset, step and store as its environments do",
    ),
    error(
        "no-panic",
        panics::none,
        &["constructs"],
        "a panic ends the whole training run",
        "return an Err for bad input; index and convert with care",
    ),
];

/// Checks that each exception of a registration names a check of [`CHECKS`] or an argument.
fn exceptions_known(subject: &Subject<'_>) -> Verdict {
    let Some(registration) = &subject.registration else {
        return skipped("it is not registered");
    };
    let is_argument = |name: &str| {
        subject
            .arguments()
            .is_some_and(|(_, kwargs)| kwargs.contains_key(name))
    };
    let is_known = |name: &str| match name.split_once('.') {
        Some((check, name)) => check == "arguments-matter" && is_argument(name),
        None => CHECKS.iter().any(|check| check.name == name),
    };
    match registration
        .exceptions
        .iter()
        .find(|(name, _)| !is_known(name))
    {
        Some((name, _)) => broken(format!(
            "`{}` has an exception for `{name}`",
            registration.id()
        )),
        None => Ok(()),
    }
}
