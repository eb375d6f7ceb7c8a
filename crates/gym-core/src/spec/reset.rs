//! The arguments of `reset`: a seed and options.

use gym_numerics::{Generator, Seed};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value as Json};

use crate::value::{Error, Result};

/// Named reset options or constructor arguments.
pub type Kwargs = Map<String, Json>;

/// Options for the start of an episode. `Reset::default()` continues the generator and uses no
/// options.
///
/// ```
/// use gym_core::Reset;
/// let reset = Reset::seed(42).option("low", -0.1).option("high", 0.1);
/// assert_eq!(reset, Reset::from(42).option("low", -0.1).option("high", 0.1));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reset {
    /// Seeds the generator; `None` continues it (or, the first time, seeds it from the operating
    /// system).
    pub seed: Option<Seed>,
    /// Options of the environment. Unknown names are an error if its registration [names its
    /// options](crate::Registration::reset_options()), and ignored otherwise, as in Gymnasium.
    pub options: Kwargs,
}

impl Reset {
    /// A reset that seeds the generator.
    pub fn seed(seed: impl Into<Seed>) -> Self {
        Self {
            seed: Some(seed.into()),
            options: Kwargs::new(),
        }
    }

    /// Adds an option.
    #[must_use]
    pub fn option(mut self, name: &str, value: impl Into<Json>) -> Self {
        self.options.insert(name.to_owned(), value.into());
        self
    }

    /// The generator of the episode: a new one from the seed; without a seed `last`, the previous
    /// episode's; without both, a new one seeded by the operating system.
    ///
    /// # Errors
    /// The errors of [`Seed::from_os`].
    pub fn generator(&self, last: Option<&Generator>) -> Result<Generator> {
        match (&self.seed, last) {
            (Some(seed), _) => Ok(Generator::new(seed)),
            (None, Some(rng)) => Ok(rng.clone()),
            (None, None) => Ok(Generator::from_os()?),
        }
    }

    /// The options as the environment's own type; missing fields keep their defaults.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a value of the wrong type.
    pub fn options<T: DeserializeOwned>(&self, env: &str) -> Result<T> {
        serde_json::from_value(Json::Object(self.options.clone()))
            .map_err(|error| Error::argument(format!("reset options of {env}"), error.to_string()))
    }
}

impl From<()> for Reset {
    fn from((): ()) -> Self {
        Self::default()
    }
}

impl From<u64> for Reset {
    fn from(seed: u64) -> Self {
        Self::seed(seed)
    }
}

impl From<Seed> for Reset {
    fn from(seed: Seed) -> Self {
        Self::seed(seed)
    }
}

impl From<Option<u64>> for Reset {
    fn from(seed: Option<u64>) -> Self {
        Self {
            seed: seed.map(Seed::from),
            options: Kwargs::new(),
        }
    }
}
