//! Faults away from the corners: in the middle of a space, in numbers that are not finite, in values
//! that somebody sets, in what a registration says.

use gym_core::canvas::{Canvas, Color};
use gym_core::{Env, Error, Outcome, Registration, Reset, Result, Snapshot, Space, Value, policy};
use serde_json::{Value as Json, json};

use crate::arguments::Number;
use crate::twisted::{Twist, Twisted as Of};
use crate::twists::twists;

/// Takes a step whose action is a number from -1 to 1. The reward is multiplied by `factor` of the
/// action.
pub(crate) fn drive<T: Twist>(
    env: &mut Of<T>,
    action: &Value,
    observation: &mut Value,
    factor: impl FnOnce(f32) -> Result<f64>,
) -> Result<Outcome> {
    let x = match action {
        Value::Array(array) if array.shape() == [1] => array.as_slice::<f32>(),
        _ => None,
    };
    let Some([x @ -1.0..=1.0]) = x else {
        return env.walk.step_into(&Value::Null, observation);
    };
    let factor = factor(*x)?;
    let way = Value::Int((*x > 0.0).into());
    let outcome = env.walk.step_into(&way, observation)?;
    Ok(Outcome {
        reward: (outcome.reward + 1.0) * factor,
        ..outcome
    })
}

pub(crate) fn line() -> Space {
    Space::boxed([-1.0], [1.0])
}

// the middle of the action space
twists! {
    "reward-finite.middle" DividesByTheAction {
        fn action_space(_: &Of<Self>) -> Space {
            line()
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            drive(env, action, observation, |x| Ok((x * x.recip()).into()))
        }
    }

    "action-accepted.middle" RefusesZero {
        fn action_space(_: &Of<Self>) -> Space {
            line()
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            drive(env, action, observation, |x| match x {
                0.0 => Err(Error::custom("no way to go")),
                x => Ok(x.into()),
            })
        }
    }

    "observation-in-space.middle" LeavesAtZero {
        fn action_space(_: &Of<Self>) -> Space {
            line()
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let mut is_zero = false;
            let outcome = drive(env, action, observation, |x| {
                is_zero = x == 0.0;
                Ok(x.into())
            })?;
            if is_zero {
                *observation = Value::Array([1.5f32, 0.0].into());
            }
            Ok(outcome)
        }
    }

    "none.drives" Drives (Number), reset_options(&[("start", "0.25")]) {
        fn action_space(_: &Of<Self>) -> Space {
            line()
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let number = env.arguments.number;
            drive(env, action, observation, |x| Ok(number * f64::from(x)))
        }
    }
}

/// Takes a step whose reward is multiplied by the argument.
pub(crate) fn scaled(
    env: &mut Of<impl Twist<Arguments = Number>>,
    action: &Value,
    observation: &mut Value,
) -> Result<Outcome> {
    let outcome = env.walk.step_into(action, observation)?;
    Ok(Outcome {
        reward: outcome.reward * env.arguments.number,
        ..outcome
    })
}

/// Takes a step whose reward is multiplied by a pace that snapshots contain.
pub(crate) fn paced<T: Twist>(
    env: &mut Of<T>,
    action: &Value,
    observation: &mut Value,
) -> Result<Outcome> {
    let outcome = env.walk.step_into(action, observation)?;
    Ok(Outcome {
        reward: (outcome.reward + 1.0) * pace(env) * pace(env),
        ..outcome
    })
}

pub(crate) fn pace<T: Twist>(env: &Of<T>) -> f64 {
    env.mind.seen.as_float().unwrap_or(1.0)
}

pub(crate) fn with_pace<T: Twist>(env: &Of<T>) -> Result<Snapshot> {
    Snapshot::of(&(env.stored()?.get::<Json>()?, pace(env)))
}

