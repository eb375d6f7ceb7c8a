//! Faults in resets, observations and accepted actions.

use super::*;

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
