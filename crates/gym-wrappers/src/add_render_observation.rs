//! Observations that are rendered frames.

use gym_core::registry::WrapperConfig;
use gym_core::render::{Frame, Rendered};
use gym_core::spaces::{BoxSpace, DictSpace, array_of};
use gym_core::{BoxEnv, DType, Env, EnvExt, Error, Result, Space, Value};

use crate::filter_observation::{dict_like, entries};
use crate::observing::{Observer, Observing};

/// Observes the rendered frame, alone or beside the observation.
///
/// Each reset and step renders a frame and allocates it.
pub type AddRenderObservation<E = BoxEnv> = Observing<E, AddRender>;

/// The observer of [`AddRenderObservation`].
#[derive(Clone, Debug)]
pub struct AddRender {
    config: Config,
    shape: [usize; 3],
    /// Whether the inner observation is a dict, to which the wrapper adds the frame.
    extends_dict: bool,
}

gym_core::arguments! {
    /// The arguments of [`AddRenderObservation`].
    pub struct Config {
        /// Whether the observation is the frame alone, instead of a dict.
        pub render_only: bool = true,
        /// The key of the frame.
        pub render_key: String = "pixels".into(),
        /// The key of the observation. If the observation is a dict, the frame is added to it.
        pub obs_key: String = "state".into(),
    }
}

gym_core::register_wrapper!(
    "AddRenderObservation", "observes the rendered frame", Config, env: AddRenderObservation::new
);

impl<E: Env> AddRenderObservation<E> {
    /// Observes frames of `env`. A copy of it is reset and rendered to find their size.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if `env` was made without the render mode `rgb_array`, and
    /// [`Error::InvalidArgument`] if a key occurs twice.
    pub fn new(env: E, config: impl Into<Config>) -> Result<Self> {
        let (config, mut trial) = (config.into(), env.clone());
        trial.reset(0)?;
        let frame = frame(&mut trial)?;
        let shape = [frame.height() as usize, frame.width() as usize, 3];
        let pixels = Space::from(BoxSpace::uniform(0.0, 255.0, shape, DType::U8)?);
        let inner_space = env.observation_space();
        let extends_dict = matches!(inner_space, Space::Dict(_));
        let refuse = |error: Error| Config::refuse(error.to_string());
        let Config {
            render_only,
            render_key,
            obs_key,
        } = &config;
        let space = match inner_space {
            _ if *render_only => pixels,
            Space::Dict(space) => {
                let members = std::iter::once((render_key.clone(), pixels))
                    .chain(space.spaces().iter().cloned());
                dict_like(&space, members.collect()).map_err(refuse)?.into()
            }
            space => DictSpace::new([(obs_key, space), (render_key, pixels)])
                .map_err(refuse)?
                .into(),
        };
        let observer = AddRender {
            config,
            shape,
            extends_dict,
        };
        Ok(Self::with_observer(env, observer, space))
    }
}

impl Observer for AddRender {
    type Config = Config;

    fn arguments(&self) -> Config {
        self.config.clone()
    }

    fn observe<E: Env>(
        &mut self,
        env: &mut E,
        space: &Space,
        seen: &mut Value,
        _is_reset: bool,
        out: &mut Value,
    ) -> Result<()> {
        let frame = frame(env)?;
        if [frame.height() as usize, frame.width() as usize] != self.shape[..2] {
            return Err(Error::Contract(
                "the size of the rendered frame has changed".into(),
            ));
        }
        let Space::Dict(space) = space else {
            self.draw_into(&frame, out);
            return Ok(());
        };
        let keys = space.spaces().iter().map(|(key, _)| key);
        for (key, value) in keys.clone().zip(entries(keys, out)) {
            if *key == self.config.render_key {
                self.draw_into(&frame, value);
            } else if self.extends_dict {
                let lacking = || Error::Contract(format!("the observation lacks the key {key:?}"));
                value.clone_from(seen.get(key).ok_or_else(lacking)?);
            } else {
                value.clone_from(seen);
            }
        }
        Ok(())
    }
}

impl AddRender {
    fn draw_into(&self, frame: &Frame, out: &mut Value) {
        let array = array_of(out, DType::U8, &self.shape);
        array
            .as_mut_slice::<u8>()
            .unwrap_or_default()
            .copy_from_slice(frame.pixels());
    }
}

fn frame<E: Env>(env: &mut E) -> Result<Frame> {
    match env.render()? {
        Rendered::Frame(frame) => Ok(frame),
        _ => Err(Error::UnsupportedMode {
            target: Config::NAME.into(),
            mode: "an observation".into(),
            reason: "it needs single frames: make the environment with `RenderMode::RgbArray`"
                .into(),
        }),
    }
}
