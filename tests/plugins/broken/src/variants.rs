//! Faults that only show with another argument, with an option, or with unusual seeds, actions and
//! buffers.

use std::sync::atomic::{AtomicU64, Ordering};

use gym_core::spaces::{DictSpace, MultiBinary};
use gym_core::{
    Array, DType, Data, Element, Env, Error, Generator, Outcome, Reset, Result, Snapshot, Space,
    Value,
};
use serde_json::Value as Json;

use crate::arguments::{Mode, Scale};
use crate::pairs::pairs;
use crate::twisted::{Mind, Twist, Twisted as Of};
use crate::twists::with_seed;

/// Returns the first number of a buffer, if the number is finite.
fn first(buffer: &Value) -> Option<f32> {
    let numbers = buffer.as_array()?.as_slice::<f32>()?;
    numbers.first().copied().filter(|x| x.is_finite())
}

/// Scales the reward.
fn scaled<T: Twist<Arguments = Scale>>(env: &Of<T>, outcome: Outcome, more: f64) -> Outcome {
    Outcome {
        reward: (outcome.reward + more) * env.arguments.scale,
        ..outcome
    }
}

/// Pays more if steps are fast.
fn paid<T: Twist<Arguments = Mode>>(env: &Of<T>, outcome: Outcome) -> Outcome {
    let more = if env.arguments.fast { 0.25 } else { 0.0 };
    Outcome {
        reward: outcome.reward + more,
        ..outcome
    }
}

// buffers
pairs! {
    // the reward depends on the old content of the observation buffer
    "observation-whole" "reward" PaysForTheBuffer {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let old = if BAD { first(observation) } else { Some(env.walk.position() as f32) };
            let outcome = env.walk.step_into(action, observation)?;
            Ok(scaled(env, outcome, f64::from(old.unwrap_or(0.0))))
        }
    }

    // `info` contains the old content of the observation buffer
    "observation-whole" "info" TellsOfTheBuffer scaled_step {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let old = if BAD { first(observation) } else { None };
            env.walk.reset_into(reset, observation)?;
            env.mind.seen = Value::Float(old.or(first(observation)).unwrap_or(0.0).into());
            Ok(())
        }


        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            Snapshot::of(&(env.stored()?.get::<Json>()?, env.mind.seen.as_float()))
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, seen) = snapshot.get::<(Json, Option<f64>)>()?;
            env.restore_stored(&Snapshot::of(&walk)?)?;
            env.mind.seen = seen.map_or(Value::Null, Value::Float);
            Ok(())
        }

        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("began", env.mind.seen.clone());
        }
    }
}

// seeds
pairs! {
    // a seed of more than 128 bits is cut
    "other-seed-other-episode" "long" CutsLongSeeds scaled_step {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let cut = |seed: &gym_core::Seed| -> gym_core::Seed {
                let digits = seed.to_string();
                match digits.parse::<u128>() {
                    Ok(_) => seed.clone(),
                    Err(_) => modulo_2_128(&digits).to_string().parse().unwrap_or_else(|_| seed.clone()),
                }
            };
            let seed = reset.seed.as_ref().map(|seed| if BAD { cut(seed) } else { seed.clone() });
            env.walk.reset_into(&Reset { seed, ..reset.clone() }, observation)
        }
    }

    // the seed of the last reset is not read again
    "reset-forgets" "seed-again" SkipsTheSameSeed scaled_step {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let again = reset.seed.as_ref().map(|seed| Value::Text(seed.to_string()));
            let is_again = again.as_ref() == Some(&env.mind.seen);
            let seed = reset.seed.clone().filter(|_| !(BAD && is_again));
            env.walk.reset_into(&Reset { seed, ..reset.clone() }, observation)?;
            if let Some(seed) = again {
                env.mind.seen = seed;
            }
            Ok(())
        }
    }

    // a seed above 2^63 is read as a negative number, and 0 takes its place
    "other-seed-other-episode" "signed" ClampsLargeSeeds scaled_step {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_seed(env, reset, |seed| if BAD { (seed as i64).max(0) as u64 } else { seed }, observation)
        }
    }
}

/// Returns the remainder of a decimal number by 2^128.
fn modulo_2_128(digits: &str) -> u128 {
    digits.bytes().fold(0, |n: u128, digit| {
        n.wrapping_mul(10).wrapping_add((digit - b'0').into())
    })
}

