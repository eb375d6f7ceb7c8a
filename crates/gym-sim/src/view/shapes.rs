//! Shaded spheres, capsules and cylinders.
//!
//! A round shape is drawn as nested outlines, from dark to bright, each smaller and nearer to the
//! light. So the shape looks round although each outline has one colour, at any size and in any
//! format.

use gym_core::canvas::{Canvas, Color, Point};

use super::camera::{Camera, NEAR};
use super::light::{LAYERS, LIGHT, blend, lit, shade};
use super::{Scene, color_of, rgba, solids};
use gym_core::math;
use mujoco_engine::math::{Vec3, add, add_scaled, column, dot, scale, sub};
use mujoco_engine::model::{GeomType, WrapType};

const ARC: usize = 14;

/// The difference in depth between a shape's centre and its nearest point.
pub(super) fn nearness(scene: &Scene<'_>, g: usize) -> f64 {
    let [radius, half, _] = scene.model.geom_size[g];
    let axis = dot(column(&scene.data.geom_xmat[g], 2), scene.camera.ahead).abs();
    match scene.model.geom_type[g] {
        GeomType::Capsule | GeomType::Cylinder => radius + 0.3 * half * axis,
        GeomType::Ellipsoid | GeomType::Box => {
            let [x, y, z] = scene.model.geom_size[g];
            x.min(y).min(z)
        }
        _ => radius,
    }
}

/// Draws a geom.
pub(super) fn draw(scene: &Scene<'_>, g: usize, canvas: &mut dyn Canvas) {
    let (camera, model, data) = (&scene.camera, scene.model, scene.data);
    let color = color_of(model, g);
    let [radius, half, _] = model.geom_size[g];
    let center = data.geom_xpos[g];
    let axis = column(&data.geom_xmat[g], 2);
    let ends = [
        add_scaled(center, axis, half),
        add_scaled(center, axis, -half),
    ];
    match model.geom_type[g] {
        GeomType::Sphere => round(camera, [center; 2], radius, color, canvas),
        GeomType::Capsule => round(camera, ends, radius, color, canvas),
        GeomType::Cylinder => cylinder(camera, ends, &data.geom_xmat[g], radius, color, canvas),
        GeomType::Ellipsoid => solids::ellipsoid(scene, g, color, canvas),
        GeomType::Box => solids::cuboid(scene, g, color, canvas),
        _ => {}
    }
}

/// Draws a site as a ball.
pub(super) fn marker(scene: &Scene<'_>, s: usize, canvas: &mut dyn Canvas) {
    let color = rgba(scene.model.site_rgba[s]);
    let (center, radius) = (scene.data.site_xpos[s], scene.model.site_size[s][0]);
    round(&scene.camera, [center; 2], radius, color, canvas);
}

/// The radius and the colour of a spatial tendon: MuJoCo's default `width`, and its colour.
pub(super) const STRING: f64 = 0.003;
pub(super) const STRING_COLOR: Color = Color::rgb(128, 128, 128);

/// Passes the ends of the straight parts of spatial tendons, from site to site.
pub(super) fn each_string(scene: &Scene<'_>, mut draw: impl FnMut([Vec3; 2])) {
    let (model, data) = (scene.model, scene.data);
    let site = |w: usize| match model.wrap_type[w] {
        WrapType::Site => usize::try_from(model.wrap_objid[w]).ok(),
        _ => None,
    };
    for (first, parts) in model.tendon_adr.iter().zip(&model.tendon_num) {
        for w in *first..(first + parts).saturating_sub(1) {
            if let (Some(a), Some(b)) = (site(w), site(w + 1)) {
                draw([data.site_xpos[a], data.site_xpos[b]]);
            }
        }
    }
}

/// Draws the strings of spatial tendons.
pub(super) fn strings(scene: &Scene<'_>, canvas: &mut dyn Canvas) {
    let camera = &scene.camera;
    each_string(scene, |ends| {
        round(camera, ends, STRING, STRING_COLOR, canvas);
    });
}

