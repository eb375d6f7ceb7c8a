//! The Atari 2600 in pure Rust, and ale-py's environments on top.
//!
//! The processor uses a [`Bus`](cpu::Bus) and knows nothing of the machine. The [console] has a
//! cartridge and inputs, and knows nothing of games. [`ale`] adds the start of a game, the actions,
//! and the RAM addresses of score, lives and end, with one entry of `games/table.rs` per game.
//! [`AtariEnv`] makes an environment of it. Users bring the ROMs.
//!
//! Two shortcuts make it fast. Instructions in ROM are decoded once into blocks that all consoles
//! of the ROM share: each instruction is a function that calls the next one's, compiled from the
//! interpreter for one opcode and one kind of address. And the TIA draws lazily: an object is a
//! mask of 160 pixels, a write changes the rest of the line, and a line is painted at its end or
//! copied from the line above. Skipped frames compute collisions but no colours; if an undrawn
//! picture is needed after all, because a later frame ended early, the frames are replayed.
#![warn(clippy::disallowed_methods)]
// Unit tests register no environment, so that unused code is not compiled into them.
#![cfg_attr(test, allow(dead_code, unused_imports))]

mod action;
pub mod ale;
mod blocks;
mod bytes;
pub mod cartridge;
pub mod check;
pub mod console;
pub mod cpu;
mod dpc;
mod env;
pub mod games;
mod paddle;
pub mod palette;
mod preprocessing;
pub mod recording;
pub mod riot;
pub mod rom;
mod screen;
mod shrink;
mod tia;
mod wires;

pub use action::{Action, Command};
pub use ale::Ale;
pub use env::{AtariAction, AtariEnv, Config, Frameskip, ObsType};
pub use preprocessing::{AtariPreprocessing, Preprocessing};
pub use rom::{Rom, RomDir};
pub use tia::Display;

gym_core::family!(
    gym_core::registry::Family::new("Atari", 50)
        .page("atari.md")
        .needs("ROMs", rom::available)
);

/// The example of the README, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
