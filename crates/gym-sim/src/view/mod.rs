//! Pictures of a model: a camera, and shaded shapes on a canvas.

mod aim;
mod camera;
mod depth;
mod floor;
mod layer;
mod light;
mod look;
mod marks;
mod meshes;
mod shapes;
mod solids;
mod surface;
mod texture;

use gym_core::canvas::{Canvas, Color};
use gym_core::{Error, Result};
use serde::{Deserialize, Serialize};

pub use self::aim::Hit;
use self::camera::Camera;
use mujoco_engine::math::{Mat3, Vec3, add, mul_quat, quat_to_mat, rotate, sub};
use mujoco_engine::model::GeomType;
use mujoco_engine::physics::{com_pos, kinematics};
use mujoco_engine::{Data, Model};

/// The position of the free camera, with the field names of MuJoCo's `mjvCamera`. Values that are
/// `None` are computed from the model.
///
/// The camera follows the body `trackbodyid` in x and y.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CameraConfig {
    /// Distance from `lookat`, in m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance: Option<f64>,
    /// Horizontal direction in degrees; at 90 the camera looks along y, with x to the right.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<f64>,
    /// Vertical direction in degrees; negative if the camera looks down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elevation: Option<f64>,
    /// The point that the camera looks at. If it follows a body, only the height is used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lookat: Option<[f64; 3]>,
    /// The body that the camera follows; 0 or -1 for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trackbodyid: Option<i32>,
}

impl gym_core::ArgumentType for CameraConfig {
    fn kind() -> String {
        "object".to_owned()
    }
}

impl CameraConfig {
    /// A camera that follows a body at a distance, and looks at a point of height `height`; azimuth
    /// and elevation are in degrees.
    #[must_use]
    pub const fn following(
        body: i32,
        distance: f64,
        azimuth: f64,
        elevation: f64,
        height: f64,
    ) -> Self {
        Self {
            trackbodyid: Some(body),
            ..Self::at([0.0, 0.0, height], distance, azimuth, elevation)
        }
    }

    /// A camera that looks at a point.
    #[must_use]
    pub const fn at(lookat: [f64; 3], distance: f64, azimuth: f64, elevation: f64) -> Self {
        Self {
            distance: Some(distance),
            azimuth: Some(azimuth),
            elevation: Some(elevation),
            lookat: Some(lookat),
            trackbodyid: None,
        }
    }
}

/// The viewpoint of a model's pictures.
#[derive(Clone, Debug)]
pub struct View {
    mount: Mount,
    max_geom: usize,
    samples: usize,
}

/// The camera of a view: free, or one of the model's.
#[derive(Clone, Debug)]
enum Mount {
    Free {
        config: Free,
        follows: Option<usize>,
    },
    /// A camera of the model.
    Own(Own),
}

#[derive(Clone, Copy, Debug)]
struct Free {
    distance: f64,
    azimuth: f64,
    elevation: f64,
    lookat: Vec3,
}

#[derive(Clone, Copy, Debug)]
struct Own {
    mode: u8,
    body: usize,
    target: usize,
    pos: Vec3,
    quat: [f64; 4],
    fovy: f64,
    /// The height of an orthographic camera's view, in m.
    parallel: Option<f64>,
    /// The orientation in the initial configuration, and the position relative to the body and to
    /// its centre of mass.
    mat0: Mat3,
    from_body: Vec3,
    from_com: Vec3,
}

/// Vertical field of view of the free camera, in degrees.
const FOVY: f64 = 45.0;
const AZIMUTH: f64 = 90.0;
const ELEVATION: f64 = -45.0;

impl View {
    /// The view of a free camera.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] for a body that does not exist, and for numbers that are not
    /// finite.
    pub fn new(model: &Model, camera: &CameraConfig) -> Result<Self> {
        Ok(Self {
            mount: free(model, camera)?,
            max_geom: usize::MAX,
            samples: meshes::FINE,
        })
    }

    /// The view of a camera of the model.
    pub(crate) fn of_camera(model: &Model, id: usize) -> Self {
        Self {
            mount: Mount::Own(Own::new(model, &initial(model), id)),
            max_geom: usize::MAX,
            samples: meshes::FINE,
        }
    }

