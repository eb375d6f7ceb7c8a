//! How much faster worlds of the Control Suite step together than one by one: `cargo run --release
//! --package gym-control --example suite_together -- 64 dm_control/cheetah-run-v0`.

use gym_control as _;

#[path = "../../gym-sim/examples/measure/mod.rs"]
mod measure;

fn main() -> Result<(), gym_core::Error> {
    measure::main()
}
