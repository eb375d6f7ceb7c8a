//! Each conformance check flags the environment that is broken in just that way, and no other.

use std::sync::atomic::{AtomicI64, Ordering};

use gym::conform::{self, CHECKS};
use gym::{BoxEnv, Env, Error, Generator, Outcome, Reset, Result, Snapshot, Space, wrappers::OrderEnforcing};
use serde::{Deserialize, Serialize};

/// What is wrong with a [`Walk`].
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    ResetFails,
    ObservationOutside,
    RewardNotFinite,
    AcceptsAnyAction,
    GlobalState,
    KeepsLastEpisode,
    IgnoresSeed,
    CloneSharesNothing,
    SnapshotForgetsGenerator,
}

#[derive(Serialize, Deserialize)]
struct Walk {
    rng: Generator,
    position: i64,
    steps: i64,
    #[serde(skip, default = "no_fault")]
    fault: Fault,
}

fn no_fault() -> Fault {
    Fault::None
}

/// Counts every reset of the process: what no environment may depend on.
static RESETS: AtomicI64 = AtomicI64::new(0);

const SIZE: i64 = 20;

impl Clone for Walk {
    fn clone(&self) -> Self {
        let position = if self.fault == Fault::CloneSharesNothing { 0 } else { self.position };
        Self { rng: self.rng.clone(), position, ..*self }
    }
}

impl Walk {
    fn new(fault: Fault) -> Self {
        Self { rng: Generator::from(0), position: 0, steps: 0, fault }
    }

    fn observe(&self) -> i64 {
        match self.fault {
            Fault::ObservationOutside => self.position + 1,
            Fault::GlobalState => (self.position + RESETS.load(Ordering::Relaxed)) % SIZE,
            _ => self.position,
        }
    }
}

impl Env for Walk {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(SIZE)
    }

    fn action_space(&self) -> Space {
        Space::discrete(2)
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut i64) -> Result<()> {
        if self.fault == Fault::ResetFails {
            return Err(Error::custom("no ground to stand on"));
        }
        RESETS.fetch_add(1, Ordering::Relaxed);
        if let Some(seed) = &reset.seed
            && self.fault != Fault::IgnoresSeed
        {
            self.rng = Generator::new(seed);
        }
        if self.fault == Fault::IgnoresSeed && reset.seed.is_some() {
            self.rng = Generator::from(0);
        }
        let start = self.rng.integers(0, SIZE);
        let left_over = if self.fault == Fault::KeepsLastEpisode { self.steps } else { 0 };
        (self.position, self.steps) = ((start + left_over) % SIZE, 0);
        *observation = self.observe();
        Ok(())
    }

    fn step_into(&mut self, action: &i64, observation: &mut i64) -> Result<Outcome> {
        if !(0..2).contains(action) && self.fault != Fault::AcceptsAnyAction {
            return Err(Error::InvalidAction {
                action: action.to_string(),
                space: self.action_space().to_string(),
                hint: String::new(),
            });
        }
        self.steps += 1;
        let drift = self.rng.integers(0, 3);
        self.position = (self.position + (action & 1) + drift) % SIZE;
        *observation = self.observe();
        let reward = if self.fault == Fault::RewardNotFinite { f64::NAN } else { 1.0 };
        Ok(Outcome { reward, terminated: self.steps == 10, truncated: false })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        if self.fault == Fault::SnapshotForgetsGenerator {
            return Snapshot::of(&Self { rng: Generator::from(0), ..self.clone() });
        }
        Snapshot::of(self)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let fault = self.fault;
        snapshot.get().map(|walk| *self = Self { fault, ..walk })
    }
}

/// The checks that flag a walk with this fault, in a stack that enforces the order of calls.
fn flagged(fault: Fault) -> Vec<&'static str> {
    let findings = conform::check(|| Ok(BoxEnv::new(OrderEnforcing::new(Walk::new(fault)))));
    findings.iter().map(|finding| finding.check).collect()
}

#[test]
fn a_sound_environment_has_no_findings() {
    assert_eq!(flagged(Fault::None), [""; 0]);
}

#[test]
fn every_check_flags_its_fault() {
    let mut seen = vec!["reset-needed"]; // below
    for (fault, check) in [
        (Fault::ResetFails, "constructs"),
        (Fault::ObservationOutside, "observation-in-space"),
        (Fault::RewardNotFinite, "reward-finite"),
        (Fault::AcceptsAnyAction, "action-validated"),
        (Fault::GlobalState, "same-seed-same-episode"),
        (Fault::KeepsLastEpisode, "reset-forgets"),
        (Fault::IgnoresSeed, "other-seed-other-episode"),
        (Fault::CloneSharesNothing, "clone-continues"),
        (Fault::SnapshotForgetsGenerator, "snapshot-continues"),
    ] {
        let found = flagged(fault);
        match fault {
            // what depends on the whole process shows in every comparison
            Fault::GlobalState => assert!(found.contains(&check), "{fault:?}: {found:?}"),
            _ => assert_eq!(found, [check], "{fault:?}"),
        }
        seen.push(check);
    }
    let all: Vec<_> = CHECKS.iter().map(|check| check.name).collect();
    seen.sort_unstable();
    let mut sorted = all.clone();
    sorted.sort_unstable();
    assert_eq!(seen, sorted, "a check without a broken environment");
}

#[test]
fn stepping_before_reset_is_flagged() {
    let findings = conform::check(|| Ok(BoxEnv::new(Walk::new(Fault::None))));
    let names: Vec<_> = findings.iter().map(|finding| finding.check).collect();
    assert_eq!(names, ["reset-needed"]);
}
