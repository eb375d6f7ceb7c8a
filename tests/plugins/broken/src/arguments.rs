//! Arguments: some ways to read them right, and others to read them wrong.

use gym_core::{Configure, Result};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value as Json};

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

/// No arguments.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Nothing {}

/// One number, which is 1 where it is not given.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Number {
    /// What a twist makes of it.
    pub(crate) number: f64,
}

impl Default for Number {
    fn default() -> Self {
        Self { number: 1.0 }
    }
}

/// A number that is 2 where it is not given, though the default is 1.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TwoDefaults {
    /// What a reward is multiplied by, less one.
    #[serde(default = "one")]
    pub(crate) number: u32,
}

fn one() -> u32 {
    1
}

/// A number of which anything is taken.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Anything {
    /// A number, or whatever comes.
    pub(crate) number: Json,
}

impl Default for Anything {
    fn default() -> Self {
        Self { number: 1.into() }
    }
}

/// A number, with a message that does not tell what arguments there are.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Map<String, Json>")]
pub(crate) struct Silent {
    /// What a reward is multiplied by.
    pub(crate) number: f64,
}

impl Default for Silent {
    fn default() -> Self {
        Self { number: 1.0 }
    }
}

impl TryFrom<Map<String, Json>> for Silent {
    type Error = &'static str;

    fn try_from(map: Map<String, Json>) -> std::result::Result<Self, &'static str> {
        match map.iter().next() {
            None => Ok(Self::default()),
            Some((name, value)) if name == "number" && map.len() == 1 => {
                Ok(Self { number: value.as_f64().ok_or("not so")? })
            }
            _ => Err("not so"),
        }
    }
}
