//! Sub-environments of a vector, stepped by hand as the vector should step them.

use gym::vector::{Autoreset, Columns};
use gym::{BoxEnv, EnvExt, Info, Reset, Value, VectorEnv, VectorEnvExt};

/// What one sub-environment should show after a reset or step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Row {
    pub(super) observation: Value,
    pub(super) reward: f64,
    pub(super) terminated: bool,
    pub(super) truncated: bool,
    pub(super) final_observation: Option<Value>,
    pub(super) info: Info,
    pub(super) final_info: Option<Info>,
}

/// Returns the rows of a vector.
pub(super) fn rows(envs: &dyn VectorEnv, columns: &Columns) -> Vec<Row> {
    let space = envs.single_observation_space();
    let row = |batch: &Value, i| {
        let mut element = Value::Null;
        space.read_row(batch, i, &mut element).unwrap();
        element
    };
    let row = |i: usize| {
        let mut final_info = Info::new();
        envs.final_info(i, &mut |key, value| {
            drop(final_info.insert(key.to_owned(), value));
        });
        assert!(columns.has_final[i] || final_info.is_empty());
        Row {
            observation: row(&columns.observations, i),
            reward: columns.rewards[i],
            terminated: columns.terminated[i],
            truncated: columns.truncated[i],
            final_observation: columns.has_final[i].then(|| row(&columns.final_observations, i)),
            info: envs.info_map(i),
            final_info: columns.has_final[i].then_some(final_info),
        }
    };
    (0..envs.num_envs()).map(row).collect()
}

/// A sub-environment that is stepped by hand.
pub(super) struct ByHand {
    pub(super) env: BoxEnv,
    /// Whether the episode is over.
    pub(super) done: bool,
}

impl ByHand {
    pub(super) fn new(env: BoxEnv) -> Self {
        Self { env, done: false }
    }

    pub(super) fn reset(&mut self, reset: impl Into<Reset>) -> Row {
        self.done = false;
        let observation = self.env.reset(reset).unwrap();
        Row {
            observation,
            info: self.env.info_map(),
            ..Row::default()
        }
    }

    pub(super) fn step(&mut self, action: &Value, autoreset: Autoreset) -> Row {
        if self.done {
            assert_eq!(autoreset, Autoreset::NextStep);
            return self.reset(());
        }
        let step = self.env.step(action).unwrap();
        self.done = step.done();
        let row = Row {
            observation: step.observation.clone(),
            reward: step.reward,
            terminated: step.terminated,
            truncated: step.truncated,
            info: self.env.info_map(),
            ..Row::default()
        };
        if self.done && autoreset == Autoreset::SameStep {
            let start = self.reset(());
            return Row {
                observation: start.observation,
                info: start.info,
                final_observation: Some(row.observation),
                final_info: Some(row.info),
                ..row
            };
        }
        row
    }
}
