//! More faults in what lies beyond an ordinary episode: other parts of actions, snapshots and
//! options, texts, keys and clips, states and arguments that somebody sets.

use gym_core::registry::Clip;
use gym_core::render::{Metadata, RenderMode};
use gym_core::{
    Env, Error, Keys, Names, Outcome, Registration, Reset, Result, Snapshot, Space, Value, keys,
    policy,
};
use serde_json::{Value as Json, json};

use crate::arguments::Number;
use crate::reach::{drive, inspected, pace, paced, restore_pace, scaled, set_pace, with_pace};
use crate::twisted::{Mind, Twist, Twisted as Of};
use crate::twists::twists;

// actions
twists! {
    "action-accepted.in-between" RefusesOneOfMany {
        fn action_space(_: &Of<Self>) -> Space {
            Space::discrete(41)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            match action.as_int() {
                Some(20) => Err(Error::custom("no way to go")),
                Some(way @ 0..41) => env.walk.step_into(&Value::Int(way % 2), observation),
                _ => env.walk.step_into(&Value::Null, observation),
            }
        }
    }

    // an action space without zero
    "none.never-zero" NeverZero (Number), reset_options(&[("start", "0.25")]),
        exceptions(&[("action-normalised", "it has no way to stay")]) {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-1.0], [-0.5])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let number = env.arguments.number;
            drive(env, action, observation, |x| match x {
                ..=-0.5 => Ok(number / f64::from(x)),
                _ => Err(Error::custom("no way to stay")),
            })
        }
    }
}

// snapshots
twists! {
    // a missing key keeps the value of before
    "snapshot-refused.keeps" KeepsWhatIsMissing {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let mut json = snapshot.get::<Json>()?;
            let own = env.walk.snapshot()?.get::<Json>()?;
            if let (Some(state), Json::Object(own)) = (json.as_object_mut(), own)
                && !state.contains_key("position")
            {
                state.insert("position".into(), own["position"].clone());
            }
            env.walk.restore(&Snapshot::of(&json)?)
        }
    }
}

// options
twists! {
    "options-in-space.list" BeginsAnywhereOfTwo, reset_options(&[("place", "[0.25, 0.0]")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_place(env, reset, observation, |x| x.abs() < 100.0)
        }
    }

    "options-in-space.late" LeavesLater, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let start = reset.options.get("start").and_then(Json::as_f64);
            let far = start.filter(|start| *start == 10.0);
            env.mind.own = far.is_some().into();
            match far {
                Some(_) => env.walk.reset_into(&Reset { options: gym_core::Kwargs::new(), ..reset.clone() }, observation),
                None => env.walk.reset_into(reset, observation),
            }
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            if env.mind.own == 1 && env.walk.steps() > 3 {
                *observation = Value::Array([1.5f32, 0.0].into());
            }
            Ok(outcome)
        }
    }

    "none.place" BeginsAtAPlace (Number), reset_options(&[("place", "[0.25, 0.0]")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_place(env, reset, observation, |x| x.abs() <= 1.0)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }
    }
}

/// Resets with the option `place`, a list of two numbers of which the first is the start.
fn with_place<T: Twist>(
    env: &mut Of<T>,
    reset: &Reset,
    observation: &mut Value,
    is_valid: impl Fn(f64) -> bool,
) -> Result<()> {
    let Some(place) = reset.options.get("place") else {
        return env.walk.reset_into(reset, observation);
    };
    let numbers = place.as_array().filter(|list| list.len() == 2);
    let [x, y] = [0, 1].map(|i| {
        numbers
            .and_then(|list| list[i].as_f64())
            .filter(|x| is_valid(*x))
    });
    let (Some(x), Some(y)) = (x, y) else {
        return Err(Error::argument(
            "place",
            "it must be two numbers from -1 to 1",
        ));
    };
    let options = [("start".to_owned(), x.clamp(-1.0, 1.0).into())];
    let options = options.into_iter().collect();
    env.walk.reset_into(
        &Reset {
            options,
            ..reset.clone()
        },
        observation,
    )?;
    if x.abs() > 1.0 || y.abs() > 1.0 {
        *observation = Value::Array([x as f32, y as f32].into());
    }
    Ok(())
}

// texts
twists! {
    "render-modes.text-at-the-end" SpeechlessAtTheEnd {
        fn metadata(env: &Of<Self>) -> Metadata {
            Metadata { render_modes: &[RenderMode::RgbArray, RenderMode::Ansi], ..env.walk.metadata() }
        }

        fn ansi(env: &Of<Self>) -> Option<String> {
            let position = env.walk.position();
            (position.abs() < 1.0).then(|| format!("at {position}"))
        }
    }

    "none.says-the-end" SaysTheEnd (Number), reset_options(&[("start", "0.25")]) {
        fn metadata(env: &Of<Self>) -> Metadata {
            Metadata { render_modes: &[RenderMode::RgbArray, RenderMode::Ansi], ..env.walk.metadata() }
        }

        fn ansi(env: &Of<Self>) -> Option<String> {
            let position = env.walk.position();
            Some(if position.abs() < 1.0 { format!("at {position}") } else { "the end".into() })
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }
    }
}

