//! Tests through the public interface, in one program that is linked once.

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
