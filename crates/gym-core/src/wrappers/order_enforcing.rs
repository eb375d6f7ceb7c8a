use crate::render::Rendered;
use crate::{BoxEnv, Env, EnvSpec, Error, Outcome, Reset, Result, Snapshot};

/// Refuses to step or render before the first reset and after `close`, whatever the environment
/// would do.
#[derive(Clone, Debug)]
pub struct OrderEnforcing<E = BoxEnv> {
    env: E,
    stage: Stage,
}

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
enum Stage {
    Made,
    Reset,
    Closed,
}

super::reach!(OrderEnforcing<E>);

impl<E: Env> OrderEnforcing<E> {
    /// Watches over `env`.
    pub fn new(env: E) -> Self {
        Self { env, stage: Stage::Made }
    }

    fn check(&self, call: &'static str) -> Result<()> {
        match self.stage {
            Stage::Made => Err(Error::ResetNeeded(call)),
            Stage::Reset => Ok(()),
            Stage::Closed => Err(Error::Closed(call)),
        }
    }
}

impl<E: Env> crate::Wrapper for OrderEnforcing<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        if self.stage == Stage::Closed {
            return Err(Error::Closed("reset"));
        }
        self.env.reset_into(reset, observation)?;
        self.stage = Stage::Reset;
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.check("step")?;
        self.env.step_into(action, observation)
    }

    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> {
        self.check("render")?;
        self.env.render_into(rendered)
    }

    fn snapshot(&self) -> Result<Snapshot> {
        Snapshot::of(&(self.env.snapshot()?, self.stage))
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        let (env, stage) = snapshot.get()?;
        self.env.restore(&env)?;
        self.stage = stage;
        Ok(())
    }

    fn close(&mut self) {
        self.stage = Stage::Closed;
        self.env.close();
    }

    fn spec(&self) -> Option<EnvSpec> {
        self.env.spec().map(|spec| EnvSpec { order_enforce: true, ..spec })
    }
}