// options
pairs! {
    // the first reset refuses an option without a seed
    "options-accepted" "without-a-seed" NeedsASeedFirst scaled_step {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if BAD && !env.mind.is_begun && reset.seed.is_none() && !reset.options.is_empty() {
                return Err(Error::argument("reset", "`start` needs a seed"));
            }
            env.walk.reset_into(reset, observation)
        }
    }

    "observation-in-space" "option" BeginsOutside scaled_step {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            if BAD && !reset.options.is_empty() {
                [1.5f32, 0.0].write(observation);
            }
            Ok(())
        }
    }

    // an option applies to the whole episode, and the snapshot does not contain the option
    "snapshot-continues" "option" ForgetsItsOption {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.own = u64::from(!reset.options.is_empty());
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(scaled(env, outcome, env.mind.own as f64))
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            Snapshot::of(&(env.stored()?.get::<Json>()?, !BAD && env.mind.own == 1))
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, own) = snapshot.get::<(Json, bool)>()?;
            env.restore_stored(&Snapshot::of(&walk)?)?;
            env.mind.own = own.into();
            Ok(())
        }
    }

    // the clone of such an episode forgets the option
    "clone-continues" "option" CloneForgetsItsOption {
        fn copied(env: &Of<Self>) -> Mind {
            let own = if BAD { 0 } else { env.mind.own };
            Mind { own, ..env.mind.clone() }
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.own = u64::from(!reset.options.is_empty());
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(scaled(env, outcome, env.mind.own as f64))
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            Snapshot::of(&(env.stored()?.get::<Json>()?, env.mind.own == 1))
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, own) = snapshot.get::<(Json, bool)>()?;
            env.restore_stored(&Snapshot::of(&walk)?)?;
            env.mind.own = own.into();
            Ok(())
        }
    }

    // with `fast`, the reward has a random part from the operating system
    "same-seed-same-episode" "argument" FastByChance (Mode) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let chance = if BAD && env.arguments.fast { Generator::from_os()?.random() } else { 0.0 };
            let outcome = env.walk.step_into(action, observation)?;
            let outcome = paid(env, outcome);
            Ok(Outcome { reward: outcome.reward + chance, ..outcome })
        }
    }

    "observation-in-space" "argument" FastOutside (Mode) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            if BAD && env.arguments.fast {
                [1.5f32, 0.0].write(observation);
            }
            Ok(paid(env, outcome))
        }
    }

    "reward-finite" "argument" DividesByItsArgument {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let scale = env.arguments.scale;
            let scale = if BAD || scale.abs() > 1e-9 { scale } else { 1e-9 };
            Ok(Outcome { reward: (outcome.reward + 1.0) / scale, ..outcome })
        }
    }

    // a clone has default arguments
    "clone-continues" "argument" CloneIsSlow (Mode) {
        fn copied(env: &Of<Self>) -> Mind {
            Mind { own: BAD.into(), ..env.mind.clone() }
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let is_default = env.mind.own == 1;
            Ok(if is_default { outcome } else { paid(env, outcome) })
        }
    }

    // a snapshot does not contain the state that an argument adds
    "snapshot-continues" "argument-state" ForgetsFastSteps (Mode) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.mind.own = 0;
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            env.mind.own = env.mind.own.saturating_add(env.arguments.fast.into());
            Ok(Outcome { reward: outcome.reward + env.mind.own as f64, ..outcome })
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            let own = if BAD { 0 } else { env.mind.own };
            Snapshot::of(&(env.stored()?.get::<Json>()?, own))
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, own) = snapshot.get::<(Json, u64)>()?;
            env.restore_stored(&Snapshot::of(&walk)?)?;
            env.mind.own = own;
            Ok(())
        }
    }

    "no-panic" "option-and-argument" PanicsFastWithOption (Mode) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            assert!(!BAD || !env.arguments.fast || reset.options.is_empty(), "too fast");
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(paid(env, outcome))
        }
    }
}

/// Returns the elements of a multi-binary action.
fn bits<T: Twist, const N: usize>(env: &Of<T>, action: &Value) -> Result<[i8; N]> {
    let bits = action.as_array().filter(|array| array.shape() == [N]);
    let bits = bits.and_then(|array| <[i8; N]>::try_from(array.as_slice::<i8>()?).ok());
    bits.ok_or_else(|| refusal(env, action))
}

/// Returns the error of an invalid action.
fn refusal<T: Twist>(env: &Of<T>, action: &Value) -> Error {
    Error::InvalidAction {
        action: action.to_string(),
        space: T::action_space(env).to_string(),
        hint: String::new(),
    }
}

