//! Faults in what a walk shows, stores, clones and accepts.
//!
//! Each [`Twist`] overrides the method that it breaks; the others are those of the
//! [`Walk`](crate::Walk). Twists that are not named after a check, such as
//! `broken/none.late-drawing-v0`, are correct but unusual.

mod drawings;
mod episodes;
mod goals;

use std::sync::Arc;
use std::sync::atomic::Ordering;

use gym_core::canvas::{Align, Canvas, Color, Segment, Shape, Transform};
use gym_core::render::{Metadata, RenderMode};
use gym_core::spaces::{DictSpace, TextSpace, TupleSpace};
use gym_core::{
    Array, DType, Element, Env, Error, Generator, Outcome, Registration, Reset, Result, Seed,
    Snapshot, Space, Value,
};
use serde_json::Value as Json;

use crate::arguments::{Anything, Number};
use crate::twisted::{Mind, Twist, Twisted as Of};

/// Defines twists, and registers a walk with each twist under the name of the check that must find
/// the twist.
macro_rules! twists {
    ($($name:literal $Twist:ident $(($Arguments:ident))? $(, $method:ident($($argument:expr)?))* { $($item:item)* })*) => {$(
        #[doc = concat!("`", $name, "`")]
        #[derive(Debug)]
        pub(crate) struct $Twist;

        impl Twist for $Twist {
            type Arguments = twists!(@ $($Arguments)?);

            $($item)*
        }

        gym_core::register!(
            Registration::new::<Of<$Twist>>(concat!("broken/", $name, "-v0"))
                .description("Walk from the middle to either end.")
                .max_episode_steps(12)
                $(.$method($($argument)?))*
        );
    )*};
    (@) => { gym_core::NoArguments };
    (@ $Arguments:ident) => { $Arguments };
}

pub(crate) use twists;

/// Draws the walk, and then `draw` on top.
fn drawn_too<T: Twist>(env: &Of<T>, canvas: &mut dyn Canvas, draw: impl FnOnce(&mut dyn Canvas)) {
    env.walk.draw(canvas);
    draw(canvas);
}

// copies
twists! {
    "clone-apart.reset" ResetOfClone {
        fn copied(env: &Of<Self>) -> Mind {
            Mind { shared: Arc::clone(&env.mind.shared), ..env.mind.clone() }
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if reset.seed.is_some() {
                env.mind.own = env.mind.shared.fetch_add(1, Ordering::Relaxed) + 1;
            }
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.mind.is_spoilt.set(env.mind.shared.load(Ordering::Relaxed) != env.mind.own);
            env.step_of_spoilt(action, observation)
        }
    }

    "clone-apart.spoilt" SpoiltByClone {
        fn copied(env: &Of<Self>) -> Mind {
            let copy = env.mind.clone();
            env.mind.is_spoilt.set(true);
            copy
        }
    }

    "snapshot-continues.beside" SpoiltBySnapshot {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.mind.is_spoilt.set(env.mind.is_begun);
            env.walk.snapshot()
        }
    }

    "snapshot-continues.midway" SpoiltMidway {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let is_episode = !snapshot.get::<Json>()?.is_null();
            env.mind.is_spoilt.set(is_episode && env.mind.is_begun && !env.mind.is_over);
            env.walk.restore(snapshot)
        }
    }

    "snapshot-continues.after-the-end" SpoiltAfterTheEnd {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.mind.is_spoilt.set(env.mind.is_over);
            env.walk.restore(snapshot)
        }
    }

    "snapshot-continues.as-new" SpoiltForever {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)?;
            if snapshot.get::<Json>()?.is_null() {
                env.mind.is_spoilt.set(true);
            }
            Ok(())
        }
    }

    // restores correctly only for ordinary values of its argument
    "snapshot-continues.argument" OrdinarySizes (Number) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: outcome.reward * env.arguments.number, ..outcome })
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            if env.arguments.number.abs() > 1e3 {
                return Err(Error::Snapshot("a size that no walk has".into()));
            }
            env.restore_stored(snapshot)
        }
    }

    // the snapshot contains the age, but not the event at a certain age
    "snapshot-continues.event" ForgetsAnEvent {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.snapshot_with_age()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.restore_with_age(snapshot)
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if reset.seed.is_some() {
                env.mind.is_spoilt.set(false);
            }
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            if env.mind.age == 160 {
                env.mind.is_spoilt.set(true);
            }
            env.step_of_spoilt(action, observation)
        }
    }

    "snapshot-legal.reward" PaysWithoutEnd {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let reward = if env.walk.steps() >= 1000 { f64::INFINITY } else { outcome.reward };
            Ok(Outcome { reward, ..outcome })
        }
    }

    "no-panic.restored" PanicsWhenRestored {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            assert!(env.walk.steps() != 1005, "too far");
            env.walk.info(visit);
        }
    }

    "no-panic.after-a-restored-step" PanicsAfterRestored {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            assert!(env.walk.steps() < 1006, "too far");
            env.walk.info(visit);
        }
    }
}

