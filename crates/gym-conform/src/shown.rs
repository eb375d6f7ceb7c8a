//! The check of an environment's info, text and drawing.

use crate::calls::Calls;
use crate::inputs::invalid;
use crate::subject::{MIDWAY, SEEDS, Subject, alike, info, roll_out};
use crate::verdict::{Verdict, broken};
use gym_core::{BoxEnv, Env, EnvExt};

/// Checks that info, text and drawing depend only on the state. All three must be equal in a second
/// environment, in a used environment after a reset, in copies, and after refused actions.
pub(crate) fn follows(subject: &Subject<'_>) -> Verdict {
    for (i, seed) in SEEDS.into_iter().enumerate() {
        // draw for one seed only: some drawings have thousands of calls
        let is_drawn = i == 0;
        let same = |a: &BoxEnv, b: &BoxEnv, what: &str| same(a, b, what, is_drawn);
        let mut env = subject.midway(seed)?;
        if !subject.is_nondeterministic() {
            let what = "a second environment with the same seed and actions";
            same(&env, &subject.midway(seed)?, what)?;
            let mut used = subject.midway(seed + 1)?;
            used.reset(seed)?;
            let what = "a used environment that was reset with the same seed";
            same(&subject.reset(seed)?, &used, what)?;
            roll_out(&mut used, seed, MIDWAY)?;
            let what = "a used environment with the same seed and actions";
            same(&env, &used, what)?;
        }
        same(&env, &env.clone(), "a clone")?;
        if let Ok(snapshot) = env.snapshot() {
            for mut restored in [subject.make()?, subject.midway(seed + 1)?] {
                restored.restore(&snapshot)?;
                same(&env, &restored, "an environment restored from a snapshot")?;
            }
        }
        let before = env.clone();
        let (space, valid) = (env.action_space(), env.action_sampler(0)?.sample());
        for action in invalid(&space, &valid) {
            let _ = env.step(&action);
        }
        same(&before, &env, "an environment that refused actions")?;
    }
    Ok(())
}

fn same(a: &BoxEnv, b: &BoxEnv, what: &str, is_drawn: bool) -> Verdict {
    let infos = [info(a), info(b)];
    if !alike(&infos[0], &infos[1]) {
        let [a, b] = infos;
        return broken(format!(
            "{what} has the info {b:?} before its next step, and the other has {a:?}"
        ));
    }
    if a.ansi() != b.ansi() {
        return broken(format!(
            "{what} has the text {:?} before its next step, and the other has {:?}",
            b.ansi(),
            a.ansi()
        ));
    }
    if is_drawn && Calls::of(a).record != Calls::of(b).record {
        let [a, b] = [a, b].map(Calls::text);
        let differs = a.lines().zip(b.lines()).find(|(a, b)| a != b);
        let (a, b) = differs.unwrap_or(("fewer calls", "more calls"));
        return broken(format!(
            "{what} is drawn otherwise before its next step: {b}, and the other {a}"
        ));
    }
    Ok(())
}
