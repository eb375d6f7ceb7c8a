//! The textures of a model.

use serde::{Deserialize, Serialize};

use super::kinds::numbered;

numbered! {
    /// What a texture covers: MuJoCo's `mjtTexture`.
    TextureType, "texture type" {
        /// A rectangle, which is repeated.
        Flat = 0,
        /// A cube around a geom: six square faces, or one for all.
        Cube = 1,
        /// A cube around the model. Pictures do not show it.
        Skybox = 2,
    }
}

/// The textures of a model, with the field names of MuJoCo's `mjModel`. A texture that no material has
/// keeps no pixels: its width and height are 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Textures {
    /// What the texture covers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tex_type: Vec<TextureType>,
    /// Number of rows; of a cube with a face for each side, 6 times the width.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tex_height: Vec<usize>,
    /// Number of columns.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tex_width: Vec<usize>,
    /// Number of bytes of a pixel: 1 grey; 3 red, green, blue; 4 with opacity.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tex_nchannel: Vec<usize>,
    /// Where the texture begins in `tex_data`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tex_adr: Vec<usize>,
    /// The pixels of all textures, row by row from the top.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tex_data: Vec<u8>,
}
