use gym_core::registry::NoArguments;
use gym_core::render::{Metadata, RenderMode};
use gym_core::{Configure, Env, Outcome, Reset, Result, Snapshot, Space};

/// An environment that counts its steps. The action is the reward, and the action 9 terminates the
/// episode. The count is its text mode.
#[derive(Clone, Debug, Default)]
pub struct Count(i64);

impl Env for Count {
    type Observation = i64;
    type Action = i64;

    fn observation_space(&self) -> Space {
        Space::discrete(100)
    }

    fn action_space(&self) -> Space {
        Space::discrete(10)
    }

    fn reset_into(&mut self, _: &Reset, observation: &mut i64) -> Result<()> {
        self.0 = 0;
        *observation = 0;
        Ok(())
    }

    fn step_into(&mut self, action: &i64, observation: &mut i64) -> Result<Outcome> {
        self.0 += 1;
        *observation = self.0;
        Ok(Outcome {
            reward: *action as f64,
            terminated: *action == 9,
            truncated: false,
        })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&self.0)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        snapshot.get().map(|count| self.0 = count)
    }

    fn metadata(&self) -> Metadata {
        Metadata {
            render_modes: &[RenderMode::Ansi],
            ..Metadata::default()
        }
    }

    fn ansi(&self) -> Option<String> {
        Some(self.0.to_string())
    }
}

impl Configure for Count {
    type Config = NoArguments;

    fn configure(_: NoArguments, _: u32) -> Result<Self> {
        Ok(Self::default())
    }
}
