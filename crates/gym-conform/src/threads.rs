//! Checks of environments on other threads.

use std::thread;

use crate::subject::{SEEDS, STEPS, Shown, Subject, carry_on, roll_out, same};
use crate::verdict::Verdict;
use gym_core::{BoxEnv, Result};

pub(crate) fn any_thread(subject: &Subject<'_>) -> Verdict {
    let env = subject.make()?;
    for seed in SEEDS {
        let here = roll_out(&mut env.clone(), seed, STEPS)?;
        let clones = [env.clone(), env.clone()];
        let there: [Result<Vec<Shown>>; 2] = thread::scope(|scope| {
            let run = |mut env: BoxEnv| scope.spawn(move || roll_out(&mut env, seed, STEPS));
            clones.map(run).map(join)
        });
        for shown in there {
            same(
                &here,
                &shown?,
                "one of two environments on threads of their own",
            )?;
        }
        let mut stayed = env.clone();
        roll_out(&mut stayed, seed, 5)?;
        let mut moved = stayed.clone();
        let there =
            thread::scope(|scope| join(scope.spawn(move || carry_on(&mut moved, seed, STEPS))))?;
        let here = carry_on(&mut stayed, seed, STEPS)?;
        same(
            &here,
            &there,
            "an environment that moved to another thread in the middle of an episode",
        )?;
    }
    Ok(())
}

/// Returns the result of a thread, or continues its panic.
fn join<T>(handle: thread::ScopedJoinHandle<'_, T>) -> T {
    handle
        .join()
        .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}
