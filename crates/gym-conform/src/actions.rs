//! Checks of the actions that `step` accepts and refuses.

use crate::inputs::{corners, invalid};
use crate::options;
use crate::subject::{SEEDS, Subject, carry_on, same};
use crate::verdict::{Trouble, Verdict, broken};
use gym_core::{Env, EnvExt};

pub(crate) fn accepted(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.reset(0)?;
    let space = env.action_space();
    let mut samples = space.sampler(0);
    let corners = corners(&space);
    let samples = std::iter::repeat_with(|| samples.sample()).take(100);
    for action in corners.into_iter().chain(samples) {
        match env.step(&action) {
            Ok(step) if step.done() => drop(env.reset(0)?),
            Ok(_) => (),
            Err(error) => {
                return broken(format!(
                    "`step` refuses {action}, an element of {space}: {error}"
                ));
            }
        }
    }
    subject.long_runs()?.refused()
}

pub(crate) fn validated(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.reset(0)?;
    let space = env.action_space();
    let valid = env.action_sampler(0)?.sample();
    for action in invalid(&space, &valid) {
        if env.step(&action).is_ok() {
            return broken(format!(
                "`step` accepts {action:?}, which is not in {space}"
            ));
        }
    }
    Ok(())
}

pub(crate) fn refusal(subject: &Subject<'_>) -> Verdict {
    subject.repeatable()?;
    // at the start of an episode, and after some steps
    for (seed, steps) in SEEDS.into_iter().zip([0, 5, 5]) {
        let (mut env, mut other) = (subject.after(seed, steps)?, subject.after(seed, steps)?);
        let space = env.action_space();
        let valid = env.action_sampler(0)?.sample();
        for action in invalid(&space, &valid) {
            if env.step(&action).is_ok() {
                return Err(Trouble::Error(gym_core::Error::custom(
                    "an invalid action is accepted",
                )));
            }
        }
        let what = "after refused actions an episode";
        same(
            &carry_on(&mut other, seed, 50)?,
            &carry_on(&mut env, seed, 50)?,
            what,
        )?;
        if options::refused(&mut env, subject) {
            let what = "after refused resets an episode";
            same(
                &carry_on(&mut other, seed, 20)?,
                &carry_on(&mut env, seed, 20)?,
                what,
            )?;
        }
    }
    Ok(())
}
