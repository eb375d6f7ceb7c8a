//! The materials of the models, and their colours.

use mujoco_engine::{CompiledModel, Model};

/// The materials that the models use: for the agent, tools, goals, fixtures and the ground.
const LOOK: &str = r#"<mujoco><asset>
  <material name="agent" rgba="0.36 0.55 0.78 1"/><material name="tool" rgba="0.93 0.62 0.22 1"/>
  <material name="goal" rgba="0.82 0.27 0.25 0.7"/><material name="fixture" rgba="0.5 0.53 0.58 1"/>
  <material name="ground" rgba="0.78 0.8 0.83 1"/></asset></mujoco>"#;

/// The colours of the first three materials at a reward of 1.
const LOOK_AT_ONE: [[f64; 4]; 3] = [
    [0.25, 0.72, 0.36, 1.0],
    [0.25, 0.72, 0.36, 1.0],
    [0.82, 0.27, 0.25, 0.35],
];

/// Adds the materials to a text in MJCF that names them without defining them.
pub(crate) fn with_materials(text: &str) -> String {
    let assets = LOOK.trim_end_matches("</mujoco>");
    let body = text.split_once('>').map_or(text, |(_, body)| body);
    format!("{assets}{body}")
}

/// Returns a copy of the model whose colours show `reward`: dm_control's `_set_reward_colors`.
pub(crate) fn coloured(model: &Model, reward: f64) -> Model {
    let mut compiled = CompiledModel::clone(model);
    let square = reward.clamp(0.0, 1.0) * reward.clamp(0.0, 1.0);
    let part = square * square;
    for (colour, at_one) in compiled.mat_rgba.iter_mut().zip(LOOK_AT_ONE) {
        *colour = std::array::from_fn(|k| part * at_one[k] + (1.0 - part) * colour[k]);
    }
    Model::new(compiled).unwrap_or_else(|_| model.clone())
}
