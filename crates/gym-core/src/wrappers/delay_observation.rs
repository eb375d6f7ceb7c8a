use serde_json::Value as Json;

use crate::{BoxEnv, Element, Env, Error, Outcome, Reset, Result, Snapshot, WrapperSpec};

/// Gives each observation some steps late. Until the first arrives, observations are zeros (or what
/// the space has nearest to zero).
#[derive(Clone, Debug)]
pub struct DelayObservation<E: Env = BoxEnv> {
    env: E,
    zero: E::Observation,
    /// The observations on their way, as a ring.
    ring: Vec<E::Observation>,
    /// Where in the ring the oldest is.
    oldest: usize,
}

super::reach!(DelayObservation<E: Env>);

impl<E: Env> DelayObservation<E> {
    /// Delays the observations of `env` by `delay` steps.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] if the observation space has no zero; [`Error::InvalidArgument`] for a delay
    /// beyond the memory.
    pub fn new(env: E, delay: usize) -> Result<Self> {
        let zero = env.observation_space().zero()?;
        let zero = E::Observation::from_value(&zero)
            .ok_or_else(|| Error::Contract(format!("{zero} does not fit the type of the observations")))?;
        let mut ring = Vec::new();
        if ring.try_reserve_exact(delay).is_err() {
            let reason = format!("delay is {delay}: so many observations do not fit in memory");
            return Err(Error::argument("DelayObservation", reason));
        }
        ring.resize(delay, zero.clone());
        Ok(Self { ring, env, zero, oldest: 0 })
    }

    /// By how many steps observations are late.
    pub fn delay(&self) -> usize {
        self.ring.len()
    }

    /// Exchanges the newest observation for the oldest.
    fn exchange(&mut self, observation: &mut E::Observation) {
        if let Some(oldest) = self.ring.get_mut(self.oldest) {
            std::mem::swap(oldest, observation);
            self.oldest = (self.oldest + 1) % self.ring.len();
        }
    }
}

impl<E: Env> crate::Wrapper for DelayObservation<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)?;
        self.ring.iter_mut().for_each(|slot| slot.clone_from(&self.zero));
        self.exchange(observation);
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        self.exchange(observation);
        Ok(outcome)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        let space = self.env.observation_space();
        let (newer, older) = self.ring.split_at(self.oldest.min(self.ring.len()));
        let ring = older.iter().chain(newer).map(|observation| space.to_json(&observation.to_value()));
        Snapshot::of(&(self.env.snapshot()?, ring.collect::<Result<Vec<_>>>()?))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, ring): (_, Vec<Json>) = snapshot.get()?;
        if ring.len() != self.ring.len() {
            let reason = format!("it holds a delay of {} and not {}", ring.len(), self.ring.len());
            return Err(Error::Snapshot(reason));
        }
        let space = self.env.observation_space();
        let ring = ring.iter().map(|json| super::element(&space, json)).collect::<Result<_>>()?;
        self.env.restore(&env)?;
        (self.ring, self.oldest) = (ring, 0);
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(WrapperSpec::new("DelayObservation").arg("delay", self.delay()))
    }
}
