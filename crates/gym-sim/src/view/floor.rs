//! Sky, checkered floor, and shadows on it.

use gym_core::canvas::{Canvas, Color, Point, Segment, Shape};

use super::camera::{Camera, NEAR};
use super::light::{blend, lit};
use super::{Scene, color_of, is_shown};
use gym_core::math;
use mujoco_engine::math::{Vec3, add_scaled, column, dot, sub};
use mujoco_engine::model::GeomType;
use mujoco_engine::{Data, Model};

const ZENITH: Color = Color::rgb(96, 142, 190);
const HORIZON: Color = Color::rgb(226, 236, 244);
const BANDS: usize = 32;
/// The number of squares of the floor that are drawn to each side of the focus.
const SQUARES: i64 = 16;
/// The number of steps in which the squares fade out.
const RINGS: usize = 6;
/// The number of corners of a shadow's outline.
const CORNERS: usize = 20;
pub(super) const SHADOW: Color = Color::rgb(24, 34, 52).alpha(88);

/// Covers the picture with a sky that is brightest at the horizon.
pub(super) fn sky(camera: &Camera, canvas: &mut dyn Canvas) {
    canvas.clear(HORIZON);
    let [width, height] = camera.size;
    let horizon = horizon(camera).clamp(0.0, height);
    for band in 0..BANDS {
        let y = horizon * band as f64 / BANDS as f64;
        let color = blend(ZENITH, HORIZON, band as f64 / BANDS as f64);
        canvas.rect([0.0, y], [width, horizon - y], color);
    }
}

/// The y coordinate of the horizon in the picture.
fn horizon(camera: &Camera) -> f64 {
    let level = (camera.ahead[0] * camera.ahead[0] + camera.ahead[1] * camera.ahead[1]).sqrt();
    if level < 1e-3 {
        return 0.0;
    }
    camera.size[1] / 2.0 + camera.focal * camera.ahead[2] / level
}

/// Draws the floor up to the horizon, with dark squares around the focus that fade out.
pub(super) fn draw(scene: &Scene<'_>, g: usize, canvas: &mut dyn Canvas) {
    // at this distance, the squares are too small for `f64` coordinates
    const FARTHEST: f64 = 1e12;
    let (camera, size) = (&scene.camera, scene.model.geom_size[g]);
    let height = scene.data.geom_xpos[g][2];
    let visible = camera.pos[2] > height && camera.focus.iter().all(|x| x.abs() < FARTHEST);
    if !visible {
        return;
    }
    let color = super::rgba(scene.model.geom_rgba[g]);
    let light = blend(color, Color::rgb(206, 216, 226), 0.6);
    let dark = blend(light, Color::rgb(70, 92, 124), 0.32);
    let [width, picture_height] = camera.size;
    let horizon = horizon(camera).clamp(0.0, picture_height);
    canvas.rect([0.0, horizon], [width, picture_height - horizon], light);

    // squares are small for a small model
    let far = camera.pos[2] - height;
    let mut squares = [0.05, 0.1, 0.25, 0.5, 1.0, 2.0, 5.0].into_iter();
    let square = squares.find(|s| *s * 10.0 >= far).unwrap_or(10.0);
    let reach = square * SQUARES as f64;
    let center = [camera.focus[0], camera.focus[1]].map(|x| (x / square).floor() as i64);
    let corner = |i: i64, j: i64| [i as f64 * square, j as f64 * square, height];
    let bounded = |x: f64, half: f64| half <= 0.0 || x.abs() <= half;
    let mut rings: [Vec<Segment>; RINGS] = Default::default();
    let mut polygon = Vec::with_capacity(8);
    for i in center[0] - SQUARES..=center[0] + SQUARES {
        for j in center[1] - SQUARES..=center[1] + SQUARES {
            let middle = [(i as f64 + 0.5) * square, (j as f64 + 0.5) * square];
            let offset = [middle[0] - camera.focus[0], middle[1] - camera.focus[1]];
            let away = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt() / reach;
            let inside = bounded(middle[0], size[0]) && bounded(middle[1], size[1]);
            if (i + j).rem_euclid(2) == 0 || away >= 1.0 || !inside {
                continue;
            }
            let corners = [
                corner(i, j),
                corner(i + 1, j),
                corner(i + 1, j + 1),
                corner(i, j + 1),
            ];
            camera.project_polygon(&corners, &mut polygon);
            if polygon.len() >= 3 && on_screen(&polygon, camera.size) {
                outline(&polygon, &mut rings[(away * away * RINGS as f64) as usize]);
            }
        }
    }
    for (ring, squares) in rings.iter().enumerate() {
        if !squares.is_empty() {
            canvas.fill(
                Shape::Path(squares),
                blend(dark, light, ring as f64 / RINGS as f64),
            );
        }
    }
}

