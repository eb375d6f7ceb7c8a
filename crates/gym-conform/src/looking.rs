//! The check of calls that must not change an environment.

use gym_core::{BoxEnv, Env, EnvExt, Info, Result};

use crate::look::look;
use crate::subject::{SEEDS, Shown, Subject, same};
use crate::verdict::Verdict;

/// Checks that the calls in [`look`] do not change an episode.
pub(crate) fn pure(subject: &Subject<'_>) -> Verdict {
    for seed in SEEDS {
        let (mut env, mut unseen) = (subject.reset(seed)?, subject.reset(seed)?);
        let (mut samples, mut actions) = (unseen.action_sampler(seed)?, Vec::new());
        let mut play = |env: &mut BoxEnv, looks: bool| -> Result<Vec<Shown>> {
            let mut shown = Vec::new();
            for step in 0..20 {
                if looks {
                    // call `look` once: snapshots and drawings may take long
                    look(env);
                    (0..3).for_each(|_| drop((env.action_space(), env.metadata(), env.info_map())));
                    let _ = env.generator().is_some();
                }
                if actions.len() == step {
                    actions.push(samples.sample());
                }
                let step = env.step(&actions[step])?;
                let is_over = step.done();
                shown.push(Shown::Step(step, Info::default()));
                if is_over {
                    shown.push(Shown::Reset(env.reset(())?, Info::default()));
                }
            }
            Ok(shown)
        };
        let what = "an episode whose spaces, metadata, info and generator were asked for";
        same(&play(&mut unseen, false)?, &play(&mut env, true)?, what)?;
    }
    Ok(())
}
