//! Gray pictures.

use gym_core::registry::WrapperConfig;
use gym_core::spaces::BoxSpace;
use gym_core::{BoxEnv, DType, Result, Space, Value};

use crate::map::{MapObservation, ObservationMap};
use crate::within::{expect_picture, not_an_array};

/// The weights of red, green and blue in the gray value (`wrappers/transform_observation.py`,
/// `GrayscaleObservation`).
const WEIGHTS: [f64; 3] = [0.2125, 0.7154, 0.0721];

/// Turns colour images `(height, width, 3)` into grayscale `(height, width)`.
pub type GrayscaleObservation<T = BoxEnv> = MapObservation<T, Grayscale>;

gym_core::arguments! {
    /// The arguments of [`GrayscaleObservation`].
    #[derive(Copy)]
    pub struct Config {
        /// Whether the shape is `(height, width, 1)`.
        pub keep_dim: bool = false,
    }
}

impl From<bool> for Config {
    fn from(keep_dim: bool) -> Self {
        Self { keep_dim }
    }
}

/// The map of [`GrayscaleObservation`].
#[derive(Clone, Copy, Debug)]
pub struct Grayscale;

impl ObservationMap for Grayscale {
    type Config = Config;
    const TAKES_BATCHES: bool = true;

    fn new(config: &Config, inner: &Space) -> Result<(Self, Space)> {
        let &[height, width, 3] = expect_picture::<Config>(inner)?.shape() else {
            let reason =
                format!("it needs images of shape (height, width, 3), and the space is {inner}");
            return Err(Config::refuse(reason));
        };
        let shape = if config.keep_dim {
            vec![height, width, 1]
        } else {
            vec![height, width]
        };
        Ok((
            Self,
            BoxSpace::uniform(0.0, 255.0, shape, DType::U8)?.into(),
        ))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        let (Some(pixels), Value::Array(out)) = (inner.as_slice::<u8>(), out) else {
            return Err(not_an_array(inner));
        };
        let grey = out.as_mut_slice::<u8>().unwrap_or_default();
        for (grey, pixel) in grey.iter_mut().zip(pixels.chunks_exact(3)) {
            let [r, g, b] = [0, 1, 2].map(|i| f64::from(pixel[i]) * WEIGHTS[i]);
            *grey = (r + g + b) as u8;
        }
        Ok(())
    }
}

gym_core::register_wrapper!(
    "GrayscaleObservation", "turns colour images into grayscale", Config,
    env: GrayscaleObservation::new, vector: GrayscaleObservation::new
);
