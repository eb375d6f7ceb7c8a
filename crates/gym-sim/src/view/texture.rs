//! Textures on surfaces.

use super::layer::Paint;
use mujoco_engine::Model;
use mujoco_engine::model::{GeomType, TextureType};

/// The texture of a geom.
pub(super) struct Texture<'a> {
    kind: TextureType,
    size: [usize; 2],
    channels: usize,
    bytes: &'a [u8],
    /// How often the texture is repeated along texture coordinates.
    repeat: [f32; 2],
    /// Multiplies a point's coordinates where the surface has no texture coordinates.
    scale: [f32; 2],
}

impl<'a> Texture<'a> {
    pub(super) fn of_geom(m: &'a Model, g: usize, material: usize) -> Option<Self> {
        let id = usize::try_from(m.mat_texid[material]).ok()?;
        let (t, size) = (&*m.textures, m.geom_size[g]);
        let (width, height, channels) = (t.tex_width[id], t.tex_height[id], t.tex_nchannel[id]);
        if t.tex_type[id] == TextureType::Skybox || width == 0 || height == 0 {
            return None;
        }
        let [mut repeat, mut scale] = [m.mat_texrepeat[material]; 2];
        for k in 0..2 {
            if repeat[k] <= 0.0 {
                repeat[k] = 1.0;
            }
            // without `texuniform`, the texture is repeated along the geom, not along 1 m
            let whole = match m.geom_type[g] {
                GeomType::Mesh => m.geom_aabb[g][3 + k],
                _ => size[k],
            };
            if m.mat_texuniform[material] {
                repeat[k] *= if size[k] > 0.0 { size[k] } else { 1.0 };
            } else if whole > 0.0 {
                scale[k] /= whole;
            }
        }
        Some(Self {
            kind: t.tex_type[id],
            size: [width, height],
            channels,
            bytes: &t.tex_data[t.tex_adr[id]..][..width * height * channels],
            repeat: repeat.map(|x| x as f32),
            scale: scale.map(|x| x as f32),
        })
    }

    /// The colour at a point of the surface, which may have texture coordinates.
    pub(super) fn at(&self, point: [f32; 3], given: Option<[f32; 2]>) -> Paint {
        match (self.kind, given) {
            (TextureType::Cube, _) => self.on_cube(point),
            (_, Some([u, v])) => {
                self.pixel(0, self.size[1], [u * self.repeat[0], v * self.repeat[1]])
            }
            (_, None) => {
                let [x, y, _] = point;
                let place = [
                    0.5 * self.scale[0] * x - 0.5,
                    -0.5 * self.scale[1] * y - 0.5,
                ];
                self.pixel(0, self.size[1], place)
            }
        }
    }

    /// The colour in a direction: of a cube's face.
    fn on_cube(&self, [x, y, z]: [f32; 3]) -> Paint {
        let [wide, deep, high] = [x.abs(), y.abs(), z.abs()];
        // OpenGL's faces: right, left, up, down, front, back, where y points up
        let (face, across, down, ahead) = if wide >= deep && wide >= high {
            if x > 0.0 {
                (0, -z, -y, wide)
            } else {
                (1, z, -y, wide)
            }
        } else if deep >= high {
            if y > 0.0 {
                (2, x, z, deep)
            } else {
                (3, x, -z, deep)
            }
        } else if z > 0.0 {
            (4, x, -y, high)
        } else {
            (5, -x, -y, high)
        };
        let ahead = ahead.max(f32::MIN_POSITIVE);
        let place = [0.5 + 0.5 * across / ahead, 0.5 + 0.5 * down / ahead];
        let width = self.size[0];
        let first = if self.size[1] == width {
            0
        } else {
            face * width
        };
        self.pixel(first, width, place.map(|x| x.clamp(0.0, 0.999_999)))
    }

    /// The pixel at a place of the rows from `first` on, where both coordinates repeat from 0 to 1.
    fn pixel(&self, first: usize, rows: usize, place: [f32; 2]) -> Paint {
        let [x, y] = place.map(|x| x - x.floor());
        // (the product may be rounded up)
        let column = ((x * self.size[0] as f32) as usize).min(self.size[0] - 1);
        let row = ((y * rows as f32) as usize).min(rows - 1);
        let start = ((first + row) * self.size[0] + column) * self.channels;
        let part = |x: u8| f32::from(x) / 255.0;
        match self.bytes[start..start + self.channels] {
            [grey] => [part(grey), part(grey), part(grey), 1.0],
            [r, g, b] => [part(r), part(g), part(b), 1.0],
            [r, g, b, a] => [part(r), part(g), part(b), part(a)],
            _ => [1.0; 4],
        }
    }
}
