//! Faults in what a walk shows, stores, clones and accepts.
//!
//! Each [`Twist`] overrides the method that it breaks; the others are those of the
//! [`Walk`](crate::Walk). Twists that are not named after a check, such as
//! `broken/none.late-drawing-v0`, are correct but unusual.

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

// twists of resets, observations and accepted actions
twists! {
    "no-panic.argument" PanicsWithoutSize (Number) {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            assert!(env.arguments.number.abs() > 1e-3, "no size");
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { reward: outcome.reward * env.arguments.number, ..outcome })
        }
    }

    "no-panic.idle" PanicsWithoutPush {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-1.0], [1.0])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let x = numbers::<_, 1>(env, action)?[0];
            assert!(x != 0.0, "neither way");
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "resets.without-a-seed" NeedsASeed {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            if reset.seed.is_none() && !env.mind.is_begun {
                return Err(Error::custom("the first reset needs a seed"));
            }
            env.walk.reset_into(reset, observation)
        }
    }

    "reset-needed.other-error" OtherError {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            env.walk.step_into(action, observation).map_err(|error| match error {
                Error::ResetNeeded(_) => Error::custom("not yet"),
                other => other,
            })
        }
    }

    "generator-lent.another" LendsAnother {
        fn generator(env: &mut Of<Self>) -> Option<&mut Generator> {
            if env.mind.is_begun {
                env.mind.other.get_or_insert_with(|| Generator::from(0)).random();
            }
            env.mind.other.as_mut()
        }
    }

    // lends a copy of the generator, and steps draw from the original
    "generator-lent.copy" LendsACopy {
        fn generator(env: &mut Of<Self>) -> Option<&mut Generator> {
            env.mind.other = env.walk.generator().cloned();
            env.mind.other.as_mut()
        }
    }

    "other-seed-other-episode.cut-at-48-bits" CutsSeeds {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let cut = |seed: &Seed| Seed::from(seed.to_string().parse().map_or(0, |seed: u64| seed % (1 << 48)));
            env.walk.reset_into(&Reset { seed: reset.seed.as_ref().map(cut), ..reset.clone() }, observation)
        }
    }

    "other-seed-other-episode.first-without-a-seed" BeginsWithZero {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let seed = reset.seed.clone().or_else(|| (!env.mind.is_begun).then(|| Seed::from(0)));
            env.walk.reset_into(&Reset { seed, ..reset.clone() }, observation)
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.mind.is_begun = !snapshot.get::<Json>()?.is_null();
            env.walk.restore(snapshot)
        }
    }

    // counts across episodes
    "reset-forgets.late" PaysFromAnEpisodeOn {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            env.mind.own = env.mind.own.saturating_add(outcome.done().into());
            let carried = if env.mind.own > 40 { 0.5 } else { 0.0 };
            Ok(Outcome { reward: outcome.reward + carried, ..outcome })
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

    "reset-forgets.seed" IgnoresALateSeed {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.mind.own += 1;
            let seed = reset.seed.clone().filter(|_| env.mind.own <= 60);
            env.walk.reset_into(&Reset { seed, ..reset.clone() }, observation)
        }
    }

    // rarely uses randomness of the operating system
    "same-seed-same-episode.seldom" SeldomByChance {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let is_time = env.mind.age % 900 == 899;
            let chance = if is_time { Generator::from_os()?.random() } else { 0.0 };
            Ok(Outcome { reward: outcome.reward + chance, ..outcome })
        }
    }

    "info-without-nan" TellsNaN {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("mean", Value::Float(if env.walk.steps() > 3 { f64::NAN } else { 0.0 }));
        }
    }

    "info-without-nan.within" TellsNaNAmongNumbers {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            let mean = if env.walk.steps() > 3 { f64::NAN } else { 0.0 };
            let means = Value::Tuple(vec![Value::Float(1.0), [1.0, mean].into()]);
            visit("means", Value::Dict(vec![("count".into(), Value::Int(2)), ("of".into(), means)]));
        }
    }

    "info-constant.seldom" TellsSeldom {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            env.snapshot_with_age()
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.restore_with_age(snapshot)
        }

        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            env.walk.info(visit);
            if env.mind.age % 333 == 332 {
                visit("round", Value::Bool(true));
            }
        }
    }

    "options-accepted.anything" TakesAnyOption, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let mut reset = reset.clone();
            reset.options.retain(|name, value| name != "start" || value.is_number());
            env.walk.reset_into(&reset, observation)
        }
    }

    "options-matter.beyond" IgnoresWhatIsBeyond, reset_options(&[("start", "0.25")]) {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            let mut reset = reset.clone();
            reset.options.retain(|_, value| value.as_f64().is_none_or(|start| start.abs() <= 1.0));
            env.walk.reset_into(&reset, observation)
        }
    }

    "time-limit.within" TruncatesWithin {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            Ok(Outcome { truncated: env.walk.steps() == 6, ..outcome })
        }
    }

    "info-consistent.again" TellsOtherwise {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("looks", Value::Int(env.look() as i64));
        }
    }

    "info-constant.shape" OtherShape {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("steps", Value::Array(Array::zeros(DType::F64, [1 + env.walk.steps() as usize / 4]).unwrap_or_default()));
        }
    }

    "info-constant.reset" ComesWithAReset {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            env.walk.info(visit);
            if env.walk.steps() == 0 && env.walk.position() > 0.0 {
                visit("right", Value::Bool(true));
            }
        }
    }

    "info-constant.within" OtherWithin {
        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            let steps = env.walk.steps();
            let value = if steps > 3 { Value::Float(steps.into()) } else { Value::Int(steps.into()) };
            visit("count", Value::Dict(vec![("steps".into(), value)]));
        }
    }

    "space-constant.later" OtherSpaceLater {
        fn observation_space(env: &Of<Self>) -> Space {
            let side = if env.walk.steps() > 3 { 2.0 } else { 1.0 };
            Space::boxed([-side; 2], [side; 2])
        }
    }

    "space-not-empty.text" EmptyText {
        fn observation_space(env: &Of<Self>) -> Space {
            let empty = TextSpace::new(0, 0).expect("lengths in order");
            TupleSpace::new([env.walk.observation_space(), empty.into()]).into()
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, &mut env.mind.seen)?;
            *observation = Value::Tuple(vec![env.mind.seen.clone(), Value::Text(String::new())]);
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, &mut env.mind.seen)?;
            match observation {
                Value::Tuple(parts) if matches!(&parts[..], [_, Value::Text(text)] if text.is_empty()) => {
                    parts[0].clone_from(&env.mind.seen);
                }
                _ => *observation = Value::Tuple(vec![env.mind.seen.clone(), Value::Text(String::new())]),
            }
            Ok(outcome)
        }
    }

    "action-normalised.lopsided" Lopsided {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-0.5], [1.0])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let [x] = numbers(env, action)?;
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "action-accepted.corner" RefusesACorner {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-1.0; 2], [1.0; 2])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let [x, y] = numbers(env, action)?;
            if [x, y] == [-1.0, 1.0] {
                return Err(Error::custom("not both ways at once"));
            }
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "action-validated.shape" TakesAnyShape {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-1.0; 2], [1.0; 2])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let x = match action {
                Value::Array(array) if array.shape() == [2, 2] => 0.0,
                _ => numbers::<_, 2>(env, action)?[0],
            };
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "action-validated.infinite" TakesInfinity {
        fn action_space(_: &Of<Self>) -> Space {
            Space::boxed([-1.0], [1.0])
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let x = match action {
                Value::Array(array) if array.as_slice::<f32>() == Some(&[f32::INFINITY]) => 1.0,
                _ => numbers::<_, 1>(env, action)?[0],
            };
            env.walk.step_into(&Value::Int((x > 0.0).into()), observation)
        }
    }

    "observation-in-space.late-reset" BeginsOutside {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            if env.mind.age > 500 {
                [1.5f32, 0.0].write(observation);
            }
            Ok(())
        }
    }

    "reward-finite.after-a-thousand-steps" PaysLate {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            let reward = if env.mind.age == 1000 { f64::NAN } else { outcome.reward };
            Ok(Outcome { reward, ..outcome })
        }
    }

    // writes only the elements that changed since the last reset or step
    "observation-whole.changed" WritesChanges {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            if let Value::Array(array) = observation && let Some([_, still]) = array.as_mut_slice::<f32>() {
                *still = 0.5;
            }
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let old = match observation {
                Value::Array(array) => array.as_slice::<f32>().and_then(|numbers| numbers.get(1).copied()),
                _ => None,
            };
            let outcome = env.walk.step_into(action, observation)?;
            if let Value::Array(array) = observation && let Some([_, still]) = array.as_mut_slice::<f32>() {
                *still = old.unwrap_or(0.5);
            }
            Ok(outcome)
        }
    }

    "observation-dtype.within" OtherTypeWithin {
        fn observation_space(env: &Of<Self>) -> Space {
            DictSpace::new([("walk", env.walk.observation_space())]).expect("one name").into()
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, &mut env.mind.seen)?;
            *observation = Value::Dict(vec![("walk".into(), [0i8, 0].to_value())]);
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, &mut env.mind.seen)?;
            let side = [i8::from(env.walk.position() > 0.0), 0];
            match observation {
                Value::Dict(parts) if parts.len() == 1 => side.write(&mut parts[0].1),
                _ => *observation = Value::Dict(vec![("walk".into(), side.to_value())]),
            }
            Ok(outcome)
        }
    }

    "options-ignored.noticed" NoticesOptions {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            if !reset.options.is_empty() {
                [0.5f32, 0.5].write(observation);
            }
            Ok(())
        }
    }

    "no-allocation.late" AllocatesLate {
        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            if env.mind.age == 100 {
                drop(std::hint::black_box(vec![0u8; 8]));
            }
            env.walk.step_into(action, observation)
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

/// Returns the walk's metadata with other render modes.
fn drawn(render_modes: &'static [RenderMode]) -> Metadata {
    Metadata {
        render_modes,
        ..Metadata::drawn(10, (200, 40))
    }
}

// drawings
twists! {
    "metadata-complete.list" NamesAList {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::RgbArrayList])
        }
    }

    "metadata-complete.twice" NamesAModeTwice {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::RgbArray])
        }
    }

    "metadata-complete.changes" OtherRate {
        fn metadata(env: &Of<Self>) -> Metadata {
            Metadata::drawn(if env.mind.is_begun { 20 } else { 10 }, (200, 40))
        }
    }

    "metadata-complete.hidden-drawing" HidesADrawing {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[])
        }
    }

    "metadata-complete.hidden-text" HidesAText {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[])
        }

        fn draw(_: &Of<Self>, _: &mut dyn Canvas) {}

        fn ansi(_: &Of<Self>) -> Option<String> {
            Some("here".into())
        }
    }

    "metadata-complete.height" TooHigh {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata::drawn(10, (1, 1 << 15))
        }
    }

    "metadata-complete.width" TooNarrow {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata::drawn(10, (0, 40))
        }
    }

    "render-modes.human-alone" HumanAlone {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::Human])
        }
    }

    "render-modes.no-text" NoText {
        fn metadata(_: &Of<Self>) -> Metadata {
            drawn(&[RenderMode::RgbArray, RenderMode::Ansi])
        }

        fn ansi(_: &Of<Self>) -> Option<String> {
            Some(String::new())
        }
    }

    "drawing-pure.calls" DrawsOtherwise {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let looked = env.look();
            drawn_too(env, canvas, |canvas| canvas.circle([looked as f64, 0.0], 2.0, Color::BLACK));
        }
    }

    "drawing-sound.nothing-at-the-end" NothingAtTheEnd {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            if env.walk.position().abs() < 1.0 {
                env.walk.draw(canvas);
            }
        }
    }

    "drawing-sound.pop" PopsTooMuch {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.pop());
        }
    }

    "drawing-sound.width" WidthIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.line([0.0; 2], [9.0; 2], f64::NAN, Color::WHITE));
        }
    }

    "drawing-sound.radius" RadiusIsInfinite {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.circle([0.0; 2], f64::INFINITY, Color::WHITE));
        }
    }

    "drawing-sound.text-size" SizeIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| canvas.text("x", [0.0; 2], f64::NAN, Align::Left, Color::WHITE));
        }
    }

    "drawing-sound.corner" CornerIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let shape = Shape::Rect { min: [0.0; 2], size: [9.0; 2], corner: f64::NAN };
            drawn_too(env, canvas, |canvas| canvas.fill(shape, Color::WHITE));
        }
    }

    "drawing-sound.curve" CurveIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            let path = [Segment::Move([0.0; 2]), Segment::Quad([0.0; 2], [f64::NAN, 0.0]), Segment::Close];
            drawn_too(env, canvas, |canvas| canvas.fill(Shape::Path(&path), Color::WHITE));
        }
    }

    "drawing-sound.transform" TransformIsNaN {
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            drawn_too(env, canvas, |canvas| {
                canvas.push(Transform::translate(f64::NAN, 0.0));
                canvas.pop();
            });
        }
    }
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
