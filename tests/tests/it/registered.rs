//! What is registered of each environment: spaces, limits, pictures, arguments, names and keys.
//!
//! After an intended change, store the new facts with
//! `GYM_UPDATE_KEPT=1 cargo test --package gym-tests --test it registered`.

use std::fmt::Write;
use std::path::Path;

use gym::{Env, EnvExt, Registration};
use gym_testing::kept;

use super::sample::one_per_module;

/// The facts, a line each.
fn facts(entry: &Registration) -> Result<String, Box<dyn std::error::Error>> {
    let (spec, page) = (entry.spec()?, &entry.page);
    let env = spec.make()?;
    let metadata = env.metadata();
    let modes = metadata.render_modes.iter().map(|mode| mode.name());
    let (limit, threshold) = (spec.max_episode_steps, spec.reward_threshold);
    let mut told = format!("{}: {}\n", entry.id(), entry.description);
    writeln!(told, "  limit {limit:?}, threshold {threshold:?}")?;
    writeln!(told, "  observes {}", env.observation_space())?;
    writeln!(told, "  acts {}", env.action_space())?;
    let modes: Vec<_> = modes.collect();
    let (fps, size) = (metadata.render_fps, metadata.render_size);
    writeln!(
        told,
        "  renders {modes:?}, {fps} frames per second, {size:?}"
    )?;
    for (option, example) in entry.reset_options.0 {
        writeln!(told, "  reset option {option}, as {example}")?;
    }
    for argument in entry.arguments()? {
        let (name, kind, unit) = (argument.name, &argument.kind, argument.unit);
        writeln!(
            told,
            "  argument {name} = {}, {kind} {unit}",
            argument.default
        )?;
    }
    for (action, meaning) in page.actions {
        writeln!(told, "  action {action}: {meaning}")?;
    }
    if let Some(names) = page.names.map(|names| names(&env)) {
        writeln!(told, "  observed: {}", names.observation.join(", "))?;
        writeln!(told, "  acted: {}", names.action.join(", "))?;
    }
    if let Some(keys) = page.keys.map(|keys| keys(&env)) {
        let pressed = keys
            .actions
            .iter()
            .map(|(key, action)| format!("{key} {action}"));
        let pressed: Vec<_> = pressed.collect();
        writeln!(told, "  keys {}; {:?}", pressed.join(", "), keys.idle)?;
    }
    if let Some(policy) = &page.policy {
        writeln!(told, "  policy: {}", policy.description)?;
    }
    let lines = told.lines().map(str::trim_end);
    let lines = lines.filter(|line| !line.is_empty());
    Ok(lines.map(|line| format!("{line}\n")).collect())
}

#[test]
fn what_is_registered_is_as_kept() {
    let all = one_per_module().into_iter();
    let own = all.filter(|entry| entry.source.package.starts_with("gym-"));
    let told: String = own.map(|entry| facts(&entry).unwrap()).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    kept(&folder.join("registered.txt"), &told);
}
