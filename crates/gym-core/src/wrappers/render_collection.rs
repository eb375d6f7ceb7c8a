//! A wrapper that collects frames.

use crate::drawing::render::{RenderMode, Rendered};
use crate::env::{BoxEnv, Env, EnvExt, Outcome};
use crate::spec::{EnvSpec, Reset};
use crate::value::{Error, Result, Snapshot};

/// Collects a frame or text after each reset and step; `render` returns the list and clears it. An
/// episode of `T` steps has `T + 1` items.
///
/// A reset drops uncollected items.
#[derive(Clone, Debug)]
pub struct RenderCollection<E = BoxEnv> {
    inner: E,
    items: Vec<Rendered>,
}

crate::arguments! {
    /// [`RenderCollection`] has no arguments.
    pub struct Config {}
}

crate::register_wrapper!(
    "RenderCollection", "collects frames for the render modes `..._list`", Config, env: |env, _| Ok(RenderCollection::new(env))
);

crate::inner!(impl RenderCollection<E>);

impl<E: Env> RenderCollection<E> {
    /// Collects the frames or texts of `env`.
    pub fn new(env: E) -> Self {
        Self {
            inner: env,
            items: Vec::new(),
        }
    }
}

impl<E: Env> crate::env::Wrapper for RenderCollection<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    crate::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.inner.reset_into(reset, observation)?;
        self.items.clear();
        self.items.push(self.inner.render()?);
        Ok(())
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        let outcome = self.inner.step_into(action, observation)?;
        self.items.push(self.inner.render()?);
        Ok(outcome)
    }

    fn on_render_mode(&self) -> Option<RenderMode> {
        match self.inner.render_mode()? {
            RenderMode::RgbArray => Some(RenderMode::RgbArrayList),
            RenderMode::Ansi => Some(RenderMode::AnsiList),
            mode => Some(mode),
        }
    }

    fn on_render(&mut self, rendered: &mut Rendered) -> Result<()> {
        let mut frames = Vec::new();
        let mut texts = Vec::new();
        for item in self.items.drain(..) {
            match item {
                Rendered::Frame(frame) => frames.push(frame),
                Rendered::Text(text) => texts.push(text),
                _ => {
                    let reason =
                        "RenderCollection needs a mode of single items: `rgb_array` or `ansi`";
                    return Err(Error::Contract(reason.into()));
                }
            }
        }
        // an empty list has the type of its mode
        *rendered = match self.inner.render_mode() {
            Some(RenderMode::Ansi) => Rendered::Texts(texts),
            _ => Rendered::Frames(frames),
        };
        Ok(())
    }

    /// Drops the collected frames, which are from before the restore.
    fn on_restore(&mut self, snapshot: &Snapshot) -> Result<()> {
        self.inner.restore(snapshot)?;
        self.items.clear();
        Ok(())
    }

    fn on_spec(&self) -> Option<EnvSpec> {
        let spec = self.inner.spec()?;
        let list = match spec.render_mode? {
            RenderMode::RgbArray => RenderMode::RgbArrayList,
            RenderMode::Ansi => RenderMode::AnsiList,
            _ => return None,
        };
        Some(EnvSpec {
            render_mode: Some(list),
            ..spec
        })
    }
}
