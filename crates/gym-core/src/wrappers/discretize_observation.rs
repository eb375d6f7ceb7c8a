use crate::transform::not_an_array;
use crate::{Array, BoxEnv, Data, Env, Error, Result, Space, Value, WrapperSpec};

use super::observation_wrapper;
use crate::transform::bins::{Bins, Grid};

/// Cuts a bounded `Box` of observations into uniform bins and gives the bin, as one integer or as one
/// for each element.
#[derive(Clone, Debug)]
pub struct DiscretizeObservation<E = BoxEnv> {
    env: E,
    space: Space,
    bins: Bins,
    multidiscrete: bool,
    grid: Grid,
    inner: Value,
}

impl<E: Env> DiscretizeObservation<E> {
    /// Cuts each element of the observations of `env` into bins: `7` for all, `[5, 9]` for each. The
    /// integer counts the combinations in row-major order; with `multidiscrete` there is one for each
    /// element.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless the observations are in a `Box` of finite bounds, there are as
    /// many numbers of bins as elements, and none is 0.
    pub fn new(env: E, bins: impl Into<Bins>, multidiscrete: bool) -> Result<Self> {
        let (inner, bins) = (env.observation_space(), bins.into());
        let inner = super::expect_box("DiscretizeObservation", "observation", &inner)?;
        let refuse = |error: Error| Error::argument("DiscretizeObservation", error.to_string());
        let grid = Grid::new(inner, &bins).map_err(refuse)?;
        let space = grid.space(multidiscrete).map_err(refuse)?;
        Ok(Self { env, space, bins, multidiscrete, grid, inner: Value::Null })
    }

    /// The lower and upper edges of the bin that an observation names, one of each for each element.
    ///
    /// # Errors
    /// [`Error::NotInSpace`] if it is not an element of the observation space.
    pub fn revert_observation(&self, observation: &Value) -> Result<(Array, Array)> {
        self.space.check(observation)?;
        let (mut lows, mut highs) = (vec![0.0; self.grid.len()], vec![0.0; self.grid.len()]);
        self.grid.split(observation, |i, bin| (lows[i], highs[i]) = self.grid.edges(i, bin));
        let array = |numbers: Vec<f64>| {
            Array::new([self.grid.len()], Data::from_f64(self.grid.inner().dtype(), numbers))
        };
        Ok((array(lows)?, array(highs)?))
    }

    fn observe(&self, out: &mut Value) -> Result<()> {
        match &self.inner {
            Value::Array(array) if array.len() == self.grid.len() => {
                self.grid.join(|i| self.grid.index(i, array.data().get_f64(i)), &self.space, out);
                Ok(())
            }
            other => Err(not_an_array(other)),
        }
    }

    fn stored(&self) -> WrapperSpec {
        WrapperSpec::new("DiscretizeObservation")
            .arg("bins", serde_json::to_value(&self.bins).unwrap_or_default())
            .arg("multidiscrete", self.multidiscrete)
    }
}

observation_wrapper!(DiscretizeObservation);
