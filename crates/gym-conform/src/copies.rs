//! Checks of clones and snapshots.

use serde_json::{Value as Json, json};

use crate::arguments;
use crate::subject::{SEEDS, STEPS, Shown, Subject, carry_on, info, roll_out, same};
use crate::verdict::{Verdict, broken};
use gym_core::{BoxEnv, Env, EnvExt, Error, Result, Snapshot};

pub(crate) fn clone_apart(subject: &Subject<'_>) -> Verdict {
    for seed in SEEDS {
        let (mut env, mut other) = (subject.midway(seed)?, subject.midway(seed)?);
        let mut clone = env.clone();
        // independently of the clone
        let _ = carry_on(&mut clone, seed + 1, 20);
        let _ = clone.reset(seed + 1);
        clone.close();
        let what = "an environment whose clone was used";
        same(
            &carry_on(&mut other, seed, STEPS)?,
            &carry_on(&mut env, seed, STEPS)?,
            what,
        )?;
    }
    // state that clones share may show late
    let (seed, long) = (SEEDS[0], subject.long()?);
    let (mut env, mut other) = (subject.midway(seed)?, subject.midway(seed)?);
    carry_on(&mut env.clone(), seed + 1, long)?;
    let what = "an environment whose clone was used for long";
    same(
        &carry_on(&mut other, seed, long)?,
        &carry_on(&mut env, seed, long)?,
        what,
    )
}

pub(crate) fn clone_continues(subject: &Subject<'_>) -> Verdict {
    continues(subject, &[("a clone", &|env| Ok(env.clone()))])?;
    continues_after_the_end(subject, "a clone taken at the end of an episode", |env| {
        Ok(env.clone())
    })
}

pub(crate) fn snapshot_continues(subject: &Subject<'_>) -> Verdict {
    let what = "an environment restored from a snapshot";
    continues(
        subject,
        &[
            (what, &|env| restored(env, subject.make()?)),
            (
                &format!("{what} in the middle of another episode"),
                &|env| restored(env, subject.midway(7)?),
            ),
            (
                &format!("{what} after the end of another episode"),
                &|env| restored(env, ended(subject)?),
            ),
        ],
    )?;
    let what = "an environment restored from a snapshot of the end of an episode";
    continues_after_the_end(subject, what, |env| restored(env, subject.make()?))?;
    unused(subject)?;
    with_odd_arguments(subject)
}

/// `into` with the state of `env`, by way of a text.
fn restored(env: &BoxEnv, mut into: BoxEnv) -> Result<BoxEnv> {
    let stored = |error: serde_json::Error| Error::Snapshot(error.to_string());
    let text = serde_json::to_string(&env.snapshot()?).map_err(stored)?;
    into.restore(&serde_json::from_str(&text).map_err(stored)?)?;
    Ok(into)
}

/// An environment at the end of an episode, if that is not too far.
fn ended(subject: &Subject<'_>) -> Result<BoxEnv> {
    let mut env = subject.reset(7)?;
    let mut actions = env.action_sampler(7)?;
    for _ in 0..300 {
        if env.step(&actions.sample())?.done() {
            break;
        }
    }
    Ok(env)
}

/// A snapshot from before the first reset makes a used environment as good as new.
fn unused(subject: &Subject<'_>) -> Verdict {
    let (mut new, mut used) = (subject.make()?, subject.midway(0)?);
    let Ok(snapshot) = new.snapshot() else {
        return Ok(());
    };
    if used.restore(&snapshot).is_err() {
        return Ok(());
    }
    let what = "a used environment restored from a snapshot from before the first reset";
    let action = new.action_sampler(0)?.sample();
    if new.step(&action).is_ok() != used.step(&action).is_ok() {
        return broken(format!("{what} goes on with an episode"));
    }
    same(
        &roll_out(&mut new, 0, STEPS)?,
        &roll_out(&mut used, 0, STEPS)?,
        what,
    )
}