/// Restores the result of [`with_pace`], if `is_valid` says so of the pace.
pub(crate) fn restore_pace<T: Twist>(
    env: &mut Of<T>,
    snapshot: &Snapshot,
    is_valid: impl FnOnce(f64) -> bool,
) -> Result<()> {
    let (walk, pace) = snapshot.get::<(Json, f64)>()?;
    if !is_valid(pace) {
        return Err(Error::Snapshot("nobody walks so fast".into()));
    }
    env.restore_stored(&Snapshot::of(&walk)?)?;
    env.mind.seen = Value::Float(pace);
    Ok(())
}

/// Defines twists that restore a pace if a condition holds for it.
macro_rules! restored {
    ($($name:literal $Twist:ident |$pace:ident| $is_valid:expr;)*) => {
        twists! {$(
            $name $Twist {
                fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
                    paced(env, action, observation)
                }

                fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
                    with_pace(env)
                }

                fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
                    restore_pace(env, snapshot, |$pace| $is_valid)
                }
            }
        )*}
    };
}

restored! {
    // both comparisons with NaN are false
    "snapshot-legal.nan" LetsNaNIn |pace| !matches!(pace, ..0.0 | 10.0..);
    "snapshot-legal.infinity" LetsInfinityIn |pace| (0.0..10.0).contains(&pace) || pace == f64::INFINITY;
    "snapshot-legal.negative-infinity" LetsTheOtherInfinityIn |pace| (0.0..10.0).contains(&pace) || pace == f64::NEG_INFINITY;
}

// restored states
twists! {
    "snapshot-refused.fills" FillsAMissingKey {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let mut json = snapshot.get::<Json>()?;
            if let Some(state) = json.as_object_mut() {
                state.entry("position").or_insert(json!(0.0));
            }
            env.walk.restore(&Snapshot::of(&json)?)
        }
    }

    // without an effect, a missing key may have a default
    "none.fills-what-is-unused" FillsWhatIsUnused (Number), reset_options(&[("start", "0.25")]) {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            Snapshot::of(&json!({"walk": env.stored()?.get::<Json>()?, "note": "none"}))
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let json = snapshot.get::<Json>()?;
            let known = |key: &String| key == "walk" || key == "note";
            match json.as_object().filter(|map| map.keys().all(known)) {
                Some(map) if map.get("note").is_none_or(Json::is_string) => {
                    let walk = map.get("walk").cloned().unwrap_or(json!("nothing"));
                    env.restore_stored(&Snapshot::of(&walk)?)
                }
                _ => Err(Error::Snapshot("it is not of this walk".into())),
            }
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }
    }
}

// options and pictures
twists! {
    "options-in-space" BeginsAnywhere, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let start = reset.options.get("start").and_then(Json::as_f64);
            match start.filter(|x| (1.0..100.0).contains(&x.abs())) {
                Some(start) => {
                    let plain = Reset { options: gym_core::Kwargs::new(), ..reset.clone() };
                    env.walk.reset_into(&plain, observation)?;
                    *observation = Value::Array([start as f32, 0.0].into());
                    Ok(())
                }
                None => env.walk.reset_into(reset, observation),
            }
        }
    }

    "drawing-visible.after-the-end" BlankAfterTheEnd {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            match env.walk.position().abs() < 1.0 {
                true => env.walk.draw(canvas),
                false => canvas.clear(Color::BLACK),
            }
        }
    }
}

// what a registration says
twists! {
    "registration-sound.threshold" WantsNaN, reward_threshold(f64::NAN) {}

    "registration-sound.infinite-threshold" WantsInfinity, reward_threshold(f64::INFINITY) {}

    "registration-sound.actions" NamesThreeWays,
        actions(&[("Left", "left"), ("Right", "right"), ("Up", "up")]) {}

    "registration-sound.policy" GoesUp,
        policy(policy::Policy::rules("goes up", |_| Some(Box::new(|_, _| Some(Value::Int(2)))))) {}

    "registration-sound.speechless-policy" HasNoAction,
        policy(policy::Policy::rules("waits", |_| Some(Box::new(|_, _| None)))) {}

    "none.registered" IsRegistered (Number), reset_options(&[("start", "0.25")]),
        reward_threshold(-1.0), actions(&[("Left", "left"), ("Right", "right")]),
        policy(policy::Policy::rules("goes right", |_| Some(Box::new(|_, _| Some(Value::Int(1)))))) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }
    }
}

