//! Models from the argument `xml_file`, and those of tasks.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use gym_core::{Error, Result};
use mujoco_engine::{Model, Revision};

/// Loads a model for a revision of the engine. `xml_file` is the path of a file, which begins with
/// `.`, `/` or `~`, or the text of a model, which begins with `<`.
///
/// # Errors
/// [`Error::InvalidArgument`] for a file that cannot be read, and what is not a model.
pub fn load(xml_file: &str, revision: Revision) -> Result<Arc<Model>> {
    let model = if xml_file.starts_with('<') {
        Model::from_xml_with(xml_file, revision)
    } else {
        Model::from_path_with(path(xml_file)?, revision)
    };
    match model {
        Ok(model) => Ok(Arc::new(model)),
        Err(error) => Err(Error::argument("xml_file", error.to_string())),
    }
}

/// The models of [`compile`] by text, for each of [`Revision::ALL`].
static COMPILED: [Mutex<BTreeMap<String, Arc<Model>>>; Revision::ALL.len()] =
    [const { Mutex::new(BTreeMap::new()) }; Revision::ALL.len()];

/// The most compiled models that are kept: more than all tasks have with their default arguments.
const KEPT: usize = 256;

/// Compiles a task's own model, which reads no file, once for all environments.
///
/// # Errors
/// [`Error::InvalidArgument`] for what is not a model.
pub fn compile(text: &str, revision: Revision) -> Result<Arc<Model>> {
    let known = || {
        let compiled = &COMPILED[revision as usize];
        compiled.lock().unwrap_or_else(PoisonError::into_inner)
    };
    if let Some(model) = known().get(text) {
        return Ok(Arc::clone(model));
    }
    let model = load(text, revision)?;
    let mut known = known();
    if known.len() < KEPT {
        known.insert(text.to_owned(), Arc::clone(&model));
    }
    Ok(model)
}

/// Returns the text of a model, to be changed before it is loaded: `xml_file` as in [`load`].
///
/// # Errors
/// [`Error::InvalidArgument`] for a file that cannot be read.
pub fn text(xml_file: &str) -> Result<String> {
    if xml_file.starts_with('<') {
        return Ok(xml_file.to_owned());
    }
    gym_core::file::read_text(&path(xml_file)?, Model::MAX_BYTES).map_err(|error| {
        let reason =
            format!("{xml_file:?}: {error}: give the path of a model in MJCF, or its text");
        Error::argument("xml_file", reason)
    })
}

fn path(xml_file: &str) -> Result<PathBuf> {
    if !xml_file.starts_with(['.', '/', '~']) {
        let reason = format!(
            "{xml_file:?} is no model: a file's path begins with `.`, `/` or `~`, and a text with `<`"
        );
        return Err(Error::argument("xml_file", reason));
    }
    Ok(match (xml_file.strip_prefix("~/"), std::env::home_dir()) {
        (Some(rest), Some(home)) => home.join(rest),
        _ => xml_file.into(),
    })
}
