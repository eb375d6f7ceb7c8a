//! Checks of the reset options that a registration names.

use serde_json::{Value as Json, json};

use crate::arguments::{others, surroundings};
use crate::subject::{SEEDS, STEPS, Shown, Subject, carry_on, info, roll_out, same};
use crate::variation::{Effect, Search, Variant};
use crate::verdict::{Verdict, broken, skipped};
use gym_core::{BoxEnv, Env, EnvExt, Generator, Reset, Result};

/// The number of resets without a seed: an option must change at least one of them.
const UNSEEDED: usize = 20;
/// The number of episodes after an episode with an option.
const EPISODES: u64 = 5;

/// Returns the reset options of the registration, each with an example.
pub(crate) fn examples(subject: &Subject<'_>) -> Verdict<Vec<(&'static str, Json)>> {
    let named = subject
        .registration
        .as_ref()
        .map(|registration| registration.reset_options);
    let named = named.unwrap_or_default().0;
    if named.is_empty() {
        return skipped("its registration names no reset options");
    }
    let read = |(name, example): &(&'static str, &str)| match serde_json::from_str(example) {
        Ok(example) => Ok((*name, example)),
        Err(error) => broken(format!(
            "the example `{example}` of the reset option `{name}` is not JSON: {error}"
        )),
    };
    for (i, (name, _)) in named.iter().enumerate() {
        if named[..i].iter().any(|(other, _)| other == name) {
            return broken(format!("the reset option `{name}` is named twice"));
        }
    }
    named.iter().map(read).collect()
}

/// Returns values that are not of the example's type.
pub(crate) fn of_other_types(example: &Json) -> Vec<Json> {
    let mut others = vec![json!({"no": ["such", "value"]})];
    others.extend(match example {
        Json::Number(_) => vec![json!("x"), json!(true)],
        Json::Bool(_) => vec![json!("x"), json!(7)],
        Json::String(_) => vec![json!(7), json!(true)],
        Json::Array(_) | Json::Object(_) => vec![json!("x")],
        Json::Null => vec![],
    });
    others
}

/// Checks an unknown option: an environment whose registration names options must refuse it; an
/// environment whose registration names none must ignore it. Without a registration, both are
/// right.
pub(crate) fn unknown(subject: &Subject<'_>) -> Verdict {
    let plain = subject.make()?.reset(3)?;
    let knows_options = subject
        .registration
        .as_ref()
        .map(|registration| !registration.reset_options.0.is_empty());
    match subject
        .make()?
        .reset(Reset::seed(3).option("no_such_option", "x"))
    {
        Ok(_) if knows_options == Some(true) => {
            broken("the reset option `no_such_option`, which is not named, is accepted")
        }
        Ok(observation) if observation == plain => Ok(()),
        Ok(observation) => broken(format!(
            "with the option `no_such_option` an episode starts with {observation}, and without it with {plain}"
        )),
        Err(error) if knows_options == Some(false) => {
            broken(format!("`reset` with the option `no_such_option`: {error}"))
        }
        Err(_) => Ok(()),
    }
}

/// Checks that each named option accepts its example and refuses a value of another type.
pub(crate) fn accepted(subject: &Subject<'_>) -> Verdict {
    for (name, example) in examples(subject)? {
        if let Err(error) = subject
            .make()?
            .reset(Reset::seed(0).option(name, example.clone()))
        {
            return broken(format!(
                "`reset` with the option {name}={example}, its example: {error}"
            ));
        }
        if let Err(error) = subject
            .make()?
            .reset(Reset::default().option(name, example.clone()))
        {
            return broken(format!(
                "the first `reset`, without a seed and with the option {name}={example}: {error}"
            ));
        }
        for other in of_other_types(&example) {
            let reset = Reset::seed(0).option(name, other.clone());
            if subject.make()?.reset(reset).is_ok() {
                return broken(format!("`reset` accepts the option {name}={other}"));
            }
        }
    }
    Ok(())
}

/// Checks that an episode with another value of a named option, which `reset` accepts, is observed
/// within the space.
pub(crate) fn in_space(subject: &Subject<'_>) -> Verdict {
    const STEPS: usize = 8;
    for (name, example) in examples(subject)? {
        let mut values = others(&example);
        values.extend(far(&example));
        for value in values {
            let mut env = subject.make()?;
            let space = env.observation_space();
            let reset = Reset::seed(SEEDS[0]).option(name, value.clone());
            let Ok(observation) = env.reset(reset) else {
                continue;
            };
            let mut seen = vec![observation];
            let mut actions = env.action_sampler(0)?;
            for _ in 0..STEPS {
                match env.step(&actions.sample()) {
                    Ok(step) if !step.done() => seen.push(step.observation),
                    _ => break,
                }
            }
            if let Some(error) = seen.iter().find_map(|seen| space.check(seen).err()) {
                return broken(format!("after a reset with {name}={value}: {error}"));
            }
        }
    }
    Ok(())
}

