//! `cargo xtask conform [ID...]`

use gym::conform::{self, Format};
use gym::{Error, Registration, Result};

use crate::selection::Selection;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environments; all that are linked if none is named.
    ids: Vec<String>,
    /// `text`, `json` or `junit`.
    #[arg(long, default_value = "text")]
    format: Format,
}

pub(crate) fn conform(arguments: &Arguments, selection: Selection) -> Result<()> {
    let registrations = selection.of(&arguments.ids)?;
    let ids: Vec<_> = registrations.iter().map(Registration::id).map(str::to_owned).collect();
    let reports = conform::reports_with(&ids, |id| {
        if arguments.format == Format::Text {
            eprintln!("checking {id}");
        }
    })?;
    print!("{}", arguments.format.write(&reports));
    match reports.iter().filter(|report| !report.passes()).count() {
        0 => Ok(()),
        broken => Err(Error::custom(format!("{broken} environments break the rules"))),
    }
}
