//! The commands over this workspace's own environments.

use std::process::ExitCode;

fn main() -> ExitCode {
    xtask_commands::main()
}
