//! Fuzz targets. Any input gives a result or an `Err`, and never a panic.
//!
//! The same functions run under libFuzzer, guided by coverage (`cargo +nightly fuzz run --features
//! libfuzzer TARGET`), and under this crate's own runner, which needs only a stable toolchain
//! (`cargo run --package gym-fuzz -- TARGET`).

mod mutate;
pub mod seeds;
pub mod targets;

pub use mutate::Mutator;

/// A fuzz target: a function that must not panic for any input, and seed inputs.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// The name, as in `cargo fuzz run NAME`.
    pub name: &'static str,
    /// Tries an input.
    pub run: fn(&[u8]),
    /// Returns seed inputs that reach deep into the code.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// Every target.
pub const TARGETS: &[Target] = &[
    Target {
        name: "arguments",
        run: targets::arguments,
        seeds: seeds::arguments,
    },
    Target {
        name: "assets",
        run: targets::assets,
        seeds: seeds::assets,
    },
    Target {
        name: "data",
        run: targets::data,
        seeds: seeds::data,
    },
    #[cfg(unix)]
    Target {
        name: "frames",
        run: targets::frames,
        seeds: seeds::frames,
    },
    Target {
        name: "ids",
        run: targets::ids,
        seeds: seeds::ids,
    },
    Target {
        name: "mjcf",
        run: targets::mjcf,
        seeds: seeds::mjcf,
    },
    Target {
        name: "models",
        run: targets::models,
        seeds: seeds::models,
    },
    Target {
        name: "roms",
        run: targets::roms,
        seeds: seeds::roms,
    },
    Target {
        name: "snapshots",
        run: targets::snapshots,
        seeds: seeds::snapshots,
    },
    Target {
        name: "spaces",
        run: targets::spaces,
        seeds: seeds::spaces,
    },
    Target {
        name: "specs",
        run: targets::specs,
        seeds: seeds::specs,
    },
    Target {
        name: "traces",
        run: targets::traces,
        seeds: seeds::traces,
    },
];
