//! All checks over one environment, or over environments by id.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};
use std::{fmt, iter};

use gym_core::{BoxEnv, Env, EnvSpec, Result, registry};

use crate::checks::{CHECKS, Check, REPEATABLE};
use crate::finding::{Finding, Severity};
use crate::report::{Excused, Report, Skipped};
use crate::subject::Subject;
use crate::turns::Turns;
use crate::verdict::{Trouble, message};

/// Runs every check against the environments that `make` makes. Without a finding, the environment
/// conforms.
///
/// An environment from [`make`](gym_core::make) is checked without `OrderEnforcing` and
/// `PassiveEnvChecker`, which would hide the environment's own behaviour. Any other environment is
/// checked with all its wrappers.
///
/// A check that takes long is reported on standard error, while it runs and when it ends.
pub fn check(make: impl Fn() -> Result<BoxEnv>) -> Vec<Finding> {
    match bare(&make) {
        Some(spec) => {
            let make = || spec.make();
            run(&Subject::of_spec(&make, spec.clone()), |long| {
                eprintln!("{}: {long}", spec.id);
            })
            .0
        }
        None => run(&Subject::new(&make), |long| eprintln!("{long}")).0,
    }
}

/// The progress of the checks.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Progress<'a> {
    /// The first check of an environment begins.
    Begins {
        /// The environment.
        id: &'a str,
    },
    /// A check takes long and still runs.
    Runs {
        /// The environment.
        id: &'a str,
        /// The check's name.
        check: &'static str,
    },
    /// A check took long.
    Slow {
        /// The environment.
        id: &'a str,
        /// The check, and its duration.
        slow: Slow,
    },
}

impl fmt::Display for Progress<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Begins { id } => write!(f, "checking {id}"),
            Self::Runs { id, check } => write!(f, "{id}: {}", Long::Runs(check)),
            Self::Slow { id, slow } => write!(f, "{id}: {slow}"),
        }
    }
}

/// The time after which a running check is reported.
const LONG: Duration = Duration::from_secs(5);

/// The report of a check that takes long.
enum Long {
    /// The check still runs.
    Runs(&'static str),
    Ended(Slow),
}

impl fmt::Display for Long {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Runs(check) => write!(
                f,
                "the check {check} takes longer than {} s",
                LONG.as_secs()
            ),
            Self::Ended(slow) => slow.fmt(f),
        }
    }
}

/// A check that took long.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Slow {
    /// The check's name.
    pub check: &'static str,
    /// The duration.
    pub took: Duration,
    /// The time to make and reset the environment. Checks make and reset an environment hundreds of
    /// times.
    pub reset: Duration,
}

impl fmt::Display for Slow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { check, took, reset } = self;
        let [took, reset] = [took, reset].map(Duration::as_secs_f64);
        write!(
            f,
            "the check {check} took {took:.0} s; to make and reset the environment takes {reset:.3} s"
        )
    }
}

/// Returns the spec without the wrappers that hide faults, if the environment has no other wrappers
/// than its spec.
fn bare(make: &dyn Fn() -> Result<BoxEnv>) -> Option<EnvSpec> {
    // the first check makes an environment again, and reports a panic
    let stacks = catch_unwind(AssertUnwindSafe(|| {
        let made = make().ok()?;
        let spec = made.spec()?;
        let again = spec.make().ok()?;
        (made.describe() == again.describe()).then_some(spec)
    }));
    stacks.ok().flatten().map(|spec| bare_spec(&spec))
}

/// Calls `work`. Calls `tell` when `work` has run for longer than `time`.
fn watched<R>(time: Duration, tell: impl FnOnce() + Send, work: impl FnOnce() -> R) -> R {
    let (working, ended) = mpsc::channel::<()>();
    thread::scope(|scope| {
        let watch = move || {
            if ended.recv_timeout(time) == Err(RecvTimeoutError::Timeout) {
                tell();
            }
        };
        // (if the thread cannot start, the work is still done)
        let _ = thread::Builder::new().spawn_scoped(scope, watch);
        let result = work();
        drop(working);
        result
    })
}