/// Returns the option with numbers ten times as far from 0, and with 10 and -10 for each number.
fn far(example: &Json) -> Vec<Json> {
    let scaled = |by: &dyn Fn(f64) -> f64| map_numbers(example, by);
    let far = [
        scaled(&|x| 10.0 * x),
        scaled(&|x| -10.0 * x),
        scaled(&|_| 10.0),
        scaled(&|_| -10.0),
    ];
    far.into_iter().filter(|far| far != example).collect()
}

/// Returns `json` with each number replaced. (Integers stay integers.)
fn map_numbers(json: &Json, by: &dyn Fn(f64) -> f64) -> Json {
    match json {
        Json::Number(number) if number.is_f64() => json!(by(number.as_f64().unwrap_or_default())),
        Json::Number(number) => json!(by(number.as_f64().unwrap_or_default()) as i64),
        Json::Array(items) => items.iter().map(|item| map_numbers(item, by)).collect(),
        Json::Object(map) => {
            let mapped = map
                .iter()
                .map(|(key, part)| (key.clone(), map_numbers(part, by)));
            Json::Object(mapped.collect())
        }
        other => other.clone(),
    }
}

/// Checks that each named option has an effect, alone or with an argument.
pub(crate) fn matter(subject: &Subject<'_>) -> Verdict {
    let examples = examples(subject)?;
    let Some((spec, kwargs)) = subject.arguments() else {
        return skipped("it is not registered");
    };
    subject.repeatable()?;
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
        // a huge number must be refused or have an effect
        let is_plain = |value: &Json| -> Result<bool> {
            Ok(with_option(subject, Some((name, value)))? == with_option(subject, None)?)
        };
        let example_is_plain = is_plain(&example)?;
        counts_again(subject, name, &example, example_is_plain)?;
        // an unknown word must be refused, or not be taken for the example
        let unknown = json!("no such value");
        if example.is_string()
            && !example_is_plain
            && let Ok(taken) = with_option(subject, Some((name, &unknown)))
            && taken == with_option(subject, Some((name, &example)))?
        {
            return broken(format!(
                "the reset option {name}={unknown} is accepted and taken for {example}"
            ));
        }
        // if the option has an effect only with an argument, these episodes do not show the effect
        if example.is_number() && !example_is_plain {
            for beyond in [json!(1e300), json!(-1e300)] {
                if is_plain(&beyond).unwrap_or(false) {
                    return broken(format!(
                        "the reset option {name}={beyond} is accepted and changes nothing"
                    ));
                }
            }
        }
    }
    Ok(())
}

/// Plays an episode of a new environment. The reset has the option `option`, if any.
fn with_option(subject: &Subject<'_>, option: Option<(&str, &Json)>) -> Result<Vec<Shown>> {
    started(&mut subject.make()?, Reset::seed(SEEDS[0]), option)
}

/// Plays an episode of `env`. The reset is `plain` with the option `option`, if any.
fn started(env: &mut BoxEnv, plain: Reset, option: Option<(&str, &Json)>) -> Result<Vec<Shown>> {
    let observation = env.reset(match option {
        Some((name, value)) => plain.option(name, value.clone()),
        None => plain,
    })?;
    let mut shown = vec![Shown::Reset(observation, info(env))];
    shown.extend(carry_on(env, 0, 20)?);
    Ok(shown)
}

/// Checks that an option has the same effect in a used environment, and that it has an effect
/// without a seed.
fn counts_again(subject: &Subject<'_>, name: &str, example: &Json, is_plain: bool) -> Verdict {
    let option = Some((name, example));
    let new = with_option(subject, option)?;
    let mut used = subject.midway(SEEDS[1])?;
    let again = started(&mut used, Reset::seed(SEEDS[0]), option)?;
    same(
        &new,
        &again,
        &format!("a used environment with the seed and the option {name}={example}"),
    )?;
    let mut used = subject.midway(SEEDS[0])?;
    let again = started(&mut used, Reset::seed(SEEDS[0]), option)?;
    same(
        &new,
        &again,
        &format!("after the same seed without it the option {name}={example}"),
    )?;
    if is_plain {
        return Ok(());
    }
    begins_anew(subject, name, example)?;
    let (mut with, mut without) = (subject.midway(SEEDS[0])?, subject.midway(SEEDS[0])?);
    // some episodes begin by chance as with the option
    for _ in 0..UNSEEDED {
        if started(&mut with, Reset::default(), option)?
            != started(&mut without, Reset::default(), None)?
        {
            return Ok(());
        }
    }
    broken(format!(
        "the reset option {name}={example} changes nothing in {UNSEEDED} resets without a seed"
    ))
}

