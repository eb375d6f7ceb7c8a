//! Uniform bins over the bounds of a box, in numpy's order of operations.

use serde::{Deserialize, Serialize};

use gym_core::registry::WrapperConfig;
use gym_core::spaces::{BoxSpace, Discrete, MAX_ELEMENTS, MultiDiscrete, array_of};
use gym_core::{DType, Error, Result, Space, Value};

use crate::within::expect_box;

/// The number of bins for each element of a `Box`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a number of bins, or a list of them")]
pub enum Bins {
    /// The same number for each element.
    All(u32),
    /// A number for each element, in row-major order.
    Each(Vec<u32>),
}

impl From<u32> for Bins {
    fn from(bins: u32) -> Self {
        Self::All(bins)
    }
}

impl<const N: usize> From<[u32; N]> for Bins {
    fn from(bins: [u32; N]) -> Self {
        Self::Each(bins.into())
    }
}

impl gym_core::ArgumentType for Bins {
    fn kind() -> String {
        "integer or list of integers".into()
    }
}

impl Default for Bins {
    fn default() -> Self {
        Self::All(0)
    }
}

gym_core::arguments! {
    /// The division of a bounded `Box` into bins.
    pub struct Binning {
        /// The number of bins for each element of the bounded `Box`, at least 1.
        pub bins: Bins,
        /// Whether each element has its own integer, instead of one integer for the combination,
        /// counted in row-major order.
        pub multidiscrete: bool = false,
    }
}

impl<B: Into<Bins>> From<(B, bool)> for Binning {
    fn from((bins, multidiscrete): (B, bool)) -> Self {
        Self {
            bins: bins.into(),
            multidiscrete,
        }
    }
}

impl From<u32> for Binning {
    fn from(bins: u32) -> Self {
        (bins, false).into()
    }
}

impl<const N: usize> From<[u32; N]> for Binning {
    fn from(bins: [u32; N]) -> Self {
        (bins, false).into()
    }
}

impl Binning {
    /// The bins of a space of the `kind` "action" or "observation", and the space of their indices.
    /// The error of a space that is not a bounded `Box` names the wrapper of the arguments `C`.
    pub(crate) fn cut<C: WrapperConfig>(&self, kind: &str, space: &Space) -> Result<(Grid, Space)> {
        let refuse = |error: Error| C::refuse(error.to_string());
        let grid = Grid::new(expect_box::<C>(kind, space)?, &self.bins).map_err(refuse)?;
        let indices = grid.space(self.multidiscrete).map_err(refuse)?;
        Ok((grid, indices))
    }
}

/// The bins of each element.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    inner: BoxSpace,
    /// For each element, the edges of its bins: n + 1 edges for n bins.
    edges: Vec<Vec<f64>>,
}

impl Grid {
    pub(crate) fn new(inner: &BoxSpace, bins: &Bins) -> Result<Self> {
        if !inner.is_bounded() {
            return Err(Error::custom(format!(
                "bins need finite bounds, and the space is {inner}"
            )));
        }
        let len = inner.low().len();
        let counts = match bins {
            Bins::All(n) => vec![*n; len],
            Bins::Each(counts) => counts.clone(),
        };
        if counts.len() != len {
            return Err(Error::custom(format!(
                "bins are given for {} of {len} elements",
                counts.len()
            )));
        }
        if counts.contains(&0) {
            return Err(Error::custom(
                "bins is 0 for an element: it must be at least 1",
            ));
        }
        if let Some(n) = counts.iter().find(|n| **n as usize > MAX_ELEMENTS) {
            return Err(Error::custom(format!(
                "bins is {n} for an element: at most {MAX_ELEMENTS} are possible"
            )));
        }
        let bounds = inner.low().iter_f64().zip(inner.high().iter_f64());
        let edges = bounds
            .zip(&counts)
            .map(|((low, high), n)| linspace(low, high, *n, inner.dtype()));
        Ok(Self {
            inner: inner.clone(),
            edges: edges.collect(),
        })
    }

