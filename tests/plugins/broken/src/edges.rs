//! Faults that only show at an edge: after `close`, after a pause, in rare states, in used buffers,
//! without a seed. A twist whose name begins with `none.` comes close to a fault and has none.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use gym_core::canvas::Canvas;
use gym_core::render::Metadata;
use gym_core::{Env, Error, Outcome, Registration, Reset, Result, Snapshot, Space, Value};
use serde_json::Value as Json;

use crate::arguments::Number;
use crate::reach::scaled;
use crate::twisted::{Mind, Twist, Twisted as Of};
use crate::twists::{twists, with_seed};

// state that clones share
twists! {
    // `info` describes the last step of any clone
    "clone-apart.info" TellsOfItsClones {
        fn copied(env: &Of<Self>) -> Mind {
            Mind { shared: Arc::clone(&env.mind.shared), ..env.mind.clone() }
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            env.mind.shared.store(env.walk.position().to_bits(), Ordering::Relaxed);
            Ok(outcome)
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.shared.store(env.walk.position().to_bits(), Ordering::Relaxed);
            Ok(())
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)?;
            env.mind.shared.store(env.walk.position().to_bits(), Ordering::Relaxed);
            Ok(())
        }

        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("position", Value::Float(f64::from_bits(env.mind.shared.load(Ordering::Relaxed))));
        }
    }

    // clones share a table that never changes
    "none.shared-table" SharesATable (Number), reset_options(&[("start", "0.25")]) {
        fn copied(env: &Of<Self>) -> Mind {
            Mind { shared: Arc::clone(&env.mind.shared), ..env.mind.clone() }
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }

        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("table", Value::Int(env.mind.shared.load(Ordering::Relaxed) as i64));
        }
    }

    // closing the original spoils its clones
    "clone-apart.original-closed" NeedsItsOriginal {
        fn copied(env: &Of<Self>) -> Mind {
            Mind { shared: Arc::clone(&env.mind.shared), own: 1, ..env.mind.clone() }
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let is_alone = env.mind.shared.load(Ordering::Relaxed) == 1;
            env.mind.is_spoilt.set(env.mind.own == 1 && is_alone);
            env.step_of_spoilt(action, observation)
        }

        fn close(env: &mut Of<Self>) {
            if env.mind.own == 0 {
                env.mind.shared.store(1, Ordering::Relaxed);
            }
            env.walk.close();
        }
    }
}

/// The number of second calls of `close`, over all environments of the kind.
static CLOSED_AGAIN: AtomicU64 = AtomicU64::new(0);

// `close`
twists! {
    // a second `close` of an environment spoils all other environments
    "close-harmless" FreesTwice {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.mind.is_spoilt.set(CLOSED_AGAIN.load(Ordering::Relaxed) > 0);
            env.step_of_spoilt(action, observation)
        }

        fn close(env: &mut Of<Self>) {
            env.mind.own += 1;
            if env.mind.own == 2 {
                CLOSED_AGAIN.fetch_add(1, Ordering::Relaxed);
            }
            env.walk.close();
        }
    }

    "close-harmless.twice" SpoiltByASecondClose {
        fn close(env: &mut Of<Self>) {
            env.mind.own += 1;
            if env.mind.own == 2 {
                env.mind.is_spoilt.set(true);
            }
            env.walk.close();
        }
    }

    // a second `close`, in a later episode than the first, spoils the environment
    "close-harmless.in-two-episodes" SpoiltByALaterClose {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.mind.own = env.mind.own.next_multiple_of(2);
            env.walk.reset_into(reset, observation)
        }

        fn close(env: &mut Of<Self>) {
            if env.mind.own.is_multiple_of(2) {
                env.mind.own += 1;
            }
            if env.mind.own == 3 {
                env.mind.is_spoilt.set(true);
            }
            env.walk.close();
        }
    }

    // counts calls of `close` and kept options, without effect
    "none.counts-calls" CountsCalls (Number), reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if let Some(start) = reset.options.get("start").and_then(start) {
                env.mind.seen = Value::Float(start);
            }
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }

        fn close(env: &mut Of<Self>) {
            env.mind.own += 1;
            env.walk.close();
        }
    }

    "no-panic.reset-after-close" PanicsAfterClose {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            assert!(env.mind.own == 0 || env.mind.is_over, "closed");
            env.walk.reset_into(reset, observation)
        }

        fn close(env: &mut Of<Self>) {
            env.mind.own = 1;
            env.walk.close();
        }
    }

    "none.closed-for-good" RefusesAfterClose (Number), reset_options(&[("start", "0.25")]) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            scaled(env, action, observation)
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if env.mind.own == 1 {
                return Err(Error::Closed("reset"));
            }
            env.walk.reset_into(reset, observation)
        }

        fn close(env: &mut Of<Self>) {
            env.mind.own = 1;
            env.walk.close();
        }
    }
}

