//! Checks of clones and snapshots.

use serde_json::{Value as Json, json};

use crate::arguments;
use crate::calls::Calls;
use crate::subject::{MIDWAY, SEEDS, STEPS, Shown, Subject, alike, carry_on, info, roll_out, same};
use crate::verdict::{Verdict, broken};
use gym_core::{BoxEnv, Env, EnvExt, Error, Result, Snapshot, Value};

pub(crate) fn clone_apart(subject: &Subject<'_>) -> Verdict {
    for seed in SEEDS {
        let (mut env, mut other) = (subject.midway(seed)?, subject.midway(seed)?);
        // if `other` and `env` differ from the start, the check state-shown reports it
        let is_alike = same_face(&other, &env, "").is_ok();
        let (mut clone, mut idle) = (env.clone(), env.clone());
        // calls on `clone` must not change `env`
        let _ = carry_on(&mut clone, seed + 1, 20);
        let what = "an environment whose clone was used";
        let same_face = |env: &BoxEnv| match is_alike {
            true => same_face(&other, env, what),
            false => Ok(()),
        };
        same_face(&env)?;
        let _ = clone.reset(seed + 1);
        same_face(&env)?;
        clone.close();
        clone.close();
        same_face(&env)?;
        // if a clone differs at once, the check clone-continues reports it
        let copied = carry_on(&mut subject.midway(seed)?.clone(), seed, STEPS);
        let untouched = carry_on(&mut other, seed, STEPS)?;
        same(&untouched, &carry_on(&mut env, seed, STEPS)?, what)?;
        if copied.is_ok_and(|copied| same(&untouched, &copied, what).is_ok()) {
            let _ = env.reset(seed + 1);
            env.close();
            env.close();
            let what = "a clone whose original was used and closed";
            same(&untouched, &carry_on(&mut idle, seed, STEPS)?, what)?;
        }
    }
    // shared state may have an effect only after many steps
    let (seed, long) = (SEEDS[0], subject.long()?);
    let mut env = subject.midway(seed)?;
    carry_on(&mut env.clone(), seed + 1, long)?;
    let what = "an environment whose clone was used for long";
    same(
        &subject.untouched(seed, MIDWAY, long)?,
        &carry_on(&mut env, seed, long)?,
        what,
    )
}

/// Compares everything that two environments return without a reset or step.
fn same_face(a: &BoxEnv, b: &BoxEnv, what: &str) -> Verdict {
    let face = |env: &BoxEnv| {
        let spaces = [env.observation_space(), env.action_space()];
        [
            ("info", format!("{:?}", info(env))),
            ("text", format!("{:?}", env.ansi())),
            ("metadata", format!("{:?}", env.metadata())),
            ("spaces", format!("{spaces:?}")),
        ]
    };
    for ((part, a), (_, b)) in face(a).into_iter().zip(face(b)) {
        if a != b {
            return broken(format!("{what} has another {part} at once: {a} and {b}"));
        }
    }
    if Calls::of(a).record != Calls::of(b).record {
        let [a, b] = [a, b].map(Calls::text);
        return broken(format!("{what} has another drawing at once: {a} and {b}"));
    }
    Ok(())
}

pub(crate) fn clone_continues(subject: &Subject<'_>) -> Verdict {
    continues(subject, &[("a clone", &|env| Ok(env.clone()))])?;
    continues_after_the_end(subject, "a clone taken at the end of an episode", |env| {
        Ok(env.clone())
    })?;
    subject.variants().cloned()
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
    in_every_state(subject)?;
    again_and_again(subject)?;
    after_close(subject)?;
    subject.variants().restored()?;
    with_odd_arguments(subject)
}

/// Checks that a closed environment that accepts a snapshot continues.
fn after_close(subject: &Subject<'_>) -> Verdict {
    let seed = SEEDS[0];
    let mut env = subject.midway(seed)?;
    let snapshot = env.snapshot()?;
    env.close();
    // a closed environment may refuse all calls
    if env.restore(&snapshot).is_ok()
        && let Ok(rest) = carry_on(&mut env, seed, STEPS)
    {
        let untouched = subject.untouched(seed, MIDWAY, STEPS)?;
        let is_reset = |shown: &Shown| matches!(shown, Shown::Reset(..));
        // a reset after `close` is part of another check
        let end = rest.iter().position(is_reset).unwrap_or(rest.len());
        let what = "an environment that was closed and restored";
        same(&untouched, &rest[..end], what)?;
    }
    Ok(())
}

