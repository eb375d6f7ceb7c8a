//! The models of the tasks.

use std::sync::Arc;

use gym_core::{Error, Result};

use mujoco_engine::{Model, Revision};

/// The names and the texts of the built-in models.
const MODELS: [(&str, &str); 13] = [
    ("ant.xml", include_str!("../models/ant.xml")),
    (
        "half_cheetah.xml",
        include_str!("../models/half_cheetah.xml"),
    ),
    ("hopper.xml", include_str!("../models/hopper.xml")),
    ("humanoid.xml", include_str!("../models/humanoid.xml")),
    (
        "humanoidstandup.xml",
        include_str!("../models/humanoidstandup.xml"),
    ),
    (
        "inverted_double_pendulum.xml",
        include_str!("../models/inverted_double_pendulum.xml"),
    ),
    (
        "inverted_pendulum.xml",
        include_str!("../models/inverted_pendulum.xml"),
    ),
    ("pusher.xml", include_str!("../models/pusher.xml")),
    ("pusher_v5.xml", include_str!("../models/pusher_v5.xml")),
    ("reacher.xml", include_str!("../models/reacher.xml")),
    ("swimmer.xml", include_str!("../models/swimmer.xml")),
    ("walker2d.xml", include_str!("../models/walker2d.xml")),
    ("walker2d_v5.xml", include_str!("../models/walker2d_v5.xml")),
];

/// The names and the MJCF texts of the built-in models.
pub fn models() -> impl Iterator<Item = (&'static str, &'static str)> {
    MODELS.into_iter()
}

/// Loads a model for a revision of the engine. `xml_file` is the name of a built-in model, the path
/// of a file (it begins with `.`, `/` or `~`), or the text of a model (it begins with `<`).
///
/// # Errors
/// [`Error::InvalidArgument`] for an unknown name, a file that cannot be read, and one that is not
/// a model.
pub fn load(xml_file: &str, revision: Revision) -> Result<Arc<Model>> {
    if xml_file.starts_with(['<', '.', '/', '~']) {
        return gym_sim::load(xml_file, revision);
    }
    let Some((_, text)) = models().find(|(name, _)| *name == xml_file) else {
        let reason = format!(
            "there is no built-in model {xml_file:?}: the models are {}; a file's path begins with `.`, `/` or `~`",
            MODELS.map(|(name, _)| name).join(", ")
        );
        return Err(Error::argument("xml_file", reason));
    };
    gym_sim::compile(text.trim_start(), revision)
}
