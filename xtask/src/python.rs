//! `cargo xtask python --plugin PATH`: the Python package, with the environments of a plugin beside
//! ours.

use std::ffi::OsString;
use std::path::Path;

use crate::plugin::Plugin;
use crate::{say, target_dir};

const USAGE: &str = "\
Writes a Python package: rustgym, with the environments of a crate of yours beside its own

Usage: cargo xtask python --plugin PATH

It prints the command that builds and installs the package with pip. It needs Python 3.10 or later.

Options:
      --plugin PATH   The folder of the crate
  -h, --help          Print help";

/// Runs the command.
pub(crate) fn python(plugin: Option<&Path>, arguments: &[OsString]) -> Result<(), String> {
    if let Some(argument) = arguments.get(1) {
        return match argument.to_str() {
            Some("-h" | "--help") => say(format_args!("{USAGE}")),
            _ => Err(format!(
                "unexpected argument `{}`\n\n{USAGE}",
                argument.display()
            )),
        };
    }
    let plugin = plugin.ok_or("`python` needs a crate: `cargo xtask python --plugin ../my_envs`. Without one, use `pip install ./crates/gym-python`")?;
    let plugin = Plugin::read(plugin)?;
    let package = target_dir()
        .join("plugins")
        .join(format!("{}-python", plugin.name));
    plugin.write_python(&package)?;
    say(format_args!("pip install {}", package.display()))
}
