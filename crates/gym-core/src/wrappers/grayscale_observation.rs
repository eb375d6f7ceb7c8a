use crate::spaces::{BoxSpace, array_of};
use crate::transform::not_an_array;
use crate::{BoxEnv, DType, Env, Error, Result, Space, Value, WrapperSpec};

use super::observation_wrapper;

/// The shares of red, green and blue in the grey value
/// (`wrappers/transform_observation.py`, `GrayscaleObservation`).
const WEIGHTS: [f64; 3] = [0.2125, 0.7154, 0.0721];

/// Turns colour pictures `(height, width, 3)` into grey ones `(height, width)`.
#[derive(Clone, Debug)]
pub struct GrayscaleObservation<E = BoxEnv> {
    env: E,
    space: Space,
    keep_dim: bool,
    inner: Value,
}

impl<E: Env> GrayscaleObservation<E> {
    /// Turns the observations of `env` grey; with `keep_dim` their shape is `(height, width, 1)`.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless the observations are `uint8` from 0 to 255 of shape
    /// `(height, width, 3)`.
    pub fn new(env: E, keep_dim: bool) -> Result<Self> {
        let inner = env.observation_space();
        let &[height, width, 3] = super::expect_picture("GrayscaleObservation", &inner)?.shape() else {
            let reason = format!("it needs pictures of shape (height, width, 3), and these are {inner}");
            return Err(Error::argument("GrayscaleObservation", reason));
        };
        let shape = if keep_dim { vec![height, width, 1] } else { vec![height, width] };
        let space = BoxSpace::uniform(0.0, 255.0, shape, DType::U8)?.into();
        Ok(Self { env, space, keep_dim, inner: Value::Null })
    }

    fn observe(&self, out: &mut Value) -> Result<()> {
        let pixels = self.inner.as_slice::<u8>().ok_or_else(|| not_an_array(&self.inner))?;
        let array = array_of(out, DType::U8, self.space.shape().unwrap_or_default());
        let grey = array.as_mut_slice::<u8>().unwrap_or_default();
        for (grey, pixel) in grey.iter_mut().zip(pixels.chunks_exact(3)) {
            let [r, g, b] = [0, 1, 2].map(|i| f64::from(pixel[i]) * WEIGHTS[i]);
            *grey = (r + g + b) as u8;
        }
        Ok(())
    }

    fn stored(&self) -> WrapperSpec {
        WrapperSpec::new("GrayscaleObservation").arg("keep_dim", self.keep_dim)
    }
}

observation_wrapper!(GrayscaleObservation);
