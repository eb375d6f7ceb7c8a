//! `cargo xtask COMMAND`; `cargo xtask help` lists the commands.

use sutton_envs as _; // links the environments

fn main() -> std::process::ExitCode {
    gym_cli::main(env!("CARGO_MANIFEST_DIR"))
}
