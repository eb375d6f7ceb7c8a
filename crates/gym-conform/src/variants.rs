//! Short episodes with other arguments and with options, played once for several checks.

use std::panic::{AssertUnwindSafe, catch_unwind};

use gym_core::{BoxEnv, Env, EnvExt, EnvSpec, Kwargs, Reset, Result, Snapshot};
use serde_json::Value as Json;

use crate::arguments::others;
use crate::options::examples;
use crate::subject::{SEEDS, Shown, Subject, alike, carry_on, info};
use crate::verdict::{Verdict, broken, message};

/// The number of steps before a copy is taken, and after.
const BEFORE: usize = 3;
const AFTER: usize = 10;

/// The first fault of each kind.
#[derive(Default)]
pub(crate) struct Variants {
    repeated: Option<String>,
    in_space: Option<String>,
    reward: Option<String>,
    cloned: Option<String>,
    restored: Option<String>,
    panicked: Option<String>,
}

/// A way to make an environment and to reset it.
struct Variant {
    spec: EnvSpec,
    options: Kwargs,
    /// Whether the variant has another value for an argument of type float.
    is_float: bool,
    /// A description of the change, for messages.
    name: String,
}

impl Variants {
    /// Plays each variant that the environment accepts.
    pub(crate) fn play(subject: &Subject<'_>) -> Self {
        let mut faults = Self::default();
        for variant in all(subject) {
            let attempt = catch_unwind(AssertUnwindSafe(|| {
                // (the environment may refuse an argument, or fail in a step)
                let _ = faults.try_one(&variant, subject.is_nondeterministic());
            }));
            if let Err(payload) = attempt {
                let name = &variant.name;
                faults
                    .panicked
                    .get_or_insert_with(|| format!("with {name} {}", message(&*payload)));
            }
        }
        faults
    }

    fn try_one(&mut self, variant: &Variant, is_nondeterministic: bool) -> Result<()> {
        let name = &variant.name;
        let (mut env, mut shown) = variant.begin()?;
        let rest = carry_on(&mut env, 1, AFTER)?;
        shown.extend(rest.clone());
        self.see(&env, &shown, variant);
        if is_nondeterministic {
            return Ok(());
        }
        let (mut again, mut repeated) = variant.begin()?;
        repeated.extend(carry_on(&mut again, 1, AFTER)?);
        if let Some(differs) = difference(&shown, &repeated) {
            self.repeated.get_or_insert_with(|| {
                format!(
                    "with {name} a second environment with the same seed and actions differs: {differs}"
                )
            });
            return Ok(());
        }
        let (env, _) = variant.begin()?;
        let mut clone = env.clone();
        let mut copies = vec![(&mut self.cloned, "a clone", carry_on(&mut clone, 1, AFTER))];
        // (another check reports an environment without snapshots)
        if let Ok(snapshot) = env.snapshot() {
            let restored = variant.restored(&snapshot);
            copies.push((&mut self.restored, "an environment restored", restored));
        }
        for (fault, what, copied) in copies {
            let differs = match copied {
                Ok(copied) => difference(&rest, &copied),
                Err(error) => Some(error.to_string()),
            };
            if let Some(differs) = differs {
                fault.get_or_insert_with(|| format!("with {name} {what} differs: {differs}"));
            }
        }
        Ok(())
    }

    fn see(&mut self, env: &BoxEnv, shown: &[Shown], variant: &Variant) {
        let name = &variant.name;
        let space = env.observation_space();
        for (i, shown) in shown.iter().enumerate() {
            // with unusual values of physical constants, observations may leave the space
            if !variant.is_float
                && let Err(error) = space.check(shown.observation())
            {
                self.in_space
                    .get_or_insert_with(|| format!("with {name}, event {i}: {error}"));
            }
            if let Shown::Step(step, _) = shown
                && !step.reward.is_finite()
            {
                let reward = step.reward;
                self.reward.get_or_insert_with(|| {
                    format!("with {name}, event {i}: the reward is {reward}")
                });
            }
        }
    }

    pub(crate) fn repeated(&self) -> Verdict {
        verdict(&self.repeated)
    }

    pub(crate) fn in_space(&self) -> Verdict {
        verdict(&self.in_space)
    }

    pub(crate) fn reward_finite(&self) -> Verdict {
        verdict(&self.reward)
    }

    pub(crate) fn cloned(&self) -> Verdict {
        verdict(&self.cloned)
    }

    pub(crate) fn restored(&self) -> Verdict {
        verdict(&self.restored)
    }

    pub(crate) fn panicked(&self) -> Verdict {
        verdict(&self.panicked)
    }
}

fn verdict(fault: &Option<String>) -> Verdict {
    fault.as_ref().map_or(Ok(()), broken)
}

impl Variant {
    /// Makes an environment, resets it and takes a few steps.
    fn begin(&self) -> Result<(BoxEnv, Vec<Shown>)> {
        let mut env = self.spec.make()?;
        let observation = env.reset(Reset {
            options: self.options.clone(),
            ..Reset::seed(SEEDS[0])
        })?;
        let mut shown = vec![Shown::Reset(observation, info(&env))];
        shown.extend(carry_on(&mut env, 0, BEFORE)?);
        Ok((env, shown))
    }

    /// Restores a new environment from `snapshot`, and takes [`AFTER`] steps.
    fn restored(&self, snapshot: &Snapshot) -> Result<Vec<Shown>> {
        let mut env = self.spec.make()?;
        env.restore(snapshot)?;
        carry_on(&mut env, 1, AFTER)
    }
}

/// Returns the first difference of two histories.
fn difference(a: &[Shown], b: &[Shown]) -> Option<String> {
    let i = a.iter().zip(b).position(|(a, b)| !alike(a, b))?;
    Some(format!("event {i} is {:?} and {:?}", a[i], b[i]))
}

/// Returns the variants of the environment: one other argument, one option, or one option and one
/// inverted bool.
fn all(subject: &Subject<'_>) -> Vec<Variant> {
    let Some((spec, kwargs)) = subject.arguments() else {
        return Vec::new();
    };
    let with = |changed: Option<(&String, &Json)>, option: Option<&(&'static str, Json)>| {
        let (mut spec, mut options) = (spec.clone(), Kwargs::new());
        let mut name = Vec::new();
        if let Some((argument, value)) = changed {
            spec.kwargs.insert(argument.clone(), value.clone());
            name.push(format!("{argument}={value}"));
        }
        if let Some((option, value)) = option {
            options.insert((*option).to_owned(), value.clone());
            name.push(format!("the option {option}={value}"));
        }
        let name = name.join(" and ");
        Variant {
            spec,
            options,
            is_float: changed.is_some_and(|(_, value)| value.is_f64()),
            name,
        }
    };
    let examples = examples(subject).unwrap_or_default();
    let mut variants: Vec<_> = examples
        .iter()
        .map(|option| with(None, Some(option)))
        .collect();
    for (name, value) in &kwargs {
        // the last value is the most unusual: 0 for a number
        let accepted = others(value).into_iter().rev().find(|other| {
            let mut spec = spec.clone();
            spec.kwargs.insert(name.clone(), other.clone());
            // a panic is the finding of another check
            catch_unwind(AssertUnwindSafe(|| spec.make().is_ok())).unwrap_or(false)
        });
        if let Some(other) = accepted {
            let changed = Some((name, &other));
            variants.push(with(changed, None));
            if value.is_boolean() {
                variants.extend(examples.iter().map(|option| with(changed, Some(option))));
            }
        }
    }
    variants
}
