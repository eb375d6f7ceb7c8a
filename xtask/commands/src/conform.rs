//! `cargo xtask conform [ID...]`

use gym::{Error, Result};
#[cfg(feature = "conform")]
use gym::{
    Registration,
    conform::{self, Format, Progress},
};

#[cfg(feature = "conform")]
use crate::output::{self, tell};
use crate::selection::Selection;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environments; by default all that are linked.
    ids: Vec<String>,
    /// `text`, `json` or `junit`.
    #[arg(long, default_value = "text")]
    format: String,
}

/// The checks replace the program's allocator, so only a build for `conform` contains them.
#[cfg(not(feature = "conform"))]
pub(crate) fn conform(arguments: &Arguments, _: Selection) -> Result<()> {
    let Arguments { ids, format } = arguments;
    let reason =
        format!("this build has no checks for {ids:?} ({format}): run `cargo xtask conform`");
    Err(Error::custom(reason))
}

#[cfg(feature = "conform")]
pub(crate) fn conform(arguments: &Arguments, selection: Selection) -> Result<()> {
    let format: Format = arguments.format.parse()?;
    let registrations = selection.of(&arguments.ids)?;
    let ids: Vec<_> = registrations
        .iter()
        .map(Registration::id)
        .map(str::to_owned)
        .collect();
    let reports = conform::reports_with(&ids, |progress| match progress {
        Progress::Begins { .. } if format != Format::Text => (),
        progress => tell!("{progress}"),
    })?;
    output::write(format_args!("{}", format.write(&reports)))?;
    match reports.iter().filter(|report| !report.passes()).count() {
        0 => Ok(()),
        broken => Err(Error::custom(format!(
            "{broken} environments break the rules"
        ))),
    }
}
