//! Replaces the module `families` in a program without the feature `families`.

use std::path::Path;

use gym::Result;
use serde_json::{Map, Value as Json};

#[derive(clap::Subcommand)]
pub(crate) enum Command {}

impl Command {
    pub(crate) fn run(self) -> Result<()> {
        match self {}
    }
}

pub(crate) fn compare(_: &str) -> Option<Result<String>> {
    None
}

pub(crate) fn answer(_: &str, _: &Map<String, Json>, _: &Path) -> Result<Option<Vec<u8>>> {
    Ok(None)
}