/// Adds a closed contour to a path.
fn outline(polygon: &[Point], path: &mut Vec<Segment>) {
    if let [first, rest @ ..] = polygon {
        path.push(Segment::Move(*first));
        path.extend(rest.iter().map(|point| Segment::Line(*point)));
        path.push(Segment::Close);
    }
}

fn on_screen(polygon: &[Point], [width, height]: [f64; 2]) -> bool {
    let inside = |k: usize, end: f64| {
        polygon.iter().any(|p| p[k] >= 0.0) && polygon.iter().any(|p| p[k] <= end)
    };
    inside(0, width) && inside(1, height)
}

/// Draws the shadows of all shapes under a light straight above, in one shade.
pub(super) fn shadows(scene: &Scene<'_>, height: f64, canvas: &mut dyn Canvas) {
    let (camera, model, data) = (&scene.camera, scene.model, scene.data);
    if camera.pos[2] <= height {
        return;
    }
    let mut path: Vec<Segment> = Vec::new();
    let mut polygon = Vec::new();
    for g in 0..model.ngeom() {
        let center = data.geom_xpos[g];
        let kind = model.geom_type[g];
        let flat = matches!(kind, GeomType::Plane | GeomType::Hfield | GeomType::Mesh);
        if flat || !is_shown(model, g) || color_of(model, g).a < 128 || center[2] < height {
            continue;
        }
        let corners = match model.geom_type[g] {
            GeomType::Box | GeomType::Ellipsoid => solid_outline(model, data, g, height),
            _ => round_outline(model, data, g, height),
        };
        if corners.iter().any(|corner| camera.depth(*corner) < NEAR) {
            continue;
        }
        camera.project_polygon(&corners, &mut polygon);
        outline(&polygon, &mut path);
    }
    if !path.is_empty() {
        canvas.fill(Shape::Path(&path), SHADOW);
    }
}

/// The outline of a capsule's shadow: a half circle around each end. A cylinder's shadow is
/// approximated by the same outline.
fn round_outline(model: &Model, data: &Data, g: usize, height: f64) -> [Vec3; CORNERS] {
    let [radius, half, _] = model.geom_size[g];
    let (center, axis) = (data.geom_xpos[g], column(&data.geom_xmat[g], 2));
    let half = if model.geom_type[g] == GeomType::Sphere {
        0.0
    } else {
        half
    };
    let ends = [
        add_scaled(center, axis, half),
        add_scaled(center, axis, -half),
    ];
    let along = sub(ends[0], ends[1]);
    let turn = math::atan2(along[1], along[0]);
    std::array::from_fn(|i| {
        let end = ends[usize::from(i >= CORNERS / 2)];
        let step = i - if i >= CORNERS / 2 { 1 } else { 0 };
        let angle = turn - std::f64::consts::FRAC_PI_2
            + step as f64 * std::f64::consts::TAU / (CORNERS - 2) as f64;
        let (sin, cos) = math::sin_cos(angle);
        [end[0] + radius * cos, end[1] + radius * sin, height]
    })
}

