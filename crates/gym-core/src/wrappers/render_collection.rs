use crate::render::{RenderMode, Rendered};
use crate::{Env, EnvSpec, Error, Outcome, Reset, Result, Snapshot};

/// Gathers what the environment within renders after each reset and step; `render` hands over the
/// list and clears it. An episode of `T` steps gives `T + 1` items.
///
/// A reset drops what was not asked for.
#[derive(Clone, Debug)]
pub struct RenderCollection<E> {
    env: E,
    items: Vec<Rendered>,
}

impl<E: Env> RenderCollection<E> {
    /// Gathers what `env` renders.
    pub fn new(env: E) -> Self {
        Self { env, items: Vec::new() }
    }

    /// The environment within.
    pub fn into_inner(self) -> E {
        self.env
    }
}

impl<E: Env> Env for RenderCollection<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)?;
        self.items.clear();
        self.items.push(self.env.render()?);
        Ok(())
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.env.step_into(action, observation)?;
        self.items.push(self.env.render()?);
        Ok(outcome)
    }

    fn render(&mut self) -> Result<Rendered> {
        let mut frames = Vec::new();
        let mut texts = Vec::new();
        for item in self.items.drain(..) {
            match item {
                Rendered::Frame(frame) => frames.push(frame),
                Rendered::Text(text) => texts.push(text),
                Rendered::Shown | Rendered::Frames(_) | Rendered::Texts(_) => {
                    return Err(Error::Contract("only single frames or texts can be gathered".into()));
                }
            }
        }
        Ok(if texts.is_empty() { Rendered::Frames(frames) } else { Rendered::Texts(texts) })
    }

    fn snapshot(&self) -> Result<Snapshot> {
        self.env.snapshot()
    }

    /// The frames gathered so far belong to the history that is left; they are dropped.
    fn restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.env.restore(snapshot)?;
        self.items.clear();
        Ok(())
    }

    fn spec(&self) -> Option<EnvSpec> {
        let list = |mode| match mode {
            RenderMode::RgbArray => RenderMode::RgbArrayList,
            RenderMode::Ansi => RenderMode::AnsiList,
            other => other,
        };
        self.env.spec().map(|spec| EnvSpec { render_mode: spec.render_mode.map(list), ..spec })
    }

    crate::forward!(
        env: observation_space, action_space, info, metadata, draw, ansi, base, generator, close, describe
    );
}