    /// The same with at most so many geoms.
    pub(crate) fn with_max_geom(self, max_geom: usize) -> Self {
        Self { max_geom, ..self }
    }

    /// The same with at most so many samples of a pixel in a row, from 1 to 3, where there are meshes:
    /// edges are rougher, and a picture takes less time.
    #[must_use]
    pub fn with_samples(self, samples: usize) -> Self {
        let samples = samples.clamp(1, meshes::FINE);
        Self { samples, ..self }
    }

    /// Turns the free camera by some degrees, and multiplies its distance by `zoom`.
    pub(crate) fn turn(&mut self, azimuth: f64, elevation: f64, zoom: f64) {
        if let Mount::Free { config, .. } = &mut self.mount
            && azimuth.is_finite()
            && elevation.is_finite()
            && zoom > 0.0
        {
            config.azimuth = (config.azimuth + azimuth) % 360.0;
            config.elevation = (config.elevation + elevation).clamp(-89.0, 89.0);
            config.distance = (config.distance * zoom).clamp(0.1, 100.0);
        }
    }

    /// Whether the camera is free.
    pub(crate) fn is_free(&self) -> bool {
        matches!(self.mount, Mount::Free { .. })
    }

    fn camera(&self, data: &Data, (width, height): (u32, u32)) -> Camera {
        let size = [f64::from(width), f64::from(height)];
        match &self.mount {
            Mount::Free { config, follows } => {
                let mut lookat = config.lookat;
                if let Some(body) = follows {
                    lookat = [data.xpos[*body][0], data.xpos[*body][1], lookat[2]];
                }
                let angles = [config.azimuth, config.elevation];
                Camera::around(lookat, config.distance, angles, FOVY, size)
            }
            Mount::Own(own) => own.camera(data, size),
        }
    }

    /// Draws a state.
    pub fn draw(&self, model: &Model, data: &Data, size: (u32, u32), canvas: &mut dyn Canvas) {
        let scene = &self.scene(model, data, size);
        let geoms = (0..model.ngeom()).take(self.max_geom);
        floor::sky(&scene.camera, canvas);
        let floor = floor_of(model, data, self.max_geom);
        if let Some(g) = floor {
            floor::draw(scene, g, canvas);
        }
        if meshes::has_any(model, self.max_geom) {
            return meshes::draw(scene, self.max_geom, floor, canvas);
        }
        if let Some(g) = floor {
            floor::shadows(scene, data.geom_xpos[g][2], canvas);
        }
        let mut walls = geoms
            .clone()
            .filter(|g| is_wall(model, *g) && floor != Some(*g));
        for g in walls.by_ref() {
            floor::wall(scene, g, canvas);
        }
        shapes::strings(scene, canvas);
        let mut solids: Vec<(f64, usize)> = geoms
            .filter(|g| model.geom_type[*g] != GeomType::Plane && is_shown(model, *g))
            .map(|g| {
                let depth = scene.camera.depth(data.geom_xpos[g]);
                (depth - shapes::nearness(scene, g), g)
            })
            .collect();
        solids.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        for (_, g) in solids {
            shapes::draw(scene, g, canvas);
        }
        for s in (0..model.nsite()).filter(|s| is_site_shown(model, *s)) {
            shapes::marker(scene, s, canvas);
        }
    }

    fn scene<'a>(&self, model: &'a Model, data: &'a Data, size: (u32, u32)) -> Scene<'a> {
        let camera = self.camera(data, size);
        Scene {
            camera,
            samples: self.samples,
            model,
            data,
        }
    }
}

/// A state, and the camera that sees it.
struct Scene<'a> {
    camera: Camera,
    /// The most samples of a pixel in a row.
    samples: usize,
    model: &'a Model,
    data: &'a Data,
}

/// Whether pictures show a group of geoms or sites: those that MuJoCo's viewer shows at first.
fn is_group_shown(group: i32) -> bool {
    group < 3
}

/// Whether a geom is shown.
fn is_shown(model: &Model, g: usize) -> bool {
    is_group_shown(model.geom_group[g]) && color_of(model, g).a > 0
}

