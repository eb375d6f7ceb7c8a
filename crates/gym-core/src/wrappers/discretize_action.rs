use crate::{Array, BoxEnv, Element, Env, Error, Outcome, Reset, Result, Space, Value, WrapperSpec};

use crate::transform::bins::{Bins, Grid};

/// Cuts a bounded `Box` of actions into uniform bins and takes the bin, as one integer or as one for
/// each element; the environment gets its middle.
#[derive(Clone, Debug)]
pub struct DiscretizeAction<E = BoxEnv> {
    env: E,
    space: Space,
    bins: Bins,
    multidiscrete: bool,
    grid: Grid,
    inner: Value,
}

super::reach!(DiscretizeAction<E>);

impl<E: Env> DiscretizeAction<E> {
    /// Cuts each element of the actions of `env` into bins: `5` for all, `[5, 9]` for each. The integer
    /// counts the combinations in row-major order; with `multidiscrete` there is one for each element.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] unless the actions are in a `Box` of finite bounds, there are as many
    /// numbers of bins as elements, and none is 0.
    pub fn new(env: E, bins: impl Into<Bins>, multidiscrete: bool) -> Result<Self> {
        let (inner, bins) = (env.action_space(), bins.into());
        let inner = super::expect_box("DiscretizeAction", "action", &inner)?;
        let refuse = |error: Error| Error::argument("DiscretizeAction", error.to_string());
        let grid = Grid::new(inner, &bins).map_err(refuse)?;
        let space = grid.space(multidiscrete).map_err(refuse)?;
        let inner = Value::Array(Array::zeros(inner.dtype(), inner.shape()));
        Ok(Self { env, space, bins, multidiscrete, grid, inner })
    }

    /// The action whose bins have their middle nearest to a continuous action.
    ///
    /// # Errors
    /// [`Error::InvalidAction`] if that has another number of elements.
    pub fn revert_action(&self, action: &E::Action) -> Result<Value> {
        let action = action.to_value();
        let Some(array) = action.as_array().filter(|array| array.len() == self.grid.len()) else {
            return Err(self.env.action_space().refuse_action(&action));
        };
        let nearest = |i: usize| {
            let distance = |bin: &i64| (self.grid.center(i, *bin) - array.data().get_f64(i)).abs();
            (0..self.grid.count(i)).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        let mut out = Value::Null;
        self.grid.join(nearest, &self.space, &mut out);
        Ok(out)
    }
}

impl<E: Env> crate::Wrapper for DiscretizeAction<E> {
    type Observation = E::Observation;
    type Action = Value;

    super::within!(E);

    fn reset_into(&mut self, reset: &Reset, observation: &mut E::Observation) -> Result<()> {
        self.env.reset_into(reset, observation)
    }

    fn action_space(&self) -> Space {
        self.space.clone()
    }

    fn step_into(&mut self, action: &Value, observation: &mut E::Observation) -> Result<Outcome> {
        let Self { env, space, grid, inner, .. } = self;
        if !space.contains(action) {
            return Err(space.refuse_action(action));
        }
        if let Value::Array(array) = inner {
            grid.split(action, |i, bin| array.set_f64(i, grid.center(i, bin)));
        }
        super::act(env, inner, observation)
    }

    fn wrapper_spec(&self) -> Option<WrapperSpec> {
        Some(
            WrapperSpec::new("DiscretizeAction")
                .arg("bins", serde_json::to_value(&self.bins).unwrap_or_default())
                .arg("multidiscrete", self.multidiscrete),
        )
    }
}
