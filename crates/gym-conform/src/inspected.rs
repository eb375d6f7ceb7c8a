//! The check of what an environment lets others see and set.

use serde_json::{Value as Json, json};

use crate::arguments::others;
use crate::damage::{far, moves};
use crate::options::of_other_types;
use crate::subject::{MIDWAY, SEEDS, Subject, carry_on, same};
use crate::verdict::{Verdict, broken};
use gym_core::{BoxEnv, Env, EnvExt};

/// The steps of a comparison.
const STEPS: usize = 20;

/// Checks that `set_state` refuses what is no state, and that states and arguments are shown after
/// they were set.
pub(crate) fn checked(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.midway(SEEDS[0])?;
    let Some(inspect) = env.inspect_mut() else {
        return Ok(());
    };
    if let Some(own) = inspect.state() {
        for foreign in [json!(null), json!("x"), json!({"no": "such"}), json!([[]])] {
            if foreign != own && inspect.set_state(foreign.clone()).is_ok() {
                return broken(format!(
                    "`set_state` accepts {foreign}, and a state is {own}"
                ));
            }
            let now = inspect.state();
            if now.as_ref() != Some(&own) {
                return broken(format!(
                    "`set_state` refuses {foreign}, and the state was {own} and is {now:?}"
                ));
            }
        }
        let is_settable = inspect.set_state(own.clone()).is_ok();
        let now = inspect.state();
        if now.as_ref() != Some(&own) {
            return broken(format!("`set_state` of its own state {own} leaves {now:?}"));
        }
        // the environment may refuse every state
        if is_settable {
            generator_stays(subject, &own)?;
            states(subject, &own)?;
            clones(subject, &own)?;
        }
    }
    arguments(subject)
}

/// Checks that `set_state` draws no numbers.
fn generator_stays(subject: &Subject<'_>, own: &Json) -> Verdict {
    let mut env = subject.midway(SEEDS[0])?;
    let before = env.generator().cloned();
    if let Some(inspect) = env.inspect_mut() {
        inspect.set_state(own.clone())?;
    }
    match before.as_ref() == env.generator().as_deref() {
        true => Ok(()),
        false => broken("`set_state` of its own state changes the generator"),
    }
}

/// Checks that clones go on from a state that was set, and that a snapshot contains it.
fn clones(subject: &Subject<'_>, own: &Json) -> Verdict {
    /// The states that are tried.
    const MOST: usize = 6;
    let mut tried = 0;
    let mut state = own.clone();
    for damage in moves(own) {
        let mut env = subject.after(SEEDS[1], MIDWAY + 1)?;
        let accepted = damage.done_to(&mut state, |other| {
            let inspect = env.inspect_mut();
            inspect.is_some_and(|inspect| inspect.set_state(other.clone()).is_ok())
        });
        if !accepted {
            continue;
        }
        tried += 1;
        let mut clone = env.clone();
        let what = damage.difference(own);
        restored(subject, &env, &what)?;
        // a state in which `step` fails is no fault
        let Ok(after) = carry_on(&mut env, SEEDS[0], STEPS) else {
            continue;
        };
        let what = format!("a clone after `set_state` with {what}");
        same(&after, &carry_on(&mut clone, SEEDS[0], STEPS)?, &what)?;
        if tried == MOST {
            break;
        }
    }
    Ok(())
}

/// Checks that an environment that is restored shows the state that was set.
fn restored(subject: &Subject<'_>, env: &BoxEnv, what: &str) -> Verdict {
    let mut other = subject.midway(SEEDS[0])?;
    // (there may be no snapshot of this state)
    let Ok(snapshot) = env.snapshot() else {
        return Ok(());
    };
    if other.restore(&snapshot).is_err() {
        return Ok(());
    }
    let [set, restored] = [env, &other].map(|env| env.inspect().and_then(gym_core::Inspect::state));
    match set == restored {
        true => Ok(()),
        false => broken(format!(
            "after `set_state` with {what} the state is {set:?}, and that of an environment restored from its snapshot is {restored:?}"
        )),
    }
}

/// Checks that states with a number beyond any episode are refused, or harmless.
fn states(subject: &Subject<'_>, own: &Json) -> Verdict {
    let space = subject.make()?.observation_space();
    let mut state = own.clone();
    for damage in far(own) {
        let mut env = subject.midway(SEEDS[0])?;
        let accepted = damage.done_to(&mut state, |other| {
            let inspect = env.inspect_mut();
            inspect.is_some_and(|inspect| inspect.set_state(other.clone()).is_ok())
        });
        let mut actions = env.action_sampler(0)?;
        for _ in 0..if accepted { MIDWAY } else { 0 } {
            // a state in which `step` fails is no fault
            let Ok(step) = env.step(&actions.sample()) else {
                break;
            };
            let is_sound = space.contains(&step.observation) && step.reward.is_finite();
            if !is_sound {
                return broken(format!(
                    "after `set_state` accepts {}, a step has the observation {} and the reward {}",
                    damage.difference(own),
                    step.observation,
                    step.reward
                ));
            }
            if step.done() {
                break;
            }
        }
    }
    Ok(())
}

/// Checks that an argument that was set has its new value, that a refused one has its old value, and
/// that unknown names and values of another type are refused.
fn arguments(subject: &Subject<'_>) -> Verdict {
    let mut env = subject.midway(SEEDS[0])?;
    let Some(inspect) = env.inspect_mut() else {
        return Ok(());
    };
    let Json::Object(own) = inspect.arguments() else {
        return Ok(());
    };
    let unknown = ("no_such_argument", json!(1));
    let wrong = own.iter().flat_map(|(name, value)| {
        let others = of_other_types(value).into_iter();
        others.map(move |other| (&**name, other))
    });
    for (name, value) in wrong.chain([unknown]) {
        if inspect.set_argument(name, value.clone()).is_ok() {
            return broken(format!("`set_argument` accepts {name}={value}"));
        }
        let now = inspect.arguments();
        if now != Json::Object(own.clone()) {
            return broken(format!(
                "`set_argument` refuses {name}={value}, and the arguments are {now}"
            ));
        }
    }
    made_with(subject, &own)?;
    for (name, value) in &own {
        for other in others(value) {
            if inspect.set_argument(name, other.clone()).is_err() {
                continue;
            }
            let now = &inspect.arguments()[name];
            let is_set = match (now.as_f64(), other.as_f64()) {
                (Some(now), Some(other)) => now == other,
                _ => *now == other,
            };
            if !is_set {
                return broken(format!(
                    "after `set_argument` accepts {name}={other}, the argument is {now}"
                ));
            }
        }
    }
    Ok(())
}

/// Checks that an environment shows the arguments that it was made with.
fn made_with(subject: &Subject<'_>, own: &serde_json::Map<String, Json>) -> Verdict {
    let Some((spec, _)) = subject.arguments() else {
        return Ok(());
    };
    for (name, value) in own {
        for other in others(value) {
            let mut spec = spec.clone();
            spec.kwargs.insert(name.clone(), other.clone());
            // (the environment may refuse the value, or take no such argument)
            let Ok(env) = spec.make() else { continue };
            let Some(Json::Object(shown)) = env.inspect().map(gym_core::Inspect::arguments) else {
                continue;
            };
            if shown.get(name) == Some(value) {
                return broken(format!(
                    "made with {name}={other}, its argument is shown as {value}"
                ));
            }
        }
    }
    Ok(())
}
