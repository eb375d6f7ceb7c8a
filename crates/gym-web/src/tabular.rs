//! Temporal-difference control over a table of action values: Sutton and Barto, *Reinforcement
//! Learning: An Introduction*, second edition, chapter 6.

use gym::{BoxEnv, Env, Error, Generator, Reset, Result, Seed, Space, Value};
use serde::Deserialize;

use crate::episode::Episode;

/// The parameters, which may change while the learner learns.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Parameters {
    /// The kind of target of an update.
    update: Update,
    /// The step size alpha: the share of a temporal-difference error that one update corrects.
    step_size: f64,
    /// The discount gamma of future rewards.
    discount: f64,
    /// The probability of a random action, epsilon, in the first episode.
    epsilon: f64,
    /// The factor of epsilon after each episode.
    epsilon_decay: f64,
    /// The least epsilon.
    epsilon_min: f64,
    /// The value of an action before its first update.
    initial_value: f64,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Update {
    /// The best action of the next state: section 6.5.
    QLearning,
    /// The action that is taken next: section 6.4.
    Sarsa,
    /// The mean over the actions that may be taken next: section 6.6.
    ExpectedSarsa,
}

/// A table of action values, and the environment from which it is learned.
#[derive(Debug)]
pub(crate) struct Tabular {
    pub(crate) parameters: Parameters,
    env: BoxEnv,
    rng: Generator,
    /// The seed of the first episode; later episodes continue the environment's generator.
    seed: Option<Seed>,
    states: usize,
    actions: usize,
    first_state: i64,
    first_action: i64,
    values: Vec<f64>,
    epsilon: f64,
    running: Option<Running>,
}

/// The episode that the last slice of training ended in.
#[derive(Clone, Copy, Debug)]
struct Running {
    state: usize,
    action: usize,
    episode: Episode,
}

impl Tabular {
    pub(crate) fn new(env: BoxEnv, seed: Seed, parameters: Parameters) -> Result<Self> {
        let (Space::Discrete(observed), Space::Discrete(chosen)) =
            (env.observation_space(), env.action_space())
        else {
            return Err(Error::custom(format!(
                "{env} has no table: its states or actions are not numbered"
            )));
        };
        let [states, actions] =
            [observed.n(), chosen.n()].map(|n| usize::try_from(n).unwrap_or_default());
        Ok(Self {
            rng: Generator::new(&seed.plus(1)),
            values: vec![parameters.initial_value; states * actions],
            epsilon: parameters.epsilon,
            first_state: observed.start(),
            first_action: chosen.start(),
            seed: Some(seed),
            running: None,
            parameters,
            env,
            states,
            actions,
        })
    }

    pub(crate) fn states(&self) -> usize {
        self.states
    }

    pub(crate) fn actions(&self) -> usize {
        self.actions
    }

    pub(crate) fn epsilon(&self) -> f64 {
        self.epsilon
    }

