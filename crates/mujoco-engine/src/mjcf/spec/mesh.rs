//! Meshes.

use std::path::PathBuf;

use super::{file_of, replace, replace_some};
use crate::Result;
use crate::math::spatial::{Quat, Vec3};
use crate::mjcf::xml::{Element, Place};

/// How a mesh's mass is spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inertia {
    /// Through the convex hull.
    Convex,
    /// Through the volume of all triangles' pyramids from the centroid, each counted as positive.
    #[default]
    Legacy,
    /// Through the volume that the faces enclose; these must be oriented alike.
    Exact,
    /// On the surface.
    Shell,
}

/// What the element `mesh` says besides its data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Multiplies the vertices' coordinates; an odd number of negative factors turns the faces.
    pub scale: Vec3,
    /// The origin, in the file's coordinates.
    pub position: Vec3,
    /// The orientation of the axes, in the file's coordinates; need not be of length 1.
    pub orientation: Quat,
    /// How the mass is spread.
    pub inertia: Inertia,
    /// Whether normals are means over edges of any angle.
    pub smooth: bool,
    /// `maxhullvert`: the most vertices of the hull, at least 4.
    pub max_hull_vertices: Option<u32>,
    /// Whether a geom that collides has the mesh.
    pub collides: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            scale: [1.0; 3],
            position: [0.0; 3],
            orientation: [1.0, 0.0, 0.0, 0.0],
            inertia: Inertia::default(),
            smooth: false,
            max_hull_vertices: None,
            collides: true,
        }
    }
}

/// A mesh, before its file is read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    pub(crate) place: Place,
    pub(crate) name: String,
    pub(crate) path: Option<PathBuf>,
    pub(crate) content_type: Option<String>,
    /// The name and the parameters of a shape that needs no file, with the place of its errors.
    pub(crate) builtin: Option<(&'static str, Vec<f64>)>,
    pub(crate) vertices: Vec<f32>,
    pub(crate) normals: Vec<f32>,
    pub(crate) texture: Vec<f32>,
    pub(crate) faces: Vec<i32>,
    pub(crate) options: Options,
    /// The material of geoms that name none.
    pub(crate) material: Option<String>,
}

impl Mesh {
    /// Reads a mesh whose file is in `folder` beside the model.
    pub(crate) fn read(
        &mut self,
        element: &mut Element<'_, '_>,
        folder: &str,
        strip: bool,
    ) -> Result<()> {
        self.place = element.place();
        (self.name, self.path) = file_of(element, folder, strip)?;
        self.content_type = element.text("content_type")?;
        for (name, list) in [
            ("vertex", &mut self.vertices),
            ("normal", &mut self.normals),
            ("texcoord", &mut self.texture),
        ] {
            *list = element.list_of(name, "a number")?.unwrap_or_default();
        }
        self.faces = element
            .list_of("face", "a whole number")?
            .unwrap_or_default();
        replace(&mut self.options.position, element.numbers("refpos")?);
        replace(&mut self.options.orientation, element.numbers("refquat")?);
        replace(&mut self.options.smooth, element.flag("smoothnormal")?);
        replace_some(&mut self.material, element.text("material")?);
        let shapes = [
            "none",
            "sphere",
            "hemisphere",
            "supersphere",
            "supertorus",
            "cone",
        ];
        let shape = element.keyword("builtin", &shapes.map(|name| (name, name)))?;
        let params = element.list("params")?;
        self.builtin = match shape {
            None | Some("none") => None,
            Some(shape) => Some((shape, params.ok_or_else(|| element.missing("params"))?)),
        };
        self.read_class(element)
    }

    /// Reads the attributes that a class may have.
    pub(crate) fn read_class(&mut self, element: &mut Element<'_, '_>) -> Result<()> {
        let options = &mut self.options;
        replace(&mut options.scale, element.numbers("scale")?);
        let kinds = [
            ("convex", Inertia::Convex),
            ("legacy", Inertia::Legacy),
            ("exact", Inertia::Exact),
            ("shell", Inertia::Shell),
        ];
        element.set_keyword("inertia", &kinds, &mut options.inertia)?;
        match element.integer::<i32>("maxhullvert")? {
            None => {}
            Some(-1) => options.max_hull_vertices = None,
            Some(most @ 4..) => options.max_hull_vertices = Some(most as u32),
            Some(most) => {
                let reason = format!("is {most}: use at least 4, or -1 for no limit");
                return Err(element.place().attribute("maxhullvert", reason));
            }
        }
        Ok(())
    }
}
