//! Models from texts and files in MJCF.

use std::collections::BTreeMap;
use std::path::Path;

use crate::mjcf::store::Store;
use crate::mjcf::{files, reader};
use crate::{Error, Model, Result, Revision};

impl Model {
    /// The largest size in bytes of a model's text, and of all its texts together.
    pub const MAX_BYTES: usize = files::MAX_LEN;

    /// Compiles a model from a text in MJCF, which names no files.
    ///
    /// | section | supported |
    /// |---|---|
    /// | all | `include`; `default` classes and `childclass`; orientations by quat, axisangle, xyaxes, zaxis and euler |
    /// | `compiler` | angle, eulerseq, autolimits, inertiafromgeom, inertiagrouprange, balanceinertia, boundmass, boundinertia, settotalmass, meshdir, assetdir, strippath, fitaabb, fusestatic, discardvisual, alignfree, coordinate="local" |
    /// | `option` | timestep, gravity, wind, magnetic, density, viscosity, cone, impratio, solver, iterations, ls_iterations, tolerance, noslip_iterations, noslip_tolerance, ccd_iterations, ccd_tolerance, sleep_tolerance, integrator, `flag` |
    /// | bodies | `body` (mocap, gravcomp, sleep), `frame`, `replicate`, `attach`, `inertial`; all joints with springs, dampers, dry friction, limits, align; sites, all cameras and lights |
    /// | `geom` | plane, hfield, sphere, capsule, ellipsoid, cylinder, box; fluidshape; surfacevel; adhesion; all contact parameters; meshes, and shapes fitted to them |
    /// | `asset` | model, for `attach`; mesh, of a file (STL, OBJ, MSH), of vertices in the text or builtin (sphere, hemisphere, supersphere, supertorus, cone): scale, refpos, refquat, inertia, smoothnormal, maxhullvert; hfield, of a file (PNG, or MuJoCo's binary) or of elevations in the text |
    /// | `contact` | pair, exclude |
    /// | `equality` | connect, weld, joint, tendon |
    /// | `tendon` | fixed, spatial (sites, pulleys, spheres and cylinders with side sites); springs, dampers, armature, limits |
    /// | `actuator` | general, motor, position, velocity, intvelocity, damper, cylinder, muscle (also without lengthrange), adhesion; on joints, tendons, sites, slider-cranks and bodies |
    /// | `sensor` | those of joints, tendons, actuators, sites, frames, subtrees, and the clock; touch, contact, magnetometer, insidesite, camprojection; rangefinder of sites and cameras; distance, normal, fromto |
    /// | `keyframe` | key |
    ///
    /// `asset` also gives materials and textures, of PNG files or builtin patterns, for pictures;
    /// `statistic` and `size` are read as in MuJoCo; `visual`, `custom`, `user` and skins are
    /// ignored. Text that is not quite XML (attributes without a space between them, `&` in values,
    /// `--` in comments) is read where libmujoco reads it, and a file that is a part of a model, with
    /// `body` outermost, is a model without the part. What refers to a part of a `replicate`, or to an
    /// attached part, is copied with it. Options of attached models have no effect.
    ///
    /// Errors are composites, flexes, plugins, signed distance fields, delays, the actuators dcmotor,
    /// pid and orientation, and the sensors user, tactile and plugin. So are more than 4000 objects of
    /// a kind other than sites, more than 200,000 elements in bodies, and more than 8 MiB of their
    /// names, all with the copies that `replicate` and `attach` make; matrices of more than 2 GiB; more
    /// than 10 models within each other; and files of meshes or of height fields with more than 256 MiB
    /// together.
    ///
    /// # Errors
    /// [`Error::Mjcf`] for text that is not XML, for anything outside the supported part of MJCF,
    /// and for an impossible model, with the line.
    pub fn from_xml(text: &str) -> Result<Self> {
        Self::from_xml_with(text, Revision::default())
    }

    /// [`from_xml`](Self::from_xml), for a revision of the engine.
    ///
    /// # Errors
    /// The errors of `from_xml`.
    pub fn from_xml_with(text: &str, revision: Revision) -> Result<Self> {
        Self::from_texts(&files::Texts::of(text)?, revision)
    }

    /// Compiles a model from a file in MJCF and the files that it names. These are in the folder of
    /// this file (meshes: in its folder `meshdir`), or else in that of the file that names them.
    ///
    /// # Errors
    /// [`Error::File`] if a file cannot be read, is missing or is included twice, or with the error
    /// of [`from_xml`](Self::from_xml).
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self> {
        Self::from_path_with(path, Revision::default())
    }

    /// [`from_path`](Self::from_path), for a revision of the engine.
    ///
    /// # Errors
    /// The errors of `from_path`.
    pub fn from_path_with(path: impl AsRef<Path>, revision: Revision) -> Result<Self> {
        Self::from_store(path.as_ref(), Store::Disk, revision)
    }

    /// Compiles a model from files in memory, where there is no file system: `main` is the path of
    /// the model, and `files` are the bytes of all files by their paths, such as
    /// `robot/meshes/arm.stl`. Files are found as by [`from_path`](Self::from_path).
    ///
    /// ```
    /// use mujoco_engine::{Model, Revision};
    ///
    /// let scene = r#"<mujoco><include file="parts/arm.xml"/></mujoco>"#;
    /// let arm = r#"<mujoco><worldbody><body><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"#;
    /// let files = [("robot/scene.xml", scene), ("robot/parts/arm.xml", arm)];
    /// let files = files.map(|(path, text)| (path.to_owned(), text.as_bytes().to_vec())).into();
    /// let model = Model::from_files(&files, "robot/scene.xml", Revision::default())?;
    /// assert_eq!(model.nbody(), 2);
    /// # Ok::<(), mujoco_engine::Error>(())
    /// ```
    ///
    /// # Errors
    /// The errors of `from_path`.
    pub fn from_files(
        files: &BTreeMap<String, Vec<u8>>,
        main: &str,
        revision: Revision,
    ) -> Result<Self> {
        Self::from_store(Path::new(main), Store::Memory(files), revision)
    }

    fn from_store(path: &Path, store: Store<'_>, revision: Revision) -> Result<Self> {
        let texts = files::Texts::of_file(path, store);
        let model = texts.and_then(|texts| Self::from_texts(&texts, revision));
        model.map_err(|error| match error {
            Error::File { .. } => error,
            error => Error::File {
                path: path.display().to_string(),
                reason: error.to_string(),
            },
        })
    }

    fn from_texts(texts: &files::Texts<'_>, revision: Revision) -> Result<Self> {
        let spec = reader::read(&texts.parse()?, revision)?;
        let compiled = super::compile(&spec, texts.store().assets())?;
        super::finish(compiled, &spec).map_err(|error| spec.located(error))
    }
}
