//! Policies that play an environment well: rules, or a trained network.

use crate::env::BoxEnv;
use crate::value::{Element, Result, Value};

/// Chooses the action for an observation; `None` if the value is not an observation of the
/// environment.
pub type Controller = Box<dyn FnMut(&BoxEnv, &Value) -> Option<Value>>;

/// A policy that plays an environment well, for
/// [`Registration::policy`](crate::Registration::policy).
#[derive(Clone, Copy, Debug)]
pub struct Policy {
    /// A phrase that continues "the good policy", such as "drives right".
    pub description: &'static str,
    source: Source,
}

#[derive(Clone, Copy, Debug)]
enum Source {
    Rules(fn(&BoxEnv) -> Option<Controller>),
    Trained(fn(&BoxEnv) -> Result<Controller>),
}

impl Policy {
    /// Rules: `start` returns the controller of one episode, or `None` if the rules do not fit the
    /// arguments.
    pub const fn rules(
        description: &'static str,
        start: fn(&BoxEnv) -> Option<Controller>,
    ) -> Self {
        Self {
            description,
            source: Source::Rules(start),
        }
    }

    /// A trained policy, such as a network of the crate gym-policies: `start` returns the controller
    /// of one episode.
    pub const fn trained(
        description: &'static str,
        start: fn(&BoxEnv) -> Result<Controller>,
    ) -> Self {
        Self {
            description,
            source: Source::Trained(start),
        }
    }

    /// The controller of one episode; `None` if the policy does not fit the environment's
    /// arguments.
    ///
    /// # Errors
    /// The errors of a trained policy that is damaged or does not fit the environment's spaces.
    pub fn controller(&self, env: &BoxEnv) -> Result<Option<Controller>> {
        match self.source {
            Source::Rules(start) => Ok(start(env)),
            Source::Trained(start) => start(env).map(Some),
        }
    }
}

/// A controller that depends only on the observation.
pub fn reflex<O: Element, A: Element>(
    mut act: impl FnMut(&O) -> A + 'static,
) -> Option<Controller> {
    Some(Box::new(move |_, seen| {
        O::with(seen, |seen| act(seen).to_value())
    }))
}

/// A policy that another crate than the environment's links, for a registered id. Submit it with
/// `gym_core::inventory::submit!`.
#[derive(Clone, Copy, Debug)]
pub struct LinkedPolicy {
    /// The id of the environment.
    pub id: &'static str,
    /// The policy.
    pub policy: Policy,
}

inventory::collect!(LinkedPolicy);

impl LinkedPolicy {
    /// The linked policy for an id.
    pub(crate) fn find(id: &str) -> Option<Policy> {
        let mut linked = inventory::iter::<Self>.into_iter();
        linked
            .find(|linked| linked.id == id)
            .map(|linked| linked.policy)
    }
}