/// Runs every check. Returns the findings, and the skipped checks with the reasons. Calls `tell`
/// during and after each check that takes long.
fn run(subject: &Subject<'_>, tell: impl Fn(&Long) + Sync) -> (Vec<Finding>, Vec<Skipped>) {
    // a panic occurs again in a check, which reports it
    let _ = catch_unwind(AssertUnwindSafe(|| {
        subject.first_run().is_ok() && subject.paused().is_ok()
    }));
    let started = Instant::now();
    let _ = catch_unwind(AssertUnwindSafe(|| subject.reset(0).is_ok()));
    let reset = started.elapsed();
    let (mut findings, mut skipped, mut passed) = (Vec::new(), Vec::new(), Vec::new());
    let (mut errors, mut panics) = (Vec::new(), Vec::new());
    let finding = |check: &Check, message: String| {
        let Check {
            name,
            severity,
            why,
            mend,
            ..
        } = *check;
        Finding {
            check: name,
            severity,
            message,
            why,
            mend,
        }
    };
    for check in CHECKS {
        if let Some(needed) = check.needs.iter().find(|needed| !passed.contains(*needed)) {
            skipped.push(Skipped {
                check: check.name,
                reason: format!("it depends on {needed}"),
            });
            continue;
        }
        let started = Instant::now();
        let outcome = watched(
            LONG,
            || tell(&Long::Runs(check.name)),
            || catch_unwind(AssertUnwindSafe(|| (check.run)(subject))),
        );
        let took = started.elapsed();
        if took > LONG {
            tell(&Long::Ended(Slow {
                check: check.name,
                took,
                reset,
            }));
        }
        let panicked = match outcome {
            Ok(verdict) => match verdict {
                Ok(()) => {
                    passed.push(check.name);
                    continue;
                }
                Err(Trouble::Broken(message)) => {
                    findings.push(finding(check, message));
                    continue;
                }
                Err(Trouble::Skipped(reason)) => {
                    // a skipped check counts as passed for the checks that need it, except if these
                    // would compare episodes of a nondeterministic environment
                    if !(REPEATABLE.contains(&check.name) && subject.is_nondeterministic()) {
                        passed.push(check.name);
                    }
                    skipped.push(Skipped {
                        check: check.name,
                        reason,
                    });
                    continue;
                }
                Err(Trouble::Error(error)) => {
                    errors.push((check, error));
                    continue;
                }
            },
            Err(payload) => message(&*payload),
        };
        panics.push((check, panicked));
    }
    // every panic breaks the rule no-panic
    if let (Some((check, panicked)), Some(no_panic)) = (panics.first(), CHECKS.last())
        && findings
            .iter()
            .all(|finding| finding.check != no_panic.name)
    {
        findings.push(finding(
            no_panic,
            format!("during {}: {panicked}", check.name),
        ));
    }
    // an error may be the consequence of a finding; without a finding, report the error
    let is_explained = findings
        .iter()
        .any(|finding| finding.severity == Severity::Error);
    for (check, error) in errors {
        if is_explained {
            skipped.push(Skipped {
                check: check.name,
                reason: error.to_string(),
            });
        } else {
            findings.push(finding(check, format!("it cannot be checked: {error}")));
        }
    }
    (findings, skipped)
}

/// Runs every check over registered environments, several at a time. Each is checked without
/// `OrderEnforcing` and `PassiveEnvChecker`, which would hide its own behaviour.
///
/// # Errors
/// The errors of an unknown id. A broken rule is not an error but part of a report.
pub fn reports(ids: &[String]) -> Result<Vec<Report>> {
    reports_with(ids, |_| ())
}