// twists of queries, refused calls, and ended episodes
twists! {
    "looking-pure.action-space" ActionSpaceSpoils {
        fn action_space(env: &Of<Self>) -> Space {
            spoil_third(env);
            env.walk.action_space()
        }
    }

    "looking-pure.observation-space" ObservationSpaceSpoils {
        fn observation_space(env: &Of<Self>) -> Space {
            spoil_third(env);
            env.walk.observation_space()
        }
    }

    "looking-pure.metadata" MetadataSpoils {
        fn metadata(env: &Of<Self>) -> Metadata {
            spoil_third(env);
            env.walk.metadata()
        }
    }

    // a single call has no effect
    "looking-pure.info" InfoSpoils {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            if env.look() >= 3 {
                env.mind.is_spoilt.set(true);
            }
            env.walk.info(visit);
        }
    }

    "looking-pure.generator" GeneratorSpoils {
        fn generator(env: &mut Of<Self>) -> Option<&mut Generator> {
            if env.mind.age == 3 && let Some(generator) = env.walk.generator() {
                generator.random();
            }
            env.walk.generator()
        }
    }

    "generator-lent.at-the-end" LendsNothingAtTheEnd {
        fn generator(env: &mut Of<Self>) -> Option<&mut Generator> {
            if env.mind.is_over { None } else { env.walk.generator() }
        }
    }

    "clone-continues.at-the-end" SpoiltCloneOfTheEnd {
        fn copied(env: &Of<Self>) -> Mind {
            let copy = env.mind.clone();
            copy.is_spoilt.set(env.mind.is_over);
            copy
        }
    }

    // continues with another generator after the end
    "snapshot-continues.at-the-end" SpoiltSnapshotOfTheEnd {
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.walk.restore(snapshot)?;
            if env.walk.position().abs() == 1.0 && let Some(generator) = env.walk.generator() {
                generator.random();
            }
            Ok(())
        }
    }

    "refusal-changes-nothing.at-the-start" DrawsForARefusal {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            if env.walk.steps() == 0 && !matches!(action, Value::Int(0 | 1)) && let Some(generator) = env.walk.generator() {
                generator.random();
            }
            env.walk.step_into(action, observation)
        }
    }

    "refusal-changes-nothing.reset" BeginsBeforeItRefuses, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if reset.options.values().any(|value| !value.is_number()) && env.mind.is_begun {
                env.walk.reset_into(&Reset { options: Default::default(), ..reset.clone() }, observation)?;
            }
            env.walk.reset_into(reset, observation)
        }
    }

    "options-matter.without-a-seed" NeedsASeedForOptions, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            without_numbers(env, reset, reset.seed.is_none(), observation)
        }
    }

    "options-matter.first-reset-alone" IgnoresLaterOptions, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            without_numbers(env, reset, env.mind.is_begun, observation)
        }
    }

    "options-matter.seed" IgnoresTheSeedOfOptions, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let seed = reset.seed.clone().filter(|_| reset.options.is_empty() || !env.mind.is_begun);
            env.walk.reset_into(&Reset { seed, ..reset.clone() }, observation)
        }
    }

    "reset-forgets.option" KeepsAnOption, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let mut options = reset.options.clone();
            if let Some(start) = options.get("start").and_then(Json::as_f64).filter(|start| start.abs() <= 1.0) {
                env.mind.seen = Value::Float(start);
            } else if let Value::Float(start) = env.mind.seen && options.is_empty() {
                options.insert("start".into(), start.into());
            }
            env.walk.reset_into(&Reset { options, ..reset.clone() }, observation)
        }
    }

    "other-seed-other-episode.halved" HalvesSeeds {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_seed(env, reset, |seed| seed / 2, observation)
        }
    }

    "other-seed-other-episode.remainder" TakesARemainder {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            with_seed(env, reset, |seed| seed % 1000, observation)
        }
    }

    // alternates between two episodes of the same seed
    "reset-carries-on.in-turn" TakesTurns, exceptions(&[("generator-lent", "each reset has a seed of its own")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            const BEGUN: u64 = 1 << 60;
            env.mind.own = match &reset.seed {
                Some(seed) => BEGUN | seed.to_string().parse().map_or(0, |seed: u64| seed % (1 << 40) * 2),
                None if env.mind.own == 0 => BEGUN | (Generator::from_os()?.random() * 1e9) as u64,
                None => env.mind.own ^ 1,
            };
            let seed = reset.seed.clone().unwrap_or_else(|| env.mind.own.into());
            env.walk.reset_into(&Reset { seed: Some(seed), ..reset.clone() }, observation)
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            Snapshot::of(&(env.walk.snapshot()?.get::<Json>()?, env.mind.own))
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            let (walk, own) = snapshot.get::<(Json, u64)>()?;
            env.walk.restore(&Snapshot::of(&walk)?)?;
            env.mind.own = own;
            Ok(())
        }
    }

    "drawing-sound.late" DrawsNaNLate {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let x = if env.mind.age > 400 { f64::NAN } else { 0.0 };
            drawn_too(env, canvas, |canvas| canvas.circle([x, 0.0], 2.0, Color::BLACK));
        }
    }

    // keeps memory of each episode forever
    "no-allocation.kept" KeepsEachEpisode {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            match &mut env.mind.seen {
                Value::Tuple(episodes) => episodes.push(Value::Null),
                other => *other = Value::Tuple(vec![Value::Null]),
            }
            env.walk.reset_into(reset, observation)
        }
    }
}

