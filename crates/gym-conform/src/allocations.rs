//! Checks of allocations in a step.

use crate::subject::Subject;
use crate::verdict::{Verdict, broken};
use gym_core::{Element, Env, EnvExt, Result, Value};

pub(crate) fn none(subject: &Subject<'_>) -> Verdict {
    const WARM: u32 = 12;
    let steps = subject.long()?;
    let mut env = subject.make()?;
    let mut actions = env.action_sampler(0)?;
    let mut observation = Value::empty();
    // buffers may grow in the first episode
    env.reset_into(&0.into(), &mut observation)?;
    env.step_into(&actions.sample(), &mut observation)?;
    env.reset_into(&0.into(), &mut observation)?;
    for step in 0..steps {
        let action = actions.sample();
        let mut outcome = Ok(gym_core::Outcome::default());
        let count = || outcome = env.step_into(&action, &mut observation);
        let allocations = allocation_counter::measure(count).count_total;
        let outcome = outcome?;
        if allocations > 0 {
            return broken(format!(
                "step {step} of seed 0 allocates {allocations} times"
            ));
        }
        if outcome.done() {
            env.reset_into(&().into(), &mut observation)?;
        }
    }
    // these resets have equal seeds, so their buffers have grown already
    let mut begin = |times: u32| -> Result<i64> {
        let mut result = Ok(());
        let resets =
            || result = (0..times).try_for_each(|_| env.reset_into(&0.into(), &mut observation));
        let kept = allocation_counter::measure(resets).bytes_current;
        result.map(|()| kept)
    };
    // a buffer that doubles its size grows at most once in twice as many resets
    begin(WARM)?;
    let kept = begin(WARM + 2)?;
    if kept > 0 {
        return broken(format!(
            "{} resets with the same seed keep {kept} bytes more",
            WARM + 2
        ));
    }
    Ok(())
}