/// Whether a site is shown.
fn is_site_shown(model: &Model, s: usize) -> bool {
    is_group_shown(model.site_group[s]) && rgba(model.site_rgba[s]).a > 0
}

/// Whether a geom is a bounded plane. Of the other planes, only the floor is drawn.
fn is_wall(model: &Model, g: usize) -> bool {
    let [x, y, _] = model.geom_size[g];
    model.geom_type[g] == GeomType::Plane && x > 0.0 && y > 0.0 && is_shown(model, g)
}

/// The floor: the lowest horizontal plane.
fn floor_of(model: &Model, data: &Data, max_geom: usize) -> Option<usize> {
    (0..model.ngeom())
        .take(max_geom)
        .filter(|g| model.geom_type[*g] == GeomType::Plane && data.geom_xmat[*g][8] > 0.99)
        .min_by(|a, b| data.geom_xpos[*a][2].total_cmp(&data.geom_xpos[*b][2]))
}

/// The number of the model's camera of a name.
///
/// # Errors
/// [`Error::InvalidArgument`] with the names that there are.
pub fn camera(model: &Model, name: &str) -> Result<usize> {
    model.camera_id(name).ok_or_else(|| {
        let names = model.names.camera.iter().flatten();
        let names: Vec<&str> = names.map(|name| &**name).collect();
        let names = names.join(", ");
        let reason = format!("there is no camera {name:?}: the cameras are {names}");
        Error::argument("camera_name", reason)
    })
}

/// The initial configuration.
fn initial(model: &Model) -> Data {
    let mut data = Data::new(model);
    kinematics(model, &mut data);
    com_pos(model, &mut data);
    data
}

/// The colour of a geom: its own, or its material's.
fn color_of(model: &Model, g: usize) -> Color {
    const GREY: [f64; 4] = [0.5, 0.5, 0.5, 1.0];
    match usize::try_from(model.geom_matid[g]) {
        Ok(material) if model.geom_rgba[g] == GREY => rgba(model.mat_rgba[material]),
        _ => rgba(model.geom_rgba[g]),
    }
}

fn rgba([r, g, b, a]: [f64; 4]) -> Color {
    let byte = |x: f64| (x.clamp(0.0, 1.0) * 255.0).round() as u8;
    Color {
        r: byte(r),
        g: byte(g),
        b: byte(b),
        a: byte(a),
    }
}

/// Returns a free camera. A value that `config` leaves out is the default of MuJoCo's viewer.
fn free(model: &Model, config: &CameraConfig) -> Result<Mount> {
    let wrong = |reason: &str| Error::argument("default_camera_config", reason);
    let follows = match config.trackbodyid {
        Some(id @ 1..) => match usize::try_from(id).ok().filter(|id| *id < model.nbody()) {
            Some(id) => Some(id),
            None => {
                let number = model.nbody();
                return Err(wrong(&format!(
                    "trackbodyid {id}: the model has {number} bodies"
                )));
            }
        },
        _ => None,
    };
    let config = Free {
        distance: config.distance.unwrap_or(model.stat.extent),
        azimuth: config.azimuth.unwrap_or(AZIMUTH),
        elevation: config.elevation.unwrap_or(ELEVATION),
        lookat: config.lookat.unwrap_or_else(|| middle(model)),
    };
    let numbers = [config.distance, config.azimuth, config.elevation];
    if !numbers.iter().chain(&config.lookat).all(|x| x.is_finite()) || config.distance <= 0.0 {
        let reason = "the distance must be positive, and all numbers finite";
        return Err(wrong(reason));
    }
    Ok(Mount::Free { config, follows })
}

/// The middle of a model in its initial configuration: the median of its geoms' positions.
fn middle(model: &Model) -> Vec3 {
    let places = initial(model).geom_xpos;
    std::array::from_fn(|k| {
        let mut numbers: Vec<f64> = places.iter().map(|pos| pos[k]).collect();
        numbers.sort_by(f64::total_cmp);
        let at = |n: usize| numbers.get(n / 2).copied().unwrap_or(0.0);
        // of an even number of geoms, the mean of the two in the middle, as in numpy
        (at(numbers.len().saturating_sub(1)) + at(numbers.len())) / 2.0
    })
}

