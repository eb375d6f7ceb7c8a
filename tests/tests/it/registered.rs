//! What is registered of each environment: spec, spaces, pictures, arguments, names and keys.
//!
//! After an intended change, store the new facts with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-tests --test it registered`.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use gym::{BoxEnv, Env, EnvExt, Registration, registry};
use gym_testing::{Digest, kept};

use super::sample::one_per_module;

type Result<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;

/// What an entry of the registry says, a line each.
fn of_entry(told: &mut String, entry: &Registration) -> Result {
    writeln!(told, "{}: {}", entry.id(), entry.description)?;
    writeln!(told, "  spec {}", serde_json::to_string(&entry.spec()?)?)?;
    writeln!(told, "  light step {}", entry.light_step)?;
    if let Some(need) = entry.needs {
        writeln!(told, "  needs {}", need.what)?;
    }
    for (check, reason) in entry.exceptions {
        writeln!(told, "  may fail {check}: {reason}")?;
    }
    for (option, example) in entry.reset_options.0 {
        writeln!(told, "  reset option {option}, as {example}")?;
    }
    for argument in entry.arguments()? {
        let (name, kind, unit) = (argument.name, &argument.kind, argument.unit);
        let (versions, default) = (&argument.versions, &argument.default);
        writeln!(
            told,
            "  argument {name} = {default}, {kind} {unit} {versions}"
        )?;
    }
    let page = &entry.page;
    if let Some(clip) = &page.clip {
        writeln!(told, "  clip {clip:?}")?;
    }
    for (action, meaning) in page.actions {
        writeln!(told, "  action {action}: {meaning}")?;
    }
    if let Some(policy) = &page.policy {
        writeln!(told, "  policy: {}", policy.description)?;
    }
    Ok(())
}

/// What an environment says of itself, a line each.
fn of_env(told: &mut String, entry: &Registration, mut env: BoxEnv) -> Result {
    env.reset(1)?;
    writeln!(told, "  is {}", env.describe())?;
    writeln!(told, "  observes {}", env.observation_space())?;
    writeln!(told, "  acts {}", env.action_space())?;
    writeln!(told, "  {:?}", env.metadata())?;
    if let Some(names) = entry.page.names.map(|names| names(&env)) {
        writeln!(told, "  observed: {}", names.observation.join(", "))?;
        writeln!(told, "  acted: {}", names.action.join(", "))?;
    }
    if let Some(keys) = entry.page.keys.map(|keys| keys(&env)) {
        for (key, action) in &keys.actions {
            writeln!(told, "  key {key} {action}")?;
        }
        writeln!(told, "  idle {:?}", keys.idle)?;
    }
    if let Some(depths) = env.depth((32, 24)) {
        let depths: Vec<_> = depths.into_iter().map(f64::from).collect();
        let mut digest = Digest::default();
        digest.numbers(&depths);
        writeln!(told, "  depths {}", digest.finish())?;
    }
    Ok(())
}

/// The facts of one environment of each module, and digests of those of the others.
#[test]
fn what_is_registered_is_as_kept() {
    let whole = one_per_module();
    let whole: BTreeSet<_> = whole.iter().map(Registration::id).collect();
    let mut all = String::new();
    for entry in registry::all() {
        if !entry.source.package.starts_with("gym-") {
            continue;
        }
        let mut told = String::new();
        of_entry(&mut told, &entry).unwrap();
        if entry.needs.is_none() {
            let env = entry.spec().unwrap().make().unwrap();
            of_env(&mut told, &entry, env).unwrap();
        }
        if whole.contains(entry.id()) {
            let lines = told.lines().map(str::trim_end);
            all.extend(
                lines
                    .filter(|line| !line.is_empty())
                    .flat_map(|line| [line, "\n"]),
            );
        } else {
            let mut digest = Digest::default();
            digest.bytes(told.as_bytes());
            writeln!(all, "{}: {}", entry.id(), &digest.finish()[..16]).unwrap();
        }
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    kept(&folder.join("registered.txt"), &all);
}
