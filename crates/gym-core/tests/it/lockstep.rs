//! Environments that step together, and panic in one of the three parts of a step.

use gym_core::registry::{VectorKind, make_vec};
use gym_core::vector::VectorReset;
use gym_core::vector::lockstep::{Lockstep, Together};
use gym_core::{
    Configure, Env, NoArguments, Outcome, Registration, Reset, Result, Space, Value, VectorEnvExt,
};

/// An environment that counts its steps. Action 1 panics at the start of a step, action 2 after the
/// shared part of a step, action 3 at the end of a step.
#[derive(Clone, Debug, Default)]
struct Brittle {
    steps: i64,
    /// The action of the step that has begun; -1 for a reset.
    begun: Option<i64>,
}

const BEGINS: i64 = 1;
const COLLECTS: i64 = 2;
const ENDS: i64 = 3;

/// The numbers of environments of a group whose step has begun and was solved.
#[derive(Default)]
struct Count {
    begun: usize,
    solved: usize,
}

impl Together for Count {
    const LEN: usize = 8;

    fn solve(&mut self) {
        self.solved = self.begun;
    }

    fn clear(&mut self) {
        (self.begun, self.solved) = (0, 0);
    }
}

impl Env for Brittle {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(1000)
    }

    fn action_space(&self) -> Space {
        Space::discrete(4)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        self.begun = None;
        (self.steps, *observation) = (0, 0);
        Ok(())
    }

    fn step_into(&mut self, action: &i64, observation: &mut i64) -> Result<Outcome> {
        assert_eq!(self.begun.take(), Some(*action), "the step has not begun");
        assert_ne!(*action, ENDS, "a bad end");
        self.steps += 1;
        *observation = self.steps;
        Ok(Outcome {
            reward: 1.0,
            ..Outcome::default()
        })
    }
}

impl Lockstep for Brittle {
    type Group = Count;

    fn begin_reset(&mut self, _: &Reset, group: &mut Count) {
        group.begun += 1;
        self.begun = Some(-1);
    }

    fn begin_step(&mut self, action: &i64, group: &mut Count) {
        assert_ne!(*action, BEGINS, "a bad begin");
        group.begun += 1;
        self.begun = Some(*action);
    }

    fn collect(&mut self, group: &mut Count) {
        assert!(
            group.solved > 0 && self.begun.is_some(),
            "nothing has begun"
        );
        assert_ne!(self.begun, Some(COLLECTS), "a bad second half");
    }
}

impl Configure for Brittle {
    type Config = NoArguments;

    fn configure(_: NoArguments, _: u32) -> Result<Self> {
        Ok(Self::default())
    }
}

gym_core::register!(Registration::new::<Brittle>("lockstep/Brittle-v0").lockstep::<Brittle>());

#[test]
fn a_panic_ahead_of_a_step_is_an_error_of_that_sub_environment_alone() {
    let actions = |second: i64| Value::Array([0, second, 0].into());
    let seen = |value: &Value| value.as_slice::<i64>().unwrap().to_vec();
    let reset = |mask: [bool; 3]| VectorReset::default().mask(mask);
    for kind in [VectorKind::Native, VectorKind::Async] {
        for (action, message) in [
            (BEGINS, "a bad begin"),
            (COLLECTS, "a bad second half"),
            (ENDS, "a bad end"),
        ] {
            let mut envs = make_vec("lockstep/Brittle-v0", 3, kind).unwrap();
            let mut columns = envs.reset(5).unwrap();
            envs.step_into(&actions(0), &mut columns).unwrap();
            let error = envs
                .step_into(&actions(action), &mut columns)
                .unwrap_err()
                .to_string();
            let what = format!("{kind:?}, {action}: {error}");
            assert!(
                error.starts_with("sub-environment 1: ") && error.contains(message),
                "{what}"
            );
            assert_eq!(seen(&columns.observations), [2, 1, 2], "{what}");
            assert_eq!(columns.rewards, [1.0, 0.0, 1.0], "{what}");
            // the sub-environment needs a reset before the next step
            let error = envs
                .step_into(&actions(0), &mut columns)
                .unwrap_err()
                .to_string();
            assert!(
                error.contains("it panicked in an earlier call"),
                "{what}, then {error}"
            );
            envs.reset_into(&reset([true, false, false]), &mut columns)
                .unwrap();
            assert_eq!(seen(&columns.observations), [0, 1, 2], "{what}");
            envs.reset_into(&reset([false, true, false]), &mut columns)
                .unwrap();
            envs.step_into(&actions(0), &mut columns).unwrap();
            assert_eq!(seen(&columns.observations), [1, 1, 3], "{what}");
        }
    }
}
