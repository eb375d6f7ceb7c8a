//! How much faster worlds of mazes step together than one by one: `cargo run --release --package
//! gym-robotics --example mazes_together -- 64 AntMaze_UMaze-v5`.

use gym_robotics as _;

#[path = "../../gym-sim/examples/measure/mod.rs"]
mod measure;

fn main() -> Result<(), gym_core::Error> {
    measure::main()
}
