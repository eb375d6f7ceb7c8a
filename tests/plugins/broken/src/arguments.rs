//! Arguments that are read correctly, and others that are not.

use gym_core::{ArgumentType, Configure, Result};
use serde_json::Value as Json;

use crate::{Fault, Walk};

impl ArgumentType for Fault {
    fn kind() -> String {
        String::kind()
    }
}

gym_core::arguments! {
    /// Arguments that are read correctly.
    pub struct Config {
        /// The fault of the environment.
        pub fault: Fault,
    }
}

gym_core::arguments! {
    /// Arguments that accept anything: breaks `arguments-refused`.
    pub struct Careless {
        /// The size of a step, in tenths.
        pub stride: Json = 0.into(),
    }
}

gym_core::arguments! {
    /// Arguments that are read but not used: breaks `arguments-matter`.
    pub struct Ignored {
        /// The speed of an animation.
        pub pace: u32,
        /// The size of a step, in tenths.
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
        /// The number; the twist decides its effect.
        pub number: f64 = 1.0,
    }
}

gym_core::arguments! {
    /// A number that accepts any JSON.
    pub(crate) struct Anything {
        /// A number, or any other JSON.
        pub number: Json = 1.into(),
    }
}

gym_core::arguments! {
    /// A factor of all rewards.
    pub(crate) struct Scale {
        /// The factor.
        pub scale: f64 = 1.0,
    }
}

gym_core::arguments! {
    /// A switch.
    pub(crate) struct Mode {
        /// Whether steps are fast; the twist decides its effect.
        pub fast: bool = false,
    }
}

gym_core::arguments! {
    /// Weights of the reward.
    pub(crate) struct Weights {
        /// The weights.
        pub weights: Vec<f64> = vec![1.0, 2.0],
    }
}

gym_core::arguments! {
    /// A bonus that may be missing.
    pub(crate) struct Bonus {
        /// The bonus; null is a quarter.
        pub bonus: Option<f64> = None,
    }
}
