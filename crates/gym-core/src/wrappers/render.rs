use std::fmt;

use crate::canvas::Canvas;
use crate::render::{Frame, Painter, RenderMode, Rendered, painter};
use crate::{Env, EnvSpec, Error, Outcome, Reset, Result};

/// Gives an environment its render mode: turns its [`draw`](Env::draw) or [`ansi`](Env::ansi) into
/// what [`render`](Env::render) returns, one picture or text at a time.
pub struct Render<E> {
    env: E,
    mode: RenderMode,
    size: (u32, u32),
    painter: Option<Box<dyn Painter>>,
}

impl<E: Env> Render<E> {
    /// Renders `env` in a mode of single items; [`RenderCollection`](super::RenderCollection)
    /// around it makes a list.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if the environment lacks the mode, or no crate that draws is
    /// linked.
    pub fn new(env: E, mode: RenderMode) -> Result<Self> {
        let metadata = env.metadata();
        let unsupported = |reason: String| Error::UnsupportedMode {
            target: env.describe(),
            mode: mode.to_string(),
            reason,
        };
        if !metadata.render_modes.contains(&mode) {
            let modes: Vec<_> = metadata.render_modes.iter().map(|mode| mode.name()).collect();
            return Err(unsupported(match modes[..] {
                [] => "it has no render modes".into(),
                _ => format!("its modes are {}", modes.join(", ")),
            }));
        }
        let painter = match mode {
            RenderMode::Ansi => None,
            RenderMode::Human => return Err(unsupported("no crate that opens a window is linked".into())),
            _ => Some(painter().ok_or_else(|| {
                unsupported("no crate that draws is linked: add gym-render and `use gym_render as _;`".into())
            })?),
        };
        Ok(Self { env, mode, size: metadata.render_size, painter })
    }

    /// Renders at another size; drawings are vectors and scale.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a width or height of 0 or above 16384.
    pub fn with_size(self, width: u32, height: u32) -> Result<Self> {
        let valid = 1..=16384;
        if !(valid.contains(&width) && valid.contains(&height)) {
            return Err(Error::argument(
                "render_size",
                format!("{width}x{height}: width and height must be between 1 and 16384"),
            ));
        }
        Ok(Self { size: (width, height), ..self })
    }

    /// The environment within.
    pub fn into_inner(self) -> E {
        self.env
    }
}

impl<E: Env> Env for Render<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.env.step_into(action, observation)
    }

    fn render(&mut self) -> Result<Rendered> {
        let Some(painter) = &mut self.painter else {
            return self.env.ansi().map(Rendered::Text).ok_or(Error::ResetNeeded("render"));
        };
        let mut frame = Frame::new(self.size.0, self.size.1);
        let size = self.env.metadata().render_size;
        painter.paint(size, &mut |canvas: &mut dyn Canvas| self.env.draw(canvas), &mut frame);
        Ok(Rendered::Frame(frame))
    }

    fn spec(&self) -> Option<EnvSpec> {
        let size = (self.size != self.env.metadata().render_size).then_some(self.size);
        self.env.spec().map(|spec| EnvSpec { render_mode: Some(self.mode), render_size: size, ..spec })
    }

    fn describe(&self) -> String {
        self.env.describe()
    }

    crate::forward!(
        env: observation_space, action_space, snapshot, restore, info, metadata, draw, ansi, base, generator, close
    );
}

impl<E: Clone> Clone for Render<E> {
    fn clone(&self) -> Self {
        let painter = self.painter.as_ref().and_then(|_| painter());
        Self { env: self.env.clone(), mode: self.mode, size: self.size, painter }
    }
}

impl<E: fmt::Debug> fmt::Debug for Render<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Render")
            .field("env", &self.env)
            .field("mode", &self.mode)
            .field("size", &self.size)
            .finish_non_exhaustive()
    }
}