/// Spoils the episode if the function is called after the third step.
fn spoil_third<T: Twist>(env: &Of<T>) {
    if env.mind.is_begun && env.mind.age == 3 {
        env.mind.is_spoilt.set(true);
    }
}

/// Resets without the numeric options, if `ignores`.
fn without_numbers<T: Twist>(
    env: &mut Of<T>,
    reset: &Reset,
    ignores: bool,
    observation: &mut Value,
) -> Result<()> {
    let mut reset = reset.clone();
    reset
        .options
        .retain(|_, value| !(ignores && value.is_number()));
    env.walk.reset_into(&reset, observation)
}

/// Resets with another seed, if the seed has at most 64 bits.
pub(crate) fn with_seed<T: Twist>(
    env: &mut Of<T>,
    reset: &Reset,
    other: impl Fn(u64) -> u64,
    observation: &mut Value,
) -> Result<()> {
    let cut = |seed: &Seed| {
        seed.to_string()
            .parse()
            .map_or_else(|_| seed.clone(), |x| other(x).into())
    };
    env.walk.reset_into(
        &Reset {
            seed: reset.seed.as_ref().map(cut),
            ..reset.clone()
        },
        observation,
    )
}

/// Returns the numbers of an action.
fn numbers<T: Twist, const N: usize>(env: &Of<T>, action: &Value) -> Result<[f32; N]> {
    let numbers = match action {
        Value::Array(array) if array.shape() == [N] => array.as_slice::<f32>(),
        _ => None,
    };
    let numbers = numbers.and_then(|numbers| <[f32; N]>::try_from(numbers).ok());
    numbers
        .filter(|numbers| numbers.iter().all(|x| x.is_finite()))
        .ok_or_else(|| Error::InvalidAction {
            action: action.to_string(),
            space: T::action_space(env).to_string(),
            hint: String::new(),
        })
}

// arguments
twists! {
    "arguments-refused.anything" TakesAnything (Anything) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: outcome.reward * env.arguments.number.as_f64().unwrap_or(1.0), ..outcome })
        }
    }

    // ignores the seed; registered as nondeterministic, so the checks compare no episodes
    "none.by-chance" ByChance (Number), reset_options(&[("start", "0.25")]), nondeterministic() {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(&Reset { seed: None, ..reset.clone() }, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: outcome.reward * env.arguments.number, ..outcome })
        }
    }

    "none.slow-with-a-large-seed" SlowWithALargeSeed (Number), reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if reset.seed.as_ref().is_some_and(|seed| seed.to_string().len() > 40) {
                std::thread::sleep(std::time::Duration::from_millis(5600));
            }
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: outcome.reward * env.arguments.number, ..outcome })
        }
    }

    "none.late-drawing" LateDrawing (Number), reset_options(&[("start", "0.25")]) {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let x = if env.walk.steps() > 0 { env.arguments.number } else { 0.0 };
            drawn_too(env, canvas, |canvas| canvas.circle([x, 0.0], 2.0, Color::BLACK));
        }
    }

    "none.beyond-the-actions" WiderActions (Number), reset_options(&[("start", "0.25")]) {
        fn action_space(env: &Of<Self>) -> Space {
            Space::discrete(if env.arguments.number > 1.5 { 4 } else { 2 })
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let action = match action {
                Value::Int(way @ 2..4) if env.arguments.number > 1.5 => Value::Int(way - 2),
                other => other.clone(),
            };
            env.walk.step_into(&action, observation)
        }
    }

    "none.late-effect" LateEffect (Number), reset_options(&[("start", "0.25")]) {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.snapshot_with_age()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.restore_with_age(snapshot)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let factor = if (300..3000).contains(&env.mind.age) { env.arguments.number } else { 1.0 };
            Ok(Outcome { reward: outcome.reward * factor, ..outcome })
        }
    }

    // the argument has an effect only after 100 steps of an episode; the checks' episodes are
    // shorter
    "none.effect-elsewhere" EffectElsewhere (Number), reset_options(&[("start", "0.25")]) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let factor = if env.walk.steps() > 100 { env.arguments.number } else { 1.0 };
            Ok(Outcome { reward: (outcome.reward + 1.0) * factor, ..outcome })
        }
    }
}
