//! The rules of [`Env`] as checks that run against any environment.
//!
//! A plugin's own test suite runs them in one line; `cargo xtask conform` runs them over everything
//! that is linked.
//!
//! ```text
//! let findings = conform::check(|| gym_core::make("my_envs/Corridor-v0"));
//! assert!(findings.is_empty(), "{findings:#?}");
//! ```

use std::fmt;

use crate::{BoxEnv, Env, Error, Info, Reset, Result, Step, Value};

/// A broken rule.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The name of the check, one of [`CHECKS`].
    pub check: &'static str,
    /// What was seen, where, and how to mend it.
    pub message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.check, self.message)
    }
}

/// One rule.
#[derive(Debug)]
pub struct Check {
    /// A short name.
    pub name: &'static str,
    /// Why it matters to those who use the environment.
    pub why: &'static str,
    run: fn(&Maker<'_>) -> Verdict,
}

type Maker<'a> = dyn Fn() -> Result<BoxEnv> + 'a;

/// What was seen, where a rule is broken.
type Verdict<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;

/// Every rule, in the order in which they are checked.
pub const CHECKS: &[Check] = &[
    Check { name: "constructs", why: "nothing works without it", run: constructs },
    Check {
        name: "reset-needed",
        why: "an agent that forgets to reset must be told, not trained on nonsense",
        run: reset_needed,
    },
    Check {
        name: "observation-in-space",
        why: "agents size their networks and tables by the space",
        run: observation_in_space,
    },
    Check { name: "reward-finite", why: "one NaN ruins a training run", run: reward_finite },
    Check {
        name: "action-validated",
        why: "an invalid action must be an error, not a guess or a panic",
        run: action_validated,
    },
    Check {
        name: "same-seed-same-episode",
        why: "experiments must be repeatable",
        run: same_seed_same_episode,
    },
    Check { name: "reset-forgets", why: "an episode must not depend on those before it", run: reset_forgets },
    Check {
        name: "other-seed-other-episode",
        why: "a seed that changes nothing gives the same training data again and again",
        run: other_seed_other_episode,
    },
    Check { name: "clone-continues", why: "planners branch from clones", run: clone_continues },
    Check {
        name: "snapshot-continues",
        why: "checkpoints must resume where they were taken",
        run: snapshot_continues,
    },
];

/// Runs every check against the environment that `make` makes. No finding means that it conforms.
pub fn check(make: impl Fn() -> Result<BoxEnv>) -> Vec<Finding> {
    let mut findings = Vec::new();
    for Check { name, run, .. } in CHECKS {
        if let Err(message) = run(&make) {
            findings.push(Finding { check: name, message: message.to_string() });
            if *name == "constructs" {
                break;
            }
        }
    }
    findings
}

/// Episodes are compared over this many steps, through several resets where they are short.
const STEPS: usize = 400;
const SEEDS: [u64; 3] = [0, 1, 123_456_789];

/// What an environment showed after one reset or step.
#[derive(Debug, PartialEq)]
enum Shown {
    Reset(Value, Info),
    Step(Step<Value>, Info),
}

/// Random actions for `steps` steps, with unseeded resets where an episode ends.
fn roll_out(env: &mut BoxEnv, seed: u64, steps: usize) -> Result<Vec<Shown>> {
    let observation = env.reset(seed)?;
    let mut shown = vec![Shown::Reset(observation, info(env))];
    shown.extend(carry_on(env, seed, steps)?);
    Ok(shown)
}

/// As [`roll_out`], from the current state.
fn carry_on(env: &mut BoxEnv, action_seed: u64, steps: usize) -> Result<Vec<Shown>> {
    let mut actions = env.action_sampler(action_seed)?;
    let mut shown = Vec::with_capacity(steps);
    for _ in 0..steps {
        let step = env.step(&actions.sample())?;
        let done = step.done();
        shown.push(Shown::Step(step, info(env)));
        if done {
            let observation = env.reset(())?;
            shown.push(Shown::Reset(observation, info(env)));
        }
    }
    Ok(shown)
}

/// The entries of `info` without wall-clock time.
fn info(env: &BoxEnv) -> Info {
    let mut info = env.info_map();
    if let Some(Value::Dict(episode)) = info.get_mut("episode") {
        episode.retain(|(key, _)| key != "t");
    }
    info
}

/// Says where two histories part. NaN counts as equal to itself: it has a check of its own.
fn same(a: &[Shown], b: &[Shown], what: &str) -> Verdict {
    let differ = |(a, b): (&Shown, &Shown)| a != b && format!("{a:?}") != format!("{b:?}");
    match a.iter().zip(b).position(differ) {
        None => Ok(()),
        Some(i) => Err(format!("{what} differs at event {i}: {:?} and {:?}", a[i], b[i]).into()),
    }
}

fn constructs(make: &Maker<'_>) -> Verdict {
    make()?.reset(0)?;
    Ok(())
}

fn reset_needed(make: &Maker<'_>) -> Verdict {
    let mut env = make()?;
    let action = env.action_sampler(0)?.sample();
    match env.step(&action) {
        Err(Error::ResetNeeded(_)) => Ok(()),
        Err(error) => Err(format!("`step` before `reset` gives another error than ResetNeeded: {error}"))?,
        Ok(_) => Err("`step` before `reset` succeeds: return Err(Error::ResetNeeded(\"step\"))".into()),
    }
}

fn observation_in_space(make: &Maker<'_>) -> Verdict {
    let mut env = make()?;
    let space = env.observation_space();
    for seed in SEEDS {
        for (i, shown) in roll_out(&mut env, seed, STEPS)?.iter().enumerate() {
            let (Shown::Reset(observation, _) | Shown::Step(Step { observation, .. }, _)) = shown;
            space.check(observation).map_err(|error| format!("seed {seed}, event {i}: {error}"))?;
        }
    }
    Ok(())
}

fn reward_finite(make: &Maker<'_>) -> Verdict {
    let mut env = make()?;
    for seed in SEEDS {
        for (i, shown) in roll_out(&mut env, seed, STEPS)?.iter().enumerate() {
            if let Shown::Step(Step { reward, .. }, _) = shown
                && !reward.is_finite()
            {
                Err(format!("seed {seed}, event {i}: the reward is {reward}"))?;
            }
        }
    }
    Ok(())
}

fn action_validated(make: &Maker<'_>) -> Verdict {
    let mut env = make()?;
    env.reset(0)?;
    let valid = env.action_sampler(0)?.sample();
    for action in invalid_actions(&valid) {
        if env.step(&action).is_ok() {
            let space = env.action_space();
            Err(format!(
                "`step` accepts {action}, which is not in {space}: return Err(Error::InvalidAction {{ .. }})"
            ))?;
        }
    }
    env.step(&valid).map_err(|error| format!("a valid action after refused ones: {error}"))?;
    Ok(())
}

/// Actions of another kind or shape than a valid one, out of any discrete range, or not a number.
fn invalid_actions(valid: &Value) -> Vec<Value> {
    let mut actions = vec![Value::Null, Value::Text("left".into()), Value::Tuple(vec![]), Value::Float(0.5)];
    match valid {
        Value::Int(_) => actions.extend([Value::Int(-1), Value::Int(i64::MIN), Value::Int(i64::MAX)]),
        _ => actions.push(Value::Int(0)),
    }
    if let Some(values) = valid.as_slice::<f32>() {
        actions.push(Value::Array(vec![f32::NAN; values.len()].into()));
        actions.push(Value::Array(vec![0.0f32; values.len() + 1].into()));
        actions.push(Value::Array(vec![0.0f64; values.len()].into()));
    }
    actions
}

fn same_seed_same_episode(make: &Maker<'_>) -> Verdict {
    let roll = |seed| roll_out(&mut make()?, seed, STEPS);
    SEEDS.into_iter().try_for_each(|seed| {
        same(&roll(seed)?, &roll(seed)?, "a second environment with the same seed and actions")
    })
}

fn reset_forgets(make: &Maker<'_>) -> Verdict {
    let mut env = make()?;
    for seed in SEEDS {
        let first = roll_out(&mut env, seed, STEPS)?;
        // leave it in the middle of another episode
        roll_out(&mut env, seed + 1, 7)?;
        let second = roll_out(&mut env, seed, STEPS)?;
        same(&first, &second, "a used environment with the same seed and actions")?;
    }
    Ok(())
}

fn other_seed_other_episode(make: &Maker<'_>) -> Verdict {
    let mut env = make()?;
    // the same actions each time, so that only the environment's own randomness can tell
    let mut episode = |reset: Reset| -> Result<Vec<Shown>> {
        let observation = env.reset(reset)?;
        let mut shown = vec![Shown::Reset(observation, info(&env))];
        shown.extend(carry_on(&mut env, 0, STEPS)?);
        Ok(shown)
    };
    let first = episode(Reset::seed(0))?;
    for seed in 1..20 {
        if episode(Reset::seed(seed))? != first {
            return Ok(());
        }
    }
    for _ in 0..20 {
        if episode(Reset::default())? != first {
            return Err("20 seeds give the same episode, yet there is randomness: seed the generator \
                        from `reset.seed`"
                .into());
        }
    }
    Ok(())
}

fn clone_continues(make: &Maker<'_>) -> Verdict {
    continues(make, "a clone", |env| Ok(env.clone()))
}

fn snapshot_continues(make: &Maker<'_>) -> Verdict {
    continues(make, "an environment restored from a snapshot", |env| {
        let json =
            serde_json::to_string(&env.snapshot()?).map_err(|error| Error::Snapshot(error.to_string()))?;
        let mut restored = make()?;
        restored
            .restore(&serde_json::from_str(&json).map_err(|error| Error::Snapshot(error.to_string()))?)?;
        Ok(restored)
    })
}

/// Whether a copy taken in the middle of an episode goes on as the original does.
fn continues(make: &Maker<'_>, what: &str, copy: impl Fn(&BoxEnv) -> Result<BoxEnv>) -> Verdict {
    for seed in SEEDS {
        let mut env = make()?;
        roll_out(&mut env, seed, 5)?;
        let mut copied = copy(&env).map_err(|error| format!("{what}: {error}"))?;
        let original = carry_on(&mut env, seed, STEPS)?;
        let copied = carry_on(&mut copied, seed, STEPS).map_err(|error| format!("{what}: {error}"))?;
        same(&original, &copied, what)?;
    }
    Ok(())
}
