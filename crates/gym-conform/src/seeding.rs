//! Checks of seeds.

use std::iter;

use crate::options;
use crate::subject::{SEEDS, STEPS, Shown, Subject, carry_on, info, roll_out, same};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::{BoxEnv, Env, EnvExt, Error, Generator, Reset, Result, Seed};

/// The number of seeds or resets. At least two of them must give different episodes.
const TRIES: u64 = 20;
/// The number of steps within which most episodes differ.
const SOON: usize = 5;

pub(crate) fn resets(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    let large: Seed = "1427247692705959881058285969449495136382746631"
        .parse()
        .map_err(Error::from)?; // 2^150 + 7
    for seed in [Some(0.into()), Some(u64::MAX.into()), Some(large), None] {
        let what = seed.as_ref().map_or_else(
            || "without a seed".to_owned(),
            |seed| format!("with the seed {seed}"),
        );
        if let Err(error) = env.reset(Reset {
            seed,
            ..Reset::default()
        }) {
            return broken(format!("`reset` {what}: {error}"));
        }
    }
    // the first reset may have no seed
    match subject.make()?.reset(()) {
        Ok(_) => Ok(()),
        Err(error) => broken(format!("the first `reset` without a seed: {error}")),
    }
}

pub(crate) fn same_seed(subject: &Subject<'_>) -> Verdict {
    subject.repeatable()?;
    let roll = |seed| roll_out(&mut subject.make()?, seed, STEPS);
    SEEDS.into_iter().try_for_each(|seed| {
        same(
            &roll(seed)?,
            &roll(seed)?,
            "a second environment with the same seed and actions",
        )?;
        let what = "a second environment with resets in the middle of an episode, seeded once,";
        same(
            &interrupted(subject, seed)?,
            &interrupted(subject, seed)?,
            what,
        )
    })?;
    let again = roll_out(&mut subject.make()?, SEEDS[0], subject.longest()?)?;
    same(
        subject.first_run()?,
        &again,
        "a later environment with the same seed and actions, in a long run,",
    )?;
    subject.variants().repeated()
}

/// Returns an unseeded episode after an abandoned seeded episode and an episode without steps.
fn interrupted(subject: &Subject<'_>, seed: u64) -> Result<Vec<Shown>> {
    let mut env = subject.midway(seed)?;
    env.reset(())?;
    episode(&mut env, Reset::default())
}

pub(crate) fn reset_forgets(subject: &Subject<'_>) -> Verdict {
    forgets(subject)?;
    options::forgotten(subject)
}

fn forgets(subject: &Subject<'_>) -> Verdict {
    /// The number of resets before the episode that is compared.
    const MANY: u64 = 100;
    subject.repeatable()?;
    let mut env = subject.make()?;
    for seed in SEEDS {
        let first = roll_out(&mut env, seed, STEPS)?;
        // abandon an episode of another seed after 7 steps
        roll_out(&mut env, seed + 1, 7)?;
        let second = roll_out(&mut env, seed, STEPS)?;
        same(
            &first,
            &second,
            "a used environment with the same seed and actions",
        )?;
        // the same seed once more, and then two resets without a step between them
        let again = roll_out(&mut env, seed, SOON)?;
        let what = "an environment whose last reset had the same seed";
        same(&first[..again.len()], &again, what)?;
        let observation = env.reset(seed)?;
        let again = [Shown::Reset(observation, info(&env))];
        same(&first[..1], &again, what)?;
    }
    // a counter that no reset sets to 0 may have an effect only after many steps
    let (seed, steps) = (SEEDS[0], subject.longest()?);
    let first = roll_out(&mut subject.make()?, seed, STEPS)?;
    carry_on(&mut env, seed, steps)?;
    same(
        &first,
        &roll_out(&mut env, seed, STEPS)?,
        &format!("an environment that took {steps} steps before"),
    )?;
    for seed in 0..MANY {
        env.reset(seed)?;
    }
    same(
        &first,
        &roll_out(&mut env, seed, STEPS)?,
        &format!("an environment that was reset {MANY} times before"),
    )
}

/// Plays an episode with fixed actions, so that episodes differ only by the environment's
/// randomness.
fn episode(env: &mut BoxEnv, reset: Reset) -> Result<Vec<Shown>> {
    episode_of(env, reset, STEPS)
}

/// Like [`episode`], but plays only the first `steps` steps.
fn episode_of(env: &mut BoxEnv, reset: Reset, steps: usize) -> Result<Vec<Shown>> {
    let observation = env.reset(reset)?;
    let mut shown = vec![Shown::Reset(observation, env.info_map())];
    shown.extend(carry_on(env, 0, steps)?);
    Ok(shown)
}

pub(crate) fn other_seed(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    if !is_random(&mut env)? {
        return skipped("it is not random");
    }
    let first = episode(&mut env, Reset::seed(0))?;
    for seed in 1..TRIES {
        if episode(&mut env, Reset::seed(seed))? != first {
            return seeds_count(subject, &mut env);
        }
    }
    broken(format!(
        "{TRIES} seeds give the same episode, although it is random"
    ))
}

