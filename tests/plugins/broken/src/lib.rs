//! One deliberately faulty environment for each check of gym-conform, named after it:
//! `broken/reward-finite-v0` breaks the rule `reward-finite` and no other, and
//! `broken/reward-finite.late-v0` breaks the same rule in another way.
//!
//! All are the same [`Walk`] with one [`Fault`] or one twist. `broken/none-v0` has none.

mod arguments;
mod between;
mod beyond;
mod edges;
mod faces;
mod fault;
mod pairs;
mod reach;
mod seldom;
mod twisted;
mod twists;
mod variants;
mod vectors;
mod walk;

pub use arguments::{Careless, Config, Ignored};
pub use fault::Fault;
pub use walk::Walk;

use gym_core::Registration;

/// Registers the walk with a fault, under the name of the check that must find the fault.
macro_rules! register {
    ($($name:literal $(, $method:ident($argument:expr))*;)*) => {$(
        gym_core::register!(
            Registration::new::<Walk>(concat!("broken/", $name, "-v0"))
                .kwargs(concat!(r#"{"fault": ""#, $name, r#""}"#))
                .description("Walk from the middle to either end.")
                .max_episode_steps(12)
                $(.$method($argument))*
        );
    )*};
}

register! {
    "none", reset_options(&[("start", "0.25")]);
    "constructs";
    "described", description(" ");
    "exceptions-known", exceptions(&[("reward-finit", "a slip of the pen")]);
    "space-not-empty";
    "space-width";
    "space-bounded";
    "action-normalised";
    "resets";
    "space-constant";
    "action-accepted";
    "action-accepted.held";
    "action-validated";
    "action-validated.one-element";
    "action-validated.one-number";
    "observation-in-space";
    "observation-in-space.held";
    "observation-in-space.huge-action";
    "observation-dtype";
    // a space that contains infinity has no finite bound
    "observation-finite", exceptions(&[("space-bounded", "infinity must lie in the space for this")]);
    "reward-finite";
    "reward-finite.late";
    "info-consistent";
    "info-consistent.at-the-end";
    "info-constant";
    "info-constant.type";
    "reset-needed";
    "time-limit";
    "same-seed-same-episode";
    "same-seed-same-episode.interrupted";
    "same-seed-same-episode.late";
    "options-accepted", reset_options(&[("start", "0.25")]);
    "options-accepted.no-json", reset_options(&[("start", "a quarter")]);
    "options-ignored";
    "options-matter", reset_options(&[("start", "0.25")]);
    "reset-forgets";
    "other-seed-other-episode";
    "other-seed-other-episode.cut";
    "reset-carries-on";
    "reset-carries-on.to-the-next-seed";
    "generator-lent";
    "generator-lent.fixed";
    "observation-whole";
    "refusal-changes-nothing";
    "clone-apart";
    "clone-apart.late";
    "clone-apart.closed";
    "clone-continues";
    "snapshot-continues";
    "snapshot-continues.late";
    "snapshot-continues.unused";
    "snapshot-continues.used";
    "snapshot-refused";
    "snapshot-refused.changes";
    "snapshot-legal";
    "any-thread";
    "any-thread.moved";
    "metadata-complete";
    "frame-rate";
    "drawing-sound";
    "drawing-sound.at-the-end";
    "drawing-pure";
    "drawing-pure.text";
    "drawing-visible";
    "drawing-visible.off-the-canvas";
    "drawing-follows";
    "render-modes";
    "no-allocation";
    "no-panic";
    "no-panic.at-the-end";
}

gym_core::register!(
    Registration::new::<Walk<Ignored>>("broken/arguments-matter-v0")
        .description("Walk from the middle to either end.")
        .exceptions(&[("arguments-matter.pace", "nothing is animated here")])
        .max_episode_steps(12)
);
gym_core::register!(
    Registration::new::<Walk<Careless>>("broken/arguments-refused-v0")
        .description("Walk from the middle to either end.")
        .max_episode_steps(12)
);
gym_core::register!(
    Registration::new::<Walk>("broken/versioned")
        .description("Walk from the middle to either end.")
        .max_episode_steps(12)
);
gym_core::register!(
    Registration::new::<Walk>("broken/described.unfinished-v0")
        .description("TODO")
        .max_episode_steps(12)
);
gym_core::register!(
    Registration::new::<Walk>("broken/exceptions-known.argument-v0")
        .description("Walk from the middle to either end.")
        .exceptions(&[("arguments-matter.fauld", "a slip of the pen")])
        .max_episode_steps(12)
);
gym_core::register!(
    Registration::new::<Walk>("broken/described.again-v0")
        .description("described.again")
        .max_episode_steps(12)
);