/// Draws a capsule; if both ends coincide, a sphere.
fn round(camera: &Camera, ends: [Vec3; 2], radius: f64, color: Color, canvas: &mut dyn Canvas) {
    if ends.iter().any(|end| camera.depth(*end) < NEAR + radius) {
        return;
    }
    let light = camera.flat(LIGHT);
    let centers = ends.map(|end| camera.project(end));
    let radii = ends.map(|end| camera.pixels(radius, end));
    // a dark outline separates the shape from its background
    let dark = blend(shade(color, 0.0), Color::BLACK, 0.35);
    outline(centers, radii.map(|r| r + 0.6), dark, canvas);
    for layer in 0..LAYERS {
        let t = layer as f64 / (LAYERS - 1) as f64;
        let shrink = 1.0 - 0.86 * t;
        let shift = 0.46 * t;
        let moved: [Point; 2] = std::array::from_fn(|i| {
            [
                centers[i][0] + light[0] * radii[i] * shift,
                centers[i][1] + light[1] * radii[i] * shift,
            ]
        });
        outline(moved, radii.map(|r| r * shrink), shade(color, t), canvas);
    }
}

/// Fills the hull of two circles.
fn outline([a, b]: [Point; 2], [ra, rb]: [f64; 2], color: Color, canvas: &mut dyn Canvas) {
    let along = [b[0] - a[0], b[1] - a[1]];
    let distance = (along[0] * along[0] + along[1] * along[1]).sqrt();
    if distance <= (ra - rb).abs() + 1e-9 {
        let (center, radius) = if ra >= rb { (a, ra) } else { (b, rb) };
        canvas.circle(center, radius.max(0.0), color);
        return;
    }
    // at these angles, the circles' common tangents touch the circles
    let turn = math::atan2(along[1], along[0]);
    let sine = (ra - rb) / distance;
    let slope = math::atan2(sine, (1.0 - sine.powi(2)).max(0.0).sqrt());
    let quarter = std::f64::consts::FRAC_PI_2;
    let points: [Point; 2 * ARC] = std::array::from_fn(|i| {
        let (center, radius, from, to) = if i < ARC {
            (b, rb, turn - quarter + slope, turn + quarter - slope)
        } else {
            (a, ra, turn + quarter - slope, turn + 3.0 * quarter + slope)
        };
        let angle = from + (to - from) * (i % ARC) as f64 / (ARC - 1) as f64;
        let (sin, cos) = math::sin_cos(angle);
        [center[0] + radius * cos, center[1] + radius * sin]
    });
    canvas.polygon(&points, color);
}

/// Draws a cylinder: its side in strips, shaded by their direction to the light, then the visible
/// end.
fn cylinder(
    camera: &Camera,
    ends: [Vec3; 2],
    mat: &[f64; 9],
    radius: f64,
    color: Color,
    canvas: &mut dyn Canvas,
) {
    const SIDES: usize = 32;
    if ends.iter().any(|end| camera.depth(*end) < NEAR + radius) {
        return;
    }
    let (x, y, z) = (column(mat, 0), column(mat, 1), column(mat, 2));
    let spoke = |i: usize| {
        let (sin, cos) = math::sin_cos(i as f64 * std::f64::consts::TAU / SIDES as f64);
        add(scale(x, cos), scale(y, sin))
    };
    let lit = |normal: Vec3| lit(color, normal);
    let ring = |end: Vec3| -> [Point; SIDES] {
        std::array::from_fn(|i| camera.project(add_scaled(end, spoke(i), radius)))
    };
    let rings = ends.map(ring);
    for i in 0..SIDES {
        let next = (i + 1) % SIDES;
        let normal = spoke(i);
        let towards = sub(camera.pos, add_scaled(ends[0], normal, radius));
        if dot(normal, towards) > 0.0 || dot(spoke(next), towards) > 0.0 {
            let strip = [rings[0][i], rings[0][next], rings[1][next], rings[1][i]];
            canvas.polygon(&strip, lit(normal));
        }
    }
    for (end, normal, ring) in [(ends[0], z, rings[0]), (ends[1], scale(z, -1.0), rings[1])] {
        if dot(normal, sub(camera.pos, end)) > 0.0 {
            canvas.polygon(&ring, lit(normal));
        }
    }
}
