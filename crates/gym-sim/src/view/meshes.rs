//! Pictures of models that have meshes or height fields: all shapes as triangles in one [`Layer`], so that each hides
//! what is behind it.

use gym_core::canvas::{Canvas, Color};

use super::layer::{Corner, Layer, Seen, image};
use super::look::Look;
use super::surface::{Surface, Triangles};
use super::{Scene, color_of, floor, is_shown, is_site_shown, rgba, shapes};
use mujoco_engine::Model;
use mujoco_engine::math::{Mat3, Vec3, add_scaled, column, dot, normalize, scale, sub};
use mujoco_engine::model::GeomType;

/// The largest number of samples of a layer.
const MOST: usize = 1 << 24;
/// Samples of a pixel in a row, and rows of samples of a pixel, unless a view has fewer.
pub(super) const FINE: usize = 3;

/// Whether a geom is a mesh or a height field.
pub(super) fn is_mesh(model: &Model, g: usize) -> bool {
    let kind = model.geom_type[g];
    matches!(kind, GeomType::Mesh | GeomType::Hfield) && model.geom_dataid[g] >= 0
}

/// Whether a picture shows a mesh or a height field.
pub(super) fn has_any(model: &Model, max_geom: usize) -> bool {
    let mut geoms = (0..model.ngeom()).take(max_geom);
    geoms.any(|g| is_mesh(model, g) && is_shown(model, g))
}

/// A surface in the picture: where it is, and how it looks.
struct Solid<'a> {
    /// Whether it is a mesh or a height field.
    is_mesh: bool,
    pos: Vec3,
    mat: Mat3,
    /// The radius of a ball around `pos` with all points.
    radius: f64,
    shape: Shape,
    look: Look<'a>,
}

enum Shape {
    Mesh(usize),
    Surface(Surface),
}

/// Draws the geoms but the floor, sites and strings.
pub(super) fn draw(
    scene: &Scene<'_>,
    max_geom: usize,
    floor: Option<usize>,
    canvas: &mut dyn Canvas,
) {
    let (camera, model, data) = (&scene.camera, scene.model, scene.data);
    let solids = solids(scene, max_geom, floor);
    let fine = Size::new(camera.size, canvas.resolution(), scene.samples);
    let focal = [fine.scale[0] * camera.focal, fine.scale[1] * camera.focal];
    let mut layer = Layer::new(fine.pixels, fine.per_pixel, focal);
    if let Some(height) = floor.map(|g| data.geom_xpos[g][2])
        && camera.pos[2] > height
    {
        let mut shadows = Layer::of_depths(fine.pixels, fine.per_pixel, focal);
        for solid in &solids {
            if solid.look.color[3] >= 0.5 && solid.pos[2] + solid.radius > height {
                solid.cast(model, scene, height, &mut shadows);
            }
        }
        let color = floor::SHADOW;
        let shade = |cover: u8| color.alpha((u32::from(cover) * u32::from(color.a) / 255) as u8);
        let pixels: Vec<Color> = shadows.cover().map(shade).collect();
        canvas.image(image(&pixels, layer.width(), camera.size));
        // the floor hides what is below it
        let down = camera.pos[2] - height;
        layer.hide_behind(|[right, up]| {
            -(camera.ahead[2] + camera.right[2] * right + camera.up[2] * up) / down
        });
    }
    let (mut opaque, mut clear): (Vec<&Solid<'_>>, Vec<_>) =
        solids.iter().partition(|solid| solid.look.color[3] >= 1.0);
    // the nearest first: what it hides is not painted
    let order = |solids: &mut Vec<&Solid<'_>>| {
        solids.sort_by(|a, b| camera.depth(a.pos).total_cmp(&camera.depth(b.pos)));
    };
    order(&mut opaque);
    order(&mut clear);
    for solid in opaque.into_iter().chain(clear.into_iter().rev()) {
        solid.paint(model, scene, &mut layer);
    }
    canvas.image(image(&layer.pixels(), layer.width(), camera.size));
}

