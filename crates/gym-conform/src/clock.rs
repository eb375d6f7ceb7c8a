//! The check that episodes do not depend on a clock.

use std::time::{Duration, Instant};

use crate::subject::{SEEDS, STEPS, Shown, Subject, carry_on, roll_out, same};
use crate::verdict::Verdict;
use gym_core::{BoxEnv, Result};

/// An environment in the middle of an episode, and the rest of this episode, played without a pause
/// in another environment.
pub(crate) struct Paused {
    env: BoxEnv,
    rest: Vec<Shown>,
    since: Instant,
}

impl Paused {
    pub(crate) fn new(subject: &Subject<'_>) -> Result<Self> {
        let midway = || subject.midway(SEEDS[0]);
        Ok(Self {
            env: midway()?,
            rest: carry_on(&mut midway()?, SEEDS[0], STEPS)?,
            since: Instant::now(),
        })
    }
}

/// Checks that a pause does not change the rest of an episode, nor a later episode.
pub(crate) fn unread(subject: &Subject<'_>) -> Verdict {
    /// A clock that counts seconds changes within this time.
    const PAUSE: Duration = Duration::from_millis(1050);
    subject.repeatable()?;
    let Paused { env, rest, since } = subject.paused()?;
    // (the other checks have taken most of this time)
    subject.sleep(PAUSE.saturating_sub(since.elapsed()));
    let later = carry_on(&mut env.clone(), SEEDS[0], STEPS)?;
    same(rest, &later, "an episode that goes on after a pause")?;
    let first = subject.first_run()?;
    let again = roll_out(&mut subject.make()?, SEEDS[0], STEPS)?;
    let len = again.len().min(first.len());
    same(
        &first[..len],
        &again[..len],
        "a later environment with the same seed and actions",
    )
}
