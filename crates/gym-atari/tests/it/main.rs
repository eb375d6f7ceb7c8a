//! The crate's public interface, tested in one program that is linked once.

mod before;
mod cartridges;
mod chips;
mod details;
mod environment;
mod episodes;
mod games;
mod lcg;
mod opcodes;
mod programs;
mod recordings;
mod replays;
mod rom;
mod shortcuts;
