//! A wrapper that refuses calls in a wrong order.

use crate::drawing::render::Rendered;
use crate::env::{BoxEnv, Env, Outcome};
use crate::spec::{EnvSpec, Reset, WrapperConfig};
use crate::value::{Error, Result, Snapshot};

/// Refuses to step or render before the first reset, and every call after `close`.
#[derive(Clone, Debug)]
pub struct OrderEnforcing<E = BoxEnv> {
    inner: E,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
enum Stage {
    Made,
    Reset,
    /// The environment is closed. Snapshots do not contain this, so restoring a snapshot cannot
    /// close an environment.
    #[serde(skip)]
    Closed,
}

crate::arguments! {
    /// [`OrderEnforcing`] has no arguments.
    pub struct Config {}
}

crate::register_wrapper!(
    "OrderEnforcing", "refuses steps before a reset", Config, env: |env, _| Ok(OrderEnforcing::new(env))
);

crate::inner!(impl OrderEnforcing<E>);

impl<E: Env> OrderEnforcing<E> {
    /// Watches over `env`.
    pub fn new(env: E) -> Self {
        Self {
            inner: env,
            stage: Stage::Made,
        }
    }

    fn check_open(&self, call: &'static str) -> Result<()> {
        if self.stage == Stage::Closed {
            Err(Error::Closed(call))
        } else {
            Ok(())
        }
    }

    fn check(&self, call: &'static str) -> Result<()> {
        match self.stage {
            Stage::Made => Err(Error::ResetNeeded(call)),
            Stage::Reset => Ok(()),
            Stage::Closed => Err(Error::Closed(call)),
        }
    }
}

impl<E: Env> crate::env::Wrapper for OrderEnforcing<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    crate::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.check_open("reset")?;
        self.inner.reset_into(reset, observation)?;
        self.stage = Stage::Reset;
        Ok(())
    }

    #[inline]
    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.check("step")?;
        self.inner.step_into(action, observation)
    }

    fn on_render(&mut self, rendered: &mut Rendered) -> Result<()> {
        self.check("render")?;
        self.inner.render_into(rendered)
    }

    fn on_snapshot(&self) -> Result<Snapshot> {
        self.check_open("snapshot")?;
        Snapshot::of(&(self.inner.snapshot()?, self.stage))
    }

    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.check_open("restore")?;
        let (env, stage) = snapshot.get()?;
        self.inner.restore(&env)?;
        self.stage = stage;
        Ok(())
    }

    fn on_close(&mut self) {
        self.stage = Stage::Closed;
        self.inner.close();
    }

    fn on_spec(&self) -> Option<EnvSpec> {
        // directly around the environment, this wrapper counts as the one that `make` adds; outside
        // another wrapper, it is an additional wrapper
        self.inner
            .spec()
            .map(|spec| match spec.additional_wrappers.is_empty() {
                true => EnvSpec {
                    order_enforce: true,
                    ..spec
                },
                false => spec.wrapped(Config {}.spec()),
            })
    }
}