/// Checks that an environment continues unchanged if it is restored from its own snapshot again and
/// again.
fn again_and_again(subject: &Subject<'_>) -> Verdict {
    const AFTER: usize = 20;
    // storing a large state takes long
    let times = if subject.few()? < 20 { 2 } else { 10 };
    let seed = SEEDS[0];
    let mut env = subject.midway(seed)?;
    for _ in 0..times {
        let snapshot = env.snapshot()?;
        env.restore(&snapshot)?;
    }
    let rest = carry_on(&mut env, seed, AFTER)?;
    let untouched = subject.untouched(seed, MIDWAY, STEPS)?;
    let what = format!("an environment restored {times} times from its own snapshot");
    same(&untouched, &rest, &what)
}

/// Checks, in each state of some episodes, that a snapshot can be taken, and that the events after
/// `restore` are equal. Only this check finds faults in rare states.
fn in_every_state(subject: &Subject<'_>) -> Verdict {
    /// The number of events that are compared after each state.
    const AFTER: usize = 4;
    /// The number of bytes from which a stored state counts as large.
    const LARGE: usize = 100_000;
    let seed = SEEDS[1];
    let mut env = subject.make()?;
    let mut actions = env.action_sampler(seed)?;
    let (mut shown, mut taken, mut states) = (Vec::new(), Vec::new(), Vec::new());
    env.reset(seed)?;
    let stored = env.snapshot().map(|state| serde_json::to_string(&state));
    let is_large = matches!(stored, Ok(Ok(text)) if text.len() >= LARGE);
    // storing a large state takes long
    let (events, every) = match (subject.few()? < 20, is_large) {
        (true, _) => (60, 6),
        (false, true) => (400, 8),
        (false, false) => (400, 1),
    };
    let mut is_over = false;
    for event in 0..events {
        let action = (!is_over).then(|| actions.sample());
        let next = go_on(&mut env, action.as_ref())?;
        is_over = matches!(&next, Shown::Step(step, _) if step.done());
        taken.push(action);
        shown.push(next);
        if event % every == 0 || is_over {
            match env.snapshot() {
                Ok(snapshot) => states.push((event + 1, snapshot)),
                Err(error) => {
                    return broken(format!(
                        "after {event} events of seed {seed} there is no snapshot: {error}"
                    ));
                }
            }
        }
    }
    let mut other = subject.midway(7)?;
    for (i, (event, snapshot)) in states.into_iter().enumerate() {
        // `restore` mostly happens within an episode of `other`; this reset keeps the episode short
        if i % 16 == 0 {
            other.reset(7)?;
        }
        let what = format!("an environment restored after {event} events of seed {seed}");
        if let Err(error) = other.restore(&snapshot) {
            return broken(format!("{what}: {error}"));
        }
        let until = (event + AFTER).min(events);
        let again = taken[event..until]
            .iter()
            .map(|action| go_on(&mut other, action.as_ref()));
        match again.collect::<Result<Vec<_>>>() {
            Ok(again) => same(&shown[event..until], &again, &what)?,
            Err(error) => return broken(format!("{what}: {error}")),
        }
    }
    Ok(())
}

/// Takes a step, or resets `env` if there is no action.
fn go_on(env: &mut BoxEnv, action: Option<&Value>) -> Result<Shown> {
    match action {
        Some(action) => {
            let step = env.step(action)?;
            Ok(Shown::Step(step, info(env)))
        }
        None => {
            let observation = env.reset(())?;
            Ok(Shown::Reset(observation, info(env)))
        }
    }
}

/// Writes the snapshot of `env` as text, reads the text, and restores `into` from the result.
fn restored(env: &BoxEnv, mut into: BoxEnv) -> Result<BoxEnv> {
    let stored = |error: serde_json::Error| Error::Snapshot(error.to_string());
    let text = serde_json::to_string(&env.snapshot()?).map_err(stored)?;
    into.restore(&serde_json::from_str(&text).map_err(stored)?)?;
    Ok(into)
}