/// Checks that resets with an option and without a seed continue the generator: if episodes of
/// several seeds differ, these episodes differ too.
fn begins_anew(subject: &Subject<'_>, name: &str, example: &Json) -> Verdict {
    let option = Some((name, example));
    let all_equal = |reset: &dyn Fn(u64) -> Reset| -> Result<bool> {
        let mut env = subject.midway(SEEDS[0])?;
        let first = started(&mut env, reset(0), option)?;
        for i in 1..UNSEEDED as u64 {
            if started(&mut env, reset(i), option)? != first {
                return Ok(false);
            }
        }
        Ok(true)
    };
    if all_equal(&|_| Reset::default())? && !all_equal(&|seed| Reset::seed(seed))? {
        return broken(format!(
            "{UNSEEDED} resets with the option {name}={example} and without a seed give the same episode"
        ));
    }
    Ok(())
}

/// Checks that an option affects only one episode.
pub(crate) fn forgotten(subject: &Subject<'_>) -> Verdict {
    let Ok(examples) = examples(subject) else {
        return Ok(());
    };
    for (name, example) in examples {
        let mut env = subject.make()?;
        // the check options-accepted reports a refusal
        if env
            .reset(Reset::seed(SEEDS[1]).option(name, example.clone()))
            .is_err()
        {
            continue;
        }
        let after = started(&mut env, Reset::seed(SEEDS[0]), None)?;
        let what = format!("an environment that was reset with {name}={example} before");
        same(&with_option(subject, None)?, &after, &what)?;
        // no time limit, which would end episodes before the environment does
        let mut env = subject.unlimited()?;
        env.reset(Reset::seed(SEEDS[1]).option(name, example.clone()))?;
        if finish_episode(&mut env, subject.long()?)? {
            let plain = started(&mut subject.unlimited()?, Reset::seed(SEEDS[0]), None)?;
            let after = started(&mut env, Reset::seed(SEEDS[0]), None)?;
            let what = format!("after a whole episode with {name}={example} the next one");
            same(&plain, &after, &what)?;
        }
        forgotten_with_the_seed(subject, name, &example)?;
        forgotten_without_a_seed(subject, name, &example)?;
    }
    // the option must not be stored outside of the environment, such as in a static variable
    let first = subject.first_run()?;
    let again = roll_out(&mut subject.make()?, SEEDS[0], STEPS)?;
    same(
        &first[..again.len().min(first.len())],
        &again,
        "a new environment after others were reset with options",
    )
}

/// Checks that a reset with a seed does not depend on an earlier reset with this seed and an
/// option.
fn forgotten_with_the_seed(subject: &Subject<'_>, name: &str, example: &Json) -> Verdict {
    let option = Some((name, example));
    let mut env = subject.make()?;
    started(&mut env, Reset::seed(SEEDS[0]), option)?;
    let what = format!("after a reset with {name}={example} the same seed without it");
    let plain = with_option(subject, None)?;
    for _ in 0..EPISODES {
        let again = started(&mut env, Reset::seed(SEEDS[0]), None)?;
        same(&plain, &again, &what)?;
    }
    Ok(())
}

/// Takes at most `steps` random steps, to the end of the episode. Returns whether the episode has
/// ended.
fn finish_episode(env: &mut BoxEnv, steps: usize) -> Result<bool> {
    let mut actions = env.action_sampler(0)?;
    for _ in 0..steps {
        if env.step(&actions.sample())?.done() {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Checks that episodes without a seed do not depend on an earlier option. Before each of these
/// episodes, both environments get the same generator.
fn forgotten_without_a_seed(subject: &Subject<'_>, name: &str, example: &Json) -> Verdict {
    let after = |first: Reset| -> Result<Option<Vec<Shown>>> {
        let mut env = subject.make()?;
        env.reset(first)?;
        let mut shown = Vec::new();
        for seed in 0..EPISODES {
            let Some(generator) = env.generator() else {
                return Ok(None);
            };
            *generator = Generator::from(seed);
            shown.extend(started(&mut env, Reset::default(), None)?);
        }
        Ok(Some(shown))
    };
    let seeded = |i: usize| Reset::seed(SEEDS[i]);
    let (Some(plain), Some(other)) = (after(seeded(0))?, after(seeded(1))?) else {
        return Ok(());
    };
    // if episodes depend on more than the generator, they cannot be compared
    if same(&plain, &other, "").is_err() {
        return Ok(());
    }
    let Some(with) = after(seeded(0).option(name, example.clone()))? else {
        return Ok(());
    };
    let what = format!("an episode without a seed, after one with {name}={example},");
    same(&plain, &with, &what)
}

/// Resets `env` with an invalid value for each option. Returns whether `env` refused all of them.
pub(crate) fn refused(env: &mut BoxEnv, subject: &Subject<'_>) -> bool {
    let nothing_like_it = json!({"no": ["such", "value"]});
    examples(subject)
        .unwrap_or_default()
        .iter()
        .all(|(name, _)| {
            [None, Some(3.into())].into_iter().all(|seed| {
                let reset = Reset {
                    seed,
                    ..Reset::default()
                }
                .option(name, nothing_like_it.clone());
                env.reset(reset).is_err()
            })
        })
}
