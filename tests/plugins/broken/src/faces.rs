//! Faults in what a walk shows before its next step: the picture, the text and the info of a state
//! that was reset, restored, copied or refused an action; and faults after `close`.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use gym_core::canvas::{Canvas, Color};
use gym_core::render::{Metadata, RenderMode};
use gym_core::{Env, Outcome, Reset, Result, Snapshot, Value};
use serde_json::Value as Json;

use crate::pairs::{pairs, scaled_step};
use crate::twisted::{Mind, Twist, Twisted as Of};

/// Draws the walk, and a mark at the position in `own`.
fn draw_own<T: Twist>(env: &Of<T>, canvas: &mut dyn Canvas) {
    env.walk.draw(canvas);
    let x = f64::from_bits(env.mind.own);
    canvas.circle([100.0 + 90.0 * x, 10.0], 4.0, Color::BLACK);
}

/// Returns the larger of the position and the position in `own`.
fn farthest<T: Twist>(env: &Of<T>) -> u64 {
    f64::from_bits(env.mind.own)
        .max(env.walk.position())
        .to_bits()
}

/// Returns a snapshot of the walk and `own`.
fn stored_own<T: Twist>(env: &Of<T>) -> Result<Snapshot> {
    Snapshot::of(&(env.stored()?.get::<Json>()?, env.mind.own))
}

fn restore_own<T: Twist>(env: &mut Of<T>, snapshot: &Snapshot) -> Result<()> {
    let (walk, own) = snapshot.get::<(Json, u64)>()?;
    let is_place = f64::from_bits(own).is_finite();
    if !is_place {
        return Err(gym_core::Error::Snapshot("the place is not finite".into()));
    }
    env.restore_stored(&Snapshot::of(&walk)?)?;
    env.mind.own = own;
    Ok(())
}

// pictures and texts
pairs! {
    // the mark of the farthest position stays from episode to episode
    "state-shown" "drawing-after-reset" KeepsTheMark {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.own = if BAD { farthest(env) } else { env.walk.position().to_bits() };
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = scaled_step(env, action, observation)?;
            env.mind.own = farthest(env);
            Ok(outcome)
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> { stored_own(env) }
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> { restore_own(env, snapshot) }
        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) { draw_own(env, canvas); }
    }

    // the snapshot does not contain the mark
    "state-shown" "drawing-restored" ForgetsTheMark {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.own = env.walk.position().to_bits();
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = scaled_step(env, action, observation)?;
            env.mind.own = farthest(env);
            Ok(outcome)
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            if BAD { env.stored() } else { stored_own(env) }
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            if BAD { env.restore_stored(snapshot) } else { restore_own(env, snapshot) }
        }

        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) { draw_own(env, canvas); }
    }

    // the clone is drawn without the mark until its next reset
    "state-shown" "drawing-of-a-clone" CloneForgetsTheMark {
        fn copied(env: &Of<Self>) -> Mind {
            let copy = env.mind.clone();
            copy.is_spoilt.set(BAD);
            copy
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.own = env.walk.position().to_bits();
            env.mind.is_spoilt.set(false);
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            env.mind.own = farthest(env);
            Ok(Outcome { reward: outcome.reward * env.arguments.scale, ..outcome })
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> { stored_own(env) }
        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> { restore_own(env, snapshot) }

        fn draw(env: &Of<Self>, canvas: &mut dyn Canvas) {
            if env.mind.is_spoilt.get() {
                env.walk.draw(canvas);
            } else {
                draw_own(env, canvas);
            }
        }
    }

    // the text contains the number of the object, which is not part of the state
    "state-shown" "text" TellsItsNumber scaled_step {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata {
                render_modes: &[RenderMode::RgbArray, RenderMode::Ansi],
                ..Metadata::drawn(10, (200, 40))
            }
        }


        fn ansi(env: &Of<Self>) -> Option<String> {
            let number = if BAD { env.walk.number() } else { env.walk.steps().into() };
            Some(format!("walk {number}"))
        }
    }
}

