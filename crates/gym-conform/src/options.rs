//! Checks of the reset options that a registration names.

use serde_json::{Value as Json, json};

use crate::arguments::{others, surroundings};
use crate::subject::Subject;
use crate::variation::{Effect, Search, Variant};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::{EnvExt, Reset};

/// The options with their examples.
fn examples(subject: &Subject<'_>) -> Verdict<Vec<(&'static str, Json)>> {
    let named = subject.registration.as_ref().map(|registration| registration.reset_options);
    let named = named.unwrap_or_default();
    if named.is_empty() {
        return skipped("its registration names no reset options");
    }
    let read = |(name, example): &(&'static str, &str)| match serde_json::from_str(example) {
        Ok(example) => Ok((*name, example)),
        Err(error) => {
            broken(format!("the example `{example}` of the reset option `{name}` is no JSON: {error}"))
        }
    };
    named.iter().map(read).collect()
}

/// An unnamed option is refused if the registration names any, and ignored otherwise.
pub(crate) fn unknown(subject: &Subject<'_>) -> Verdict {
    let plain = subject.make()?.reset(3)?;
    let names = subject.registration.as_ref().map(|registration| registration.reset_options);
    let names = names.unwrap_or_default();
    match subject.make()?.reset(Reset::seed(3).option("no_such_option", "x")) {
        Ok(_) if !names.is_empty() => {
            broken("the reset option `no_such_option`, which is not named, is accepted")
        }
        Ok(observation) if observation == plain => Ok(()),
        Ok(observation) => broken(format!(
            "with the option `no_such_option` an episode starts with {observation}, and without it with {plain}"
        )),
        Err(error) if names.is_empty() => {
            broken(format!("`reset` with the option `no_such_option`: {error}"))
        }
        Err(_) => Ok(()),
    }
}

/// Each named option accepts its example, and refuses unlike values.
pub(crate) fn accepted(subject: &Subject<'_>) -> Verdict {
    for (name, example) in examples(subject)? {
        if let Err(error) = subject.make()?.reset(Reset::seed(0).option(name, example.clone())) {
            return broken(format!("`reset` with the option {name}={example}, its example: {error}"));
        }
    }
    Ok(())
}

/// Each named option changes something, if only together with an argument.
pub(crate) fn matter(subject: &Subject<'_>) -> Verdict {
    let examples = examples(subject)?;
    let Some((spec, kwargs)) = subject.arguments() else { return skipped("it is not registered") };
    if subject.is_nondeterministic() {
        return skipped("it is registered as nondeterministic");
    }
    let mut search = Search::new(subject, surroundings(&spec, &kwargs))?;
    for (name, example) in examples {
        let tried = [vec![example.clone()], others(&example)].concat();
        let set = |value: &Json| {
            let value = value.clone();
            move |around: &Variant| Some(around.clone().with_option(name, value.clone()))
        };
        if search.effect(&tried.iter().map(set).collect::<Vec<_>>()) != Effect::Seen {
            return broken(format!(
                "the reset option `{name}` changes neither episodes nor info or pictures: tried {}",
                json!(tried)
            ));
        }
    }
    Ok(())
}