/// Checks that every bit of a seed counts, and that the first reset without a seed is random.
fn seeds_count(subject: &Subject<'_>, env: &mut BoxEnv) -> Verdict {
    let seeded = |env: &mut BoxEnv, seed: u64, steps| episode_of(env, Reset::seed(seed), steps);
    let other = |env: &mut BoxEnv, seed: u128, steps| {
        let seed: Seed = seed.to_string().parse().map_err(Error::from)?;
        episode_of(
            env,
            Reset {
                seed: Some(seed),
                ..Reset::default()
            },
            steps,
        )
    };
    // differences of the seeds: single high bits, a power of 10, 2^31 - 1 and 2^32 - 1
    let bits = [16, 24, 31, 32, 48, 53, 63, 64, 100].map(|bit| (1u128 << bit, format!("2^{bit}")));
    let others = [10u128.pow(18), (1 << 31) - 1, (1 << 32) - 1].map(|by| (by, by.to_string()));
    for (by, name) in bits.into_iter().chain(others) {
        let what = format!("a seed and the one {name} above it always give the same episode");
        not_always(env, &what, seeded, |env, seed, steps| {
            other(env, by + u128::from(seed), steps)
        })?;
    }
    // the seed `seed` plus 2^128, in decimal digits
    let what = "a seed and the one 2^128 above it always give the same episode";
    let above = |env: &mut BoxEnv, seed: u64, steps| {
        let seed = format!("3402823669209384634633746074317682114{}", 56 + seed);
        let seed: Seed = seed.parse().map_err(Error::from)?;
        let reset = Reset {
            seed: Some(seed),
            ..Reset::default()
        };
        episode_of(env, reset, steps)
    };
    not_always(env, what, seeded, above)?;
    // an environment that stores a seed as a float loses the seed's lowest bits
    for bit in [30, 60, 100] {
        let what = format!("a seed above 2^{bit} and the next always give the same episode");
        let large =
            |env: &mut BoxEnv, seed: u64, steps| other(env, (1 << bit) + u128::from(seed), steps);
        let next = |env: &mut BoxEnv, seed: u64, steps| {
            other(env, (1 << bit) + u128::from(seed) + 1, steps)
        };
        not_always_true(env, &what, seeded, |env, seed| {
            Ok(large(env, seed, SOON)? == next(env, seed, SOON)?
                && large(env, seed, STEPS)? == next(env, seed, STEPS)?)
        })?;
    }
    let what = "an even seed and the next always give the same episode";
    not_always(env, what, seeded, |env, seed, steps| {
        other(env, u128::from(seed ^ 1), steps)
    })?;
    let what = "environments whose first reset has no seed always begin with the same episode";
    let first = episode(&mut subject.make()?, Reset::default())?;
    let fresh = |_: &mut BoxEnv, _| Ok(episode(&mut subject.make()?, Reset::default())? == first);
    not_always_true(env, what, seeded, fresh)?;
    seeds_apart(subject, env)
}

/// Checks that no two of many seeds leave the environment's generator in the same state. If the
/// generator does not depend on the seed at all, the check `generator-lent` reports it.
fn seeds_apart(subject: &Subject<'_>, env: &mut BoxEnv) -> Verdict {
    /// The number of values of the seed's upper 32 bits, and of its lower 32 bits.
    const HALVES: u64 = 12;
    let mut rng = Generator::from(0);
    let halves = (0..HALVES).flat_map(|high| (0..HALVES).map(move |low| (high << 32) | low));
    let random =
        iter::repeat_with(|| rng.integers(i64::MIN, i64::MAX) as u64).take(subject.many_resets()?);
    let mut states: Vec<(Generator, u64)> = Vec::new();
    for seed in halves.chain(random) {
        // a task that generates levels at random may fail for a rare seed
        if env.reset(seed).is_err() {
            continue;
        }
        let Some(state) = env.generator() else {
            return Ok(());
        };
        match states.iter().find(|(other, _)| other == state) {
            // the seeds 0 and 1 give the same state: see `generator-lent`
            Some(_) if states.len() == 1 => return Ok(()),
            Some((_, other)) => {
                return broken(format!(
                    "the seeds {other} and {seed} leave the generator in the same state: the seed is cut"
                ));
            }
            None => states.push((state.clone(), seed)),
        }
    }
    Ok(())
}

