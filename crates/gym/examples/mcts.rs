//! Monte-Carlo tree search with clones of the environment, on FrozenLake and LunarLander, beside random actions.
//! Run it with `cargo run --release --example mcts`.
//!
//! The search is UCT (Kocsis and Szepesvári 2006, "Bandit based Monte-Carlo planning") over sequences of actions: each
//! simulation plays a clone from the present on, down the tree by upper confidence bounds and then at random. Before it
//! does, the clone's generator is seeded anew: the planner knows the odds and not the future.

use gym::box2d::lunar_lander;
use gym::toytext::frozen_lake;
use gym::{Env, Generator, Result, wrappers::TimeLimit};

/// How a search is done.
#[derive(Clone, Copy)]
struct Search {
    /// Simulations for each decision.
    simulations: u32,
    /// The steps that a simulation looks ahead.
    depth: u32,
    /// How often each action is repeated, while planning and in earnest.
    repeats: u32,
    /// The weight of the bound: about the spread of returns.
    exploration: f64,
    /// Of returns.
    discount: f64,
}

/// What is known about the situation after a sequence of actions.
#[derive(Default)]
struct Node {
    visits: f64,
    total: f64,
    children: Vec<Node>,
}

impl Node {
    fn mean(&self) -> f64 {
        self.total / self.visits
    }

    /// The action to try next: each once, then the highest upper confidence bound (UCB1).
    fn select(&self, exploration: f64) -> usize {
        let bound = |child: &Node| match child.visits {
            0.0 => f64::INFINITY,
            visits => child.mean() + exploration * (self.visits.ln() / visits).sqrt(),
        };
        best(self.children.iter().map(bound))
    }
}

/// The index of the largest number.
fn best(numbers: impl Iterator<Item = f64>) -> usize {
    numbers.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
}

impl Search {
    /// The action that looks best from here.
    fn plan<E: Env>(&self, env: &E, actions: &[E::Action], rng: &mut Generator) -> Result<usize> {
        let mut root = Node::default();
        for _ in 0..self.simulations {
            let mut clone = env.clone();
            if let Some(generator) = clone.generator() {
                *generator = Generator::from(rng.integers(0, i64::MAX) as u64);
            }
            self.simulate(&mut root, &mut clone, actions, self.depth, rng)?;
        }
        Ok(best(root.children.iter().map(|child| child.visits)))
    }

    /// The return of one simulation from a node on.
    fn simulate<E: Env>(
        &self,
        node: &mut Node,
        env: &mut E,
        actions: &[E::Action],
        depth: u32,
        rng: &mut Generator,
    ) -> Result<f64> {
        let is_new = node.children.is_empty();
        let value = if is_new || depth == 0 {
            node.children.resize_with(actions.len(), Node::default);
            self.roll_out(env, actions, depth, rng)?
        } else {
            let action = node.select(self.exploration);
            let (reward, done) = self.act(env, &actions[action])?;
            let child = &mut node.children[action];
            let rest = if done { end(child) } else { self.simulate(child, env, actions, depth - 1, rng)? };
            let value = reward + self.discount * rest;
            // a child's worth includes the way there
            child.total += value - rest;
            value
        };
        node.visits += 1.0;
        node.total += value;
        Ok(value)
    }

    /// The return of random actions.
    fn roll_out<E: Env>(
        &self,
        env: &mut E,
        actions: &[E::Action],
        depth: u32,
        rng: &mut Generator,
    ) -> Result<f64> {
        let (mut total, mut weight) = (0.0, 1.0);
        for _ in 0..depth {
            let action = &actions[rng.integers(0, actions.len() as i64) as usize];
            let (reward, done) = self.act(env, action)?;
            total += weight * reward;
            weight *= self.discount;
            if done {
                break;
            }
        }
        Ok(total)
    }

    /// The reward of an action, repeated, and whether the episode is over.
    fn act<E: Env>(&self, env: &mut E, action: &E::Action) -> Result<(f64, bool)> {
        let mut total = 0.0;
        for _ in 0..self.repeats {
            let step = env.step(action)?;
            total += step.reward;
            if step.done() {
                return Ok((total, true));
            }
        }
        Ok((total, false))
    }
}

/// Counts a visit of a situation after which nothing follows.
fn end(node: &mut Node) -> f64 {
    node.visits += 1.0;
    0.0
}

/// The mean return of some episodes, planned or, without a search, random.
fn mean_return<E: Env>(
    env: &mut E,
    actions: &[E::Action],
    search: Option<Search>,
    episodes: u64,
) -> Result<f64> {
    let mut total = 0.0;
    for seed in 0..episodes {
        let mut rng = Generator::from(seed);
        env.reset(seed)?;
        loop {
            let (action, repeats) = match search {
                Some(search) => (search.plan(env, actions, &mut rng)?, search.repeats),
                None => (rng.integers(0, actions.len() as i64) as usize, 1),
            };
            let once = Search { repeats, ..FROZEN_LAKE };
            let (reward, done) = once.act(env, &actions[action])?;
            total += reward;
            if done {
                break;
            }
        }
    }
    Ok(total / episodes as f64)
}

const FROZEN_LAKE: Search =
    Search { simulations: 300, depth: 60, repeats: 1, exploration: 0.3, discount: 0.98 };
const LUNAR_LANDER: Search =
    Search { simulations: 60, depth: 12, repeats: 6, exploration: 60.0, discount: 0.99 };

fn main() -> Result<()> {
    let mut lake = TimeLimit::new(gym::toytext::FrozenLake::new(frozen_lake::Config::default())?, 100)?;
    let actions = frozen_lake::Action::ALL;
    let random = mean_return(&mut lake, &actions, None, 200)?;
    let planned = mean_return(&mut lake, &actions, Some(FROZEN_LAKE), 20)?;
    println!("FrozenLake-v1: {random:.2} of random episodes reach the goal, {planned:.2} of planned ones");

    let mut lander = TimeLimit::new(gym::box2d::LunarLander::new(lunar_lander::Config::default())?, 1000)?;
    let actions = lunar_lander::Engine::ALL.map(lunar_lander::Action::Fire);
    let random = mean_return(&mut lander, &actions, None, 50)?;
    let planned = mean_return(&mut lander, &actions, Some(LUNAR_LANDER), 3)?;
    println!(
        "LunarLander-v3: the mean return is {random:.0} for random actions, {planned:.0} for planned ones"
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planning_beats_chance() -> Result<()> {
        let mut lake = TimeLimit::new(gym::toytext::FrozenLake::new(frozen_lake::Config::default())?, 100)?;
        let actions = frozen_lake::Action::ALL;
        let random = mean_return(&mut lake, &actions, None, 100)?;
        let planned = mean_return(&mut lake, &actions, Some(FROZEN_LAKE), 6)?;
        assert!(random < 0.1 && planned > 0.3, "random {random}, planned {planned}");
        Ok(())
    }
}
