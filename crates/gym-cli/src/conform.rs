//! `cargo xtask conform [ID...]`

use std::process::ExitCode;

use gym::Result;

use crate::workspace::Workspace;

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environments; by default those that this workspace registers.
    ids: Vec<String>,
    /// Checks one environment of each class: leaves one out if a later one of its module and
    /// namespace has all of its arguments.
    #[arg(long, conflicts_with = "ids")]
    sample: bool,
    /// With `--sample`: checks also all environments of crates with files that differ from this
    /// commit.
    #[arg(long, value_name = "COMMIT", requires = "sample")]
    changed_since: Option<String>,
    /// `text`, `json` or `junit`.
    #[arg(long, default_value = "text")]
    format: String,
}

/// Builds this program with the feature `conform`, and runs it.
#[cfg(not(feature = "conform"))]
pub(crate) fn conform(arguments: &Arguments, workspace: &Workspace) -> Result<ExitCode> {
    use std::env;
    use std::process::Command;

    use gym::{Error, registry};

    // these ids are linked in both builds
    for id in &arguments.ids {
        registry::find(id)?;
    }
    // use another profile than this program's, because some systems cannot replace a running file
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .args(["run", "--features", "gym-cli/conform", "--manifest-path"])
        .arg(workspace.manifest())
        .args(["--", "conform", "--format", &arguments.format]);
    if arguments.sample {
        cargo.arg("--sample");
    }
    if let Some(commit) = &arguments.changed_since {
        cargo.args(["--changed-since", commit]);
    }
    cargo.arg("--").args(&arguments.ids);
    let status = cargo
        .status()
        .map_err(|error| Error::custom(format!("cargo cannot be run: {error}")))?;
    // a program that a signal ended has no exit code
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

/// Checks the environments.
#[cfg(feature = "conform")]
pub(crate) fn conform(arguments: &Arguments, workspace: &Workspace) -> Result<ExitCode> {
    use gym::conform::{self, Format, Progress};
    use gym::{Error, Registration};

    use crate::output::{self, tell};
    use crate::sample::{changed_files, sample};

    let format: Format = arguments.format.parse()?;
    let mut registrations = workspace.select(&arguments.ids)?;
    if arguments.sample {
        let changed = match &arguments.changed_since {
            Some(commit) => changed_files(workspace, commit)?,
            None => vec![],
        };
        registrations = sample(registrations, &changed)?;
    }
    let ids: Vec<_> = registrations
        .iter()
        .map(Registration::id)
        .map(str::to_owned)
        .collect();
    let reports = conform::reports_with(&ids, |progress| match progress {
        Progress::Begins { .. } if format != Format::Text => (),
        progress => tell(format_args!("{progress}")),
    })?;
    let text = format.write(&reports);
    if format == Format::Text {
        output::text(&text)?;
    } else {
        // JSON and XML escape control characters themselves
        output::write(format_args!("{text}"))?;
    }
    match reports.iter().filter(|report| !report.passes()).count() {
        0 => Ok(ExitCode::SUCCESS),
        broken => Err(Error::custom(format!(
            "{broken} environments break the rules"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// No build begins for an id that is not registered: without a package in the folder, a build
    /// would fail with an exit code and not with this error.
    #[test]
    fn an_unknown_id_is_an_error_before_the_build() {
        let arguments = Arguments {
            ids: vec!["Nope-v1".to_owned()],
            sample: false,
            changed_since: None,
            format: "text".to_owned(),
        };
        let workspace = Workspace::of(Path::new("no_such_folder"));
        let error = conform(&arguments, &workspace).unwrap_err().to_string();
        assert!(error.contains("Nope"), "{error}");
    }
}
