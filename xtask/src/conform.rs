//! `cargo xtask conform [ID...] [--plugin PATH]`

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use gym::conform::{self, Format};
use gym::{Error, Registration, Result, registry};

use crate::plugin::{self, Plugin, cargo, root};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The environments; all that are linked, or all of the plugin, if none is named.
    ids: Vec<String>,
    /// The folder of a crate with environments of its own; it need not be part of this workspace.
    #[arg(long, value_name = "PATH")]
    plugin: Option<PathBuf>,
    /// `text`, `json` or `junit`.
    #[arg(long, default_value = "text")]
    format: Format,
}

pub(crate) fn conform(arguments: &Arguments) -> Result<()> {
    if let Some(folder) = &arguments.plugin {
        return run_plugin(folder, arguments);
    }
    let mut ids = arguments.ids.clone();
    if ids.is_empty() {
        ids = registry::all().iter().map(Registration::id).map(str::to_owned).collect();
    }
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

/// Builds a program that links the plugin, and runs it.
fn run_plugin(folder: &Path, arguments: &Arguments) -> Result<()> {
    let plugin = Plugin::read(folder)?;
    let runner = plugin::target_dir().join("conform").join(&plugin.name);
    write_runner(&runner, &plugin)?;
    let mut command = Command::new(cargo());
    command.args(["run", "--quiet", "--manifest-path"]).arg(runner.join("Cargo.toml"));
    command.arg("--target-dir").arg(plugin::target_dir()).arg("--");
    let format = match arguments.format {
        Format::Text => "text",
        Format::Json => "json",
        Format::Junit => "junit",
    };
    let status = command.arg(format).args(&arguments.ids).status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) if status.code() == Some(1) => {
            Err(Error::custom(format!("environments of `{}` break the rules", plugin.name)))
        }
        // what went wrong stands above: a build that failed, an unknown id, or the last id that was begun
        Ok(status) => Err(Error::custom(format!("`{}` could not be checked ({status})", plugin.name))),
        Err(error) => Err(Error::custom(format!("cargo cannot be run: {error}"))),
    }
}

fn write_runner(runner: &Path, plugin: &Plugin) -> Result<()> {
    let io = |path: &Path| {
        let path = path.to_owned();
        move |error| Error::io(&path, error)
    };
    let source = runner.join("src");
    fs::create_dir_all(&source).map_err(io(&source))?;
    let manifest = format!(
        "[package]\n\
         name = \"conform-{name}\"\n\
         version = \"0.0.0\"\n\
         edition = \"2024\"\n\
         publish = false\n\
         \n\
         [workspace]\n\
         \n\
         [dependencies]\n\
         {name} = {{ path = {path:?} }}\n\
         gym-core = {core}\n\
         gym-render = {render}\n\
         \n\
         {profile}",
        name = plugin.name,
        path = plugin.folder,
        core = plugin.gym_core.with_features(&["count-allocations"]),
        render = plugin.gym_core.sibling("gym-render").with_features(&[]),
        profile = plugin::PROFILE,
    );
    let main = format!(
        "use gym_render as _;\n\
         use {krate} as _;\n\
         \n\
         fn main() {{\n    \
             std::process::exit(check().unwrap_or_else(|error| {{\n        \
                 eprintln!(\"error: {{error}}\");\n        \
                 2\n    \
             }}));\n\
         }}\n\
         \n\
         fn check() -> Result<i32, Box<dyn std::error::Error>> {{\n    \
             use gym_core::conform::{{self, Format, Report}};\n    \
             let mut arguments = std::env::args().skip(1);\n    \
             let format: Format = arguments.next().unwrap_or_default().parse()?;\n    \
             let mut ids: Vec<String> = arguments.collect();\n    \
             if ids.is_empty() {{\n        \
                 ids = conform::ids_of({name:?});\n    \
             }}\n    \
             if ids.is_empty() {{\n        \
                 return Err(\"the crate registers no environment: put `gym_core::register!(...)` at its top level\".into());\n    \
             }}\n    \
             let begin = |id: &str| if format == Format::Text {{ eprintln!(\"checking {{id}}\") }};\n    \
             let reports = conform::reports_with(&ids, begin)?;\n    \
             print!(\"{{}}\", format.write(&reports));\n    \
             Ok(i32::from(!reports.iter().all(Report::passes)))\n\
         }}\n",
        krate = plugin.krate,
        name = plugin.name,
    );
    for (path, text) in [(runner.join("Cargo.toml"), manifest), (source.join("main.rs"), main)] {
        // an unchanged file is not built again
        if fs::read_to_string(&path).ok().as_deref() != Some(&text) {
            gym::file::write(&path, text.as_bytes())?;
        }
    }
    let lock = runner.join("Cargo.lock");
    if !lock.exists() {
        // the versions that are there already
        let own = plugin.folder.join("Cargo.lock");
        let known = if own.exists() { own } else { root().join("Cargo.lock") };
        fs::copy(&known, &lock).map_err(io(&known))?;
    }
    Ok(())
}
