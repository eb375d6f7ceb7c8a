//! Tests through the public interface, in one program that is linked once.

mod adversarial;
#[path = "../../../mujoco-engine/tests/it/common.rs"]
mod common;
mod episodes;
mod features;
mod models;
mod recorded;
mod rewards;
mod simulation;
mod tasks;
mod together;
mod traces;
mod vectors;
