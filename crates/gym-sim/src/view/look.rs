//! How a surface looks: colour, texture and shine, in light.

use gym_core::canvas::Color;

use super::layer::Paint;
use super::light::LIGHT;
use super::surface::Triangles;
use super::texture::Texture;
use mujoco_engine::Model;
use mujoco_engine::math::{Mat3, Vec3, add, normalize};

/// The look of a surface without light.
pub(super) struct Look<'a> {
    /// Multiplies the texture's colours.
    pub(super) color: Paint,
    specular: f32,
    /// The exponent of the shine, from 0 to 128.
    shininess: u32,
    emission: f32,
    texture: Option<Texture<'a>>,
}

/// A look in the picture's light.
pub(super) struct Lit<'a> {
    look: &'a Look<'a>,
    /// Turns normals of the surface to the world.
    turn: [f32; 9],
    /// Directions of the light, to the camera, and half between them.
    light: [f32; 3],
    view: [f32; 3],
    half: [f32; 3],
}

impl<'a> Look<'a> {
    /// A colour with MuJoCo's default shine.
    pub(super) fn plain(color: Color) -> Self {
        Self {
            color: paint_of(color),
            specular: 0.5,
            shininess: 64,
            emission: 0.0,
            texture: None,
        }
    }

    /// A geom of a colour, with its material.
    pub(super) fn of_geom(m: &'a Model, g: usize, color: Color) -> Self {
        let Ok(material) = usize::try_from(m.geom_matid[g]) else {
            return Self::plain(color);
        };
        Self {
            color: paint_of(color),
            specular: m.mat_specular[material].clamp(0.0, 1.0) as f32,
            shininess: (m.mat_shininess[material].clamp(0.0, 1.0) * 128.0) as u32,
            emission: m.mat_emission[material].clamp(0.0, 1.0) as f32,
            texture: Texture::of_geom(m, g, material),
        }
    }

    /// The look of a surface with the frame `mat`, from a direction.
    pub(super) fn in_light(&'a self, mat: &Mat3, towards: Vec3) -> Lit<'a> {
        let (half, _) = normalize(add(LIGHT, towards));
        Lit {
            look: self,
            turn: single(*mat),
            light: single(LIGHT),
            view: single(towards),
            half: single(half),
        }
    }
}

impl Lit<'_> {
    /// The colour of a point of a triangle, from the shares of its corners.
    pub(super) fn paint(&self, triangles: &Triangles<'_>, face: usize, share: [f32; 3]) -> Paint {
        let own = mean(triangles.normals, triangles.face_normals[face], share);
        let row = |k: usize| [self.turn[3 * k], self.turn[3 * k + 1], self.turn[3 * k + 2]];
        let normal = [0, 1, 2].map(|k| dot(row(k), own));
        let length = dot(normal, normal).sqrt().max(f32::MIN_POSITIVE);
        let mut color = self.look.color;
        if let Some(texture) = &self.look.texture {
            let place = mean(triangles.points, triangles.faces[face], share);
            let given = !triangles.texture.is_empty();
            let at = given.then(|| mean(triangles.texture, triangles.face_texture[face], share));
            let paint = texture.at(place, at);
            color = [0, 1, 2, 3].map(|k| color[k] * paint[k]);
        }
        self.shade(color, normal.map(|x| x / length))
    }

    /// A colour of a surface with a normal: in the light from above and, less, from the camera; and
    /// what the light's image adds.
    fn shade(&self, [r, g, b, a]: Paint, normal: [f32; 3]) -> Paint {
        /// The light from everywhere, a little blue.
        const AROUND: [f32; 3] = [0.32, 0.335, 0.37];
        let key = 0.5 + 0.5 * dot(normal, self.light);
        let ahead = dot(normal, self.view).max(0.0);
        let light = 0.46 * key * key + 0.28 * ahead + self.look.emission;
        let shine = power(dot(normal, self.half).max(0.0), self.look.shininess);
        let shine = 0.4 * self.look.specular * shine;
        let lit = |color: f32, k: usize| (color * (AROUND[k] + light) + shine).min(1.0);
        [lit(r, 0), lit(g, 1), lit(b, 2), a]
    }
}

fn single<const N: usize>(numbers: [f64; N]) -> [f32; N] {
    numbers.map(|x| x as f32)
}

/// The mean of the corners of a triangle, by their shares.
fn mean<const N: usize>(all: &[[f32; N]], corners: [u32; 3], share: [f32; 3]) -> [f32; N] {
    let [a, b, c] = corners.map(|corner| &all[corner as usize]);
    std::array::from_fn(|k| share[0] * a[k] + share[1] * b[k] + share[2] * c[k])
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn paint_of(Color { r, g, b, a }: Color) -> Paint {
    [r, g, b, a].map(|x| f32::from(x) / 255.0)
}

/// A number to the power of a whole number, by multiplications.
fn power(mut x: f32, mut exponent: u32) -> f32 {
    let mut result = 1.0;
    while exponent > 0 {
        if exponent & 1 == 1 {
            result *= x;
        }
        x *= x;
        exponent >>= 1;
    }
    result
}
