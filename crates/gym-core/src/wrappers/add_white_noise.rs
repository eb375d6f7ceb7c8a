use crate::render::Rendered;
use crate::{Env, EnvSpec, Error, Result, WrapperSpec};

use crate::transform::noise;

/// Replaces random pixels of rendered pictures with white noise; around it,
/// [`AddRenderObservation`](super::AddRenderObservation) observes them.
///
/// The draws come from the environment's own [generator](Env::generator), as in Gymnasium: rendering
/// then shifts what the environment draws.
#[derive(Clone, Debug)]
pub struct AddWhiteNoise<E> {
    env: E,
    probability: f64,
    is_grayscale: bool,
}

impl<E: Env> AddWhiteNoise<E> {
    /// Replaces each pixel with that probability, by grey noise or by coloured.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a probability outside `[0, 1)`.
    pub fn new(env: E, probability_of_noise_per_pixel: f64, is_noise_grayscale: bool) -> Result<Self> {
        let probability = probability_of_noise_per_pixel;
        if !(0.0..1.0).contains(&probability) {
            let reason = format!("probability_of_noise_per_pixel is {probability}: it must be in [0, 1)");
            return Err(Error::argument("AddWhiteNoise", reason));
        }
        Ok(Self { env, probability, is_grayscale: is_noise_grayscale })
    }

    /// The environment within.
    pub fn into_inner(self) -> E {
        self.env
    }
}

impl<E: Env> Env for AddWhiteNoise<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    fn render(&mut self) -> Result<Rendered> {
        let mut frame = noise::expect_frame("AddWhiteNoise", self.env.render()?)?;
        let rng = super::lend(&mut self.env, "AddWhiteNoise")?;
        let white = noise::white(rng, &frame, self.is_grayscale);
        noise::cover(&mut frame, &white, |_| rng.random() < self.probability);
        Ok(Rendered::Frame(frame))
    }

    fn spec(&self) -> Option<EnvSpec> {
        let wrapper = WrapperSpec::new("AddWhiteNoise")
            .arg("probability_of_noise_per_pixel", self.probability)
            .arg("is_noise_grayscale", self.is_grayscale);
        self.env.spec().map(|spec| spec.wrapped(wrapper))
    }

    crate::forward!(
        env: reset_into, step_into, observation_space, action_space, snapshot, restore, info, metadata, draw, ansi, base, generator,
        close, describe
    );
}