/// Lowers depths to those of meshes and height fields, sampled at so many columns and rows for a focal length in
/// samples.
pub(super) fn depths(
    scene: &Scene<'_>,
    max_geom: usize,
    (size, focal): ([usize; 2], [f64; 2]),
    depths: &mut [f32],
) {
    let mut layer = Layer::of_depths(size, 1, focal);
    for solid in solids(scene, max_geom, None) {
        if solid.is_mesh {
            solid.paint(scene.model, scene, &mut layer);
        }
    }
    for (depth, found) in depths.iter_mut().zip(layer.depths(f32::INFINITY)) {
        *depth = depth.min(found);
    }
}

/// The sizes of a layer.
struct Size {
    pixels: [usize; 2],
    per_pixel: usize,
    /// Pixels for a unit of the drawing.
    scale: [f64; 2],
}

impl Size {
    /// For a drawing of a size of which each unit becomes `resolution` pixels; fewer, if these are
    /// too many.
    fn new(size: [f64; 2], resolution: f64, samples: usize) -> Self {
        let area = (size[0] * size[1]).max(1.0);
        let most = (MOST as f64 / area).sqrt();
        let resolution = resolution.clamp(1.0 / 64.0, most);
        let pixels = size.map(|side| ((side * resolution).round() as usize).clamp(1, MOST));
        let fits = |n: &usize| pixels[0] * pixels[1] * n * n <= MOST;
        let per_pixel = (1..=samples).rev().find(fits).unwrap_or(1);
        let scale = [0, 1].map(|k| pixels[k] as f64 / size[k].max(1.0));
        Self {
            pixels,
            per_pixel,
            scale,
        }
    }
}

fn solids<'a>(scene: &Scene<'a>, max_geom: usize, floor: Option<usize>) -> Vec<Solid<'a>> {
    let (model, data) = (scene.model, scene.data);
    let mut solids = Vec::new();
    for g in (0..model.ngeom()).take(max_geom) {
        if floor == Some(g) || !is_shown(model, g) {
            continue;
        }
        let (kind, size) = (model.geom_type[g], model.geom_size[g]);
        let shape = match kind {
            GeomType::Mesh | GeomType::Hfield => match usize::try_from(model.geom_dataid[g]) {
                Ok(id) if kind == GeomType::Mesh => Shape::Mesh(id),
                Ok(id) => Shape::Surface(Surface::of_hfield(&model.hfields, id)),
                Err(_) => continue,
            },
            _ => Shape::Surface(Surface::of_shape(kind, size)),
        };
        let radius = match kind {
            GeomType::Plane => size[0].hypot(size[1]),
            _ => model.geom_rbound[g],
        };
        solids.push(Solid {
            is_mesh: is_mesh(model, g),
            pos: data.geom_xpos[g],
            mat: data.geom_xmat[g],
            radius,
            shape,
            look: Look::of_geom(model, g, color_of(model, g)),
        });
    }
    for s in (0..model.nsite()).filter(|s| is_site_shown(model, *s)) {
        let radius = model.site_size[s][0];
        solids.push(Solid {
            is_mesh: false,
            pos: data.site_xpos[s],
            mat: data.site_xmat[s],
            radius,
            shape: Shape::Surface(Surface::of_shape(GeomType::Sphere, [radius; 3])),
            look: Look::plain(rgba(model.site_rgba[s])),
        });
    }
    shapes::each_string(scene, |[a, b]| {
        let (along, length) = normalize(sub(a, b));
        let half = length / 2.0;
        solids.push(Solid {
            is_mesh: false,
            pos: add_scaled(b, along, half),
            mat: upright(along),
            radius: half + shapes::STRING,
            shape: Shape::Surface(Surface::of_shape(
                GeomType::Capsule,
                [shapes::STRING, half, 0.0],
            )),
            look: Look::plain(shapes::STRING_COLOR),
        });
    });
    solids
}

