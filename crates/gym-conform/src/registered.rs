//! Checks of the facts in a registration.

use crate::subject::{SEEDS, Subject};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::keys::{Idle, Keys};
use gym_core::names::parts;
use gym_core::registry::Clip;
use gym_core::{Env, EnvExt, Policy, Space};

pub(crate) fn constructs(subject: &Subject<'_>) -> Verdict {
    match subject.make() {
        Ok(_) => Ok(()),
        Err(error) => broken(error.to_string()),
    }
}

pub(crate) fn described(subject: &Subject<'_>) -> Verdict {
    match &subject.registration {
        Some(registration) if registration.description.trim().is_empty() => broken(format!(
            "`{}` is registered without a description",
            registration.id()
        )),
        Some(registration) if says_nothing(registration.id(), registration.description.trim()) => {
            broken(format!(
                "`{}` is described as {:?}",
                registration.id(),
                registration.description
            ))
        }
        Some(_) => Ok(()),
        None => skipped("it is not registered"),
    }
}

/// Returns whether a description only repeats the id, or is not written yet.
fn says_nothing(id: &str, about: &str) -> bool {
    let name = id.rsplit('/').next().unwrap_or(id);
    let stem = name.rsplit_once("-v").map_or(name, |(stem, _)| stem);
    [id, name, stem].contains(&about.trim_end_matches('.')) || about.starts_with("TODO")
}

pub(crate) fn versioned(subject: &Subject<'_>) -> Verdict {
    let Some(registration) = &subject.registration else {
        return skipped("it is not registered");
    };
    let version = registration
        .id()
        .rsplit_once("-v")
        .map(|(_, version)| version);
    match version.is_some_and(|version| version.parse::<u32>().is_ok()) {
        true => Ok(()),
        false => broken(format!("`{}` has no version", registration.id())),
    }
}

/// Checks that the threshold is a number, that each number has one name, that actions, keys and the
/// good policy are in the space, and that the clip has frames.
pub(crate) fn sound(subject: &Subject<'_>) -> Verdict {
    let (Some(registration), Some(spec)) = (&subject.registration, &subject.spec) else {
        return skipped("it is not registered");
    };
    if let Some(threshold) = spec.reward_threshold.filter(|x| !x.is_finite()) {
        return broken(format!("the reward threshold is {threshold}"));
    }
    let env = subject.reset(SEEDS[0])?;
    let (page, space) = (&registration.page, env.action_space());
    of_actions(page.actions, &space)?;
    if let Some(names) = page.names {
        let names = names(&env);
        for (of, space, names) in [
            ("observation", &env.observation_space(), &names.observation),
            ("action", &space, &names.action),
        ] {
            if let Err(error) = parts(space, names) {
                return broken(format!("the names of an {of}'s numbers: {error}"));
            }
        }
    }
    if let Some(keys) = page.keys {
        let Keys { actions, idle } = keys(&env);
        let idle = match idle {
            Idle::Action(action) => Some(("no key".to_owned(), action)),
            Idle::Wait | Idle::Repeat => None,
        };
        for (key, action) in actions.into_iter().chain(idle) {
            let is_action = space.from_json(&action);
            if !is_action.is_ok_and(|action| space.contains(&action)) {
                return broken(format!("the action of {key}, {action}, is not in {space}"));
            }
        }
    }
    if let Some(Clip {
        seeds,
        every,
        frames,
        size: (width, height),
    }) = &page.clip
        && (seeds.is_empty() || [every, frames, width, height].contains(&&0))
    {
        return broken(format!(
            "the clip of the seeds {seeds:?} has {frames} frames of {width} by {height} pixels, one for every {every} states"
        ));
    }
    page.policy.map_or(Ok(()), |policy| acts(subject, policy))
}

/// Checks the names of actions and their meanings.
fn of_actions(actions: &[(&str, &str)], space: &Space) -> Verdict {
    if let Space::Discrete(discrete) = space
        && actions.len() as i128 > i128::from(discrete.n())
    {
        return broken(format!(
            "{} actions have names, and the space is {space}",
            actions.len()
        ));
    }
    for (i, (name, meaning)) in actions.iter().enumerate() {
        if name.trim().is_empty() || meaning.trim().is_empty() {
            return broken(format!("the action {i} is called {name:?}: {meaning:?}"));
        }
        if actions[..i].iter().any(|(other, _)| other == name) {
            return broken(format!("two actions are called {name:?}"));
        }
    }
    Ok(())
}

/// Checks that the actions of a policy are elements of the action space.
fn acts(subject: &Subject<'_>, policy: Policy) -> Verdict {
    /// The steps of the policy for each seed.
    const STEPS: usize = 60;
    for seed in SEEDS {
        let mut env = subject.make()?;
        let space = env.action_space();
        let mut observation = env.reset(seed)?;
        let mut act = match policy.controller(&env) {
            Ok(Some(act)) => act,
            // (it does not fit the arguments)
            Ok(None) => return Ok(()),
            Err(error) => return broken(format!("its policy: {error}")),
        };
        for step in 0..STEPS {
            let place = format!("seed {seed}, step {step}");
            let Some(action) = act(&env, &observation) else {
                return broken(format!(
                    "{place}: its policy has no action for {observation}"
                ));
            };
            if !space.contains(&action) {
                return broken(format!(
                    "{place}: its policy chooses {action}, which is not in {space}"
                ));
            }
            let next = env.step(&action)?;
            if next.done() {
                break;
            }
            observation = next.observation;
        }
    }
    Ok(())
}