impl Own {
    fn new(model: &Model, data: &Data, id: usize) -> Self {
        let (body, pos, quat) = (model.cam_bodyid[id], model.cam_pos[id], model.cam_quat[id]);
        let place = add(data.xpos[body], rotate(&data.xmat[body], pos));
        let orthographic = model.cam_projection[id] == 1;
        Self {
            mode: model.cam_mode[id],
            body,
            target: usize::try_from(model.cam_targetbodyid[id]).unwrap_or(0),
            pos,
            quat,
            // the field of view of a perspective camera is an angle
            fovy: if orthographic {
                FOVY
            } else {
                model.cam_fovy[id]
            },
            parallel: orthographic.then_some(model.cam_fovy[id]),
            mat0: quat_to_mat(mul_quat(data.xquat[body], quat)),
            from_body: sub(place, data.xpos[body]),
            from_com: sub(place, data.subtree_com[body]),
        }
    }

    fn camera(&self, data: &Data, size: [f64; 2]) -> Camera {
        if let Some(height) = self.parallel {
            return self.perspective(data, size).orthographic(height);
        }
        self.perspective(data, size)
    }

    /// The camera as if its rays met in it.
    fn perspective(&self, data: &Data, size: [f64; 2]) -> Camera {
        let body = self.body;
        let place = add(data.xpos[body], rotate(&data.xmat[body], self.pos));
        match self.mode {
            1 => {
                let place = add(data.xpos[body], self.from_body);
                Camera::new(place, &self.mat0, self.fovy, size)
            }
            2 => {
                let place = add(data.subtree_com[body], self.from_com);
                Camera::new(place, &self.mat0, self.fovy, size)
            }
            3 => Camera::towards(place, data.xpos[self.target], self.fovy, size),
            4 => Camera::towards(place, data.subtree_com[self.target], self.fovy, size),
            _ => {
                let axes = quat_to_mat(mul_quat(data.xquat[body], self.quat));
                Camera::new(place, &axes, self.fovy, size)
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use gym_core::canvas::{Align, Point, Shape, Transform};

    /// Of an even number of places numpy's median is the mean of the two in the middle.
    #[test]
    fn the_free_camera_looks_at_the_median_of_the_geoms() {
        let looks_at = |places: &[&str]| {
            let geom = |pos: &&str| format!("<geom size='.1' pos='{pos}'/>");
            let geoms: String = places.iter().map(geom).collect();
            let text = format!("<mujoco><worldbody>{geoms}</worldbody></mujoco>");
            let model = Model::from_xml(&text).unwrap();
            let view = View::new(&model, &CameraConfig::default()).unwrap();
            view.free_camera().unwrap().lookat.unwrap()
        };
        assert_eq!(looks_at(&[]), [0.0; 3]);
        assert_eq!(looks_at(&["1 2 3"]), [1.0, 2.0, 3.0]);
        assert_eq!(looks_at(&["1 2 3", "2 8 -3"]), [1.5, 5.0, 0.0]);
        let places = ["9 1 0", "-4 2 7", "2 4 1"];
        assert_eq!(looks_at(&places), [2.0, 2.0, 1.0]);
        let places = ["9 1 0", "-4 2 7", "2 4 1", "3 8 2"];
        assert_eq!(looks_at(&places), [2.5, 3.0, 1.5]);
    }

    /// A canvas that keeps the colours of shapes.
    #[derive(Default)]
    pub(crate) struct Colors(pub(crate) Vec<Color>);

    impl Canvas for Colors {
        fn clear(&mut self, color: Color) {
            self.0.push(color);
        }
        fn fill(&mut self, _: Shape<'_>, color: Color) {
            self.0.push(color);
        }
        fn stroke(&mut self, _: Shape<'_>, _: f64, color: Color) {
            self.0.push(color);
        }
        fn text(&mut self, _: &str, _: Point, _: f64, _: Align, _: Color) {}
        fn push(&mut self, _: Transform) {}
        fn pop(&mut self) {}
    }
}
