//! Monte-Carlo tree search by clones of the environment, against random play: on CartPole, and on
//! LunarLander, whose state is a whole world of rigid bodies.
//! Run it with `cargo run --release --example monte_carlo_tree_search`.

use gym::prelude::*;
use gym::{Error, Generator};

/// A node of the search tree: the results of an action, and in `children` the results of each next
/// action. The same actions may lead to different states; a node has the mean over the states.
#[derive(Default)]
struct Node {
    visits: f64,
    total: f64,
    children: Vec<Node>,
}

struct Search {
    actions: usize,
    /// Futures that are played for each decision.
    futures: usize,
    /// Steps of a future at most.
    horizon: usize,
    /// The weight of exploration, in units of the return.
    exploration: f64,
    rng: Generator,
}

impl Search {
    /// Chooses the action with the most visits.
    fn decide(&mut self, env: &BoxEnv) -> Result<Value> {
        let mut root = Node::default();
        for _ in 0..self.futures {
            let mut future = env.clone();
            // each simulated future has its own random numbers, so that the planner cannot know the
            // numbers of the real episode
            if let Some(rng) = future.generator() {
                *rng = Generator::from(self.rng.integers(0, i64::MAX) as u64);
            }
            self.play(&mut root, &mut future, self.horizon)?;
        }
        let visits = root.children.iter().map(|child| child.visits).enumerate();
        let most = visits.max_by(|a, b| a.1.total_cmp(&b.1));
        Ok(action(most.map_or(0, |(index, _)| index)))
    }

    /// Follows the tree to a leaf, expands the leaf, plays random actions from there, and returns
    /// the return.
    fn play(&mut self, node: &mut Node, env: &mut BoxEnv, steps: usize) -> Result<f64> {
        if steps == 0 {
            return Ok(0.0);
        }
        if node.children.is_empty() {
            node.children.resize_with(self.actions, Node::default);
            return self.play_at_random(env, steps);
        }
        let index = self.select(&node.children);
        let child = &mut node.children[index];
        let step = env.step(&action(index))?;
        let rest = if step.done() {
            0.0
        } else {
            self.play(child, env, steps - 1)?
        };
        child.visits += 1.0;
        child.total += step.reward + rest;
        Ok(step.reward + rest)
    }

    /// UCB1 (Auer, Cesa-Bianchi and Fischer, 2002), in trees UCT (Kocsis and Szepesvári, 2006).
    fn select(&self, children: &[Node]) -> usize {
        let visits: f64 = children.iter().map(|child| child.visits).sum();
        let bound = |child: &Node| match child.visits {
            0.0 => f64::INFINITY,
            n => child.total / n + self.exploration * (visits.ln() / n).sqrt(),
        };
        let bounds = children.iter().map(bound).enumerate();
        bounds
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |(index, _)| index)
    }

    fn play_at_random(&mut self, env: &mut BoxEnv, steps: usize) -> Result<f64> {
        let mut total = 0.0;
        for _ in 0..steps {
            let step = env.step(&action(self.rng.choice(self.actions)))?;
            total += step.reward;
            if step.done() {
                break;
            }
        }
        Ok(total)
    }
}

fn action(index: usize) -> Value {
    Value::Int(index as i64)
}

/// The mean return of some episodes.
fn evaluate(
    env: &mut BoxEnv,
    episodes: u64,
    mut decide: impl FnMut(&BoxEnv) -> Result<Value>,
) -> Result<f64> {
    let mut total = 0.0;
    for seed in 0..episodes {
        env.reset(seed)?;
        loop {
            let step = env.step(&decide(env)?)?;
            total += step.reward;
            if step.done() {
                break;
            }
        }
    }
    Ok(total / episodes as f64)
}

/// Mean returns of random play, and of planning with a number of futures and steps per decision.
fn compare(
    id: &str,
    episodes: u64,
    futures: usize,
    horizon: usize,
    exploration: f64,
) -> Result<(f64, f64)> {
    let mut env = gym::make(id)?;
    let Space::Discrete(space) = env.action_space() else {
        return Err(Error::custom(format!("{id} has no discrete actions")));
    };
    let actions = space.n() as usize;
    let mut search = Search {
        actions,
        futures,
        horizon,
        exploration,
        rng: Generator::from(0),
    };
    let mut rng = Generator::from(0);
    let random = evaluate(&mut env, episodes, |_| Ok(action(rng.choice(actions))))?;
    let planned = evaluate(&mut env, episodes, |env| search.decide(env))?;
    Ok((random, planned))
}

fn main() -> Result<()> {
    for (id, futures, horizon, exploration) in [
        ("CartPole-v1", 30, 40, 10.0),
        ("LunarLander-v3", 50, 25, 30.0),
    ] {
        let (random, planned) = compare(id, 3, futures, horizon, exploration)?;
        println!(
            "{id:15} mean return of 3 episodes: {planned:8.2} planned, {random:8.2} at random"
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planning_beats_chance() -> Result<()> {
        let (random, planned) = compare("CartPole-v1", 1, 20, 30, 10.0)?;
        assert!(
            planned > 3.0 * random,
            "{planned} planned, {random} at random"
        );
        Ok(())
    }
}