// actions
pairs! {
    "action-validated" "multi-binary" TakesAnyBit {
        fn action_space(_: &Of<Self>) -> Space {
            MultiBinary::new([3]).map_or_else(|_| Space::discrete(2), Space::from)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let [way, ..] = match bits::<_, 3>(env, action)? {
                bits if BAD || bits.iter().all(|bit| matches!(bit, 0 | 1)) => bits,
                _ => return Err(refusal(env, action)),
            };
            let outcome = env.walk.step_into(&Value::Int((way > 0).into()), observation)?;
            Ok(scaled(env, outcome, 0.0))
        }
    }

    "action-accepted" "all-bits" RefusesAllBits {
        fn action_space(_: &Of<Self>) -> Space {
            MultiBinary::new([16]).map_or_else(|_| Space::discrete(2), Space::from)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let bits = bits::<_, 16>(env, action)?;
            if !bits.iter().all(|bit| matches!(bit, 0 | 1)) || BAD && bits == [1; 16] {
                return Err(refusal(env, action));
            }
            let outcome = env.walk.step_into(&Value::Int(bits[0].into()), observation)?;
            Ok(scaled(env, outcome, 0.0))
        }
    }

    // the part `push` may be missing, or hold anything
    "action-validated" "part" TakesHalfAnAction {
        fn action_space(_: &Of<Self>) -> Space {
            let parts = [("push", Space::discrete(3)), ("way", Space::discrete(2))];
            DictSpace::new(parts).map_or_else(|_| Space::discrete(2), Space::from)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let push = action.get("push");
            let is_whole = matches!(action, Value::Dict(parts) if parts.len() == 2);
            let is_valid = BAD || is_whole && matches!(push, Some(Value::Int(0..3)));
            let way = action.get("way").filter(|way| is_valid && matches!(way, Value::Int(0 | 1)));
            let Some(way) = way.cloned() else { return Err(refusal(env, action)) };
            let outcome = env.walk.step_into(&way, observation)?;
            Ok(scaled(env, outcome, 0.0))
        }
    }
}

/// The last walk that was reset or stepped.
static CURRENT: [AtomicU64; 2] = [AtomicU64::new(0), AtomicU64::new(0)];
/// The number of walks that were reset.
static WALKS: AtomicU64 = AtomicU64::new(0);

// faults that need more than one environment
pairs! {
    // all walks share one global world: a step uses the wind of the walk that was called last
    "clone-apart" "in-turn" LivesInOneWorld {
        fn copied(env: &Of<Self>) -> Mind {
            Mind { own: 0, ..env.mind.clone() }
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.mind.own = WALKS.fetch_add(1, Ordering::Relaxed) + 1;
            CURRENT[usize::from(BAD)].store(env.mind.own, Ordering::Relaxed);
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let current = CURRENT[usize::from(BAD)].load(Ordering::Relaxed);
            let is_other = BAD && env.mind.own != 0 && current != env.mind.own;
            Ok(scaled(env, outcome, if is_other { 0.5 } else { 0.0 }))
        }
    }

    // the bounds depend on the number of the walk
    "space-constant" "instances" BoundsByNumber scaled_step {
        fn observation_space(env: &Of<Self>) -> Space {
            let side = if BAD && env.walk.number().is_multiple_of(2) { 2.0 } else { 1.0 };
            Space::boxed([-side; 2], [side; 2])
        }
    }
}

// late
pairs! {
    "observation-dtype" "late" OtherTypeLate {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.snapshot_with_age()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.restore_with_age(snapshot)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            if BAD && env.mind.age > 400 {
                let side = i8::from(env.walk.position() > 0.0);
                let bytes = Array::new([2], Data::from_i64(DType::I8, [side.into(), 0]));
                *observation = bytes.map_or(Value::Null, Value::Array);
            }
            Ok(scaled(env, outcome, 0.0))
        }
    }

    "space-constant" "late" OtherSpaceLate scaled_step {
        fn observation_space(env: &Of<Self>) -> Space {
            let side = if BAD && env.mind.age > 400 { 2.0 } else { 1.0 };
            Space::boxed([-side; 2], [side; 2])
        }


        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.snapshot_with_age()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.restore_with_age(snapshot)
        }
    }

    "info-without-nan" "late" TellsNaNLate scaled_step {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("mean", Value::Float(if BAD && env.mind.age > 400 { f64::NAN } else { 0.0 }));
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.snapshot_with_age()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.restore_with_age(snapshot)
        }
    }
}