    /// The space of indices: `Discrete` over all combinations, or one integer for each element.
    pub(crate) fn space(&self, multidiscrete: bool) -> Result<Space> {
        let mut counts = (0..self.len()).map(|i| self.count(i));
        if multidiscrete {
            return Ok(MultiDiscrete::new(counts.collect::<Vec<i64>>())?.into());
        }
        let n = counts.try_fold(1i64, i64::checked_mul);
        let n = n.ok_or_else(|| {
            Error::custom("the number of combinations of bins does not fit int64")
        })?;
        Ok(Discrete::new(n)?.into())
    }

    /// The box that is divided into bins.
    pub(crate) fn inner(&self) -> &BoxSpace {
        &self.inner
    }

    /// The number of numbers in an element.
    pub(crate) fn len(&self) -> usize {
        self.edges.len()
    }

    /// The index of the bin of element `i` that contains `x`; the first or last bin for `x` outside
    /// the bounds.
    pub(crate) fn index(&self, i: usize, x: f64) -> i64 {
        let (low, high) = (
            self.inner.low().data().get_f64(i),
            self.inner.high().data().get_f64(i),
        );
        // Gymnasium lowers the bound by this margin; in float32, rounding removes the margin unless
        // the bound is small
        const MARGIN: f64 = 1e-8;
        let high = match self.inner.dtype() {
            DType::F32 => f64::from(high as f32 - MARGIN as f32),
            _ => high - MARGIN,
        };
        let x = if x < low { low } else { x };
        let x = if x > high { high } else { x };
        let edges = &self.edges[i];
        // numpy's `digitize`: the number of inner edges that are at most `x`; for NaN, all of them
        edges[1..edges.len() - 1]
            .iter()
            .filter(|edge| x >= **edge || x.is_nan())
            .count() as i64
    }

    /// The edges of a bin of element `i`; an index outside the range means the nearest bin.
    pub(crate) fn edges(&self, i: usize, bin: i64) -> (f64, f64) {
        let edges = &self.edges[i];
        let bin = bin.clamp(0, edges.len() as i64 - 2) as usize;
        (edges[bin], edges[bin + 1])
    }

    /// The middle of a bin of the element `i`.
    pub(crate) fn center(&self, i: usize, bin: i64) -> f64 {
        let (low, high) = self.edges(i, bin);
        match self.inner.dtype() {
            DType::F32 => f64::from(0.5 * (low as f32 + high as f32)),
            _ => 0.5 * (low + high),
        }
    }

    /// The number of bins of element `i`.
    pub(crate) fn count(&self, i: usize) -> i64 {
        self.edges[i].len() as i64 - 1
    }

    /// Calls `visit` for each element with its bin in `value`, an element of
    /// [`space`](Self::space).
    pub(crate) fn split(&self, value: &Value, mut visit: impl FnMut(usize, i64)) {
        match value {
            Value::Int(index) => {
                let mut index = *index;
                for i in (0..self.len()).rev() {
                    visit(i, index.rem_euclid(self.count(i)));
                    index = index.div_euclid(self.count(i));
                }
            }
            value => {
                let bins = value.as_slice::<i64>().unwrap_or_default();
                bins.iter()
                    .take(self.len())
                    .enumerate()
                    .for_each(|(i, bin)| visit(i, *bin));
            }
        }
    }

    /// Writes to `out` the element of [`space`](Self::space) that has the bin `bin(i)` for each
    /// element `i`.
    pub(crate) fn join(&self, bin: impl Fn(usize) -> i64, space: &Space, out: &mut Value) {
        if let Space::MultiDiscrete(space) = space {
            let array = array_of(out, space.dtype(), space.shape());
            let bins = array.as_mut_slice::<i64>().unwrap_or_default();
            bins.iter_mut()
                .enumerate()
                .for_each(|(i, out)| *out = bin(i));
        } else {
            *out = Value::Int((0..self.len()).fold(0, |flat, i| flat * self.count(i) + bin(i)));
        }
    }
}