/// Numbers that no ordinary episode reaches are stored and restored too.
fn with_odd_arguments(subject: &Subject<'_>) -> Verdict {
    for odd in arguments::odd(subject) {
        let played = || -> Result<BoxEnv> {
            let mut env = odd.spec.make()?;
            env.reset(0)?;
            carry_on(&mut env, 0, 20)?;
            Ok(env)
        };
        // it may refuse the argument, or the steps
        let Ok(env) = played() else { continue };
        if let Err(error) = restored(&env, env.clone()) {
            return broken(format!(
                "with the argument {odd} an environment refuses its own snapshot: {error}"
            ));
        }
    }
    Ok(())
}

/// A way to copy an environment, with its name.
type Copying<'a> = (&'a str, &'a dyn Fn(&BoxEnv) -> Result<BoxEnv>);

/// Whether copies taken in the middle of an episode continue like an original that was not copied.
fn continues(subject: &Subject<'_>, copies: &[Copying<'_>]) -> Verdict {
    let long = subject.long()?;
    let [early, other, late] = SEEDS;
    let first = copies.first().map_or("a copy", |(what, _)| what);
    // copies taken early that run long, and some taken late
    for (seed, before, after) in [(early, 5, long), (other, 5, STEPS), (late, long / 2, STEPS)] {
        let mut env = subject.after(seed, before)?;
        let untouched = carry_on(&mut subject.after(seed, before)?, seed, after)?;
        for (what, copy) in copies {
            match copy(&env).and_then(|mut copied| carry_on(&mut copied, seed, after)) {
                Ok(copied) => same(&untouched, &copied, what)?,
                Err(error) => return broken(format!("{what}: {error}")),
            }
        }
        same(
            &untouched,
            &carry_on(&mut env, seed, after)?,
            &format!("beside {first} the original"),
        )?;
    }
    Ok(())
}

/// The same of a copy taken at the end of an episode, where it begins another.
fn continues_after_the_end(
    subject: &Subject<'_>,
    what: &str,
    copy: impl Fn(&BoxEnv) -> Result<BoxEnv>,
) -> Verdict {
    let mut env = ended(subject)?;
    let next = |env: &mut BoxEnv| -> Result<Vec<Shown>> {
        let first = Shown::Reset(env.reset(())?, info(env));
        Ok([vec![first], carry_on(env, 0, 50)?].concat())
    };
    let mut copied = match copy(&env) {
        Ok(copied) => copied,
        Err(error) => return broken(format!("{what}: {error}")),
    };
    let copied = next(&mut copied)?;
    let left = next(&mut env)?;
    same(&left, &copied, what)
}

/// Content that no environment writes is refused, and a refusal changes nothing.
pub(crate) fn snapshot_refused(subject: &Subject<'_>) -> Verdict {
    let seed = SEEDS[0];
    let state = |snapshot: &Snapshot| snapshot.get::<Json>();
    let midway = || -> Result<BoxEnv> {
        let mut env = subject.unlimited()?;
        roll_out(&mut env, seed, 5)?;
        Ok(env)
    };
    let mut env = midway()?;
    let good = state(&env.snapshot()?)?;
    let foreign = [
        json!(3),
        json!("x"),
        json!({"no": "such"}),
        json!([1, 2, 3, 4, 5, 6, 7]),
    ];
    for json in foreign {
        if env.restore(&Snapshot::of(&json)?).is_ok() && json != good {
            return broken(format!("`restore` accepts {json}"));
        }
    }
    subject.damaged()?.changed()?;
    let what = "after refused snapshots an episode";
    same(
        &carry_on(&mut midway()?, seed, 50)?,
        &carry_on(&mut env, seed, 50)?,
        what,
    )
}

/// `restore` accepts only states that the environment can reach.
pub(crate) fn snapshot_legal(subject: &Subject<'_>) -> Verdict {
    subject.damaged()?.illegal()
}
