//! Tests of the crate from outside: one program, which is linked once.

mod adversarial;
mod changes;
mod common;
mod compiled;
mod contacts;
mod episodes;
mod features;
mod mjcf;
mod models;
mod recorded;
mod rewards;
mod simulation;
mod tasks;
mod traces;
mod vectors;
