//! Faults that show only in one of several situations that a check tries.

use gym_core::{Env, Error, Outcome, Registration, Reset, Result, Snapshot, Value};

use crate::twisted::{Twist, Twisted as Of};
use crate::twists::twists;

/// A reset without an option.
fn without(reset: &Reset, name: &str) -> Reset {
    let mut reset = reset.clone();
    reset.options.remove(name);
    reset
}

// close
twists! {
    "close-harmless.gone" IsGoneWhenClosedTwice {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if env.mind.own > 1 {
                return Err(Error::Closed("reset"));
            }
            env.mind.own = 0;
            env.walk.reset_into(reset, observation)
        }

        fn close(env: &mut Of<Self>) {
            env.mind.own += 1;
            env.walk.close();
        }
    }

    "snapshot-continues.closed" IsSpoiltWhenClosedAndRestored {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.mind.is_spoilt.set(false);
            env.walk.reset_into(reset, observation)
        }

        fn close(env: &mut Of<Self>) {
            env.mind.is_spoilt.set(true);
            env.walk.close();
        }
    }

    "no-panic.closed-midway" PanicsWhenClosedMidway {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            assert!(env.mind.own < 4, "closed in the middle of an episode");
            env.walk.reset_into(reset, observation)
        }

        fn close(env: &mut Of<Self>) {
            env.mind.own = env.mind.age;
            env.walk.close();
        }
    }
}

// what is written into
twists! {
    "observation-whole.form" KeepsAnotherForm {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let is_other = observation.as_array().is_some_and(|array| array.shape() == [2, 3]);
            let outcome = env.walk.step_into(action, observation)?;
            if is_other {
                *observation = Value::from([0.5_f32, 0.0]);
            }
            Ok(outcome)
        }
    }
}

// options
twists! {
    "options-matter.after-the-same-seed" KeepsTheStartOfASeed, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let seed = reset.seed.as_ref().map(|seed| format!("{seed:?}"));
            let last = seed.map_or(Value::Null, Value::Text);
            let is_plain = !reset.options.contains_key("start");
            let again = last != Value::Null && env.mind.seen == last;
            let done = match again {
                true => env.walk.reset_into(&without(reset, "start"), observation),
                false => env.walk.reset_into(reset, observation),
            };
            env.mind.seen = if is_plain { last } else { Value::Null };
            done
        }
    }

    "no-panic.option" PanicsOnAnotherOption, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let start = reset.options.get("start").and_then(serde_json::Value::as_f64);
            assert!(start.is_none_or(|start| start.abs() < 1e9), "it is far away");
            env.walk.reset_into(reset, observation)
        }
    }
}

// snapshots
twists! {
    "snapshot-refused.spoilt" IsSpoiltByARefusal {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let is_list = snapshot.get::<Vec<i64>>().is_ok();
            let restored = env.walk.restore(snapshot);
            if restored.is_err() && is_list {
                env.mind.is_spoilt.set(true);
            }
            restored
        }
    }
}

// entries that are not neighbours, and numbers next to a range
twists! {
    "info-consistent.apart" TellsTwiceApart {
        fn info(_: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            for key in ["place", "way", "place"] {
                visit(key, Value::Int(0));
            }
        }
    }

    "action-validated.below" TakesTheNumberBelow {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let is_below = *action == Value::Int(-1);
            env.walk.step_into(if is_below { &Value::Int(0) } else { action }, observation)
        }
    }

    "action-validated.above" TakesTheNumberAbove {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let is_above = *action == Value::Int(2);
            env.walk.step_into(if is_above { &Value::Int(1) } else { action }, observation)
        }
    }
}
