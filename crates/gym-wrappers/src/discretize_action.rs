//! Actions as indices of bins.

use gym_core::spaces::array_of;
use gym_core::{BoxEnv, Element, Result, Space, Value};

use crate::bins::{Binning, Grid};
use crate::map::{ActionMap, MapAction};

/// Cuts a bounded `Box` of actions into uniform bins. An action is the index of a bin, one integer
/// or one for each element; the environment receives the bin's centre.
pub type DiscretizeAction<T = BoxEnv> = MapAction<T, Discretize>;

gym_core::arguments! {
    /// The arguments of [`DiscretizeAction`].
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
    "DiscretizeAction", "turns the index of a bin into the action at its centre", Config,
    env: DiscretizeAction::new, vector: DiscretizeAction::new
);

/// The bins of [`DiscretizeAction`].
#[derive(Clone, Debug)]
pub struct Discretize {
    space: Space,
    grid: Grid,
}

impl ActionMap for Discretize {
    type Config = Config;
    type Action<A: Element> = Value;

    fn new(config: &Config, inner: &Space) -> Result<(Self, Space)> {
        let (grid, space) = config.binning.cut::<Config>("action", inner)?;
        let map = Self {
            space: space.clone(),
            grid,
        };
        Ok((map, space))
    }

    fn map<'a>(&self, action: &'a mut Value, buffer: &'a mut Value) -> &'a Value {
        let (grid, inner) = (&self.grid, self.grid.inner());
        let array = array_of(buffer, inner.dtype(), inner.shape());
        grid.split(action, |i, bin| array.set_f64(i, grid.center(i, bin)));
        buffer
    }
}

impl<T> DiscretizeAction<T> {
    /// The action whose bin centres are nearest to a continuous action.
    ///
    /// # Errors
    /// [`Error::InvalidAction`](gym_core::Error::InvalidAction) if the continuous action has
    /// another number of elements.
    pub fn revert_action(&self, action: &impl Element) -> Result<Value> {
        let Discretize { space, grid } = self.map();
        let action = action.to_value();
        let Some(array) = action.as_array().filter(|array| array.len() == grid.len()) else {
            return Err(Space::from(grid.inner().clone()).refuse_action(&action));
        };
        let nearest = |i: usize| {
            let distance = |bin: &i64| (grid.center(i, *bin) - array.data().get_f64(i)).abs();
            (0..grid.count(i))
                .min_by(|a, b| distance(a).total_cmp(&distance(b)))
                .unwrap_or(0)
        };
        let mut out = Value::Null;
        grid.join(nearest, space, &mut out);
        Ok(out)
    }
}
