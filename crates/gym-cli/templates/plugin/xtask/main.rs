//! `cargo xtask COMMAND`; `cargo xtask help` lists the commands.

use plugin_name as _; // links its environments

fn main() -> std::process::ExitCode {
    gym_cli::main(env!("CARGO_MANIFEST_DIR"))
}
