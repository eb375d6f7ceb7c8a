//! `cargo xtask mjcf FILE`

use std::path::PathBuf;

use crate::output::say;
use gym::sim::engine::Model;
use gym::{Error, Result};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// A model in MJCF.
    file: PathBuf,
}

pub(crate) fn mjcf(arguments: &Arguments) -> Result<()> {
    let model =
        Model::from_path(&arguments.file).map_err(|error| Error::custom(error.to_string()))?;
    let figures = model.figures();
    for (name, size) in figures["sizes"].as_object().into_iter().flatten() {
        say(format_args!("{name:9} {size}"))?;
    }
    Ok(())
}
