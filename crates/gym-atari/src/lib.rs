//! The Atari 2600 in pure Rust, and ale-py's environments on top.
#![forbid(unsafe_code)]

mod bytes;
mod action;
pub mod cartridge;
pub mod console;
pub mod cpu;
pub mod riot;
mod tia;

pub use tia::Display;