/// A frame whose z axis is `z`.
fn upright(z: Vec3) -> Mat3 {
    let near = if z[0].abs() < 0.6 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    let (x, _) = normalize(sub(near, scale(z, dot(near, z))));
    let y = mujoco_engine::math::cross(z, x);
    [x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]]
}

impl Solid<'_> {
    fn triangles<'a>(&'a self, model: &'a Model) -> Triangles<'a> {
        match &self.shape {
            Shape::Mesh(id) => Triangles::of_mesh(model, *id),
            Shape::Surface(surface) => Triangles::of_surface(surface),
        }
    }

    /// Draws the surface.
    fn paint(&self, model: &Model, scene: &Scene<'_>, layer: &mut Layer) {
        let camera = &scene.camera;
        let from = sub(self.pos, camera.pos);
        let axes = [camera.right, camera.up, camera.ahead];
        if layer.misses(axes.map(|axis| dot(axis, from)), self.radius) {
            return;
        }
        let corner = |seen| layer.corner(seen);
        let seen: Vec<Corner> = self.seen(model, axes, from).map(corner).collect();
        let triangles = self.triangles(model);
        let light = self
            .look
            .in_light(&self.mat, normalize(scale(from, -1.0)).0);
        for (i, face) in triangles.faces.iter().enumerate() {
            let corners = face.map(|corner| seen[corner as usize]);
            layer.triangle(corners, |share| light.paint(&triangles, i, share));
        }
    }

    /// Draws the shadow on a floor under a light straight above.
    fn cast(&self, model: &Model, scene: &Scene<'_>, height: f64, layer: &mut Layer) {
        let camera = &scene.camera;
        let from = sub([self.pos[0], self.pos[1], height], camera.pos);
        // the directions without their heights: all points lie on the floor
        let axes = [camera.right, camera.up, camera.ahead];
        let around = axes.map(|axis| dot(axis, from));
        if layer.misses(around, self.radius) {
            return;
        }
        let along = axes.map(|[x, y, _]| [x, y, 0.0]);
        let around = around.map(|x| x as f32);
        let corner = |at: Seen| layer.corner([0, 1, 2].map(|k| at[k] + around[k]));
        let seen: Vec<Corner> = self.seen(model, along, [0.0; 3]).map(corner).collect();
        for face in self.triangles(model).faces {
            layer.triangle(face.map(|corner| seen[corner as usize]), |_| [0.0; 4]);
        }
    }

    /// The points along three directions, from a point that is at `-from` from the surface's.
    fn seen<'a>(
        &'a self,
        model: &'a Model,
        axes: [Vec3; 3],
        from: Vec3,
    ) -> impl Iterator<Item = Seen> + 'a {
        let columns = [0, 1, 2].map(|k| column(&self.mat, k));
        let turn = axes.map(|axis| columns.map(|column| dot(axis, column) as f32));
        let move_by = axes.map(|axis| dot(axis, from) as f32);
        let points = self.triangles(model).points.iter();
        points.map(move |[x, y, z]: &[f32; 3]| {
            [0, 1, 2].map(|k| turn[k][0] * x + turn[k][1] * y + turn[k][2] * z + move_by[k])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::{CameraConfig, View};
    use gym_core::canvas::{Align, Image, Point, Shape, Transform};
    use mujoco_engine::{Data, forward};

    /// A canvas that keeps images.
    #[derive(Default)]
    struct Images(Vec<(usize, Vec<Color>)>);

    impl Canvas for Images {
        fn clear(&mut self, _: Color) {}
        fn fill(&mut self, _: Shape<'_>, _: Color) {}
        fn stroke(&mut self, _: Shape<'_>, _: f64, _: Color) {}
        fn text(&mut self, _: &str, _: Point, _: f64, _: Align, _: Color) {}
        fn push(&mut self, _: Transform) {}
        fn pop(&mut self) {}
        fn image(&mut self, image: Image<'_>) {
            self.0.push((image.width, image.pixels.to_vec()));
        }
    }

    /// A cube as a mesh above a floor, with other geoms, seen from above.
    fn seen(geoms: &str) -> (View, Model, Data) {
        let text = format!(
            r#"<mujoco><asset><mesh name="cube" vertex="-1 -1 -1 1 -1 -1 1 1 -1 -1 1 -1 -1 -1 1 1 -1 1 1 1 1 -1 1 1"/></asset>
            <worldbody><geom type="plane" size="0 0 1"/>{geoms}</worldbody></mujoco>"#
        );
        let model = Model::from_xml(&text).unwrap();
        let mut data = Data::new(&model);
        forward(&model, &mut data);
        let camera = CameraConfig::at([0.0; 3], 12.0, 90.0, -90.0);
        (View::new(&model, &camera).unwrap(), model, data)
    }

    const CUBE: &str = r#"type="mesh" mesh="cube" contype="0" conaffinity="0""#;

    #[test]
    fn shapes_hide_each_other_and_cast_shadows() {
        let sphere = r#"<geom size=".5" pos="0 0 4.5" rgba="1 0 0 1"/>"#;
        let (view, model, data) = seen(&format!(
            "<geom {CUBE} pos=\"0 0 3\" rgba=\"0 0 1 1\"/>{sphere}"
        ));
        let mut canvas = Images::default();
        view.draw(&model, &data, (100, 80), &mut canvas);
        let [(width, shadow), (_, shapes)] = &canvas.0[..] else {
            panic!("{} images", canvas.0.len())
        };
        assert_eq!((*width, shapes.len()), (100, 8000));
        let at = |x: usize, y: usize| shapes[y * 100 + x];
        assert!(at(50, 40).r > 2 * at(50, 40).b, "the sphere is in front");
        assert!(at(40, 40).b > 2 * at(40, 40).r, "the cube");
        assert_eq!(at(5, 5).a, 0);
        let covered = |image: &[Color]| image.iter().filter(|color| color.a > 0).count();
        // the cube's top is 8 m away, its shadow 12 m
        let ratio = covered(shapes) as f64 / covered(shadow) as f64;
        assert!((2.0..2.6).contains(&ratio), "{ratio}");
        assert!(shadow.iter().all(|color| color.a <= floor::SHADOW.a));
    }

    #[test]
    fn depths_of_a_mesh_are_exact_and_hidden_groups_are_not_shown() {
        let box_above = r#"<geom type="box" size="9 9 .1" pos="0 0 6" group="3"/>"#;
        let (view, model, data) = seen(&format!("<geom {CUBE} pos=\"0 0 3\"/>{box_above}"));
        let depths = view.depth(&model, &data, (100, 80));
        assert!(
            (depths[40 * 100 + 50] - 8.0).abs() < 1e-5,
            "{}",
            depths[40 * 100 + 50]
        );
        assert!((depths[0] - 12.0).abs() < 1e-5, "{}", depths[0]);
        // and below the floor
        let (view, model, data) = seen(&format!("<geom {CUBE} pos=\"0 0 -3\"/>"));
        let mut canvas = Images::default();
        view.draw(&model, &data, (100, 80), &mut canvas);
        assert!(
            canvas
                .0
                .iter()
                .all(|(_, pixels)| pixels.iter().all(|color| color.a == 0))
        );
    }

    #[test]
    fn a_layer_has_a_limit() {
        for (size, resolution) in [
            ([480.0, 480.0], 1.0),
            ([480.0; 2], 1e9),
            ([16_384.0; 2], 1.0),
            ([1e-3; 2], 1.0),
        ] {
            let found = Size::new(size, resolution, FINE);
            let samples = found.pixels[0] * found.pixels[1] * found.per_pixel * found.per_pixel;
            assert!((1..=2 * MOST).contains(&samples), "{size:?}: {samples}");
        }
        assert_eq!(Size::new([480.0, 360.0], 2.0, FINE).pixels, [960, 720]);
    }
}
