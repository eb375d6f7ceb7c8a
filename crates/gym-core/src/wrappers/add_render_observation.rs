use crate::render::{Frame, Rendered};
use crate::spaces::{BoxSpace, DictSpace, array_of};
use crate::{BoxEnv, DType, Element, Env, EnvExt, Error, Outcome, Reset, Result, Space, Value, WrapperSpec};

/// Observes the rendered picture, alone or beside the observation.
///
/// A picture is drawn, and memory for it allocated, at each reset and step.
#[derive(Clone, Debug)]
pub struct AddRenderObservation<E = BoxEnv> {
    env: E,
    space: Space,
    shape: Vec<usize>,
    render_key: String,
    /// The key of the observation; `None` to observe the picture alone.
    obs_key: Option<String>,
    /// Whether the observation within is a dict, which the picture is added to.
    extends_dict: bool,
    inner: Value,
}

super::reach!(AddRenderObservation<E>);

impl<E: Env> AddRenderObservation<E> {
    /// Gymnasium's default key of the picture.
    pub const RENDER_KEY: &'static str = "pixels";
    /// Gymnasium's default key of the observation.
    pub const OBS_KEY: &'static str = "state";

    /// Observes the picture alone. The size of the picture is found by rendering a copy of `env` after
    /// a reset.
    ///
    /// # Errors
    /// [`Error::UnsupportedMode`] if `env` was made without the render mode `rgb_array`.
    pub fn new(env: E) -> Result<Self> {
        Self::build(env, true, Self::RENDER_KEY, Self::OBS_KEY)
    }

    /// Observes a dict of the picture under `render_key` and the observation under `obs_key`; where the
    /// observation is a dict itself, the picture is added to it.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`Error::InvalidArgument`] if a key occurs twice.
    pub fn with_state(env: E, render_key: &str, obs_key: &str) -> Result<Self> {
        Self::build(env, false, render_key, obs_key)
    }

    pub(crate) fn build(env: E, render_only: bool, render_key: &str, obs_key: &str) -> Result<Self> {
        let mut trial = env.clone();
        trial.reset(0)?;
        let frame = frame(&mut trial)?;
        let shape = vec![frame.height() as usize, frame.width() as usize, 3];
        let pixels = Space::from(BoxSpace::uniform(0.0, 255.0, shape.as_slice(), DType::U8)?);
        let inner = env.observation_space();
        let extends_dict = matches!(inner, Space::Dict(_));
        let dict = |space: Result<DictSpace>| match space {
            Ok(space) => Ok(Space::from(space)),
            Err(error) => Err(Error::argument("AddRenderObservation", error.to_string())),
        };
        let space = match inner {
            _ if render_only => pixels,
            Space::Dict(space) => {
                let build = match super::filter_observation::is_sorted(&space) {
                    true => DictSpace::new,
                    false => DictSpace::in_order,
                };
                let members = space.spaces().iter().cloned();
                dict(build(
                    std::iter::once((render_key.to_owned(), pixels)).chain(members).collect::<Vec<_>>(),
                ))?
            }
            space => dict(DictSpace::new([(obs_key, space), (render_key, pixels)]))?,
        };
        let obs_key = (!render_only).then(|| obs_key.to_owned());
        let render_key = render_key.to_owned();
        Ok(Self { env, space, shape, render_key, obs_key, extends_dict, inner: Value::Null })
    }

    fn observe(&mut self, out: &mut Value) -> Result<()> {
        let frame = frame(&mut self.env)?;
        if [frame.height() as usize, frame.width() as usize] != self.shape[..2] {
            return Err(Error::Contract("the size of the rendered picture has changed".into()));
        }
        let Space::Dict(space) = &self.space else {
            return self.draw_into(&frame, out);
        };
        if !matches!(out, Value::Dict(entries) if entries.len() == space.spaces().len()) {
            *out = Value::Dict(space.spaces().iter().map(|(key, _)| (key.clone(), Value::Null)).collect());
        }
        let Value::Dict(entries) = out else { return Ok(()) };
        for ((name, value), (key, _)) in entries.iter_mut().zip(space.spaces()) {
            name.clone_from(key);
            if *key == self.render_key {
                self.draw_into(&frame, value)?;
            } else if self.extends_dict {
                let lacking = || Error::Contract(format!("the observation lacks the key {key:?}"));
                value.clone_from(self.inner.get(key).ok_or_else(lacking)?);
            } else {
                value.clone_from(&self.inner);
            }
        }
        Ok(())
    }

    fn draw_into(&self, frame: &Frame, out: &mut Value) -> Result<()> {
        let array = array_of(out, DType::U8, &self.shape);
        array.as_mut_slice::<u8>().unwrap_or_default().copy_from_slice(frame.pixels());
        Ok(())
    }
}

fn frame<E: Env>(env: &mut E) -> Result<Frame> {
    match env.render()? {
        Rendered::Frame(frame) => Ok(frame),
        _ => Err(Error::UnsupportedMode {
            target: "AddRenderObservation".into(),
            mode: "an observation".into(),
            reason: "it needs single pictures: make the environment with `RenderMode::RgbArray`".into(),
        }),
    }
}

impl<E: Env> crate::Wrapper for AddRenderObservation<E> {
    type Observation = Value;
    type Action = E::Action;

    super::within!(E);

    fn observation_space(&self) -> Space {
        self.space.clone()
    }

    fn reset_into(&mut self, reset: &Reset, observation: &mut Value) -> Result<()> {
        let Self { env, inner, .. } = self;
        E::Observation::fill(inner, |inner| env.reset_into(reset, inner))?;
        self.observe(observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut Value) -> Result<Outcome> {
        let Self { env, inner, .. } = self;
        let outcome = E::Observation::fill(inner, |inner| env.step_into(action, inner))?;
        self.observe(observation)?;
        Ok(outcome)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(
            WrapperSpec::new("AddRenderObservation")
                .arg("render_only", self.obs_key.is_none())
                .arg("render_key", self.render_key.as_str())
                .arg("obs_key", self.obs_key.as_deref().unwrap_or(Self::OBS_KEY)),
        )
    }
}