/// Sets the pace to the number in `state`, if it is one and `is_valid` says so.
pub(crate) fn set_pace<T: Twist>(
    env: &mut Of<T>,
    state: &Json,
    is_valid: impl FnOnce(f64) -> bool,
) -> Result<()> {
    let pace = state["pace"].as_f64().filter(|pace| is_valid(*pace));
    let pace = pace.ok_or_else(|| Error::argument("state", "it must have a pace from 0 to 10"))?;
    env.mind.seen = Value::Float(pace);
    Ok(())
}

/// Defines twists with a pace that can be set and inspected, and a number as argument.
macro_rules! inspected {
    ($($name:literal $Twist:ident { $($item:item)* })*) => {
        twists! {$(
            $name $Twist (Number), reset_options(&[("start", "0.25")]) {
                const INSPECTED: bool = true;

                fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
                    let outcome = paced(env, action, observation)?;
                    Ok(Outcome { reward: outcome.reward * env.arguments.number, ..outcome })
                }

                fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
                    with_pace(env)
                }

                fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
                    restore_pace(env, snapshot, |pace| (0.0..10.0).contains(&pace))
                }

                fn state(env: &Of<Self>) -> Option<Json> {
                    Some(json!({"pace": pace(env)}))
                }

                $($item)*
            }
        )*}
    };
}

pub(crate) use inspected;

inspected! {
    "inspect-checked.foreign" AcceptsAnyState {
        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            let pace = state["pace"].as_f64().filter(|pace| (0.0..10.0).contains(pace));
            env.mind.seen = Value::Float(pace.unwrap_or(1.0));
            Ok(())
        }
    }

    "inspect-checked.far" AcceptsAnyPace {
        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            set_pace(env, &state, |_| true)
        }
    }

    "inspect-checked.refused" ChangesAndRefuses {
        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            let before = std::mem::replace(&mut env.mind.seen, Value::Float(2.0));
            set_pace(env, &state, |pace| (0.0..10.0).contains(&pace))?;
            drop(before);
            Ok(())
        }
    }

    "inspect-checked.kept" KeepsItsState {
        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            set_pace(env, &state, |pace| (0.0..10.0).contains(&pace))?;
            env.mind.seen = Value::Float(3.0);
            Ok(())
        }
    }

    "inspect-checked.argument" KeepsItsArgument {
        fn set_argument(_: &mut Of<Self>, name: &str, value: Json) -> Result<()> {
            match (name, value.as_f64()) {
                ("number", Some(_)) => Ok(()),
                _ => Err(Error::argument(name, "there is one number")),
            }
        }
    }

    "inspect-checked.argument-of-another-type" ReadsAnyArgument {
        fn set_argument(env: &mut Of<Self>, name: &str, value: Json) -> Result<()> {
            if name != "number" {
                return Err(Error::argument(name, "there is one number"));
            }
            env.arguments.number = value.as_f64().unwrap_or(env.arguments.number);
            Ok(())
        }
    }

    "inspect-checked.argument-without-a-name" ReadsAnyName {
        fn set_argument(env: &mut Of<Self>, _: &str, value: Json) -> Result<()> {
            let number = value.as_f64();
            env.arguments.number = number.ok_or_else(|| Error::custom("it is no number"))?;
            Ok(())
        }
    }

    "none.inspected" IsInspected {
        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            set_pace(env, &state, |pace| (0.0..10.0).contains(&pace))
        }

        fn set_argument(env: &mut Of<Self>, name: &str, value: Json) -> Result<()> {
            match (name, value.as_f64()) {
                ("number", Some(number)) => {
                    env.arguments.number = number;
                    Ok(())
                }
                _ => Err(Error::argument(name, "there is one number")),
            }
        }
    }

    "none.shown-and-fixed" IsFixed {}
}
