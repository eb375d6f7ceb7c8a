//! Checks of `info`.

use std::collections::{BTreeMap, BTreeSet};

use crate::subject::{STEPS, Shown, Subject, alike, each_event, tour};
use crate::verdict::{Verdict, broken};
use gym_core::{BoxEnv, Env, Value};

pub(crate) fn consistent(subject: &Subject<'_>) -> Verdict {
    tour(&mut subject.make()?, 0, STEPS, |env, step| {
        let entries = entries(env);
        let mut keys: Vec<_> = entries.iter().map(|(key, _)| key).collect();
        keys.sort_unstable();
        if let Some(twice) = keys.windows(2).find(|pair| pair[0] == pair[1]) {
            return broken(format!("after step {step} info shows {:?} twice", twice[0]));
        }
        let again = self::entries(env);
        if !alike(&entries, &again) {
            return broken(format!(
                "asked twice after step {step}, info shows {entries:?} and then {again:?}"
            ));
        }
        Ok(())
    })
}

/// Checks that each entry has one type and is present after every step, because vectors collect
/// entries in columns.
pub(crate) fn constant(subject: &Subject<'_>) -> Verdict {
    let mut forms: BTreeMap<String, String> = BTreeMap::new();
    let mut keys: [Option<BTreeSet<String>>; 2] = [None, None];
    let mut check = |shown: &Shown, place: &str| {
        let (kind, what, info) = match shown {
            Shown::Reset(_, info) => (0, "reset", info),
            Shown::Step(_, info) => (1, "step", info),
        };
        // `RecordEpisodeStatistics` adds this entry at the end of an episode
        let info = || info.iter().filter(|(key, _)| *key != "episode");
        let now: BTreeSet<String> = info().map(|(key, _)| key.clone()).collect();
        let before = keys[kind].get_or_insert_with(|| now.clone());
        if let Some(key) = before.symmetric_difference(&now).next() {
            let change = if now.contains(key) { "comes" } else { "goes" };
            return broken(format!(
                "{place}: the entry `{key}` {change} from one {what} to another"
            ));
        }
        for (key, value) in info() {
            let form = form(value);
            let before = forms.entry(key.clone()).or_insert_with(|| form.clone());
            if *before != form {
                return broken(format!(
                    "{place}: the entry `{key}` is {form} and was {before}"
                ));
            }
        }
        Ok(())
    };
    each_event(subject, &mut check)?;
    // some faults appear only in a long run
    let late = subject.first_run()?.iter().enumerate();
    late.into_iter()
        .try_for_each(|(i, shown)| check(shown, &format!("a long run, event {i}")))
}

/// Checks that no entry is NaN, because a logger's mean would then be NaN too.
pub(crate) fn no_nan(subject: &Subject<'_>) -> Verdict {
    let check = |shown: &Shown, place: &str| {
        let (Shown::Reset(_, info) | Shown::Step(_, info)) = shown;
        match info.iter().find(|(_, value)| has_nan(value)) {
            Some((key, value)) => broken(format!("{place}: the entry `{key}` is {value}")),
            None => Ok(()),
        }
    };
    each_event(subject, check)?;
    let late = subject.first_run()?.iter().enumerate();
    late.into_iter()
        .try_for_each(|(i, shown)| check(shown, &format!("a long run, event {i}")))
}

fn has_nan(value: &Value) -> bool {
    match value {
        Value::Float(x) => x.is_nan(),
        Value::Array(array) => array.iter_f64().any(f64::is_nan),
        Value::Dict(entries) => entries.iter().any(|(_, value)| has_nan(value)),
        Value::Tuple(values) => values.iter().any(has_nan),
        _ => false,
    }
}

/// Describes the type of a value; for arrays with dtype and shape.
fn form(value: &Value) -> String {
    match value {
        Value::Null => "nothing".into(),
        Value::Bool(_) => "a bool".into(),
        Value::Int(_) => "an integer".into(),
        Value::Float(_) => "a float".into(),
        Value::Text(_) => "a text".into(),
        Value::Array(array) => format!(
            "an array of {} with shape {:?}",
            array.dtype(),
            array.shape()
        ),
        Value::Dict(entries) => {
            let entries: Vec<_> = entries
                .iter()
                .map(|(key, value)| format!("{key}: {}", form(value)))
                .collect();
            format!("a dict {{{}}}", entries.join(", "))
        }
        // lists may be of any length
        _ => "a list".into(),
    }
}

/// Returns the entries without `episode`, which holds wall-clock time.
fn entries(env: &BoxEnv) -> Vec<(String, Value)> {
    let mut entries = Vec::new();
    env.info(&mut |key, value| {
        if key != "episode" {
            entries.push((key.to_owned(), value));
        }
    });
    entries
}
