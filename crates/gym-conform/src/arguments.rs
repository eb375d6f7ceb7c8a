//! Checks of the arguments of registered environments.

use serde_json::json;

use crate::subject::{SEEDS, STEPS, Subject, roll_out, same};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::{EnvSpec, Kwargs};

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
