//! The tables of `docs/mujoco-versions.md`: the default version of MuJoCo for each id, and the
//! first step at which two versions differ.

use std::fmt::Write;
use std::path::Path;

use gym::sim::engine::Revision;
use gym::{EnvExt, Error, Registration, Result, Value, builder, registry};

use gym_cli::Document;

use crate::book::{self, Marks};

const PAGE: &str = "docs/mujoco-versions.md";
const MARKS: Marks = [
    "<!-- versions: written by cargo xtask docs -->\n",
    "<!-- end of versions -->\n",
];
const STEPS: usize = 1000;
const SEED: u64 = 0;
/// The versions that the second table compares.
const COMPARED: [Revision; 2] = [Revision::V3_12, Revision::V4_0];
/// The limits of differences in the table; with 0, a difference of one bit counts.
const LIMITS: [f64; 3] = [0.0, 1e-9, 1e-3];

/// Returns the page with the tables of versions and of differences.
pub(crate) fn document(folder: &Path) -> Result<Document> {
    let written = |error: std::fmt::Error| Error::custom(error.to_string());
    let mut text = String::from("| `mujoco` | equal to MuJoCo |\n|---|---|\n");
    for revision in Revision::ALL {
        let versions = match revision.versions() {
            [_, others @ ..] if !others.is_empty() => others.join(", "),
            own => own.join(", "),
        };
        writeln!(text, "| `\"{revision}\"` | {versions} |").map_err(written)?;
    }
    text += "\n| ids | default | any bit | 1e-9 | 1e-3 |\n|---|---|---|---|---|\n";
    // ids of one module with equal differences share a row
    let mut rows: Vec<(&str, String, String)> = Vec::new();
    for registration in registry::self_contained() {
        let id = registration.id();
        let arguments = registration.arguments()?;
        let Some(version) = arguments.iter().find(|argument| argument.name == "mujoco") else {
            continue;
        };
        let default = version.default.as_str().unwrap_or_default();
        let [bit, small, large] = first_differences(&registration)?
            .map(|step| step.map_or("-".to_owned(), |step| step.to_string()));
        let cells = format!("{default} | {bit} | {small} | {large}");
        let module = registration.source.module;
        let same = rows
            .iter_mut()
            .find(|row| row.0 == module && row.2 == cells);
        match same {
            Some((_, ids, _)) => write!(ids, ", `{id}`").map_err(written)?,
            None => rows.push((module, format!("`{id}`"), cells)),
        }
    }
    for (_, ids, cells) in rows {
        writeln!(text, "| {ids} | {cells} |").map_err(written)?;
    }
    book::page(folder, PAGE, MARKS, &text)
}

/// Returns, for each limit, the first step at which an observation or a reward differs by more than
/// the limit. The actions are random; when the episode of the first version ends, both versions are
/// reset. Step 0 is the reset.
fn first_differences(registration: &Registration) -> Result<[Option<usize>; 3]> {
    let made = |revision: &Revision| {
        let builder = builder(registration.id()).arg("mujoco", revision.name());
        builder.build()
    };
    let mut envs = COMPARED.iter().map(made).collect::<Result<Vec<_>>>()?;
    let mut actions = envs[0].action_sampler(SEED)?;
    let mut found = [None; 3];
    let mut compare = |step: usize, seen: [Vec<f64>; 2]| {
        let [a, b] = &seen;
        let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        let most = off.fold(0.0, f64::max);
        for (found, limit) in found.iter_mut().zip(LIMITS) {
            let differs = most > limit || (limit == 0.0 && bits(a) != bits(b));
            *found = found.or(differs.then_some(step));
        }
        found.iter().all(Option::is_some)
    };
    let reset = |envs: &mut [gym::BoxEnv], seed: Option<u64>| -> Result<[Vec<f64>; 2]> {
        let mut seen = envs.iter_mut().map(|env| {
            let observation = match seed {
                Some(seed) => env.reset(seed),
                None => env.reset(()),
            };
            observation.map(|observation| numbers(&observation))
        });
        let mut next = || seen.next().unwrap_or_else(|| Ok(Vec::new()));
        Ok([next()?, next()?])
    };
    compare(0, reset(&mut envs, Some(SEED))?);
    for step in 1..=STEPS {
        let action = actions.sample();
        let (mut seen, mut ended) = ([Vec::new(), Vec::new()], false);
        for (i, (env, seen)) in envs.iter_mut().zip(&mut seen).enumerate() {
            let taken = env.step(&action)?;
            *seen = numbers(&taken.observation);
            seen.push(taken.reward);
            ended |= i == 0 && taken.done();
        }
        if compare(step, seen) {
            break;
        }
        if ended && compare(step, reset(&mut envs, None)?) {
            break;
        }
    }
    Ok(found)
}

/// The numbers of an observation, those of a dict one after the other.
fn numbers(observation: &Value) -> Vec<f64> {
    match observation {
        Value::Dict(parts) => parts.iter().flat_map(|(_, part)| numbers(part)).collect(),
        _ => observation.as_slice::<f64>().unwrap_or_default().to_vec(),
    }
}
