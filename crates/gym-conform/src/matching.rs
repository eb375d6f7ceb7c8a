//! Whether two environments are the same task: Gymnasium's `check_environments_match`.

use crate::subject::alike;
use gym_core::{Element, Env, EnvExt, Error, Info, Result};

/// The parts of `info` that two environments must share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum InfoComparison {
    /// The same entries.
    #[default]
    Equivalence,
    /// The second has each entry of the first.
    Superset,
    /// The same names, with any values.
    KeysEquivalence,
    /// The second has each name of the first.
    KeysSuperset,
    /// Nothing.
    Skip,
}

/// The parts that [`environments_match`] compares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matching {
    /// The number of steps; 0 compares only the reset.
    pub num_steps: usize,
    /// Seeds the resets and the actions.
    pub seed: u64,
    /// Leaves out the observation space and the observations.
    pub skip_obs: bool,
    /// Leaves out the rewards.
    pub skip_rew: bool,
    /// Leaves out `terminated`.
    pub skip_terminal: bool,
    /// Leaves out `truncated`.
    pub skip_truncated: bool,
    /// Does not compare rendering. By default rendering is compared if both environments have a
    /// render mode other than `human`.
    pub skip_render: bool,
    /// The entries of `info` to compare.
    pub info_comparison: InfoComparison,
}

impl Default for Matching {
    /// Everything, over 200 steps of seed 0.
    fn default() -> Self {
        Self {
            num_steps: 200,
            seed: 0,
            skip_obs: false,
            skip_rew: false,
            skip_terminal: false,
            skip_truncated: false,
            skip_render: false,
            info_comparison: InfoComparison::Equivalence,
        }
    }
}

/// Plays both environments with the same seed and actions, and compares their results.
///
/// ```
/// use gym_conform::{Matching, environments_match};
/// use gym_core::{BoxEnv, Env, Outcome, Reset, Result, Snapshot, Space};
/// # #[derive(Clone)]
/// # struct Still;
/// # impl Env for Still {
/// #     type Observation = usize;
/// #     type Action = usize;
/// #     fn observation_space(&self) -> Space { Space::discrete(1) }
/// #     fn action_space(&self) -> Space { Space::discrete(1) }
/// #     fn reset_into(&mut self, _: &Reset, observation: &mut usize) -> Result<()> { *observation = 0; Ok(()) }
/// #     fn step_into(&mut self, _: &usize, observation: &mut usize) -> Result<Outcome> { *observation = 0; Ok(Outcome::default()) }
/// #     fn snapshot(&self) -> Result<Snapshot> { Snapshot::of(&()) }
/// #     fn restore(&mut self, _: &Snapshot) -> Result<()> { Ok(()) }
/// # }
/// environments_match(&mut Still, &mut BoxEnv::new(Still), &Matching::default())?;
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// # Errors
/// [`Error::Custom`] with the first difference, and the errors of a reset or step.
pub fn environments_match<A: Env, B: Env>(a: &mut A, b: &mut B, matching: &Matching) -> Result<()> {
    let differ = |what: &str, a: &dyn std::fmt::Display, b: &dyn std::fmt::Display| {
        Err(Error::custom(format!(
            "the environments differ in {what}: {a} and {b}"
        )))
    };
    let spaces = [a.action_space(), b.action_space()];
    if spaces[0] != spaces[1] {
        return differ("the action space", &spaces[0], &spaces[1]);
    }
    let spaces = [a.observation_space(), b.observation_space()];
    if !matching.skip_obs && spaces[0] != spaces[1] {
        return differ("the observation space", &spaces[0], &spaces[1]);
    }
    reset(a, b, matching)?;
    let mut actions = a.action_space().sampler(matching.seed);
    for step in 0..matching.num_steps {
        let action = actions.sample();
        let fits = |name: &str| {
            Error::custom(format!(
                "{action} does not fit the actions of the {name} environment"
            ))
        };
        let action_a = A::Action::from_value(&action).ok_or_else(|| fits("first"))?;
        let action_b = B::Action::from_value(&action).ok_or_else(|| fits("second"))?;
        let (from_a, from_b) = (a.step(&action_a)?, b.step(&action_b)?);
        let [seen_a, seen_b] = [from_a.observation.to_value(), from_b.observation.to_value()];
        if !matching.skip_obs && !alike(&seen_a, &seen_b) {
            return differ(&format!("the observation of step {step}"), &seen_a, &seen_b);
        }
        if !matching.skip_rew && !alike(&from_a.reward, &from_b.reward) {
            return differ(
                &format!("the reward of step {step}"),
                &from_a.reward,
                &from_b.reward,
            );
        }
        if !matching.skip_terminal && from_a.terminated != from_b.terminated {
            return differ(
                &format!("`terminated` of step {step}"),
                &from_a.terminated,
                &from_b.terminated,
            );
        }
        if !matching.skip_truncated && from_a.truncated != from_b.truncated {
            return differ(
                &format!("`truncated` of step {step}"),
                &from_a.truncated,
                &from_b.truncated,
            );
        }
        compare_rest(a, b, matching, &format!("step {step}"))?;
        if from_a.done() || from_b.done() {
            reset(a, b, matching)?;
        }
    }
    Ok(())
}

fn reset<A: Env, B: Env>(a: &mut A, b: &mut B, matching: &Matching) -> Result<()> {
    let (seen_a, seen_b) = (
        a.reset(matching.seed)?.to_value(),
        b.reset(matching.seed)?.to_value(),
    );
    if !matching.skip_obs && !alike(&seen_a, &seen_b) {
        return Err(Error::custom(format!(
            "the environments differ in the observation of reset: {seen_a} and {seen_b}"
        )));
    }
    compare_rest(a, b, matching, "reset")
}

/// Compares `info` and frames.
fn compare_rest<A: Env, B: Env>(
    a: &mut A,
    b: &mut B,
    matching: &Matching,
    place: &str,
) -> Result<()> {
    let (info_a, info_b) = (a.info_map(), b.info_map());
    let has_key = |info: &Info, key: &String| info.contains_key(key);
    let is_matched = match matching.info_comparison {
        InfoComparison::Equivalence => alike(&info_a, &info_b),
        InfoComparison::Superset => info_a
            .iter()
            .all(|(key, a)| info_b.get(key).is_some_and(|b| alike(a, b))),
        InfoComparison::KeysEquivalence => info_a.keys().eq(info_b.keys()),
        InfoComparison::KeysSuperset => info_a.keys().all(|key| has_key(&info_b, key)),
        InfoComparison::Skip => true,
    };
    if !is_matched {
        return Err(Error::custom(format!(
            "the environments differ in the info of {place}: {info_a:?} and {info_b:?}"
        )));
    }
    if !matching.skip_render
        && let (Ok(a), Ok(b)) = (a.render(), b.render())
        && a != b
    {
        return Err(Error::custom(format!(
            "the environments differ in the picture of {place}"
        )));
    }
    Ok(())
}