/// Like [`reports`], and calls `tell` with the progress. The progress shows which environment is
/// slow, hangs or aborts.
///
/// # Errors
/// The errors of [`reports`].
pub fn reports_with(ids: &[String], tell: impl Fn(Progress<'_>) + Sync) -> Result<Vec<Report>> {
    let specs = ids
        .iter()
        .map(|id| registry::resolve(id)?.0.spec())
        .collect::<Result<Vec<_>>>()?;
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let turns = Turns::new(cores);
    // more threads than have a turn, because the check of the clock sleeps for a second
    let workers = (8 * cores).min(specs.len().max(1));
    // Each thread takes the last remaining spec. Some environments take a hundred times as long as
    // others; the slowest are last in the order of ids (`rapier/CarRacing-v3`).
    let queue = Mutex::new(specs.iter().enumerate());
    let next_spec = || {
        queue
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .next_back()
    };
    let check_next = || {
        let (i, spec) = next_spec()?;
        tell(Progress::Begins { id: &spec.id });
        let long = |long: &Long| match long {
            Long::Runs(check) => tell(Progress::Runs {
                id: &spec.id,
                check,
            }),
            Long::Ended(slow) => tell(Progress::Slow {
                id: &spec.id,
                slow: slow.clone(),
            }),
        };
        Some((i, report(spec, &turns, long)))
    };
    let work = || iter::from_fn(|| turns.take(check_next)).collect::<Vec<_>>();
    let mut reports: Vec<(usize, Report)> = thread::scope(|scope| {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .flat_map(|handle| handle.join().unwrap_or_else(|panic| resume_unwind(panic)))
            .collect()
    });
    reports.sort_by_key(|(i, _)| *i);
    Ok(reports.into_iter().map(|(_, report)| report).collect())
}

/// Returns the spec without the wrappers that hide faults.
fn bare_spec(spec: &EnvSpec) -> EnvSpec {
    EnvSpec {
        order_enforce: false,
        disable_env_checker: true,
        ..spec.clone()
    }
}

fn report(spec: &EnvSpec, turns: &Turns, tell: impl Fn(&Long) + Sync) -> Report {
    let bare = bare_spec(spec);
    let make = || bare.make();
    let subject = Subject::of_spec(&make, bare.clone()).in_turns(turns);
    let (mut findings, skipped) = run(&subject, tell);
    let mut excused = Vec::new();
    findings.retain(|Finding { check, .. }| {
        let reason = subject.exception(check);
        excused.extend(reason.map(|reason| Excused { check, reason }));
        reason.is_none()
    });
    // exceptions for single arguments, which the check `arguments-matter` has skipped
    let exceptions = subject
        .registration
        .as_ref()
        .map_or(&[][..], |registration| registration.exceptions);
    let of_parts = exceptions.iter().filter(|(check, _)| check.contains('.'));
    excused.extend(of_parts.map(|&(check, reason)| Excused { check, reason }));
    Report {
        id: spec.id.clone(),
        findings,
        excused,
        skipped,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn progress_names_environment_check_and_time() {
        let id = "a/B-v0";
        let runs = Progress::Runs {
            id,
            check: "clones-agree",
        };
        assert_eq!(Progress::Begins { id }.to_string(), "checking a/B-v0");
        assert_eq!(
            runs.to_string(),
            "a/B-v0: the check clones-agree takes longer than 5 s"
        );
        let slow = Slow {
            check: "clones-agree",
            took: Duration::from_millis(6600),
            reset: Duration::from_millis(250),
        };
        let told = Progress::Slow { id, slow }.to_string();
        assert!(
            told.starts_with("a/B-v0: ")
                && told.contains("clones-agree")
                && told.contains("7 s")
                && told.contains("0.250 s"),
            "{told}"
        );
    }

    #[test]
    fn work_that_takes_long_is_told_while_it_goes_on() {
        let (told, hears) = mpsc::channel();
        // the work waits until `tell` was called
        watched(
            Duration::ZERO,
            || told.send(()).unwrap(),
            || hears.recv().unwrap(),
        );
        // the work ends before `time` has passed
        let answer = watched(Duration::MAX, || panic!("told"), || 3);
        assert_eq!(answer, 3);
    }
}
