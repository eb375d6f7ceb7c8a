//! Checks of clones and snapshots.

use serde_json::{Value as Json, json};

use crate::subject::{SEEDS, STEPS, Subject, carry_on, roll_out, same};
use crate::verdict::{Trouble, Verdict, broken};
use gym_core::{BoxEnv, Env, Error, Result, Snapshot};

pub(crate) fn clone_apart(subject: &Subject<'_>) -> Verdict {
    for seed in SEEDS {
        let (mut env, mut other) = (subject.midway(seed)?, subject.midway(seed)?);
        let mut clone = env.clone();
        // whatever becomes of the clone
        let _ = carry_on(&mut clone, seed + 1, 20);
        let _ = clone.reset(seed + 1);
        clone.close();
        let what = "an environment whose clone was used";
        same(&carry_on(&mut other, seed, STEPS)?, &carry_on(&mut env, seed, STEPS)?, what)?;
    }
    Ok(())
}

pub(crate) fn clone_continues(subject: &Subject<'_>) -> Verdict {
    continues(subject, "a clone", |env| Ok(env.clone()))
}

pub(crate) fn snapshot_continues(subject: &Subject<'_>) -> Verdict {
    continues(subject, "an environment restored from a snapshot", |env| restored(env, subject.make()?))?;
    let what = "an environment restored from a snapshot in the middle of another episode";
    continues(subject, what, |env| restored(env, subject.midway(7)?))?;
    let what = "an environment restored from a snapshot after the end of another episode";
    continues(subject, what, |env| restored(env, ended(subject)?))?;
    unused(subject)
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
    let Ok(snapshot) = new.snapshot() else { return Ok(()) };
    if used.restore(&snapshot).is_err() {
        return Ok(());
    }
    let what = "a used environment restored from a snapshot from before the first reset";
    let action = new.action_sampler(0)?.sample();
    if new.step(&action).is_ok() != used.step(&action).is_ok() {
        return broken(format!("{what} goes on with an episode"));
    }
    same(&roll_out(&mut new, 0, STEPS)?, &roll_out(&mut used, 0, STEPS)?, what)
}

/// Whether a copy taken in the middle of an episode goes on as an original of which none was taken.
fn continues(subject: &Subject<'_>, what: &str, copy: impl Fn(&BoxEnv) -> Result<BoxEnv>) -> Verdict {
    for seed in SEEDS {
        let mut env = subject.midway(seed)?;
        let mut copied = match copy(&env) {
            Ok(copied) => copied,
            Err(error) => return broken(format!("{what}: {error}")),
        };
        let copied = match carry_on(&mut copied, seed, STEPS) {
            Ok(copied) => copied,
            Err(error) => return broken(format!("{what}: {error}")),
        };
        let left = carry_on(&mut env, seed, STEPS)?;
        let untouched = carry_on(&mut subject.midway(seed)?, seed, STEPS)?;
        same(&untouched, &copied, what)?;
        same(&untouched, &left, &format!("beside {what} the original"))?;
    }
    Ok(())
}

/// What no environment writes is refused, and a refusal changes nothing.
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
    let foreign = [json!(3), json!("x"), json!({"no": "such"}), json!([1, 2, 3, 4, 5, 6, 7])];
    for json in foreign {
        if env.restore(&Snapshot::of(&json)?).is_ok() && json != good {
            return broken(format!("`restore` accepts {json}"));
        }
    }
    for json in damaged(&good) {
        let snapshot = Snapshot::of(&json)?;
        let mut env = env.clone();
        if env.restore(&snapshot).is_err() {
            let after = env.snapshot().map_err(Trouble::Error)?;
            if state(&after)? != good {
                return broken("a snapshot that `restore` refuses changes the environment all the same");
            }
        }
    }
    let what = "after refused snapshots an episode";
    same(&carry_on(&mut midway()?, seed, 50)?, &carry_on(&mut env, seed, 50)?, what)
}

/// Copies of a snapshot, each with one part that it should not have.
pub(crate) fn damaged(good: &Json) -> Vec<Json> {
    /// A picture or a track has thousands of parts, all much alike.
    const MAX: usize = 150;
    let bad = [json!(null), json!("x"), json!(-1), json!(1e300), json!([]), json!({}), json!(u64::MAX)];
    let all = count(good) * bad.len();
    // no multiple of the number of bad parts, so that each of them has its turn
    let stride = all.div_ceil(MAX).max(1);
    let stride = stride + usize::from(stride > 1 && stride.is_multiple_of(bad.len()));
    let copies = (0..all).step_by(stride).filter_map(|i| {
        let mut copy = good.clone();
        *part(&mut copy, &mut { i / bad.len() })? = bad[i % bad.len()].clone();
        Some(copy)
    });
    copies.collect()
}

fn count(json: &Json) -> usize {
    1 + match json {
        Json::Array(items) => items.iter().map(count).sum(),
        Json::Object(map) => map.values().map(count).sum(),
        _ => 0,
    }
}

/// The part of an index in the order of reading.
fn part<'a>(json: &'a mut Json, index: &mut usize) -> Option<&'a mut Json> {
    if *index == 0 {
        return Some(json);
    }
    *index -= 1;
    match json {
        Json::Array(items) => items.iter_mut().find_map(|item| part(item, index)),
        Json::Object(map) => map.values_mut().find_map(|value| part(value, index)),
        _ => None,
    }
}
