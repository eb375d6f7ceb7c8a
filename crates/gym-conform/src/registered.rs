//! Checks of the facts in a registration.

use crate::subject::Subject;
use crate::verdict::{Verdict, broken, skipped};

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