// copies
pairs! {
    // the text contains the steps, which a clone counts too
    "clone-apart" "text" TellsTheClonesSteps {
        fn metadata(_: &Of<Self>) -> Metadata {
            Metadata {
                render_modes: &[RenderMode::RgbArray, RenderMode::Ansi],
                ..Metadata::drawn(10, (200, 40))
            }
        }

        fn copied(env: &Of<Self>) -> Mind {
            let copy = env.mind.clone();
            let shared = if BAD { Arc::clone(&env.mind.shared) } else { copy.shared.clone() };
            Mind { shared, ..copy }
        }

        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.shared.store(env.walk.steps().into(), Ordering::Relaxed);
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = env.walk.step_into(action, observation)?;
            env.mind.shared.store(env.walk.steps().into(), Ordering::Relaxed);
            Ok(Outcome { reward: outcome.reward * env.arguments.scale, ..outcome })
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            env.restore_stored(snapshot)?;
            env.mind.shared.store(env.walk.steps().into(), Ordering::Relaxed);
            Ok(())
        }

        fn ansi(env: &Of<Self>) -> Option<String> {
            Some(format!("step {}", env.mind.shared.load(Ordering::Relaxed)))
        }
    }
}

// infos
pairs! {
    // `info` names the last action, and the snapshot does not contain it
    "state-shown" "info-restored" ForgetsTheLastAction {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.own = 0;
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = scaled_step(env, action, observation)?;
            env.mind.own = 1 + action.as_int().unwrap_or(0) as u64;
            Ok(outcome)
        }

        fn snapshot(env: &Of<Self>) -> Result<Snapshot> {
            if BAD { env.stored() } else { stored_own(env) }
        }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            if BAD { env.restore_stored(snapshot) } else { restore_own(env, snapshot) }
        }

        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("last", Value::Int(env.mind.own as i64));
        }
    }

    // `info` counts refused actions until the next step
    "state-shown" "info-after-refusal" CountsRefusals {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            env.mind.own = 0;
            Ok(())
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            if BAD { env.mind.own += 1; }
            let outcome = scaled_step(env, action, observation)?;
            env.mind.own = 0;
            Ok(outcome)
        }

        fn info(env: &Of<Self>, visit: &mut dyn FnMut(&str, Value)) {
            visit("refused", Value::Int(env.mind.own as i64));
        }
    }
}

// copies
pairs! {
    // each restore increments a stored count; the thirtieth restore spoils the walk
    "snapshot-continues" "again-and-again" WearsOut scaled_step {
        fn snapshot(env: &Of<Self>) -> Result<Snapshot> { stored_own(env) }

        fn restore(env: &mut Of<Self>, snapshot: &Snapshot) -> Result<()> {
            restore_own(env, snapshot)?;
            env.mind.own += u64::from(BAD);
            env.mind.is_spoilt.set(env.mind.own > 8);
            Ok(())
        }
    }

    // a clone that is dropped spoils the original and the other clones
    "clone-apart" "dropped" NeedsItsClones {
        fn copied(env: &Of<Self>) -> Mind {
            env.mind.shared.fetch_add(1, Ordering::Relaxed);
            Mind { shared: Arc::clone(&env.mind.shared), ..env.mind.clone() }
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let alive = Arc::strong_count(&env.mind.shared) as u64;
            env.mind.is_spoilt.set(BAD && alive <= env.mind.shared.load(Ordering::Relaxed));
            scaled_step(env, action, observation)
        }
    }
}

// `close`
pairs! {
    "no-panic" "restored-after-close" PanicsRestored {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.mind.own = 0;
            env.walk.reset_into(reset, observation)
        }

        fn step(env: &mut Of<Self>, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = scaled_step(env, action, observation)?;
            assert!(!BAD || env.mind.own == 0, "closed");
            Ok(outcome)
        }

        fn close(env: &mut Of<Self>) {
            env.mind.own = 1;
            env.walk.close();
        }
    }

    // a reset after `close` draws one number too many
    "close-harmless" "generator" ClosesItsGenerator scaled_step {
        fn reset(env: &mut Of<Self>, reset: &Reset, observation: &mut Value) -> Result<()> {
            env.walk.reset_into(reset, observation)?;
            if BAD && env.mind.own == 1 && let Some(generator) = env.walk.generator() {
                generator.random();
            }
            Ok(())
        }

        fn close(env: &mut Of<Self>) {
            env.mind.own = 1;
            env.walk.close();
        }
    }
}