/// numpy's `linspace(low, high, bins + 1)`: `float32` for `float32` bounds, else `float64`.
fn linspace(low: f64, high: f64, bins: u32, dtype: DType) -> Vec<f64> {
    let point = |i: u32| {
        if i == bins {
            return high;
        }
        if dtype == DType::F32 {
            let (low, delta, i, bins) =
                (low as f32, high as f32 - low as f32, i as f32, bins as f32);
            let step = delta / bins;
            let offset = if step == 0.0 {
                i / bins * delta
            } else {
                i * step
            };
            return f64::from(offset + low);
        }
        let (delta, i, bins) = (high - low, f64::from(i), f64::from(bins));
        let step = delta / bins;
        let offset = if step == 0.0 {
            i / bins * delta
        } else {
            i * step
        };
        offset + low
    };
    (0..=bins).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(bins: impl Into<Bins>) -> Grid {
        Grid::new(
            &BoxSpace::new([0.0f32, -1.0], [1.0, 1.0]).unwrap(),
            &bins.into(),
        )
        .unwrap()
    }

    #[test]
    fn bins_are_numpys() {
        // np.linspace(np.float32(-1.2), np.float32(0.6), 8)
        let expected = [
            -1.2f32,
            -0.94285715,
            -0.6857143,
            -0.42857146,
            -0.17142856,
            0.08571434,
            0.34285712,
            0.6,
        ];
        let low = f64::from(-1.2f32);
        assert_eq!(
            linspace(low, f64::from(0.6f32), 7, DType::F32),
            expected.map(f64::from)
        );
        let grid = grid([4, 1]);
        let indices = [-7.0, 0.0, 0.25, 0.3, 1.0, 7.0, f64::NAN].map(|x| grid.index(0, x));
        assert_eq!(indices, [0, 0, 1, 1, 3, 3, 3]);
        assert_eq!(grid.index(1, 0.5), 0);
        assert_eq!(grid.center(0, 1), 0.375);
    }

    #[test]
    fn combined_indices_come_apart_again() {
        let grid = grid([4, 3]);
        let space = grid.space(false).unwrap();
        assert_eq!(space.to_string(), "Discrete(12)");
        for flat in 0..12 {
            let mut bins = [0; 2];
            grid.split(&Value::Int(flat), |i, bin| bins[i] = bin);
            let mut joined = Value::Null;
            grid.join(|i| bins[i], &space, &mut joined);
            assert_eq!(joined, Value::Int(flat));
        }
        assert_eq!(
            grid.space(true).unwrap().to_string(),
            "MultiDiscrete([4 3])"
        );
        let space = BoxSpace::new([0.0f32; 2], [f32::INFINITY; 2]).unwrap();
        assert!(Grid::new(&space, &Bins::All(2)).is_err());
    }

    /// Gymnasium clips to the upper bound less 1e-8, which is below the lower bound here.
    #[test]
    fn a_box_narrower_than_the_margin_has_one_bin_in_use() {
        let narrow = BoxSpace::uniform(0.0, 1e-9, [1], DType::F64).unwrap();
        let grid = Grid::new(&narrow, &2.into()).unwrap();
        assert_eq!([0.0, 4e-10, 6e-10, 1e-9].map(|x| grid.index(0, x)), [0; 4]);
        let wide = BoxSpace::uniform(0.0, 1.0, [1], DType::F64).unwrap();
        let grid = Grid::new(&wide, &2.into()).unwrap();
        let xs = [
            f64::NEG_INFINITY,
            0.5_f64.next_down(),
            0.5,
            f64::INFINITY,
            f64::NAN,
        ];
        assert_eq!(xs.map(|x| grid.index(0, x)), [0, 0, 1, 1, 1]);
    }
}