// resets
twists! {
    // the option applies until the next reset with a seed
    "reset-forgets.option-without-a-seed" KeepsAnOptionForLong, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let until = if reset.seed.is_some() { 0 } else { u64::MAX };
            with_kept(env, reset, until, observation)
        }
    }

    // the option applies to the next two episodes too
    "reset-forgets.option-twice-more" KeepsAnOptionTwice, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let until = if reset.seed.is_some() { 0 } else { 2 };
            with_kept(env, reset, until, observation)
        }
    }

    // the option applies to each later reset with the same seed
    "reset-forgets.option-by-seed" KeepsTheStartOfASeed, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let mut options = reset.options.clone();
            if let Some(seed) = &reset.seed {
                let seed = seed.to_string();
                if let Some(start) = options.get("start").and_then(start) {
                    env.mind.seen = Value::Dict(vec![(seed, start.into())]);
                } else if let Some(Value::Float(start)) = env.mind.seen.get(&seed) && options.is_empty() {
                    options.insert("start".into(), (*start).into());
                }
            }
            env.walk.reset_into(&Reset { options, ..reset.clone() }, observation)
        }
    }

    // if the option's episode has ended, the option applies to the next episode too
    "reset-forgets.option-after-an-end" KeepsAnOptionPastAnEnd, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let mut options = reset.options.clone();
            let kept = std::mem::replace(&mut env.mind.seen, Value::Null);
            if let Some(start) = options.get("start").and_then(start) {
                env.mind.seen = Value::Float(start);
            } else if let Value::Float(start) = kept && env.mind.is_over && options.is_empty() {
                options.insert("start".into(), start.into());
            }
            env.walk.reset_into(&Reset { options, ..reset.clone() }, observation)
        }
    }

    // the option applies from the third later reset with the same seed on
    "reset-forgets.option-by-seed-later" KeepsTheStartForLater, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let mut options = reset.options.clone();
            let seed = reset.seed.as_ref().map(ToString::to_string).unwrap_or_default();
            if let Some(start) = options.get("start").and_then(start) {
                (env.mind.seen, env.mind.own) = (Value::Dict(vec![(seed, start.into())]), 0);
            } else if let Some(Value::Float(start)) = env.mind.seen.get(&seed) && options.is_empty() {
                env.mind.own += 1;
                if env.mind.own > 2 {
                    options.insert("start".into(), (*start).into());
                }
            }
            env.walk.reset_into(&Reset { options, ..reset.clone() }, observation)
        }
    }

    // an option without a seed resets the generator
    "options-matter.begins-anew" BeginsAnew, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let has_option = reset.options.contains_key("start");
            let seed = reset.seed.clone().or_else(|| has_option.then(|| 7.into()));
            env.walk.reset_into(&Reset { seed, ..reset.clone() }, observation)
        }
    }

    // 41 resets without a step between them spoil the environment
    "reset-forgets.many-resets" CountsResets {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.mind.own += 1;
            env.mind.is_spoilt.set(env.mind.own > 40);
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.mind.own = 0;
            env.step_of_spoilt(action, observation)
        }
    }

    "other-seed-other-episode.float" CutsToAFloat {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_seed(env, reset, |seed| seed as f32 as u64, observation)
        }
    }

    "other-seed-other-episode.folded" FoldsSeeds {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_seed(env, reset, |seed| (seed ^ (seed >> 32)) % (1 << 32), observation)
        }
    }

    "other-seed-other-episode.odd-remainder" TakesAnOddRemainder {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_seed(env, reset, |seed| seed % 65_521, observation)
        }
    }

    "other-seed-other-episode.double" CutsToADouble {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_seed(env, reset, |seed| seed as f64 as u64, observation)
        }
    }
}

/// Returns the start position `option`; `None` if the walk does not accept the position.
fn start(option: &Json) -> Option<f64> {
    option.as_f64().filter(|start| start.abs() <= 1.0)
}

