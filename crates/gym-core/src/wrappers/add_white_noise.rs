use crate::render::Rendered;
use crate::{BoxEnv, Env, Error, Outcome, Reset, Result, WrapperSpec};

use crate::transform::noise;

/// Replaces random pixels of rendered pictures with white noise; around it,
/// [`AddRenderObservation`](super::AddRenderObservation) observes them.
///
/// The draws come from the environment's own [generator](Env::generator), as in Gymnasium: rendering
/// then shifts what the environment draws.
#[derive(Clone, Debug)]
pub struct AddWhiteNoise<E = BoxEnv> {
    env: E,
    probability: f64,
    is_grayscale: bool,
}

super::reach!(AddWhiteNoise<E>);

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
}

impl<E: Env> crate::Wrapper for AddWhiteNoise<E> {
    type Observation = E::Observation;
    type Action = E::Action;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn step_into(&mut self, action: &E::Action, observation: &mut E::Observation) -> Result<Outcome> {
        self.env.step_into(action, observation)
    }

    fn render_into(&mut self, rendered: &mut Rendered) -> Result<()> {
        self.env.render_into(rendered)?;
        let frame = noise::expect_frame("AddWhiteNoise", rendered)?;
        let rng = super::lend(&mut self.env, "AddWhiteNoise")?;
        let white = noise::white(rng, frame, self.is_grayscale);
        noise::cover(frame, &white, |_| rng.random() < self.probability);
        Ok(())
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(
            WrapperSpec::new("AddWhiteNoise")
                .arg("probability_of_noise_per_pixel", self.probability)
                .arg("is_noise_grayscale", self.is_grayscale),
        )
    }
}
