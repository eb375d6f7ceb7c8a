//! Resized pictures.

pub mod area;

use gym_core::registry::WrapperConfig;
use gym_core::spaces::BoxSpace;
use gym_core::{BoxEnv, DType, Result, Space, Value};

use crate::map::{MapObservation, ObservationMap};
use crate::within::{expect_picture, not_an_array};
use area::AreaResize;

/// Resizes images with OpenCV's area filter: the mean of the pixels that each new pixel covers when
/// shrinking, linear interpolation when growing.
pub type ResizeObservation<T = BoxEnv> = MapObservation<T, Resize>;

gym_core::arguments! {
    /// The arguments of [`ResizeObservation`].
    #[derive(Copy)]
    pub struct Config {
        /// The new height and width, at least 1.
        pub shape: [usize; 2],
    }
}

impl From<[usize; 2]> for Config {
    fn from(shape: [usize; 2]) -> Self {
        Self { shape }
    }
}

/// The filter of [`ResizeObservation`].
#[derive(Clone, Debug)]
pub struct Resize(AreaResize);

impl ObservationMap for Resize {
    type Config = Config;

    fn new(
        &Config {
            shape: [height, width],
        }: &Config,
        inner: &Space,
    ) -> Result<(Self, Space)> {
        let shape = expect_picture::<Config>(inner)?.shape();
        let (source, channels) = match *shape {
            [height, width] => ((height, width), 1),
            [height, width, channels] => ((height, width), channels),
            _ => {
                let reason =
                    format!("it needs images with two or three axes, and the space is {inner}");
                return Err(Config::refuse(reason));
            }
        };
        if [height, width, source.0, source.1].contains(&0) {
            let reason = format!("{source:?} to ({height}, {width}): all must be at least 1");
            return Err(Config::refuse(reason));
        }
        let shape = [&[height, width], &shape[2..]].concat();
        let space = BoxSpace::uniform(0.0, 255.0, shape, DType::U8)?;
        Ok((
            Self(AreaResize::new(source, (height, width), channels)),
            space.into(),
        ))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        let source = inner.as_slice::<u8>().filter(|source| self.0.fits(source));
        let (Some(source), Value::Array(out)) = (source, out) else {
            return Err(not_an_array(inner));
        };
        self.0
            .resize(source, out.as_mut_slice::<u8>().unwrap_or_default());
        Ok(())
    }
}

gym_core::register_wrapper!(
    "ResizeObservation", "resizes images with OpenCV's area filter", Config,
    env: ResizeObservation::new, vector: ResizeObservation::new
);
