//! Arguments: one way to read them right, and three ways to read them wrong.

use gym_core::{Configure, Result};
use serde::{Deserialize, Serialize};

use crate::{Fault, Walk};

/// Read as they should be.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// What is wrong.
    pub fault: Fault,
}

/// Writes an argument under another name than it reads: breaks `arguments-round-trip`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Renamed {
    /// How long a step is, in tenths.
    #[serde(rename(serialize = "stride", deserialize = "step_length"))]
    pub stride: u32,
}

/// Ignores names that it does not know: breaks `arguments-refused`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Careless {
    /// How long a step is, in tenths.
    pub stride: u32,
}

/// Reads an argument and leaves it at that: breaks `arguments-matter`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Ignored {
    /// How long a step is, in tenths.
    pub stride: u32,
}

impl Configure for Walk<Ignored> {
    type Config = Ignored;

    fn configure(_: Ignored) -> Result<Self> {
        Self::new(Fault::None)
    }
}

impl Configure for Walk<Config> {
    type Config = Config;

    fn configure(config: Config) -> Result<Self> {
        Self::new(config.fault)
    }
}

impl Configure for Walk<Renamed> {
    type Config = Renamed;

    fn configure(_: Renamed) -> Result<Self> {
        Self::new(Fault::None)
    }
}

impl Configure for Walk<Careless> {
    type Config = Careless;

    fn configure(_: Careless) -> Result<Self> {
        Self::new(Fault::None)
    }
}