/// Returns an environment at the end of an episode, or after 300 steps.
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

/// Checks that a used environment equals a new environment after it is restored from a new
/// environment's snapshot.
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

/// Checks that environments with unusual arguments accept their own snapshots.
fn with_odd_arguments(subject: &Subject<'_>) -> Verdict {
    for odd in arguments::odd(subject) {
        let played = || -> Result<BoxEnv> {
            let mut env = odd.spec.make()?;
            env.reset(0)?;
            carry_on(&mut env, 0, 20)?;
            Ok(env)
        };
        // (the environment may refuse the argument, or fail in a step)
        let Ok(env) = played() else { continue };
        if let Err(error) = restored(&env, env.clone()) {
            return broken(format!(
                "with the argument {odd} an environment refuses its own snapshot: {error}"
            ));
        }
    }
    Ok(())
}

/// The name of a way to copy an environment, and the function that copies.
type Copying<'a> = (&'a str, &'a dyn Fn(&BoxEnv) -> Result<BoxEnv>);

/// Checks that copies taken in an episode continue like an environment that was not copied.
fn continues(subject: &Subject<'_>, copies: &[Copying<'_>]) -> Verdict {
    let long = subject.long()?;
    let [early, other, late] = SEEDS;
    let first = copies.first().map_or("a copy", |(what, _)| what);
    // two early copies, of which one is played for long, and one late copy
    for (seed, before, after) in [
        (early, MIDWAY, long),
        (other, MIDWAY, STEPS),
        (late, long / 2, STEPS),
    ] {
        let mut env = subject.after(seed, before)?;
        let untouched = subject.untouched(seed, before, after)?;
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

/// Checks that a copy taken at the end of an episode has the same next episode as the original.
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

/// Checks that `restore` refuses content that no environment writes, and that a refused `restore`
/// changes nothing.
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
    subject.damaged()?.filled()?;
    of_other_arguments(subject)?;
    let what = "after refused snapshots an episode";
    same(
        &carry_on(&mut midway()?, seed, 50)?,
        &carry_on(&mut env, seed, 50)?,
        what,
    )
}

/// Checks a snapshot of an environment with another argument: `restore` must refuse the snapshot,
/// or the environment must continue like the snapshot's environment.
fn of_other_arguments(subject: &Subject<'_>) -> Verdict {
    const AFTER: usize = 20;
    let Some((spec, kwargs)) = subject.arguments() else {
        return Ok(());
    };
    let seed = SEEDS[0];
    let mut own = subject.midway(seed)?;
    for (name, value) in &kwargs {
        for other in arguments::guesses(value) {
            let mut with = spec.clone();
            with.kwargs.insert(name.clone(), other.clone());
            let midway = || -> Result<BoxEnv> {
                let mut env = with.make()?;
                roll_out(&mut env, seed, 5)?;
                Ok(env)
            };
            // (the environment may refuse the argument, or have no snapshots)
            let Ok(mut env) = midway() else { continue };
            let Ok(snapshot) = env.snapshot() else {
                continue;
            };
            if own.restore(&snapshot).is_err() {
                continue;
            }
            let mut actions = own.action_sampler(seed)?;
            for _ in 0..AFTER {
                let action = actions.sample();
                // (an action may be valid with only one of the two arguments)
                let (Ok(a), Ok(b)) = (env.step(&action), own.step(&action)) else {
                    break;
                };
                let is_over = a.done();
                let [a, b] = [Shown::Step(a, info(&env)), Shown::Step(b, info(&own))];
                if !alike(&a, &b) {
                    return broken(format!(
                        "`restore` accepts the snapshot of an environment with {name}={other}, and goes on otherwise: {a:?} and {b:?}"
                    ));
                }
                if is_over {
                    break;
                }
            }
        }
    }
    Ok(())
}

/// Checks that `restore` accepts only states that the environment can reach.
pub(crate) fn snapshot_legal(subject: &Subject<'_>) -> Verdict {
    subject.damaged()?.illegal()
}
