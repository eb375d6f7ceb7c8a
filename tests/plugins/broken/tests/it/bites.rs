//! Each environment is flagged by the check that it is named after, and by no other.

use std::collections::BTreeSet;
use std::sync::{LazyLock, Mutex};

use broken_envs as _;
use gym_conform::{CHECKS, Finding, Progress, Report};
use gym_core::wrappers::TimeLimit;
use gym_core::{BoxEnv, Env, Outcome, Reset, Result, Value};
use gym_render as _;
use gym_wrappers as _;

/// The reports, made once, because some faults depend on earlier calls in the process.
pub(crate) static REPORTS: LazyLock<Vec<Report>> = LazyLock::new(|| {
    gym_conform::reports(&gym_conform::ids_of("broken-envs")).expect("the ids are registered")
});

/// Returns the name of the check that the id contains, without the suffix that distinguishes
/// several faults of one check.
fn expected(id: &str) -> &str {
    let name = id.strip_prefix("broken/").expect("an id of this crate");
    let name = name.strip_suffix("-v0").unwrap_or(name);
    name.split_once('.').map_or(name, |(check, _)| check)
}

#[test]
fn each_check_flags_its_fault_and_no_other() {
    let is_right = |report: &Report| {
        let flagged: Vec<_> = report
            .findings
            .iter()
            .map(|finding| finding.check)
            .collect();
        match expected(&report.id) {
            // a correct environment passes all checks; a nondeterministic environment skips
            // comparisons
            "none" if report.id.contains("by-chance") => {
                flagged.is_empty() && compares_nothing(report)
            }
            "none" => flagged.is_empty() && report.skipped.is_empty(),
            check => flagged == [check],
        }
    };
    let wrong: Vec<_> = REPORTS.iter().filter(|report| !is_right(report)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Whether the report skips only the checks of equal episodes, and checks that depend on these.
fn compares_nothing(report: &Report) -> bool {
    let is_chance = |reason: &str| {
        reason == "it is registered as nondeterministic" || reason.starts_with("it depends on")
    };
    report
        .skipped
        .iter()
        .all(|skipped| is_chance(&skipped.reason))
        && ["same-seed-same-episode", "reset-forgets"]
            .iter()
            .all(|check| report.skipped.iter().any(|skipped| skipped.check == *check))
}

#[test]
fn every_check_has_a_faulty_environment() {
    let ids = gym_conform::ids_of("broken-envs");
    let faulty: BTreeSet<_> = ids
        .iter()
        .map(|id| expected(id))
        .filter(|name| *name != "none")
        .collect();
    let checks: BTreeSet<_> = CHECKS.iter().map(|check| check.name).collect();
    assert_eq!(faulty, checks);
}

#[test]
fn findings_say_what_why_and_how() {
    for Report { findings, id, .. } in REPORTS.iter() {
        for Finding {
            message, why, mend, ..
        } in findings
        {
            assert!(
                message.len() > 10 && why.len() > 10 && mend.len() > 10,
                "{id}: {message}"
            );
        }
    }
}

#[test]
fn an_unregistered_environment_is_checked_as_well() {
    let check = |fault| {
        let walk =
            move || broken_envs::Walk::<broken_envs::Config>::new(fault).map(gym_core::BoxEnv::new);
        gym_conform::check(walk)
            .iter()
            .map(|finding| finding.check)
            .collect::<Vec<_>>()
    };
    assert_eq!(check(broken_envs::Fault::None), [""; 0]);
    assert_eq!(check(broken_envs::Fault::RewardFinite), ["reward-finite"]);
    assert_eq!(check(broken_envs::Fault::Constructs), ["constructs"]);
}

/// A third-party wrapper that drops a limit is found, although neither the wrapper nor its
/// environment is registered.
#[test]
fn a_limit_that_is_lost_on_the_way_is_seen_without_a_registration() {
    #[derive(Clone, Debug)]
    struct Overrides {
        inner: BoxEnv,
        is_truncated: bool,
    }
    impl gym_core::Wrapper for Overrides {
        type Observation = Value;
        type Action = Value;
        gym_core::inner!(BoxEnv);
        fn on_reset(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
            self.inner.reset_into(reset, observation)
        }
        fn on_step(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
            let outcome = self.inner.step_into(action, observation)?;
            Ok(Outcome {
                truncated: outcome.truncated && self.is_truncated,
                ..outcome
            })
        }
    }
    let check = |is_truncated| {
        let findings = gym_conform::check(|| {
            let walk = BoxEnv::new(broken_envs::Walk::<broken_envs::Config>::new(
                broken_envs::Fault::None,
            )?);
            let limited = BoxEnv::new(TimeLimit::new(walk, 9)?);
            Ok(BoxEnv::new(Overrides {
                inner: limited,
                is_truncated,
            }))
        });
        findings
            .iter()
            .map(|finding| finding.check)
            .collect::<Vec<_>>()
    };
    assert_eq!(check(true), [""; 0]);
    assert_eq!(check(false), ["time-limit"]);
}

/// The effect of the wrapper [`Own`] on the ends of episodes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ends {
    /// Truncates after this number of steps.
    After(u32),
    /// Truncates where the walk is to the right of this place.
    RightOf(f32),
    /// Begins the next episode in the step that ends one.
    Resets,
    /// Begins the next episode in the step that ends one, and hides the end.
    ResetsInside,
    /// Repeats each action this number of times.
    Repeats(u32),
}

/// A wrapper without a stored form: a check can learn its limit only from its episodes.
#[derive(Clone, Debug)]
struct Own {
    inner: BoxEnv,
    ends: Ends,
    steps: u32,
}

impl gym_core::Wrapper for Own {
    type Observation = Value;
    type Action = Value;

    gym_core::inner!(BoxEnv);

    fn on_reset(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        self.steps = 0;
        self.inner.reset_into(reset, observation)
    }

    fn on_step(&mut self, action: &Value, observation: &mut Value) -> Result<Outcome> {
        let mut outcome = self.inner.step_into(action, observation)?;
        self.steps += 1;
        match self.ends {
            Ends::After(steps) => outcome.truncated |= self.steps >= steps,
            Ends::RightOf(place) => {
                let seen = observation
                    .as_array()
                    .and_then(|seen| seen.as_slice::<f32>());
                outcome.truncated |= seen.is_some_and(|seen| seen[0] > place);
            }
            Ends::Resets | Ends::ResetsInside if outcome.done() => {
                self.inner.reset_into(&Reset::default(), observation)?;
                if self.ends == Ends::ResetsInside {
                    (outcome.terminated, outcome.truncated) = (false, false);
                }
            }
            Ends::Resets | Ends::ResetsInside => {}
            Ends::Repeats(times) => {
                for _ in 1..times {
                    if !outcome.done() {
                        outcome = self.inner.step_into(action, observation)?;
                    }
                }
            }
        }
        Ok(outcome)
    }

    fn on_snapshot(&self) -> Result<gym_core::Snapshot> {
        gym_core::Snapshot::of(&(self.inner.snapshot()?, self.steps))
    }

    fn on_restore(&mut self, snapshot: &gym_core::Snapshot) -> Result<()> {
        let (env, steps) = snapshot.get()?;
        self.inner.restore(&env)?;
        self.steps = steps;
        Ok(())
    }
}

/// The step count of a `TimeLimit` shows whether the limit or a wrapper ended an episode. This
/// holds for wrappers around the result of `make`, and around one or two limits.
#[test]
fn wrappers_that_end_episodes_by_themselves_are_seen() {
    let flagged = |limits: &[u32], ends: Ends| {
        let findings = gym_conform::check(|| {
            let walk = broken_envs::Walk::<broken_envs::Config>::new(broken_envs::Fault::None)?;
            let mut env = BoxEnv::new(walk);
            for limit in limits {
                env = BoxEnv::new(TimeLimit::new(env, *limit)?);
            }
            Ok(BoxEnv::new(Own {
                inner: env,
                ends,
                steps: 0,
            }))
        });
        // `Own` accepts any stored count, and its reset within a step allocates
        let others = ["snapshot-legal", "no-allocation"];
        let checks = findings.iter().map(|finding| finding.check);
        checks
            .filter(|check| !others.contains(check))
            .collect::<Vec<_>>()
    };
    assert_eq!(flagged(&[9], Ends::After(5)), ["time-limit"]);
    assert_eq!(flagged(&[9], Ends::Resets), ["time-limit"]);
    assert_eq!(flagged(&[9], Ends::ResetsInside), ["time-limit"]);
    // without a fault: an end for another reason, a limit that is never reached, repeated actions
    assert_eq!(flagged(&[9], Ends::RightOf(0.3)), [""; 0]);
    assert_eq!(flagged(&[5, 9], Ends::After(100)), [""; 0]);
    assert_eq!(flagged(&[9, 5], Ends::After(100)), [""; 0]);
    assert_eq!(flagged(&[9], Ends::Repeats(2)), [""; 0]);

    // `make` returns the same type for every environment
    let made = |ends| {
        gym_conform::check(|| {
            let env = gym_core::make("broken/none-v0")?;
            Ok(BoxEnv::new(Own {
                inner: env,
                ends,
                steps: 0,
            }))
        })
    };
    let has_limit =
        |findings: Vec<Finding>| findings.iter().any(|finding| finding.check == "time-limit");
    assert!(has_limit(made(Ends::After(5))) && has_limit(made(Ends::ResetsInside)));
    assert!(!has_limit(made(Ends::Repeats(3))) && !has_limit(made(Ends::RightOf(0.3))));
}

#[test]
fn what_make_puts_around_an_environment_hides_nothing() {
    for name in [
        "reset-needed",
        "observation-dtype",
        "observation-in-space",
        "info-consistent",
    ] {
        let findings = gym_conform::check(|| gym_core::make(&format!("broken/{name}-v0")));
        assert_eq!(
            findings
                .iter()
                .map(|finding| finding.check)
                .collect::<Vec<_>>(),
            [name]
        );
    }
}

#[test]
fn unknown_ids_are_refused() {
    let error = gym_conform::reports(&["broken/reward-finit-v0".into()]).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("did you mean `broken/reward-finite-v0`?"),
        "{error}"
    );
}

