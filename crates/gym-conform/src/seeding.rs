//! Checks of what a seed decides.

use crate::subject::{SEEDS, STEPS, Shown, Subject, carry_on, roll_out, same};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::{BoxEnv, Env, EnvExt, Error, Generator, Reset, Result, Seed};

/// The number of seeds or resets that must give different episodes.
const TRIES: u64 = 20;

pub(crate) fn resets(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    let large: Seed = "1427247692705959881058285969449495136382746631".parse().map_err(Error::from)?; // 2^150 + 7
    for seed in [Some(0.into()), Some(u64::MAX.into()), Some(large), None] {
        let what =
            seed.as_ref().map_or_else(|| "without a seed".to_owned(), |seed| format!("with the seed {seed}"));
        if let Err(error) = env.reset(Reset { seed, ..Reset::default() }) {
            return broken(format!("`reset` {what}: {error}"));
        }
    }
    // and the first time without a seed
    match subject.make()?.reset(()) {
        Ok(_) => Ok(()),
        Err(error) => broken(format!("the first `reset` without a seed: {error}")),
    }
}

pub(crate) fn same_seed(subject: &Subject<'_>) -> Verdict {
    if subject.is_nondeterministic() {
        return skipped("it is registered as nondeterministic");
    }
    let roll = |seed| roll_out(&mut subject.make()?, seed, STEPS);
    SEEDS.into_iter().try_for_each(|seed| {
        same(&roll(seed)?, &roll(seed)?, "a second environment with the same seed and actions")?;
        let what = "a second environment with resets in the middle of an episode, seeded once,";
        same(&interrupted(subject, seed)?, &interrupted(subject, seed)?, what)
    })?;
    let again = roll_out(&mut subject.make()?, SEEDS[0], subject.long()?)?;
    same(subject.first_run()?, &again, "a later environment with the same seed and actions, in a long run,")
}

/// Episodes after an abandoned seeded one, and after one that was not begun.
fn interrupted(subject: &Subject<'_>, seed: u64) -> Result<Vec<Shown>> {
    let mut env = subject.midway(seed)?;
    env.reset(())?;
    episode(&mut env, Reset::default())
}

pub(crate) fn reset_forgets(subject: &Subject<'_>) -> Verdict {
    if subject.is_nondeterministic() {
        return skipped("it is registered as nondeterministic");
    }
    let mut env = subject.make()?;
    for seed in SEEDS {
        let first = roll_out(&mut env, seed, STEPS)?;
        // abandon it in the middle of another episode
        roll_out(&mut env, seed + 1, 7)?;
        let second = roll_out(&mut env, seed, STEPS)?;
        same(&first, &second, "a used environment with the same seed and actions")?;
    }
    Ok(())
}

/// An episode of fixed actions, so that two differ only by the environment's own randomness.
fn episode(env: &mut BoxEnv, reset: Reset) -> Result<Vec<Shown>> {
    let observation = env.reset(reset)?;
    let mut shown = vec![Shown::Reset(observation, env.info_map())];
    shown.extend(carry_on(env, 0, STEPS)?);
    Ok(shown)
}

pub(crate) fn other_seed(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    if !is_random(&mut env)? {
        return skipped("nothing about it is random");
    }
    let first = episode(&mut env, Reset::seed(0))?;
    for seed in 1..TRIES {
        if episode(&mut env, Reset::seed(seed))? != first {
            let what = "a seed and the one 2^32 above it always give the same episode";
            return not_always(&mut env, what, |env, seed| episode(env, Reset::seed(seed + (1 << 32))), 0);
        }
    }
    broken(format!("{TRIES} seeds give the same episode, although it is random"))
}

/// Whether episodes differ though the actions are the same, by seed or without one.
fn is_random(env: &mut BoxEnv) -> Result<bool> {
    let first = episode(env, Reset::seed(0))?;
    for seed in 1..TRIES {
        if episode(env, Reset::default())? != first || episode(env, Reset::seed(seed))? != first {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Whether `other` is for each seed the episode of the seed `ahead` of it, although seeds distinguish most
/// episodes.
fn not_always(
    env: &mut BoxEnv,
    what: &str,
    other: impl Fn(&mut BoxEnv, u64) -> Result<Vec<Shown>>,
    ahead: u64,
) -> Verdict {
    let mut distinct = 0;
    for seed in 0..TRIES {
        let plain = episode(env, Reset::seed(seed + ahead))?;
        if other(env, seed)? != plain {
            return Ok(());
        }
        distinct += u64::from(episode(env, Reset::seed(seed + ahead + 1))? != plain);
    }
    // if few episodes differ, it is chance
    if distinct * 2 > TRIES { broken(what) } else { Ok(()) }
}

pub(crate) fn carries_on(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    if !is_random(&mut env)? {
        return skipped("nothing about it is random");
    }
    let first = episode(&mut env, Reset::seed(0))?;
    for _ in 1..TRIES {
        if episode(&mut env, Reset::default())? != first {
            let what = "a reset without a seed always gives the episode of the next seed";
            let unseeded = |env: &mut BoxEnv, seed: u64| {
                env.reset(seed)?;
                episode(env, Reset::default())
            };
            return not_always(&mut env, what, unseeded, 1);
        }
    }
    broken(format!("{TRIES} resets without a seed repeat the episode of the last seed"))
}

pub(crate) fn generator_lent(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    if !is_random(&mut env)? {
        return skipped("nothing about it is random");
    }
    let mut seeded = |seed: u64| -> Result<Option<Generator>> {
        env.reset(seed)?;
        Ok(env.generator().cloned())
    };
    let (Some(first), Some(again), Some(other)) = (seeded(1)?, seeded(1)?, seeded(2)?) else {
        return broken("`generator` is None after a reset, although episodes are random");
    };
    match (first == again, first == other) {
        (false, _) => broken("after the same seed `generator` has another state"),
        (_, true) => broken("after another seed `generator` has the same state"),
        _ => Ok(()),
    }
}