    /// Returns the values, state by state.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    pub(crate) fn act(&self, observation: &Value) -> Result<Value> {
        let best = best(self.row(self.state(observation)?));
        Ok(Value::Int(self.first_action + best as i64))
    }

    pub(crate) fn train(&mut self, episodes: u32, steps: u32) -> Result<Vec<Episode>> {
        let mut ended = Vec::new();
        let mut observation = Value::Null;
        for _ in 0..steps {
            if ended.len() >= episodes as usize {
                break;
            }
            let Running {
                state,
                action,
                mut episode,
            } = match self.running {
                Some(running) => running,
                None => self.start(&mut observation)?,
            };
            let choice = Value::Int(self.first_action + action as i64);
            let outcome = self.env.step_into(&choice, &mut observation)?;
            let next = self.state(&observation)?;
            let next_action = self.choose(next);
            let future = if outcome.terminated {
                0.0
            } else {
                self.value(next, next_action)
            };
            let Parameters {
                step_size,
                discount,
                ..
            } = self.parameters;
            let value = &mut self.values[state * self.actions + action];
            *value += step_size * (outcome.reward + discount * future - *value);
            episode.episode_return += outcome.reward;
            episode.length += 1;
            self.running = (!outcome.done()).then_some(Running {
                state: next,
                action: next_action,
                episode,
            });
            if outcome.done() {
                ended.push(episode);
                let Parameters {
                    epsilon_decay,
                    epsilon_min,
                    ..
                } = self.parameters;
                self.epsilon = (self.epsilon * epsilon_decay).max(epsilon_min);
            }
        }
        Ok(ended)
    }

    fn start(&mut self, observation: &mut Value) -> Result<Running> {
        self.env.reset_into(
            &Reset {
                seed: self.seed.take(),
                ..Reset::default()
            },
            observation,
        )?;
        let state = self.state(observation)?;
        let episode = Episode {
            episode_return: 0.0,
            length: 0,
        };
        Ok(Running {
            state,
            action: self.choose(state),
            episode,
        })
    }

    /// Returns the value of a state whose next action is known.
    fn value(&self, state: usize, action: usize) -> f64 {
        let row = self.row(state);
        let greatest = row[best(row)];
        match self.parameters.update {
            Update::QLearning => greatest,
            Update::Sarsa => row[action],
            Update::ExpectedSarsa => {
                let mean = row.iter().sum::<f64>() / row.len() as f64;
                self.epsilon * mean + (1.0 - self.epsilon) * greatest
            }
        }
    }

    /// Draws the best action, or with probability epsilon any action. Equally good actions are equally
    /// likely.
    fn choose(&mut self, state: usize) -> usize {
        if self.rng.random() < self.epsilon {
            return self.rng.choice(self.actions);
        }
        let row = self.row(state);
        let greatest = row[best(row)];
        let ties = row.iter().filter(|value| **value == greatest).count();
        let chosen = if ties > 1 { self.rng.choice(ties) } else { 0 };
        let mut equal = self
            .row(state)
            .iter()
            .enumerate()
            .filter(|(_, value)| **value == greatest);
        equal.nth(chosen).map_or(0, |(action, _)| action)
    }

    fn row(&self, state: usize) -> &[f64] {
        &self.values[state * self.actions..][..self.actions]
    }

    fn state(&self, observation: &Value) -> Result<usize> {
        let state = observation
            .as_int()
            .and_then(|state| usize::try_from(state - self.first_state).ok());
        state
            .filter(|state| *state < self.states)
            .ok_or_else(|| Error::Contract(format!("{observation} is not a state of {}", self.env)))
    }
}

/// Returns the first action with the greatest value.
fn best(row: &[f64]) -> usize {
    let better = |best: usize, other: usize| if row[other] > row[best] { other } else { best };
    (0..row.len()).reduce(better).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use gym::EnvExt;

    use super::*;

    #[test]
    fn q_learning_finds_the_way_along_the_cliff() {
        let parameters = r#"{"update": "q_learning", "step_size": 0.5, "discount": 1.0, "epsilon": 0.1, "epsilon_decay": 1.0,
            "epsilon_min": 0.0, "initial_value": 0.0}"#;
        let env = gym::make("CliffWalking-v1").unwrap();
        let parameters = serde_json::from_str(parameters).unwrap();
        let mut learner = Tabular::new(env.clone(), Seed::from(0), parameters).unwrap();
        let mut episodes = Vec::new();
        // the size of the slices does not change the training
        while episodes.len() < 500 {
            episodes.extend(learner.train(7, 100).unwrap());
        }
        let mut env = env;
        let mut observation = env.reset(0).unwrap();
        let mut total = 0.0;
        loop {
            let step = env.step(&learner.act(&observation).unwrap()).unwrap();
            total += step.reward;
            if step.done() {
                break;
            }
            observation = step.observation;
        }
        assert_eq!(total, -13.0);
    }
}
