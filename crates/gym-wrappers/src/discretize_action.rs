//! Actions out of bins.

use gym_core::registry::WrapperConfig;
use gym_core::spaces::array_of;
use gym_core::{BoxEnv, Element, Error, Result, Space, Value};

use crate::bins::{Bins, Grid};
use crate::map::{ActionMap, MapAction};
use crate::within::expect_box;

/// Cuts a bounded `Box` of actions into uniform bins. An action is the index of a bin, one integer
/// or one for each element; the environment receives the bin's centre.
pub type DiscretizeAction<T = BoxEnv> = MapAction<T, Discretize>;

gym_core::arguments! {
    /// The arguments of [`DiscretizeAction`].
    pub struct Config {
        /// The number of bins for each element of the bounded `Box`, at least 1.
        pub bins: Bins,
        /// Whether each element has its own integer, instead of one integer for the combination,
        /// counted in row-major order.
        pub multidiscrete: bool = false,
    }
}

impl<B: Into<Bins>> From<(B, bool)> for Config {
    fn from((bins, multidiscrete): (B, bool)) -> Self {
        Self {
            bins: bins.into(),
            multidiscrete,
        }
    }
}

impl From<u32> for Config {
    fn from(bins: u32) -> Self {
        (bins, false).into()
    }
}

impl<const N: usize> From<[u32; N]> for Config {
    fn from(bins: [u32; N]) -> Self {
        (bins, false).into()
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
        let refuse = |error: Error| Config::refuse(error.to_string());
        let grid =
            Grid::new(expect_box::<Config>("action", inner)?, &config.bins).map_err(refuse)?;
        let space = grid.space(config.multidiscrete).map_err(refuse)?;
        Ok((
            Self {
                space: space.clone(),
                grid,
            },
            space,
        ))
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
    /// [`Error::InvalidAction`] if that has another number of elements.
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
