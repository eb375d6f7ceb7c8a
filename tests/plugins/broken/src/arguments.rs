//! Arguments: some ways to read them right, and others to read them wrong.

use gym_core::{ArgumentType, Configure, Result};
use serde_json::Value as Json;

use crate::{Fault, Walk};

impl ArgumentType for Fault {
    fn kind() -> String {
        String::kind()
    }
}

gym_core::arguments! {
    /// Read as they should be.
    pub struct Config {
        /// What is wrong.
        pub fault: Fault,
    }
}

gym_core::arguments! {
    /// Accepts whatever comes: breaks `arguments-refused`.
    pub struct Careless {
        /// How long a step is, in tenths.
        pub stride: Json = 0.into(),
    }
}

gym_core::arguments! {
    /// Reads its arguments and does not use them: breaks `arguments-matter`.
    pub struct Ignored {
        /// How fast an animation would be.
        pub pace: u32,
        /// How long a step is, in tenths.
        pub stride: u32,
    }
}

impl Configure for Walk<Ignored> {
    type Config = Ignored;

    fn configure(_: Ignored, _: u32) -> Result<Self> {
        Self::new(Fault::None)
    }
}

impl Configure for Walk<Config> {
    type Config = Config;

    fn configure(config: Config, _: u32) -> Result<Self> {
        Self::new(config.fault)
    }
}

impl Configure for Walk<Careless> {
    type Config = Careless;

    fn configure(_: Careless, _: u32) -> Result<Self> {
        Self::new(Fault::None)
    }
}

gym_core::arguments! {
    /// One number.
    pub(crate) struct Number {
        /// What a twist makes of it.
        pub number: f64 = 1.0,
    }
}

gym_core::arguments! {
    /// A number of which anything is taken.
    pub(crate) struct Anything {
        /// A number, or whatever comes.
        pub number: Json = 1.into(),
    }
}