/// The shadow of a box or an ellipsoid: for each direction, the point that is farthest.
fn solid_outline(model: &Model, data: &Data, g: usize, height: f64) -> [Vec3; CORNERS] {
    let (center, size) = (data.geom_xpos[g], model.geom_size[g]);
    let axes = [0, 1, 2].map(|k| column(&data.geom_xmat[g], k));
    std::array::from_fn(|i| {
        let angle = (i as f64 + 0.5) * std::f64::consts::TAU / CORNERS as f64;
        let (sin, cos) = math::sin_cos(angle);
        let facing = axes.map(|axis| axis[0] * cos + axis[1] * sin);
        let parts: Vec3 = if model.geom_type[g] == GeomType::Box {
            std::array::from_fn(|k| size[k].copysign(facing[k]))
        } else {
            let scaled: Vec3 = std::array::from_fn(|k| size[k] * facing[k]);
            let length = dot(scaled, scaled).sqrt().max(f64::MIN_POSITIVE);
            std::array::from_fn(|k| size[k] * scaled[k] / length)
        };
        let at = (0..3).fold(center, |at, k| add_scaled(at, axes[k], parts[k]));
        [at[0], at[1], height]
    })
}

/// Draws a bounded plane that is not the floor, if the camera is on the side of its normal.
pub(super) fn wall(scene: &Scene<'_>, g: usize, canvas: &mut dyn Canvas) {
    let (camera, model, data) = (&scene.camera, scene.model, scene.data);
    let (center, mat, size) = (data.geom_xpos[g], &data.geom_xmat[g], model.geom_size[g]);
    let normal = column(mat, 2);
    if dot(normal, sub(camera.pos, center)) <= 0.0 {
        return;
    }
    let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(s, t)| {
        let along = add_scaled(center, column(mat, 0), s * size[0]);
        add_scaled(along, column(mat, 1), t * size[1])
    });
    let mut polygon = Vec::with_capacity(8);
    camera.project_polygon(&corners, &mut polygon);
    if polygon.len() >= 3 {
        let light = blend(color_of(model, g), Color::rgb(206, 216, 226), 0.6);
        canvas.polygon(&polygon, lit(light, normal));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::tests::Colors;
    use crate::view::{CameraConfig, View};
    use mujoco_engine::Revision;
    use mujoco_engine::physics::kinematics;

    /// The largest x and y of a geom's shadow.
    fn extent(geom: &str) -> [f64; 2] {
        let text = format!("<mujoco><worldbody><geom {geom} pos='0 0 1'/></worldbody></mujoco>");
        let model = Model::from_xml_with(&text, Revision::V4_0).unwrap();
        let mut data = Data::new(&model);
        kinematics(&model, &mut data);
        let corners = solid_outline(&model, &data, 0, 0.0);
        [0, 1].map(|k| corners.iter().map(|corner| corner[k]).fold(0.0, f64::max))
    }

    #[test]
    fn a_floor_has_shadows_on_its_upper_side_of_what_is_above() {
        let seen = |height: f64, elevation: f64| {
            let text = format!(
                "<mujoco><worldbody><geom type='plane' size='9 9 1'/><geom size='.3' pos='0 0 {height}'/></worldbody></mujoco>"
            );
            let model = Model::from_xml(&text).unwrap();
            let mut data = Data::new(&model);
            kinematics(&model, &mut data);
            let camera = CameraConfig::at([0.0, 0.0, 1.0], 4.0, 90.0, elevation);
            let mut canvas = Colors::default();
            let view = View::new(&model, &camera).unwrap();
            view.draw(&model, &data, (80, 60), &mut canvas);
            canvas.0.iter().filter(|color| **color == SHADOW).count()
        };
        assert_eq!((seen(1.0, -30.0), seen(1.0, 30.0)), (1, 0));
        assert_eq!((seen(-1.0, -30.0), seen(-1.0, 30.0)), (0, 0));
    }

    #[test]
    fn the_shadow_of_a_box_is_as_large_as_the_box() {
        let size = "size='0.31 0.005 0.01'";
        assert_eq!(extent(&format!("type='box' {size}")), [0.31, 0.005]);
        let [x, y] = extent(&format!("type='box' euler='0 0 90' {size}"));
        assert!((x - 0.005).abs() < 1e-12 && (y - 0.31).abs() < 1e-12);
        let [x, y] = extent(&format!("type='ellipsoid' {size}"));
        assert!((0.3..=0.31).contains(&x) && y <= 0.005, "{x} {y}");
    }
}