/// Returns whether episodes with equal actions differ, with other seeds or without a seed.
fn is_random(env: &mut BoxEnv) -> Result<bool> {
    let first = episode(env, Reset::seed(0))?;
    for seed in 1..TRIES {
        if episode(env, Reset::default())? != first || episode(env, Reset::seed(seed))? != first {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Reports `what` if `other` and `plain` give equal episodes for every seed, although most seeds
/// give different episodes.
fn not_always(
    env: &mut BoxEnv,
    what: &str,
    plain: impl Fn(&mut BoxEnv, u64, usize) -> Result<Vec<Shown>>,
    other: impl Fn(&mut BoxEnv, u64, usize) -> Result<Vec<Shown>>,
) -> Verdict {
    not_always_true(env, what, &plain, |env, seed| {
        // compare a few steps first: most episodes differ early
        Ok(other(env, seed, SOON)? == plain(env, seed, SOON)?
            && other(env, seed, STEPS)? == plain(env, seed, STEPS)?)
    })
}

/// Reports `what` if `holds` returns true for every seed, although most seeds give different
/// episodes.
fn not_always_true(
    env: &mut BoxEnv,
    what: &str,
    plain: impl Fn(&mut BoxEnv, u64, usize) -> Result<Vec<Shown>>,
    holds: impl Fn(&mut BoxEnv, u64) -> Result<bool>,
) -> Verdict {
    let mut distinct = 0;
    for seed in 0..TRIES {
        if !holds(env, seed)? {
            return Ok(());
        }
        // not `seed + 1`: the fault itself may make its episode equal
        distinct += u64::from(plain(env, seed + 3, STEPS)? != plain(env, seed, STEPS)?);
    }
    // if only few episodes differ, equal episodes prove nothing
    if distinct * 2 > TRIES {
        broken(what)
    } else {
        Ok(())
    }
}

pub(crate) fn carries_on(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.make()?;
    if !is_random(&mut env)? {
        return skipped("it is not random");
    }
    let first = episode(&mut env, Reset::seed(0))?;
    for _ in 1..TRIES {
        if episode(&mut env, Reset::default())? != first {
            let what = "a reset without a seed always gives the episode of the next seed";
            let unseeded = |env: &mut BoxEnv, seed: u64, steps| {
                env.reset(seed)?;
                episode_of(env, Reset::default(), steps)
            };
            let next =
                |env: &mut BoxEnv, seed: u64, steps| episode_of(env, Reset::seed(seed + 1), steps);
            not_always(&mut env, what, next, unseeded)?;
            return never_alternates(&mut env);
        }
    }
    broken(format!(
        "{TRIES} resets without a seed repeat the episode of the last seed"
    ))
}

/// Checks that resets without a seed do not repeat the same episode, or the same two episodes in
/// turn.
fn never_alternates(env: &mut BoxEnv) -> Verdict {
    let mut is_periodic = |resets: u64, steps: usize| -> Result<bool> {
        env.reset(0)?;
        let episodes = (0..resets)
            .map(|_| one_episode(env, steps))
            .collect::<Result<Vec<_>>>()?;
        Ok((1..=2).any(|period| {
            episodes
                .iter()
                .zip(&episodes[period..])
                .all(|(a, b)| a == b)
        }))
    };
    // compare more episodes too: a few may alternate by chance
    if is_periodic(6, SOON)? && is_periodic(2 * TRIES, STEPS)? {
        return broken("resets without a seed give the same few episodes in turn, again and again");
    }
    Ok(())
}

/// Resets without a seed and takes fixed actions, at most to the end of the episode.
fn one_episode(env: &mut BoxEnv, steps: usize) -> Result<Vec<Shown>> {
    let mut shown = vec![Shown::Reset(env.reset(())?, info(env))];
    let mut actions = env.action_sampler(0)?;
    for _ in 0..steps {
        let step = env.step(&actions.sample())?;
        let is_over = step.done();
        shown.push(Shown::Step(step, info(env)));
        if is_over {
            break;
        }
    }
    Ok(shown)
}

pub(crate) fn generator_lent(subject: &Subject<'_>) -> Verdict {
    subject.repeatable()?;
    let mut env = subject.make()?;
    if !is_random(&mut env)? {
        return skipped("it is not random");
    }
    let mut seeded = |seed: u64| -> Result<Option<Generator>> {
        env.reset(seed)?;
        Ok(env.generator().cloned())
    };
    let (Some(first), Some(again), Some(other)) = (seeded(1)?, seeded(1)?, seeded(2)?) else {
        return broken("`generator` is None after a reset, although episodes are random");
    };
    match (first == again, first == other) {
        (false, _) => broken("resets with one seed leave `generator` in different states"),
        (_, true) => broken("resets with different seeds leave `generator` in the same state"),
        _ => {
            let what = "a number drawn from the generator that is lent never changes the next episode: it is a copy";
            let undrawn = |env: &mut BoxEnv, seed: u64, steps| {
                env.reset(seed)?;
                episode_of(env, Reset::default(), steps)
            };
            let drawn = |env: &mut BoxEnv, seed: u64, steps| {
                env.reset(seed)?;
                if let Some(generator) = env.generator() {
                    generator.random();
                }
                episode_of(env, Reset::default(), steps)
            };
            not_always(&mut env, what, undrawn, drawn)?;
            lent_always(subject)
        }
    }
}

/// Checks that `Env::generator` returns the generator after every step, including the last step of
/// an episode.
fn lent_always(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.reset(0)?;
    let mut actions = env.action_sampler(0)?;
    for step in 1..=STEPS {
        let is_over = env.step(&actions.sample())?.done();
        if env.generator().is_none() {
            let end = if is_over {
                ", the last of an episode"
            } else {
                ""
            };
            return broken(format!("`generator` is None after step {step}{end}"));
        }
        if is_over {
            env.reset(())?;
        }
    }
    Ok(())
}
