//! Observations as indices of bins.

use gym_core::{Array, BoxEnv, Data, Result, Space, Value};

use crate::bins::{Binning, Grid};
use crate::map::{MapObservation, ObservationMap};
use crate::within::not_an_array;

/// Cuts a bounded `Box` of observations into uniform bins. An observation is the index of a bin,
/// one integer or one for each element.
pub type DiscretizeObservation<T = BoxEnv> = MapObservation<T, Discretize>;

gym_core::arguments! {
    /// The arguments of [`DiscretizeObservation`].
    pub struct Config {
        /// The bins.
        #[flatten]
        pub binning: Binning,
    }
}

impl<B: Into<Binning>> From<B> for Config {
    fn from(binning: B) -> Self {
        Self {
            binning: binning.into(),
        }
    }
}

gym_core::register_wrapper!(
    "DiscretizeObservation", "cuts observations into uniform bins", Config,
    env: DiscretizeObservation::new, vector: DiscretizeObservation::new
);

/// The bins of [`DiscretizeObservation`].
#[derive(Clone, Debug)]
pub struct Discretize {
    space: Space,
    grid: Grid,
}

impl ObservationMap for Discretize {
    type Config = Config;

    fn new(config: &Config, inner: &Space) -> Result<(Self, Space)> {
        let (grid, space) = config.binning.cut::<Config>("observation", inner)?;
        let map = Self {
            space: space.clone(),
            grid,
        };
        Ok((map, space))
    }

    fn map(&self, inner: &Value, out: &mut Value) -> Result<()> {
        match inner {
            Value::Array(array) if array.len() == self.grid.len() => {
                self.grid.join(
                    |i| self.grid.index(i, array.data().get_f64(i)),
                    &self.space,
                    out,
                );
                Ok(())
            }
            other => Err(not_an_array(other)),
        }
    }
}

impl<T> DiscretizeObservation<T> {
    /// The lower and upper edges of the bin of an observation, for each element.
    ///
    /// # Errors
    /// [`Error::NotInSpace`](gym_core::Error::NotInSpace) if it is not an element of the observation space.
    pub fn revert_observation(&self, observation: &Value) -> Result<(Array, Array)> {
        let Discretize { space, grid } = self.map();
        space.check(observation)?;
        let (mut lows, mut highs) = (vec![0.0; grid.len()], vec![0.0; grid.len()]);
        grid.split(observation, |i, bin| {
            (lows[i], highs[i]) = grid.edges(i, bin);
        });
        let array = |numbers: Vec<f64>| {
            Array::new([grid.len()], Data::from_f64(grid.inner().dtype(), numbers))
        };
        Ok((array(lows)?, array(highs)?))
    }
}
