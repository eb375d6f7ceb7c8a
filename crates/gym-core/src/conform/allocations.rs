//! Checks of what a step costs.

use super::subject::Subject;
use super::{Verdict, broken, skipped};
use crate::{Element, Env, Value};

pub(super) fn none(subject: &Subject<'_>) -> Verdict {
    const STEPS: usize = 200;
    if count(&mut || ()).is_none() {
        return skipped("add the feature `count-allocations` to the dependency on gym-core");
    }
    let mut env = subject.make()?;
    let mut actions = env.action_sampler(0)?;
    let mut observation = Value::empty();
    // buffers may grow in the first episode
    env.reset_into(&0.into(), &mut observation)?;
    env.step_into(&actions.sample(), &mut observation)?;
    env.reset_into(&0.into(), &mut observation)?;
    for step in 0..STEPS {
        let action = actions.sample();
        let mut outcome = Ok(crate::Outcome::default());
        let allocations = count(&mut || outcome = env.step_into(&action, &mut observation));
        let outcome = outcome?;
        if let Some(allocations @ 1..) = allocations {
            return broken(format!("step {step} of seed 0 allocates {allocations} times"));
        }
        if outcome.done() {
            env.reset_into(&().into(), &mut observation)?;
        }
    }
    Ok(())
}

/// The number of allocations that `f` makes on this thread, if they are counted.
#[cfg(feature = "count-allocations")]
fn count(f: &mut dyn FnMut()) -> Option<u64> {
    Some(allocation_counter::measure(f).count_total)
}

#[cfg(not(feature = "count-allocations"))]
fn count(_: &mut dyn FnMut()) -> Option<u64> {
    None
}
