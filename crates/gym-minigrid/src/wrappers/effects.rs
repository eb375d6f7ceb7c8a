//! Wrappers that change rewards, actions and initial states.

use std::fmt;

use gym_core::registry::WrapperConfig;
use gym_core::{
    BoxEnv, Element, Env, EnvExt, Error, Generator, Outcome, Reset, Result, Snapshot, Space, Value,
    WrapperSpec,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::{Action, Cell, Facts, Kind, World};

/// The effect of a wrapper. The implementing type holds the wrapper's arguments.
pub trait Effect: WrapperConfig + Clone + fmt::Debug + PartialEq + Send + 'static {
    /// The wrapper's state between steps.
    type State: Clone + fmt::Debug + Send + Serialize + DeserializeOwned + 'static;

    /// The initial state, for the grid of `facts` and `actions` actions.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for an argument out of range.
    fn state(&self, facts: &Facts, actions: usize) -> Result<Self::State>;

    /// Whether the stored state has the same form as the initial state `first`.
    fn fits(&self, stored: &Self::State, first: &Self::State) -> bool;

    /// The reset to use instead of `reset`; `None` to keep it.
    fn reset(&self, state: &mut Self::State, reset: &Reset) -> Option<Reset> {
        let _ = (state, reset);
        None
    }

    /// The action to take instead of the given one; `None` to keep it.
    fn before(&self, state: &mut Self::State, rng: &mut Generator) -> Option<i64> {
        let _ = (state, rng);
        None
    }

    /// Changes the outcome of a step. `action` is the number of the action, `front` the cell in
    /// front of the agent before the step.
    fn after(
        &self,
        state: &mut Self::State,
        world: &World,
        (action, front): (i64, Cell),
        outcome: &mut Outcome,
    ) {
        let _ = (state, world, action, front, outcome);
    }
}

/// Changes an environment by an [`Effect`].
#[derive(Clone, Debug)]
pub struct Affected<C: Effect, E = BoxEnv> {
    env: E,
    config: C,
    state: C::State,
}

impl<C: Effect, E: Env> Affected<C, E> {
    /// Wraps `env`, an environment of this crate.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for another environment, and an argument out of range.
    pub fn new(env: E, config: C) -> Result<Self> {
        let (Some(facts), Space::Discrete(actions)) = (env.layer::<Facts>(), env.action_space())
        else {
            return Err(C::refuse(format!(
                "it needs an environment of MiniGrid, and this is {}",
                env.describe()
            )));
        };
        let state = config.state(facts, actions.n() as usize)?;
        Ok(Self { env, config, state })
    }
}

impl<C: Effect, E: Env> gym_core::Wrapper for Affected<C, E> {
    type Inner = E;
    type Observation = E::Observation;
    type Action = E::Action;

    fn inner(&self) -> &E {
        &self.env
    }

    fn inner_mut(&mut self) -> &mut E {
        &mut self.env
    }

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        let other = self.config.reset(&mut self.state, reset);
        self.env
            .reset_into(other.as_ref().unwrap_or(reset), observation)
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let Self { env, config, state } = self;
        let rng = env.generator().ok_or(Error::ResetNeeded("step"))?;
        let before = rng.clone();
        let other = config.before(state, rng);
        let front = world(env)?.front();
        let other = other.and_then(|number| E::Action::from_value(&Value::Int(number)));
        let action = other.as_ref().unwrap_or(action);
        let stepped = env.step_into(action, observation);
        // a refused step must not draw from the generator
        if let (Err(_), Some(rng)) = (&stepped, env.generator()) {
            *rng = before;
        }
        let mut outcome = stepped?;
        let number = action.to_value().as_int().unwrap_or(-1);
        config.after(state, world(env)?, (number, front), &mut outcome);
        Ok(outcome)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(self.config.spec())
    }

    fn name(&self) -> &'static str {
        C::NAME
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.env.snapshot()?, &self.state))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, state): (Snapshot, C::State) = snapshot.get()?;
        if !self.config.fits(&state, &self.state) {
            return Err(Error::Snapshot(format!("it does not fit this {}", C::NAME)));
        }
        self.env.restore(&env)?;
        self.state = state;
        Ok(())
    }
}

/// Returns the world of an environment, or an error before the first reset.
fn world<E: Env>(env: &E) -> Result<&World> {
    env.layer::<World>().ok_or(Error::ResetNeeded("step"))
}

/// Counts one more visit of the situation `index`, and returns the bonus.
fn bonus(counts: &mut [u32], index: usize) -> f64 {
    let Some(count) = counts.get_mut(index) else {
        return 0.0;
    };
    *count = count.saturating_add(1);
    1.0 / f64::from(*count).sqrt()
}

/// Returns the index of the agent's cell.
fn place(world: &World) -> usize {
    (world.agent.y * world.grid.width() + world.agent.x) as usize
}

gym_core::arguments! {
    /// Adds a bonus for actions that were rarely taken in a place and direction. No arguments.
    pub struct ActionBonus {}
}

impl Effect for ActionBonus {
    type State = Vec<u32>;

    fn state(&self, Facts { rules, .. }: &Facts, actions: usize) -> Result<Vec<u32>> {
        Ok(vec![0; (rules.width * rules.height * 4) as usize * actions])
    }

    fn fits(&self, stored: &Vec<u32>, first: &Vec<u32>) -> bool {
        stored.len() == first.len()
    }

