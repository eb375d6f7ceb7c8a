//! Checks of the arguments of registered environments.

use std::fmt;

use serde_json::{Value as Json, json};

use crate::subject::Subject;
use crate::variation::{Effect, Search, Variant};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::{EnvSpec, Kwargs};

pub(crate) fn refused(subject: &Subject<'_>) -> Verdict {
    let Some((spec, kwargs)) = subject.arguments() else {
        return skipped("it is not registered");
    };
    for name in kwargs.keys() {
        let mut with = spec.clone();
        with.kwargs
            .insert(name.clone(), json!({"no": ["such", "value"]}));
        if with.make().is_ok() {
            return broken(format!(
                "the argument `{name}` accepts {}",
                with.kwargs[name]
            ));
        }
    }
    Ok(())
}

/// Checks that each bool and number among the arguments has an effect, alone or with another
/// argument.
pub(crate) fn matter(subject: &Subject<'_>) -> Verdict {
    let Some((spec, kwargs)) = subject.arguments() else {
        return skipped("it is not registered");
    };
    subject.repeatable()?;
    let mut search = Search::new(subject, surroundings(&spec, &kwargs))?;
    for (name, value) in &kwargs {
        if subject
            .exception(&format!("arguments-matter.{name}"))
            .is_some()
        {
            continue;
        }
        let others = others(value);
        let set = |other: &Json| {
            let changed = (name.clone(), other.clone());
            move |around: &Variant| {
                // skip the variants in which `name` itself is changed
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

/// Returns the default variant, and the default variant with each bool inverted.
pub(crate) fn surroundings(spec: &EnvSpec, kwargs: &Kwargs) -> Vec<Variant> {
    let default = Variant {
        spec: spec.clone(),
        options: Kwargs::new(),
    };
    let flipped = kwargs
        .iter()
        .filter_map(|(name, value)| Some((name.clone(), json!(!value.as_bool()?))));
    let flipped = flipped.map(|switch| default.clone().with_arguments([switch]));
    std::iter::once(default.clone()).chain(flipped).collect()
}

/// Returns other values of a bool or a number.
pub(crate) fn others(value: &Json) -> Vec<Json> {
    let mut others = match value {
        Json::Bool(is) => vec![json!(!is)],
        Json::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(int), _) => [
                int.saturating_mul(2),
                int.saturating_add(1),
                int.saturating_sub(1),
                0,
            ]
            .map(|x| json!(x))
            .to_vec(),
            (None, Some(x)) => [2.0 * x, 0.5 * x, x + 1.0, 0.0].map(|x| json!(x)).to_vec(),
            (None, None) => vec![],
        },
        _ => vec![],
    };
    // (twice zero is zero)
    others.retain(|other| other != value);
    others
}

/// Returns other values of an argument of any type, as far as they can be guessed.
pub(crate) fn guesses(value: &Json) -> Vec<Json> {
    match value {
        Json::Null => vec![json!(1), json!(0.5)],
        Json::Array(items) => {
            let doubled = items.iter().map(|item| others(item).into_iter().next());
            let doubled: Option<Vec<_>> = doubled.collect();
            doubled.map(Json::Array).into_iter().collect()
        }
        other => others(other),
    }
}

/// An environment with one unusual argument. The environment may refuse it.
pub(crate) struct Odd {
    pub(crate) spec: EnvSpec,
    name: String,
    value: Json,
}

impl fmt::Display for Odd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.name, self.value)
    }
}

/// Iterates over values at the ends of each argument's range, and beyond.
pub(crate) fn odd(subject: &Subject<'_>) -> impl Iterator<Item = Odd> {
    subject.arguments().into_iter().flat_map(|(spec, kwargs)| {
        kwargs.into_iter().flat_map(move |(name, default)| {
            let values = match default {
                Json::Number(number) if number.is_f64() => {
                    vec![
                        json!(0.0),
                        json!(-1.0),
                        json!(1e308),
                        json!(-1e308),
                        json!(5e-324),
                    ]
                }
                // no large sizes: the environment may rightly allocate arrays of these sizes
                Json::Number(_) => vec![json!(0), json!(-1), json!(1)],
                Json::Bool(value) => vec![json!(!value)],
                Json::String(_) => vec![json!(""), json!("no such value")],
                Json::Array(_) => vec![json!([]), json!([null]), json!([[]]), json!([1e308])],
                _ => vec![json!(0), json!(""), json!([]), json!([""]), json!({})],
            };
            let spec = spec.clone();
            values.into_iter().map(move |value| {
                let mut spec = spec.clone();
                spec.kwargs.insert(name.clone(), value.clone());
                Odd {
                    spec,
                    name: name.clone(),
                    value,
                }
            })
        })
    })
}