/// Resets with the option `start`. The next `episodes` resets without the option use the same
/// start.
fn with_kept<T: Twist>(
    env: &mut Of<T>,
    reset: &Reset,
    episodes: u64,
    observation: &mut Value,
) -> Result<()> {
    let mut options = reset.options.clone();
    if let Some(start) = options.get("start").and_then(start) {
        (env.mind.seen, env.mind.own) = (Value::Float(start), 0);
    } else if let Value::Float(start) = env.mind.seen
        && options.is_empty()
    {
        env.mind.own += 1;
        if env.mind.own <= episodes {
            options.insert("start".into(), start.into());
        } else {
            env.mind.seen = Value::Null;
        }
    }
    env.walk.reset_into(
        &Reset {
            options,
            ..reset.clone()
        },
        observation,
    )
}

// buffers, snapshots, time
twists! {
    // multiplies the old content of the observation buffer by zero, so that only NaN and infinity
    // have an effect
    "observation-whole.multiplied" MultipliesTheOld {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let old = match observation {
                Value::Array(array) => array.as_slice::<f32>().and_then(|numbers| numbers.first().copied()),
                _ => None,
            };
            let outcome = env.walk.step_into(action, observation)?;
            if let Value::Array(array) = observation && let Some([x, _]) = array.as_mut_slice::<f32>() {
                *x += 0.0 * old.unwrap_or(0.0);
            }
            Ok(outcome)
        }
    }

    "snapshot-continues.rare" RefusesARareState {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            if env.walk.steps() == 9 && env.walk.position() > 0.3 {
                return Err(Error::Snapshot("not here".into()));
            }
            env.walk.snapshot()
        }
    }

    "snapshot-continues.rarely-wrong" RestoresARareStateWrongly {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)?;
            if env.walk.steps() == 9 && env.walk.position() > 0.3 && let Some(generator) = env.walk.generator() {
                generator.random();
            }
            Ok(())
        }
    }

    // the argument scales the reward, and `restore` does not compare the argument
    "snapshot-refused.other-argument" TakesOtherArguments (Number) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: (outcome.reward + 1.0) * env.arguments.number, ..outcome })
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.walk.snapshot()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)
        }
    }

    // the snapshot stores and restores the argument
    "none.restores-its-argument" RestoresItsArgument (Number), reset_options(&[("start", "0.25")]) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: (outcome.reward + 1.0) * env.arguments.number, ..outcome })
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, arguments) = snapshot.get::<(Json, Number)>()?;
            if !arguments.number.is_finite() {
                return Err(Error::Snapshot("its number is not finite".into()));
            }
            env.walk.restore(&Snapshot::of(&walk)?)?;
            env.arguments = arguments;
            Ok(())
        }
    }

    // after a second of real time, the dynamics change
    "clock-unread" ReadsAClock {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let is_late = env.mind.begun.is_some_and(|begun| begun.elapsed() > Duration::from_secs(1));
            env.mind.is_spoilt.set(is_late);
            env.step_of_spoilt(action, observation)
        }
    }

    "metadata-complete.rate-without-modes" NoRate {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata { render_modes: &[], ..Metadata::drawn(0, (200, 40)) }
        }

        fn draw(_: &Of<Self>, _: &mut dyn Canvas) {}
    }

    "metadata-complete.at-the-end" OtherRateAtTheEnd {
        fn metadata(env: &Of<Self>) -> Metadata {
            Metadata::drawn(if env.mind.is_over { 20 } else { 10 }, (200, 40))
        }
    }

    "space-constant.at-the-end" OtherSpaceAtTheEnd {
        fn observation_space(env: &Of<Self>) -> Space {
            let side = if env.mind.is_over { 2.0 } else { 1.0 };
            Space::boxed([-side; 2], [side; 2])
        }
    }

    "space-constant.actions-at-the-end" OtherActionsAtTheEnd {
        fn action_space(env: &Of<Self>) -> Space {
            Space::discrete(if env.mind.is_over { 1 } else { 2 })
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)?;
            env.mind.is_over = false;
            Ok(())
        }
    }

    "no-allocation.seldom" AllocatesSeldom {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            if env.mind.age == 350 {
                drop(std::hint::black_box(vec![0u8; 8]));
            }
            env.walk.step_into(action, observation)
        }
    }
}
