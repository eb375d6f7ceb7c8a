//! Checks of the arguments of registered environments.

use serde_json::{Value as Json, json};

use crate::drawing::Calls;
use crate::subject::{SEEDS, STEPS, Shown, Subject, roll_out, same};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::{Env, EnvSpec, Kwargs, Result};

/// The arguments that are set when none is given.
pub(crate) fn effective(subject: &Subject<'_>) -> Option<(EnvSpec, Kwargs)> {
    let (spec, registration) = (subject.spec.as_ref()?, subject.registration.as_ref()?);
    let mut kwargs = registration.default_kwargs();
    kwargs.extend(spec.kwargs.clone());
    Some((spec.clone(), kwargs))
}

pub(crate) fn round_trip(subject: &Subject<'_>) -> Verdict {
    let Some((spec, kwargs)) = effective(subject) else { return skipped("it is not registered") };
    let explicit = EnvSpec { kwargs: kwargs.clone(), ..spec };
    let text = serde_json::to_string(&explicit).unwrap_or_default();
    let made = match serde_json::from_str::<EnvSpec>(&text) {
        Ok(read) => read.make(),
        Err(error) => return broken(format!("{text} is not read back: {error}")),
    };
    let mut made = match made {
        Ok(made) => made,
        Err(error) => {
            return broken(format!("with the arguments it has by default, {}: {error}", json!(kwargs)));
        }
    };
    let what = format!("with the arguments it has by default, {}, an episode", json!(kwargs));
    for seed in SEEDS {
        same(&roll_out(&mut subject.make()?, seed, STEPS)?, &roll_out(&mut made, seed, STEPS)?, &what)?;
    }
    Ok(())
}

pub(crate) fn refused(subject: &Subject<'_>) -> Verdict {
    const UNKNOWN: &str = "no_such_argument";
    let Some((spec, kwargs)) = effective(subject) else { return skipped("it is not registered") };
    let mut with = spec.clone();
    with.kwargs.insert(UNKNOWN.into(), json!(1));
    match with.make() {
        Ok(_) => return broken(format!("the argument `{UNKNOWN}` is accepted")),
        Err(error) => {
            let message = error.to_string();
            let registration = subject.registration.as_ref();
            let names = registration.map(gym_core::Registration::default_kwargs).unwrap_or_default();
            if let Some(name) = names.keys().find(|name| !message.contains(*name)) {
                return broken(format!(
                    "the message about an unknown argument does not name `{name}`: {message}"
                ));
            }
        }
    }
    for name in kwargs.keys() {
        let mut with = spec.clone();
        with.kwargs.insert(name.clone(), json!({"no": ["such", "value"]}));
        if with.make().is_ok() {
            return broken(format!("the argument `{name}` accepts {}", with.kwargs[name]));
        }
    }
    Ok(())
}

/// Each bool and number among the arguments changes something, if only together with another.
pub(crate) fn matter(subject: &Subject<'_>) -> Verdict {
    let Some((spec, kwargs)) = effective(subject) else { return skipped("it is not registered") };
    if subject.is_nondeterministic() {
        return skipped("it is registered as nondeterministic");
    }
    let with = |changes: &[(&String, &Json)]| {
        let mut spec = spec.clone();
        let changes = changes.iter().map(|(name, value)| ((*name).clone(), (*value).clone()));
        spec.kwargs.extend(changes);
        spec
    };
    // alone, and where a switch that is off would hide what it does
    let flipped = |(name, value): (&String, &Json)| Some((name.clone(), json!(!value.as_bool()?)));
    let switches: Vec<_> = kwargs.iter().filter_map(flipped).collect();
    let surroundings: Vec<_> = std::iter::once(None).chain(switches.iter().map(Some)).collect();
    for (name, value) in &kwargs {
        let others = others(value);
        let (mut accepted, mut matters) = (false, others.is_empty());
        'search: for steps in [STEPS, subject.long()?] {
            for surrounding in &surroundings {
                let surrounding = surrounding.filter(|(other, _)| other != name);
                let around: Vec<_> = surrounding.iter().map(|(name, value)| (name, value)).collect();
                let Ok(before) = appearance(&with(&around), steps) else { continue };
                for other in &others {
                    let Ok(after) = appearance(&with(&[&around[..], &[(name, other)]].concat()), steps)
                    else {
                        continue;
                    };
                    accepted = true;
                    if before != after {
                        matters = true;
                        break 'search;
                    }
                }
            }
        }
        if accepted && !matters {
            return broken(format!(
                "the argument `{name}` changes neither spaces nor episodes, info or pictures: tried {} for {value}",
                json!(others)
            ));
        }
    }
    Ok(())
}

/// Other values of a bool or a number.
fn others(value: &Json) -> Vec<Json> {
    match value {
        Json::Bool(is) => vec![json!(!is)],
        Json::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(int), _) => [int.saturating_mul(2), int.saturating_add(1), int.saturating_sub(1), 0]
                .map(|x| json!(x))
                .to_vec(),
            (None, Some(x)) => [2.0 * x, 0.5 * x, x + 1.0, 0.0].map(|x| json!(x)).to_vec(),
            (None, None) => vec![],
        },
        _ => vec![],
    }
}

/// All that an environment shows in an episode: spaces, metadata, what steps give, and drawings.
fn appearance(spec: &EnvSpec, steps: usize) -> Result<(String, Vec<Shown>, String)> {
    let mut env = spec.make()?;
    let spaces = format!("{} {} {:?}", env.observation_space(), env.action_space(), env.metadata());
    let shown = roll_out(&mut env, SEEDS[0], steps)?;
    Ok((spaces, shown, format!("{} {:?}", Calls::of(&env).text, env.ansi())))
}
