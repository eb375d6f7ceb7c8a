//! The check of `close`.

use crate::subject::{SEEDS, STEPS, Shown, Subject, roll_out, same};
use crate::verdict::{Verdict, broken};
use gym_core::{Env, Result};

/// Checks that one or two calls of `close` do not change other environments. If an environment can
/// be reset after `close`, its episode must equal a new environment's episode.
pub(crate) fn harmless(subject: &Subject<'_>) -> Verdict {
    let seed = SEEDS[0];
    let mut beside = subject.midway(seed)?;
    // play this episode before an environment is closed
    let first = subject.first_run()?;
    let played = roll_out(&mut subject.make()?, seed, STEPS)?;
    let closed = |times: u32| -> Result<Vec<Shown>> {
        let mut env = subject.midway(seed)?;
        (0..times).for_each(|_| env.close());
        roll_out(&mut env, seed, STEPS)
    };
    match (closed(1), closed(2)) {
        (Ok(once), Ok(twice)) => {
            same(&played, &once, "an environment that was closed and reset")?;
            same(
                &played,
                &twice,
                "an environment that was closed twice and reset",
            )?;
            let mut env = subject.midway(seed)?;
            for other in [seed + 1, seed + 2] {
                env.close();
                roll_out(&mut env, other, 5)?;
            }
            env.close();
            same(
                &played,
                &roll_out(&mut env, seed, STEPS)?,
                "an environment that was closed in several episodes",
            )?;
        }
        (Ok(_), Err(error)) => {
            return broken(format!(
                "`reset` after one `close` succeeds, and after two it does not: {error}"
            ));
        }
        // a closed environment may refuse all calls
        (Err(_), _) => (),
    }
    // close an environment before its first reset
    subject.make()?.close();
    let what = "a new environment after others were closed";
    let again = roll_out(&mut subject.make()?, seed, STEPS)?;
    same(&first[..again.len().min(first.len())], &again, what)?;
    let what = "an environment while others were closed";
    same(&played, &roll_out(&mut beside, seed, STEPS)?, what)
}
