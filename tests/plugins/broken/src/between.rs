//! More faults in the families of the others: between the corners of an action space, in options and
//! arguments that are no numbers, in snapshots that are refused late, in what is set and shown.

use gym_core::spaces::MultiDiscrete;
use gym_core::{Env, Error, Kwargs, Outcome, Registration, Reset, Result, Snapshot, Space, Value};
use serde_json::{Value as Json, json};

use crate::arguments::{Bonus, Number, Weights};
use crate::reach::{
    drive, inspected, line, pace, paced, restore_pace, scaled, set_pace, with_pace,
};
use crate::twisted::{Twist, Twisted as Of};
use crate::twists::twists;

// actions
twists! {
    "reward-finite.half" DividesAtAHalf {
        fn action_space(_: &Of<Self>) -> Space {
            line()
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            drive(env, action, observation, |x| Ok(f64::from((x - 0.5) / (x - 0.5).abs())))
        }
    }

    "reward-finite.one-of-a-thousand" PaysNaNForOne {
        fn action_space(_: &Of<Self>) -> Space {
            Space::discrete(1000)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let Some(way @ 0..1000) = action.as_int() else {
                return env.walk.step_into(&Value::Null, observation);
            };
            let outcome = env.walk.step_into(&Value::Int(way % 2), observation)?;
            let reward = if way == 333 { f64::NAN } else { outcome.reward };
            Ok(Outcome { reward, ..outcome })
        }
    }

    "action-accepted.centre" RefusesTheCentre {
        fn action_space(_: &Of<Self>) -> Space {
            MultiDiscrete::new([50i64, 50]).map_or_else(|_| line(), Space::from)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let is_pair = action.as_array().is_some_and(|array| array.shape() == [2]);
            match action.as_slice::<i64>() {
                Some([25, 25]) => Err(Error::custom("no way to go")),
                Some([x @ 0..50, y @ 0..50]) if is_pair => {
                    env.walk.step_into(&Value::Int((x + y) % 2), observation)
                }
                _ => env.walk.step_into(&Value::Null, observation),
            }
        }
    }
}

// snapshots
twists! {
    "snapshot-refused.late" RestoresBeforeItRefuses {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            paced(env, action, observation)
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            with_pace(env)
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, _) = snapshot.get::<(Json, f64)>()?;
            env.restore_stored(&Snapshot::of(&walk)?)?;
            restore_pace(env, snapshot, |pace| (0.0..10.0).contains(&pace))
        }
    }

    "snapshot-refused.other-list" TakesOtherWeights (Weights) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            weighed(env, action, observation)
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.walk.snapshot()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)
        }
    }

    "snapshot-refused.other-bonus" TakesAnotherBonus (Bonus) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let reward = outcome.reward + env.arguments.bonus.unwrap_or(0.25);
            Ok(Outcome { reward, ..outcome })
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.walk.snapshot()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)
        }
    }

    "none.weighed" IsWeighed (Weights), reset_options(&[("start", "0.25")]) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            weighed(env, action, observation)
        }
    }

    // each episode has one step
    "none.bandit" EndsAtOnce (Number), reset_options(&[("start", "0.25")]) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = scaled(env, action, observation)?;
            let reward = outcome.reward + env.walk.position() * env.arguments.number;
            Ok(Outcome { reward, terminated: true, ..outcome })
        }
    }
}

/// Takes a step whose reward is multiplied by the sum of the weights.
fn weighed(
    env: &mut Of<impl Twist<Arguments = Weights>>,
    action: &Value,
    observation: &mut Value,
) -> Result<Outcome> {
    let outcome = env.walk.step_into(action, observation)?;
    let reward = (outcome.reward + 1.0) * env.arguments.weights.iter().sum::<f64>();
    Ok(Outcome { reward, ..outcome })
}

/// Resets with the option `name`, which `read` turns into the start.
fn reset_with<T: Twist>(
    env: &mut Of<T>,
    reset: &Reset,
    observation: &mut Value,
    name: &str,
    read: impl Fn(&Json) -> Option<f64>,
) -> Result<()> {
    let mut options = Kwargs::new();
    for (option, value) in &reset.options {
        let start = (option == name).then(|| read(value)).flatten();
        let start = start.ok_or_else(|| Error::argument(option, "it is no start"))?;
        options.insert("start".into(), start.into());
    }
    let reset = Reset {
        options,
        ..reset.clone()
    };
    env.walk.reset_into(&reset, observation)
}

// options
twists! {
    "options-accepted.text" ReadsTexts, reset_options(&[("begin", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_with(env, reset, observation, "begin", |value| match value {
                Json::String(text) => Some(text.parse().unwrap_or(0.0)),
                other => other.as_f64(),
            })
        }
    }

    "options-accepted.number" TakesANumberForFalse, reset_options(&[("left", "true")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_with(env, reset, observation, "left", |value| match value {
                Json::Bool(true) => Some(-0.5),
                Json::Bool(false) | Json::Number(_) => Some(0.5),
                _ => None,
            })
        }
    }

    "options-accepted.twice" NamesAnOptionTwice,
        reset_options(&[("start", "0.25"), ("start", "0.5")]) {}

    "options-matter.word" TakesAnyWord, reset_options(&[("side", "\"left\"")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_with(env, reset, observation, "side", |value| match value.as_str()? {
                "right" => Some(0.5),
                _ => Some(-0.5),
            })
        }
    }

    "none.flag" BeginsByAFlag (Number), reset_options(&[("left", "true")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let start = |is_left: bool| if is_left { -0.5 } else { 0.5 };
            reset_with(env, reset, observation, "left", |value| value.as_bool().map(start))
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }
    }

    "none.word" BeginsByAWord (Number), reset_options(&[("side", "\"left\"")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            reset_with(env, reset, observation, "side", |value| match value.as_str()? {
                "left" => Some(-0.5),
                "right" => Some(0.5),
                _ => None,
            })
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }
    }
}

inspected! {
    "inspect-checked.text" ReadsAnyTextAsZero {
        fn set_argument(env: &mut Of<Self>, name: &str, value: Json) -> Result<()> {
            let number = value.as_f64().or(value.is_string().then_some(0.0));
            match (name, number) {
                ("number", Some(number)) => {
                    env.arguments.number = number;
                    Ok(())
                }
                _ => Err(Error::argument(name, "there is one number")),
            }
        }
    }

    "inspect-checked.generator" DrawsWhenSet {
        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            set_pace(env, &state, |pace| (0.0..10.0).contains(&pace))?;
            if let Some(generator) = env.walk.generator() {
                generator.random();
            }
            Ok(())
        }
    }

    "inspect-checked.default" ShowsTheDefault {
        fn arguments(_: &Of<Self>) -> Json {
            json!({"number": 1.0})
        }
    }
}

// a state that is set and shown, and not stored
twists! {
    "inspect-checked.snapshot" ShowsWhatIsUnused (Number), reset_options(&[("start", "0.25")]) {
        const INSPECTED: bool = true;

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }

        fn state(env: &Of<Self>) -> Option<Json> {
            Some(json!({"pace": pace(env)}))
        }

        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            set_pace(env, &state, |pace| (0.0..10.0).contains(&pace))
        }
    }
}
