//! Checks of the arguments of registered environments.

use serde_json::{Value as Json, json};

use crate::subject::{SEEDS, STEPS, Subject, roll_out, same};
use crate::variation::{Effect, Search, Variant};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::{EnvSpec, Kwargs};

pub(crate) fn round_trip(subject: &Subject<'_>) -> Verdict {
    let Some((spec, kwargs)) = subject.arguments() else { return skipped("it is not registered") };
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
    let Some((spec, kwargs)) = subject.arguments() else { return skipped("it is not registered") };
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
    let Some((spec, kwargs)) = subject.arguments() else { return skipped("it is not registered") };
    if subject.is_nondeterministic() {
        return skipped("it is registered as nondeterministic");
    }
    let mut search = Search::new(subject, surroundings(&spec, &kwargs))?;
    for (name, value) in &kwargs {
        let others = others(value);
        let set = |other: &Json| {
            let changed = (name.clone(), other.clone());
            move |around: &Variant| {
                // the switch itself is no surrounding of its own
                let is_other = around.spec.kwargs.get(name).is_none_or(|now| now == value);
                is_other.then(|| around.clone().with_arguments([changed.clone()]))
            }
        };
        if search.effect(&others.iter().map(set).collect::<Vec<_>>()) == Effect::None {
            return broken(format!(
                "the argument `{name}` changes neither spaces nor episodes, info or pictures: tried {} for {value}",
                json!(others)
            ));
        }
    }
    Ok(())
}

/// The default, and the default with each switch the other way.
pub(crate) fn surroundings(spec: &EnvSpec, kwargs: &Kwargs) -> Vec<Variant> {
    let default = Variant { spec: spec.clone(), options: Kwargs::new() };
    let flipped = kwargs.iter().filter_map(|(name, value)| Some((name.clone(), json!(!value.as_bool()?))));
    let flipped = flipped.map(|switch| default.clone().with_arguments([switch]));
    std::iter::once(default.clone()).chain(flipped).collect()
}

/// Other values of a bool or a number.
pub(crate) fn others(value: &Json) -> Vec<Json> {
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
