//! The Atari 2600 in pure Rust, and ale-py's environments on top.
#![forbid(unsafe_code)]
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
mod mt19937;
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
mod words;

pub use action::{Action, Command};
pub use ale::Ale;
pub use env::{AtariAction, AtariEnv, Config, Frameskip, ObsType};
pub use preprocessing::{AtariPreprocessing, Preprocessing};
pub use rom::{Rom, RomDir};
pub use tia::Display;
