//! Checks of `info`.

use crate::subject::{STEPS, Subject, alike, tour};
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

/// The entries, without wall-clock time.
fn entries(env: &BoxEnv) -> Vec<(String, Value)> {
    let mut entries = Vec::new();
    env.info(&mut |key, value| {
        if key != "episode" {
            entries.push((key.to_owned(), value));
        }
    });
    entries
}
