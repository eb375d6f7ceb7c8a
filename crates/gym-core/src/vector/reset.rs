use gym_numerics::Seed;
use serde_json::Value as Json;

use crate::spec::{Kwargs, Reset};
use crate::value::{Error, Result};

/// Options for the start of a vector's episodes. `VectorReset::default()` continues all generators.
///
/// ```
/// use gym_core::vector::VectorReset;
/// let reset = VectorReset::from(42).mask([true, false, true]);
/// assert_eq!(reset.of(2).unwrap().seed, Some(44.into()));
/// assert_eq!(reset.of(1), None);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VectorReset {
    /// Seeds of the generators.
    pub seeds: Seeds,
    /// Options for every sub-environment.
    pub options: Kwargs,
    /// The sub-environments to reset, if not all: Gymnasium's option `reset_mask`.
    pub mask: Option<Vec<bool>>,
}

/// Seeds for the sub-environments of a vector.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Seeds {
    /// Each sub-environment continues its generator.
    #[default]
    None,
    /// The seed of the first sub-environment. Each next sub-environment has the seed before, plus
    /// 1.
    From(Seed),
    /// The seed of each sub-environment; `None` continues its generator.
    Each(Vec<Option<Seed>>),
}

impl VectorReset {
    /// A reset with a seed for each sub-environment.
    pub fn seeds<S: Into<Seed>>(seeds: impl IntoIterator<Item = S>) -> Self {
        let seeds = seeds.into_iter().map(|seed| Some(seed.into())).collect();
        Self {
            seeds: Seeds::Each(seeds),
            ..Self::default()
        }
    }

    /// Adds an option.
    #[must_use]
    pub fn option(mut self, name: &str, value: impl Into<Json>) -> Self {
        self.options.insert(name.to_owned(), value.into());
        self
    }

    /// Resets only the sub-environments where `mask` is true.
    #[must_use]
    pub fn mask(self, mask: impl Into<Vec<bool>>) -> Self {
        Self {
            mask: Some(mask.into()),
            ..self
        }
    }

    /// Checks that this is a reset for `n` sub-environments.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for seeds or a mask of another number, or a mask that selects
    /// none.
    pub fn check(&self, n: usize) -> Result<()> {
        let refuse = |reason: String| Err(Error::argument("the reset of a vector", reason));
        match &self.seeds {
            Seeds::Each(seeds) if seeds.len() != n => {
                return refuse(format!(
                    "there are {} seeds for {n} sub-environments",
                    seeds.len()
                ));
            }
            _ => {}
        }
        match &self.mask {
            Some(mask) if mask.len() != n => refuse(format!(
                "the mask has {} entries for {n} sub-environments",
                mask.len()
            )),
            Some(mask) if !mask.contains(&true) => refuse(
                "the mask selects no sub-environment: at least one entry must be true".into(),
            ),
            _ => Ok(()),
        }
    }

    /// Whether a sub-environment is reset.
    pub fn selects(&self, index: usize) -> bool {
        self.mask
            .as_ref()
            .is_none_or(|mask| mask.get(index).copied().unwrap_or(false))
    }

    /// The reset of one sub-environment; `None` if it is left out.
    pub fn of(&self, index: usize) -> Option<Reset> {
        let seed = match &self.seeds {
            Seeds::None => None,
            Seeds::From(seed) => Some(seed.plus(index as u64)),
            Seeds::Each(seeds) => seeds.get(index).cloned().flatten(),
        };
        self.selects(index).then(|| Reset {
            seed,
            options: self.options.clone(),
        })
    }
}

impl From<()> for VectorReset {
    fn from((): ()) -> Self {
        Self::default()
    }
}

impl From<u64> for VectorReset {
    fn from(seed: u64) -> Self {
        Seed::from(seed).into()
    }
}

impl From<Seed> for VectorReset {
    fn from(seed: Seed) -> Self {
        Self {
            seeds: Seeds::From(seed),
            ..Self::default()
        }
    }
}

impl From<Option<u64>> for VectorReset {
    fn from(seed: Option<u64>) -> Self {
        seed.map_or_else(Self::default, Self::from)
    }
}

/// The seeds count up from `seed`, as in `From<u64>`; every sub-environment gets the options.
impl From<Reset> for VectorReset {
    fn from(Reset { seed, options }: Reset) -> Self {
        Self {
            seeds: seed.map_or(Seeds::None, Seeds::From),
            options,
            mask: None,
        }
    }
}