/// A clip with a number of frames.
const fn clip(frames: u32) -> Clip {
    Clip {
        seeds: 0..2,
        every: 1,
        frames,
        size: (20, 4),
    }
}

// what a registration says
twists! {
    "registration-sound.key" HasAKeyTooMany,
        keys(|_| Keys::new(keys::json!({"Left": 0, "Up": 2}))) {}

    "registration-sound.idle" IsIdleElsewhere,
        keys(|_| Keys::new(keys::json!({"Left": 0})).idle(keys::json!([0]))) {}

    "registration-sound.same-name" NamesOneTwice,
        actions(&[("Left", "left"), ("Left", "right")]) {}

    "registration-sound.no-name" NamesNothing,
        actions(&[("Left", "left"), ("", "right")]) {}

    "registration-sound.number-too-many" NamesThreeNumbers,
        names(|_| Names::new(&["position", "velocity", "acceleration"], &[])) {}

    "registration-sound.numbers-alike" NamesTwoNumbersAlike,
        names(|_| Names::new(&["position", "position"], &[])) {}

    "registration-sound.no-such-number" NamesNumbersOfAnAction,
        names(|_| Names::new(&[], &["force", "torque"])) {}

    "registration-sound.no-frames" HasNoFrames, clip(clip(0)) {}

    "registration-sound.late-policy" GoesUpLater,
        policy(policy::Policy::rules("goes up later", |_| {
            let mut steps = 0;
            Some(Box::new(move |_, _| {
                steps += 1;
                // to and fro, so that the episode goes on
                Some(Value::Int(if steps > 8 { 2 } else { steps % 2 }))
            }))
        })) {}

    "registration-sound.damaged-policy" HasADamagedPolicy,
        policy(policy::Policy::trained("is damaged", |_| Err(Error::custom("it is damaged")))) {}

    // the policy fits some arguments, and only one action has a name and a key
    "none.partly-registered" IsPartlyRegistered (Number), reset_options(&[("start", "0.25")]),
        actions(&[("Left", "left")]), keys(|_| Keys::new(keys::json!({"Left": 0})).repeat()),
        names(|_| Names::new(&["position", "velocity"], &["direction"])),
        clip(clip(9)), policy(policy::Policy::rules("never fits", |_| None)) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }
    }
}

inspected! {
    "inspect-checked.argument-refused" ChangesARefusedArgument {
        fn set_argument(env: &mut Of<Self>, name: &str, value: Json) -> Result<()> {
            env.arguments.number += 1.0;
            set_number(env, name, &value)
        }
    }

    "inspect-checked.clone" ForgetsItsPaceInClones {
        fn copied(env: &Of<Self>) -> Mind {
            Mind { seen: Value::Null, ..env.mind.clone() }
        }

        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            set_pace(env, &state, |pace| (0.0..10.0).contains(&pace))
        }
    }

    // a state that is brought into range
    "none.clamps" ClampsItsState {
        fn set_state(env: &mut Of<Self>, state: Json) -> Result<()> {
            let clamped = state["pace"].as_f64().map(|pace| pace.clamp(0.0, 9.0));
            set_pace(env, &json!({"pace": clamped}), |_| true)
        }
    }

    // an argument that counts from the next reset on
    "none.for-the-next-episode" CountsFromTheNextReset {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.arguments.number = shown(env);
            env.walk.reset_into(reset, observation)
        }

        fn arguments(env: &Of<Self>) -> Json {
            json!({"number": shown(env)})
        }

        fn set_argument(env: &mut Of<Self>, name: &str, value: Json) -> Result<()> {
            env.mind.own = hidden(name, &value)?;
            Ok(())
        }
    }
}

/// The argument, or the one that [`hidden`] took.
fn shown(env: &Of<impl Twist<Arguments = Number>>) -> f64 {
    match env.mind.own {
        0 => env.arguments.number,
        bits => f64::from_bits(!bits),
    }
}

/// Returns the number as bits that are not 0.
fn hidden(name: &str, value: &Json) -> Result<u64> {
    match (name, value.as_f64()) {
        ("number", Some(number)) => Ok(!number.to_bits()),
        _ => Err(Error::argument(name, "there is one number")),
    }
}

/// Sets the argument.
fn set_number(
    env: &mut Of<impl Twist<Arguments = Number>>,
    name: &str,
    value: &Json,
) -> Result<()> {
    match (name, value.as_f64()) {
        ("number", Some(number)) => {
            env.arguments.number = number;
            Ok(())
        }
        _ => Err(Error::argument(name, "there is one number")),
    }
}
