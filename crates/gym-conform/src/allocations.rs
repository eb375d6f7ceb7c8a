//! Checks of allocations in a step.

use crate::subject::Subject;
use crate::verdict::{Verdict, broken};
use gym_core::{Element, Env, EnvExt, Value};

pub(crate) fn none(subject: &Subject<'_>) -> Verdict {
    const STEPS: usize = 200;
    let mut env = subject.make()?;
    let mut actions = env.action_sampler(0)?;
    let mut observation = Value::empty();
    // buffers may grow in the first episode
    env.reset_into(&0.into(), &mut observation)?;
    env.step_into(&actions.sample(), &mut observation)?;
    env.reset_into(&0.into(), &mut observation)?;
    for step in 0..STEPS {
        let action = actions.sample();
        let mut outcome = Ok(gym_core::Outcome::default());
        let count = || outcome = env.step_into(&action, &mut observation);
        let allocations = allocation_counter::measure(count).count_total;
        let outcome = outcome?;
        if allocations > 0 {
            return broken(format!("step {step} of seed 0 allocates {allocations} times"));
        }
        if outcome.done() {
            env.reset_into(&().into(), &mut observation)?;
        }
    }
    Ok(())
}
