//! Tests of the crate from outside: one program, which is linked once.

mod cartridges;
mod details;
mod environment;
mod episodes;
mod games;
mod lcg;
mod opcodes;
mod programs;
mod recordings;
mod rom;
mod shortcuts;
