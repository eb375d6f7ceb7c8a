use std::fmt;

use crate::drawing::canvas::Canvas;
use crate::drawing::render::{
    Depth, Frame, Painter, RenderMode, Rendered, Screen, open_screen, painter,
};
use crate::env::{BoxEnv, Env, Outcome};
use crate::spec::{EnvSpec, Reset};
use crate::value::{Error, Result};

/// Adds a render mode to an environment: [`render`](crate::EnvExt::render) returns the frame of its
/// [`draw`](Env::draw), or the text of its [`ansi`](Env::ansi).
///
/// In the mode `human` each reset and step shows a frame in a window, no faster than the
/// environment's frames per second. The window opens at the first reset. After it is closed,
/// nothing is drawn. A clone opens no window.
pub struct Render<E = BoxEnv> {
    inner: E,
    mode: RenderMode,
    size: (u32, u32),
    painter: Option<Box<dyn Painter>>,
    window: Window,
    /// The number of frames drawn.
    frames: u64,
}

/// The window of the mode `human`.
enum Window {
    /// The render mode has no window, or the window was closed.
    None,
    /// The window opens with the first frame.
    Wanted,
    /// The window is open, and shows the frame.
    Open(Box<dyn Screen>, Frame),
}

crate::inner!(impl Render<E>);

impl<E: Env> Render<E> {
    /// Renders `env` in a mode of single items; [`RenderCollection`](super::RenderCollection)
    /// around it makes a list.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if the environment lacks the mode, or the crate that draws (or
    /// opens windows, for `human`) is not linked.
    pub fn new(env: E, mode: RenderMode) -> Result<Self> {
        let metadata = env.metadata();
        let unsupported = |reason: String| Error::UnsupportedMode {
            target: env.describe(),
            mode: mode.to_string(),
            reason,
        };
        if !metadata.render_modes.contains(&mode) {
            let modes: Vec<_> = metadata
                .render_modes
                .iter()
                .map(|mode| mode.name())
                .collect();
            return Err(unsupported(match modes[..] {
                [] => "it has no render modes".into(),
                _ => format!("its modes are {}", modes.join(", ")),
            }));
        }
        let painter = match mode {
            RenderMode::Ansi | RenderMode::DepthArray => None,
            _ => Some(painter().ok_or_else(|| {
                unsupported(
                    "no crate that draws is linked: turn on the feature `render` of rust-gym, or add \
                     gym-render and `use gym_render as _;`"
                        .into(),
                )
            })?),
        };
        let window = match mode {
            RenderMode::Human if open_screen().is_none() => {
                return Err(unsupported(
                    "no crate that opens a window is linked: turn on the feature `human` of rust-gym, or \
                     add gym-render with the feature `human` and `use gym_render as _;`"
                        .into(),
                ));
            }
            RenderMode::Human => Window::Wanted,
            _ => Window::None,
        };
        let mut env = env;
        if painter.is_some() {
            env.frames_drawn(0);
        }
        Ok(Self {
            inner: env,
            mode,
            size: metadata.render_size,
            painter,
            window,
            frames: 0,
        })
    }

    /// Renders at another size.
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
        Ok(Self {
            size: (width, height),
            ..self
        })
    }

    /// Opens a [`Window::Wanted`] before the environment changes: if the window cannot be opened,
    /// the environment is unchanged.
    fn open(&mut self) -> Result<()> {
        if let Window::Wanted = self.window
            && let Some(open) = open_screen()
        {
            let title = self
                .inner
                .spec()
                .map_or_else(|| self.inner.describe(), |spec| spec.id);
            let screen = open(&title, self.size, self.inner.metadata().render_fps)?;
            self.window = Window::Open(screen, Frame::new(self.size.0, self.size.1)?);
        }
        Ok(())
    }

    fn depth(&self) -> Result<Depth> {
        let (width, height) = self.size;
        let metres = self.inner.depth(self.size);
        let metres = metres.ok_or(Error::ResetNeeded("render"))?;
        Ok(Depth {
            width,
            height,
            metres,
        })
    }

    /// Shows the picture in the window, if there is one.
    fn show(&mut self) {
        if let (Window::Open(screen, frame), Some(painter)) = (&mut self.window, &mut self.painter)
        {
            paint(&mut self.inner, painter.as_mut(), &mut self.frames, frame);
            if !screen.show(frame) {
                self.window = Window::None;
            }
        }
    }
}

/// Paints the picture of an environment, and counts the picture.
fn paint<E: Env>(env: &mut E, painter: &mut dyn Painter, frames: &mut u64, frame: &mut Frame) {
    let size = env.metadata().render_size;
    painter.paint(size, &mut |canvas: &mut dyn Canvas| env.draw(canvas), frame);
    *frames += 1;
    env.frames_drawn(*frames);
}

impl<E: Env> crate::env::Wrapper for Render<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    crate::inner!(E);

    fn on_reset(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.open()?;
        self.inner.reset_into(reset, observation)?;
        self.show();
        Ok(())
    }

    fn on_step(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.open()?;
        let outcome = self.inner.step_into(action, observation)?;
        self.show();
        Ok(outcome)
    }

    fn on_render_mode(&self) -> Option<RenderMode> {
        Some(self.mode)
    }

    fn on_render(&mut self, rendered: &mut Rendered) -> Result<()> {
        let used = std::mem::replace(rendered, Rendered::Shown);
        if self.mode == RenderMode::Human {
            return Ok(());
        }
        let depth = match self.mode {
            RenderMode::DepthArray | RenderMode::RgbdTuple => Some(self.depth()?),
            _ => None,
        };
        let Some(painter) = &mut self.painter else {
            if let Some(depth) = depth {
                *rendered = Rendered::Depth(depth);
                return Ok(());
            }
            *rendered = self
                .inner
                .ansi()
                .map(Rendered::Text)
                .ok_or(Error::ResetNeeded("render"))?;
            return Ok(());
        };
        let mut frame = match used {
            Rendered::Frame(frame) | Rendered::Rgbd(frame, _)
                if (frame.width(), frame.height()) == self.size =>
            {
                frame
            }
            _ => Frame::new(self.size.0, self.size.1)?,
        };
        paint(
            &mut self.inner,
            painter.as_mut(),
            &mut self.frames,
            &mut frame,
        );
        *rendered = match depth {
            Some(depth) => Rendered::Rgbd(frame, depth),
            None => Rendered::Frame(frame),
        };
        Ok(())
    }

    fn on_spec(&self) -> Option<EnvSpec> {
        let size = (self.size != self.inner.metadata().render_size).then_some(self.size);
        let spec = self.inner.spec()?;
        // a spec has one render mode, inside all wrappers
        (spec.render_mode.is_none() && spec.additional_wrappers.is_empty()).then_some(EnvSpec {
            render_mode: Some(self.mode),
            render_size: size,
            ..spec
        })
    }

    fn on_describe(&self) -> String {
        self.inner.describe()
    }

    fn on_close(&mut self) {
        self.window = Window::None;
        self.inner.close();
    }
}

impl<E: Clone> Clone for Render<E> {
    fn clone(&self) -> Self {
        let painter = self.painter.as_ref().and_then(|_| painter());
        Self {
            inner: self.inner.clone(),
            mode: self.mode,
            size: self.size,
            painter,
            window: Window::None,
            frames: self.frames,
        }
    }
}

impl<E: fmt::Debug> fmt::Debug for Render<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Render")
            .field("env", &self.inner)
            .field("mode", &self.mode)
            .field("size", &self.size)
            .finish_non_exhaustive()
    }
}
