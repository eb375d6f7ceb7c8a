//! What is drawn over a picture on demand: contacts and their forces, and a body that is pulled.
//!
//! The sizes are those of MuJoCo's viewer: `addContactGeoms` in `src/engine/engine_vis_visualize.c`
//! of MuJoCo (Apache-2.0), with the defaults of `mjVisual`. Nothing hides them: most contacts are
//! inside of shapes.

use gym_core::canvas::{Canvas, Color, Point};
use gym_core::math;

use super::camera::{Camera, NEAR};
use super::{Scene, View};
use mujoco_engine::math::{Vec3, add, add_scaled, norm, rotate_back, scale};
use mujoco_engine::physics::contact_force;
use mujoco_engine::{Contact, Data, Model};

/// The radius of a contact's disc, and the width of a force's arrow, in mean sizes of bodies.
const DISC: f64 = 0.3;
const ARROW: f64 = 0.1;
/// The length in m of the arrow of a force of 1 N, times the mean mass of bodies.
const FORCE: f64 = 0.005;
/// The greatest length of an arrow, in extents of the model.
const LONGEST: f64 = 5.0;
const CORNERS: usize = 16;

const TOUCHING: Color = Color::rgb(230, 140, 30);
/// A contact that is listed, but gives no force.
const APART: Color = Color::rgb(90, 170, 220);
const PUSHING: Color = Color::rgb(200, 30, 60);
const PULLED: Color = Color::rgb(150, 30, 170);

impl View {
    /// Draws contacts as discs, and, if `forces`, their forces as arrows, over a picture that
    /// [`draw`](Self::draw) drew. An arrow points at the body with the greater number; between two
    /// bodies that move, it has two heads. Its length is 5 mm for a newton and a mean mass of 1 kg.
    pub fn draw_contacts(
        &self,
        model: &Model,
        data: &Data,
        size: (u32, u32),
        forces: bool,
        canvas: &mut dyn Canvas,
    ) {
        let scene = &self.scene(model, data, size);
        let unit = unit(model);
        for contact in &data.contact {
            disc(scene, contact, DISC * unit, canvas);
        }
        for contact in data.contact.iter().filter(|_| forces) {
            arrows(scene, contact, ARROW * unit, canvas);
        }
    }

    /// Draws a string from a point of a body to the point that pulls it.
    pub(crate) fn draw_pull(
        &self,
        model: &Model,
        data: &Data,
        size: (u32, u32),
        ends: [Vec3; 2],
        canvas: &mut dyn Canvas,
    ) {
        let scene = &self.scene(model, data, size);
        if let Some([from, to]) = seen(&scene.camera, ends) {
            canvas.line(from, to, 2.5, PULLED);
            canvas.circle(from, 4.0, PULLED);
            canvas.circle(to, 6.0, PULLED.alpha(160));
        }
    }
}

/// The unit of sizes of what is drawn.
fn unit(model: &Model) -> f64 {
    let mean = model.stat.meansize;
    if mean > 0.0 {
        mean
    } else {
        0.05 * model.stat.extent
    }
}

/// Two points in the picture, if both are ahead of the camera.
fn seen(camera: &Camera, ends: [Vec3; 2]) -> Option<[Point; 2]> {
    let ahead = ends.iter().all(|end| camera.depth(*end) >= NEAR);
    ahead.then(|| ends.map(|end| camera.project(end)))
}

fn disc(scene: &Scene<'_>, contact: &Contact, radius: f64, canvas: &mut dyn Canvas) {
    let [_, _, _, x0, x1, x2, y0, y1, y2] = contact.frame;
    let corners: [Vec3; CORNERS] = std::array::from_fn(|i| {
        let angle = i as f64 * std::f64::consts::TAU / CORNERS as f64;
        let (sin, cos) = math::sin_cos(angle);
        let along = add_scaled(contact.pos, [x0, x1, x2], radius * cos);
        add_scaled(along, [y0, y1, y2], radius * sin)
    });
    let camera = &scene.camera;
    if corners.iter().any(|corner| camera.depth(*corner) < NEAR) {
        return;
    }
    let color = if contact.efc_address >= 0 {
        TOUCHING
    } else {
        APART
    };
    // a disc that is seen from the side, or from far away, has a few pixels at least
    let center = camera.project(contact.pos);
    canvas.circle(center, 2.5, color);
    let points = corners.map(|corner| camera.project(corner));
    canvas.polygon(&points, color.alpha(200));
}

fn arrows(scene: &Scene<'_>, contact: &Contact, width: f64, canvas: &mut dyn Canvas) {
    let (model, camera) = (scene.model, &scene.camera);
    let [x, y, z, ..] = contact_force(model, scene.data, contact);
    let mass = model.stat.meanmass;
    // the frame's rows are its axes, so that its transpose turns to the world
    let force = rotate_back(&contact.frame, [x, y, z]);
    let length = norm(force) * FORCE / mass;
    if !(mass > 0.0 && length > 0.0 && length.is_finite()) {
        return;
    }
    let length = length.min(LONGEST * model.stat.extent);
    let bodies = contact.geom.map(|g| model.geom_bodyid[g]);
    let turned = if bodies[0] > bodies[1] { -1.0 } else { 1.0 };
    let vector = scale(force, turned * length / norm(force));
    let width = camera.pixels(width, contact.pos).clamp(2.0, 12.0);
    let both = bodies[0] > 0 && bodies[1] > 0;
    for sign in [1.0, -1.0].into_iter().take(if both { 2 } else { 1 }) {
        let ends = [contact.pos, add(contact.pos, scale(vector, sign))];
        if let Some(ends) = seen(camera, ends) {
            arrow(ends, width, canvas);
        }
    }
}

fn arrow([from, to]: [Point; 2], width: f64, canvas: &mut dyn Canvas) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    if length < 1.0 {
        return;
    }
    let unit = along.map(|x| x / length);
    let head = (3.0 * width).min(length);
    let neck = [to[0] - unit[0] * head, to[1] - unit[1] * head];
    canvas.line(from, neck, width, PUSHING);
    let side = [-unit[1] * head * 0.5, unit[0] * head * 0.5];
    canvas.polygon(
        &[
            to,
            [neck[0] + side[0], neck[1] + side[1]],
            [neck[0] - side[0], neck[1] - side[1]],
        ],
        PUSHING,
    );
}
