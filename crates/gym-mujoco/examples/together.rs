//! How much faster worlds step together than one by one: `cargo run --release --package gym-mujoco
//! --example together -- 64 HalfCheetah-v5`.

use gym_mujoco as _;

#[path = "../../gym-sim/examples/measure/mod.rs"]
mod measure;

fn main() -> Result<(), gym_core::Error> {
    measure::main()
}