#[test]
fn a_check_that_takes_long_is_told() {
    let told = Mutex::new(Vec::new());
    let id = "broken/none.slow-with-a-large-seed-v0";
    gym_conform::reports_with(&[id.into()], |progress| {
        told.lock().unwrap().push(match progress {
            Progress::Begins { id } => format!("{id} begins"),
            Progress::Runs { id, check } => format!("{id} runs: {check}"),
            Progress::Slow { id, slow } => {
                assert!(
                    slow.took > slow.reset && slow.took.as_secs() >= 5,
                    "{slow:?}"
                );
                assert!(
                    slow.to_string()
                        .contains(&format!("took {:.0} s", slow.took.as_secs_f64())),
                    "{slow}"
                );
                format!("{id}: {}", slow.check)
            }
            other => panic!("{other:?}"),
        });
    })
    .unwrap();
    let expected = [
        format!("{id} begins"),
        format!("{id} runs: resets"),
        format!("{id}: resets"),
    ];
    assert_eq!(told.into_inner().unwrap(), expected);
}

/// Wall-clock time does not count as a difference between runs.
#[test]
fn statistics_of_episodes_are_no_fault() {
    let findings = gym_conform::check(|| {
        let spec = gym_core::builder("broken/none-v0").spec()?;
        let statistics = gym_core::WrapperSpec::new("RecordEpisodeStatistics");
        spec.wrapped(statistics).make()
    });
    assert!(findings.is_empty(), "{findings:?}");
}
