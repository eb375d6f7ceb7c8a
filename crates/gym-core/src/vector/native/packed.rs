//! How the states of a block lie in memory.

use std::fmt;

use super::LANES;

/// What is kept of an environment's state from step to step.
pub trait Packed: Copy + fmt::Debug + Send + Sync + 'static {
    /// Those of [`LANES`] environments.
    type Block: Clone + fmt::Debug + Send + Sync + 'static;

    /// The same for each environment.
    fn splat(self) -> Self::Block;

    /// That of an environment, below [`LANES`].
    fn get(block: &Self::Block, lane: usize) -> Self;

    /// Overwrites that of an environment, below [`LANES`].
    fn set(self, block: &mut Self::Block, lane: usize);
}

/// A few numbers: the first ones of all environments lie together, then the second ones, ...
impl<const K: usize> Packed for [f64; K] {
    type Block = [[f64; LANES]; K];

    fn splat(self) -> Self::Block {
        self.map(|x| [x; LANES])
    }

    #[inline(always)]
    fn get(block: &Self::Block, lane: usize) -> Self {
        std::array::from_fn(|k| block[k][lane])
    }

    #[inline(always)]
    fn set(self, block: &mut Self::Block, lane: usize) {
        for k in 0..K {
            block[k][lane] = self[k];
        }
    }
}

/// A state in one piece.
#[derive(Clone, Copy, Debug)]
pub struct Whole<S>(pub S);

impl<S: Copy + fmt::Debug + Send + Sync + 'static> Packed for Whole<S> {
    type Block = [S; LANES];

    fn splat(self) -> Self::Block {
        [self.0; LANES]
    }

    #[inline(always)]
    fn get(block: &Self::Block, lane: usize) -> Self {
        Self(block[lane])
    }

    #[inline(always)]
    fn set(self, block: &mut Self::Block, lane: usize) {
        block[lane] = self.0;
    }
}