    fn after(
        &self,
        counts: &mut Vec<u32>,
        world: &World,
        (action, _): (i64, Cell),
        outcome: &mut Outcome,
    ) {
        let situations = 4 * world.grid.cells().len();
        let situation = 4 * place(world) + usize::from(world.direction);
        outcome.reward += bonus(counts, action.max(0) as usize * situations + situation);
    }
}

gym_core::register_wrapper!(
    "ActionBonus", "adds a reward for actions that were rarely taken in a place", ActionBonus,
    env: Affected::<ActionBonus>::new
);

gym_core::arguments! {
    /// Adds a bonus for places that were rarely visited.
    pub struct PositionBonus {
        /// The bonus of a first visit.
        pub scale: f64 = 1.0,
    }
}

impl Effect for PositionBonus {
    type State = Vec<u32>;

    fn state(&self, Facts { rules, .. }: &Facts, _: usize) -> Result<Vec<u32>> {
        Ok(vec![0; (rules.width * rules.height) as usize])
    }

    fn fits(&self, stored: &Vec<u32>, first: &Vec<u32>) -> bool {
        stored.len() == first.len()
    }

    fn after(&self, counts: &mut Vec<u32>, world: &World, _: (i64, Cell), outcome: &mut Outcome) {
        outcome.reward += bonus(counts, place(world)) * self.scale;
    }
}

gym_core::register_wrapper!(
    "PositionBonus", "adds a reward for places that were rarely visited", PositionBonus,
    env: Affected::<PositionBonus>::new
);

gym_core::arguments! {
    /// Lets an episode go on where it would end without success.
    pub struct NoDeath {
        /// The kinds of cells that end no episode, such as `lava`.
        pub no_death_types: Vec<Kind>,
        /// What is added to the reward instead.
        pub death_cost: f64 = -1.0,
    }
}

impl Effect for NoDeath {
    type State = ();

    fn state(&self, _: &Facts, _: usize) -> Result<()> {
        if self.no_death_types.contains(&Kind::Goal) {
            return Err(Self::refuse(
                "no_death_types contains `goal`, which is no death",
            ));
        }
        Ok(())
    }

    fn fits(&self, (): &(), (): &()) -> bool {
        true
    }

    fn after(
        &self,
        (): &mut (),
        world: &World,
        (action, front): (i64, Cell),
        outcome: &mut Outcome,
    ) {
        let is_death = |cell: Cell| self.no_death_types.contains(&cell.kind());
        let enters = action == Action::Forward as i64 && is_death(front);
        if outcome.terminated && (enters || is_death(world.grid.get(world.agent))) {
            outcome.terminated = false;
            outcome.reward += self.death_cost;
        }
    }
}

gym_core::register_wrapper!(
    "NoDeath", "lets episodes go on in lava, at a cost", NoDeath, env: Affected::<NoDeath>::new
);

gym_core::arguments! {
    /// Takes another action than the given one at times.
    pub struct StochasticAction {
        /// The probability of the given action.
        pub prob: f64 = 0.9,
        /// The other action; a random one if null.
        pub random_action: Option<u32>,
    }
}

impl Effect for StochasticAction {
    type State = u32;

    fn state(&self, _: &Facts, actions: usize) -> Result<u32> {
        if !(0.0..=1.0).contains(&self.prob) {
            return Err(Self::refuse(format!(
                "prob is {}: a probability is between 0 and 1",
                self.prob
            )));
        }
        if let Some(action) = self
            .random_action
            .filter(|action| *action as usize >= actions)
        {
            return Err(Self::refuse(format!(
                "random_action is {action}: there are {actions} actions"
            )));
        }
        Ok(actions as u32)
    }

    fn fits(&self, stored: &u32, first: &u32) -> bool {
        stored == first
    }

    fn before(&self, actions: &mut u32, rng: &mut Generator) -> Option<i64> {
        if rng.random() < self.prob {
            return None;
        }
        let random = self.random_action.map(i64::from);
        Some(random.unwrap_or_else(|| rng.integers(0, i64::from(*actions))))
    }
}

gym_core::register_wrapper!(
    "StochasticActionWrapper", "takes another action at times", StochasticAction,
    env: Affected::<StochasticAction>::new
);

gym_core::arguments! {
    /// Starts episodes with given seeds, one after the other.
    pub struct Reseed {
        /// The seeds.
        pub seeds: Vec<u64> = vec![0],
        /// The index of the first seed.
        pub seed_idx: u32 = 0,
    }
}

impl Effect for Reseed {
    type State = u32;

    fn state(&self, _: &Facts, _: usize) -> Result<u32> {
        if self.seed_idx as usize >= self.seeds.len() {
            let count = self.seeds.len();
            return Err(Self::refuse(format!(
                "seed_idx is {}: there are {count} seeds",
                self.seed_idx
            )));
        }
        Ok(self.seed_idx)
    }

    fn fits(&self, stored: &u32, _: &u32) -> bool {
        (*stored as usize) < self.seeds.len()
    }

    fn reset(&self, index: &mut u32, reset: &Reset) -> Option<Reset> {
        let seed = *self.seeds.get(*index as usize)?;
        *index = (*index + 1) % self.seeds.len() as u32;
        Some(Reset {
            options: reset.options.clone(),
            ..Reset::seed(seed)
        })
    }
}

gym_core::register_wrapper!(
    "ReseedWrapper", "starts episodes with given seeds", Reseed, env: Affected::<Reseed>::new
);
