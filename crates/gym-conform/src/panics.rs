//! The check that no call makes an environment panic.

use std::panic::{AssertUnwindSafe, catch_unwind};

use serde_json::{Value as Json, json};

use crate::arguments;
use crate::inputs::{corners, huge, invalid, uniform};
use crate::look::look;
use crate::subject::{Subject, carry_on};
use crate::verdict::{Verdict, broken, message};
use gym_core::{BoxEnv, Env, EnvExt, Reset, Result, Value};

pub(crate) fn none(subject: &Subject<'_>) -> Verdict {
    attempt("before the first reset", || {
        out_of_order(&mut subject.make()?)
    })?;
    attempt("when closed twice", || {
        let mut env = subject.reset(0)?;
        env.close();
        env.close();
        out_of_order(&mut env)?;
        env.reset(0).map(drop)
    })?;
    for (what, reset) in [
        ("with a seed", Reset::seed(0)),
        ("without a seed", Reset::default()),
    ] {
        for times in 1..=2 {
            let what = format!("when reset {what} after {times} calls of `close`");
            attempt(&what, || {
                let mut env = subject.midway(0)?;
                (0..times).for_each(|_| env.close());
                env.reset(reset.clone())?;
                look(&env);
                carry_on(&mut env, 0, 20).map(drop)
            })?;
        }
    }
    attempt("when restored after `close`", || {
        let mut env = subject.midway(0)?;
        let snapshot = env.snapshot()?;
        env.close();
        env.restore(&snapshot)?;
        look(&env);
        carry_on(&mut env, 0, 20).map(drop)
    })?;
    attempt("when stepped beyond the end of an episode", || {
        beyond_the_end(&mut subject.reset(0)?)
    })?;
    for action in odd_actions(&subject.make()?)? {
        attempt(&format!("on the action {action:?}"), || {
            let mut env = subject.reset(0)?;
            for _ in 0..20 {
                let _ = env.step(&action);
            }
            look(&env);
            Ok(())
        })?;
    }
    for (name, value) in odd_options(subject) {
        attempt(&format!("on the reset option {name}={value}"), || {
            let mut env = subject.make()?;
            let _ = env.reset(Reset::seed(0).option(name, value.clone()));
            let _ = env.reset(Reset::default().option(name, value.clone()));
            look(&env);
            carry_on(&mut env, 0, 5).map(drop)
        })?;
    }
    // (an environment without snapshots has no damaged snapshots)
    if let Ok(damaged) = subject.damaged() {
        damaged.panicked()?;
    }
    subject.variants().panicked()?;
    odd_arguments(subject)
}

/// Runs `f` and ignores its errors.
fn attempt(what: &str, f: impl FnOnce() -> Result<()>) -> Verdict {
    match catch_unwind(AssertUnwindSafe(f)) {
        Ok(_) => Ok(()),
        Err(payload) => broken(format!("{what} {}", message(&*payload))),
    }
}

/// Makes every call on an environment outside of an episode.
fn out_of_order(env: &mut BoxEnv) -> Result<()> {
    look(env);
    let _ = env.render();
    let _ = env.generator().is_some();
    if let Ok(snapshot) = env.snapshot() {
        let _ = env.restore(&snapshot);
    }
    let action = env.action_sampler(0)?.sample();
    let _ = env.step(&action);
    let _ = env.step(&Value::Null);
    Ok(())
}

fn beyond_the_end(env: &mut BoxEnv) -> Result<()> {
    let mut actions = env.action_sampler(0)?;
    let mut after_the_end = 0;
    for _ in 0..500 {
        match env.step(&actions.sample()) {
            Ok(step) if after_the_end == 0 && !step.done() => (),
            _ => after_the_end += 1,
        }
        if after_the_end == 20 {
            break;
        }
    }
    look(env);
    Ok(())
}

/// Returns unusual actions: the corners of the space, huge numbers, and invalid actions.
fn odd_actions(env: &BoxEnv) -> Result<Vec<Value>> {
    let space = env.action_space();
    let valid = env.action_sampler(0)?.sample();
    let mut actions = invalid(&space, &valid);
    actions.extend(corners(&space));
    actions.extend(huge(&space));
    actions.extend(
        [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY]
            .iter()
            .filter_map(|&x| uniform(&space, x)),
    );
    Ok(actions)
}

/// Iterates over options, named by the registration or not, with unexpected values.
fn odd_options(subject: &Subject<'_>) -> impl Iterator<Item = (&'static str, Json)> {
    let values = [
        json!(null),
        json!("x"),
        json!(-1e300),
        json!(1e300),
        json!([]),
        json!({"a": 1}),
        json!(true),
    ];
    let named = subject
        .registration
        .as_ref()
        .map(|registration| registration.reset_options);
    let names = named.unwrap_or_default().0.iter().map(|(name, _)| *name);
    names
        .chain(["low", "high", "seed", "options", ""])
        .flat_map(move |name| values.clone().map(|value| (name, value)))
}

/// Plays an episode with each unusual argument.
fn odd_arguments(subject: &Subject<'_>) -> Verdict {
    for odd in arguments::odd(subject) {
        attempt(&format!("with the argument {odd}"), || {
            let mut env = odd.spec.make()?;
            env.reset(0)?;
            look(&env);
            carry_on(&mut env, 0, 20)?;
            look(&env);
            Ok(())
        })?;
    }
    Ok(())
}
