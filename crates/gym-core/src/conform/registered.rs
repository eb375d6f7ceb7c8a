//! Checks of what is said about an environment, and all checks over environments by id.

use std::panic::resume_unwind;
use std::thread;

use super::subject::Subject;
use super::{CHECKS, Excused, Format, Report, Verdict, broken, run, skipped};
use crate::{EnvSpec, Error, Result, registry};

pub(super) fn constructs(subject: &Subject<'_>) -> Verdict {
    match subject.make() {
        Ok(_) => Ok(()),
        Err(error) => broken(error.to_string()),
    }
}

pub(super) fn described(subject: &Subject<'_>) -> Verdict {
    match &subject.registration {
        Some(registration) if registration.about().trim().is_empty() => {
            broken(format!("`{}` is registered without a description", registration.id()))
        }
        Some(registration) if says_nothing(registration.id(), registration.about().trim()) => {
            broken(format!("`{}` is described as {:?}", registration.id(), registration.about()))
        }
        Some(_) => Ok(()),
        None => skipped("it is not registered"),
    }
}

/// Whether a description is the id over again, or yet to be written.
fn says_nothing(id: &str, about: &str) -> bool {
    let name = id.rsplit('/').next().unwrap_or(id);
    let stem = name.rsplit_once("-v").map_or(name, |(stem, _)| stem);
    [id, name, stem].contains(&about.trim_end_matches('.')) || about.starts_with("TODO")
}

pub(super) fn versioned(subject: &Subject<'_>) -> Verdict {
    let Some(registration) = &subject.registration else { return skipped("it is not registered") };
    let version = registration.id().rsplit_once("-v").map(|(_, version)| version);
    match version.is_some_and(|version| version.parse::<u32>().is_ok()) {
        true => Ok(()),
        false => broken(format!("`{}` has no version", registration.id())),
    }
}

pub(super) fn exceptions_known(subject: &Subject<'_>) -> Verdict {
    let Some(registration) = &subject.registration else { return skipped("it is not registered") };
    let is_known = |name: &str| CHECKS.iter().any(|check| check.name == name);
    match registration.all_exceptions().iter().find(|(name, _)| !is_known(name)) {
        Some((name, _)) => broken(format!("`{}` has an exception for `{name}`", registration.id())),
        None => Ok(()),
    }
}

/// Runs every check over registered environments, several at a time. Each is checked without `OrderEnforcing` and
/// `PassiveEnvChecker`, which would hide what the environment itself does.
///
/// # Errors
/// What is wrong with an id. An environment that does not keep the rules is no error but a report.
pub fn reports(ids: &[String]) -> Result<Vec<Report>> {
    reports_with(ids, |_| ())
}

/// As [`reports`], and calls `begin` with each id before its first check, so that one that hangs or aborts is known.
///
/// # Errors
/// What is wrong with an id.
pub fn reports_with(ids: &[String], begin: impl Fn(&str) + Sync) -> Result<Vec<Report>> {
    let specs = ids.iter().map(|id| registry::resolve(id)?.0.spec()).collect::<Result<Vec<_>>>()?;
    let workers = thread::available_parallelism().map_or(1, usize::from).min(specs.len().max(1));
    let mut reports: Vec<(usize, Report)> = thread::scope(|scope| {
        let (specs, begin) = (&specs, &begin);
        let report = move |spec: &EnvSpec| {
            begin(&spec.id);
            report(spec)
        };
        let handles: Vec<_> = (0..workers)
            .map(|worker| {
                let mine = specs.iter().enumerate().skip(worker).step_by(workers);
                scope.spawn(move || mine.map(|(i, spec)| (i, report(spec))).collect::<Vec<_>>())
            })
            .collect();
        handles
            .into_iter()
            .flat_map(|handle| handle.join().unwrap_or_else(|panic| resume_unwind(panic)))
            .collect()
    });
    reports.sort_by_key(|(i, _)| *i);
    Ok(reports.into_iter().map(|(_, report)| report).collect())
}

/// Without what hides faults.
pub(super) fn bare(spec: &EnvSpec) -> EnvSpec {
    EnvSpec { order_enforce: false, disable_env_checker: true, ..spec.clone() }
}

fn report(spec: &EnvSpec) -> Report {
    let bare = bare(spec);
    let make = || bare.make();
    let subject = Subject::of_spec(&make, bare.clone());
    let (mut findings, skipped) = run(&subject);
    let mut excused = Vec::new();
    findings.retain(|finding| {
        let registration = subject.registration.as_ref();
        let reason = registration.and_then(|registration| registration.exception(finding.check));
        excused.extend(reason.map(|reason| Excused { check: finding.check, reason }));
        reason.is_none()
    });
    Report { id: spec.id.clone(), findings, excused, skipped }
}

/// The ids that a crate registers at link time, whether it is named `my-envs` or `my_envs`.
pub fn ids_of(crate_name: &str) -> Vec<String> {
    let underscored = crate_name.replace('-', "_");
    let all = registry::all();
    let own = all.iter().filter(|registration| registration.crate_name().replace('-', "_") == underscored);
    own.map(|registration| registration.id().to_owned()).collect()
}

/// What [`suite!`](super::suite) calls.
///
/// # Panics
/// If the crate registers nothing, or one of its environments breaks a rule.
pub fn assert_conforms(crate_name: &str) {
    let ids = ids_of(crate_name);
    assert!(
        !ids.is_empty(),
        "`{crate_name}` registers no environment: put `gym_core::register!(...)` at the top level of a module, and \
         let there be one gym-core in `cargo tree --duplicates`"
    );
    let reports = reports(&ids).unwrap_or_else(|error: Error| panic!("{error}"));
    let text = Format::Text.write(&reports);
    println!("{text}");
    assert!(reports.iter().all(Report::passes), "{text}");
}

/// A plugin's test: makes a `#[test]` that runs every check over every environment that a crate registers.
///
/// It stands in a file of the folder `tests`, with the crate's name as it is in `use`:
///
/// ```text
/// gym_core::conform::suite!(my_envs);
/// ```
///
/// Allocations are counted with the feature `count-allocations`, best among the plugin's `[dev-dependencies]`;
/// without it a test that is ignored says so.
#[doc(hidden)]
#[macro_export]
macro_rules! __conform_suite {
    ($name:ident) => {
        // what is not named is not linked
        use $name as _;

        #[test]
        fn every_environment_conforms() {
            $crate::conform::assert_conforms(stringify!($name));
        }

        $crate::__conform_count_allocations!();
    };
}

#[cfg(feature = "count-allocations")]
#[doc(hidden)]
#[macro_export]
macro_rules! __conform_count_allocations {
    () => {};
}

#[cfg(not(feature = "count-allocations"))]
#[doc(hidden)]
#[macro_export]
macro_rules! __conform_count_allocations {
    () => {
        #[test]
        #[ignore = "allocations are not counted: add the feature `count-allocations` to the dev-dependency on gym-core"]
        fn steps_allocate_nothing() {
            panic!("add the feature `count-allocations` to the dev-dependency on gym-core");
        }
    };
}
