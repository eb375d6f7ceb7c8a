use crate::spaces::{BoxSpace, array_of};
use crate::transform::not_an_array;
use crate::{BoxEnv, DType, Env, Error, Result, Space, Value, WrapperSpec};

use super::observation_wrapper;
use crate::transform::area::AreaResize;

/// Resizes pictures as OpenCV does with its area filter: the mean over what each new pixel covers
/// where the picture shrinks, linear between pixels where it grows.
#[derive(Clone, Debug)]
pub struct ResizeObservation<E = BoxEnv> {
    env: E,
    space: Space,
    size: (usize, usize),
    filter: AreaResize,
    inner: Value,
}

impl<E: Env> ResizeObservation<E> {
    /// Resizes the observations of `env` to a height and a width.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a size of 0, or unless the observations are `uint8` from 0 to 255
    /// of shape `(height, width)` or `(height, width, channels)`.
    pub fn new(env: E, height: usize, width: usize) -> Result<Self> {
        let refuse = |reason: String| Error::argument("ResizeObservation", reason);
        let inner = env.observation_space();
        let shape = super::expect_picture("ResizeObservation", &inner)?.shape();
        let (source, channels) = match *shape {
            [height, width] => ((height, width), 1),
            [height, width, channels] => ((height, width), channels),
            _ => {
                return Err(refuse(format!("it needs pictures of two or three axes, and these are {inner}")));
            }
        };
        if [height, width, source.0, source.1].contains(&0) {
            return Err(refuse(format!("{source:?} to ({height}, {width}): all must be at least 1")));
        }
        let shape = [&[height, width], &shape[2..]].concat();
        let space = BoxSpace::uniform(0.0, 255.0, shape, DType::U8)?.into();
        let filter = AreaResize::new(source, (height, width), channels);
        Ok(Self { env, space, size: (height, width), filter, inner: Value::Null })
    }

    fn observe(&self, out: &mut Value) -> Result<()> {
        let array = array_of(out, DType::U8, self.space.shape().unwrap_or_default());
        let source = self.inner.as_slice::<u8>().filter(|source| self.filter.fits(source));
        let source = source.ok_or_else(|| not_an_array(&self.inner))?;
        self.filter.resize(source, array.as_mut_slice::<u8>().unwrap_or_default());
        Ok(())
    }

    fn stored(&self) -> WrapperSpec {
        WrapperSpec::new("ResizeObservation").arg("shape", vec![self.size.0, self.size.1])
    }
}

observation_wrapper!(ResizeObservation);
