//! Sizes of a model, and objects by their names.

use std::ops::Range;

use super::{CompiledModel, GeomType, ObjectType, SensorType};

impl CompiledModel {
    /// Number of position coordinates.
    #[must_use]
    pub fn nq(&self) -> usize {
        self.qpos0.len()
    }

    /// Number of degrees of freedom.
    #[must_use]
    pub fn nv(&self) -> usize {
        self.dof_bodyid.len()
    }

    /// Number of controls.
    #[must_use]
    pub fn nu(&self) -> usize {
        self.actuator_trnid.len()
    }

    /// Number of bodies, with the world.
    #[must_use]
    pub fn nbody(&self) -> usize {
        self.body_parentid.len()
    }

    /// Number of joints.
    #[must_use]
    pub fn njnt(&self) -> usize {
        self.jnt_type.len()
    }

    /// Number of geoms.
    #[must_use]
    pub fn ngeom(&self) -> usize {
        self.geom_type.len()
    }

    /// Number of meshes.
    #[must_use]
    pub fn nmesh(&self) -> usize {
        self.meshes.mesh_vertadr.len()
    }

    /// Number of height fields.
    #[must_use]
    pub fn nhfield(&self) -> usize {
        self.hfields.hfield_size.len()
    }

    /// The size of the height field of a geom; zeros if there is none.
    pub(crate) fn hfield_size(&self, geom: usize) -> [f64; 4] {
        let id = self.geom_dataid.get(geom).copied();
        let id = id.and_then(|id| usize::try_from(id).ok());
        let size = id.and_then(|id| self.hfields.hfield_size.get(id));
        size.copied().unwrap_or_default()
    }

    /// Whether a geom is a mesh.
    pub(crate) fn has_meshes(&self) -> bool {
        self.geom_type.contains(&GeomType::Mesh)
    }

    /// Number of sites.
    #[must_use]
    pub fn nsite(&self) -> usize {
        self.site_bodyid.len()
    }

    /// Number of tendons.
    #[must_use]
    pub fn ntendon(&self) -> usize {
        self.tendon_adr.len()
    }

    /// Number of kinematic trees that can move.
    #[must_use]
    pub fn ntree(&self) -> usize {
        self.dof_treeid.last().map_or(0, |tree| tree + 1)
    }

    /// Number of activations.
    #[must_use]
    pub fn na(&self) -> usize {
        let last = self.actuator_actadr.iter().max();
        last.map_or(0, |adr| (adr + 1) as usize)
    }

    /// Number of mocap bodies.
    #[must_use]
    pub fn nmocap(&self) -> usize {
        let last = self.body_mocapid.iter().max();
        last.map_or(0, |id| (id + 1) as usize)
    }

    /// Number of equality constraints.
    #[must_use]
    pub fn neq(&self) -> usize {
        self.eq_type.len()
    }

    /// Number of sensors.
    #[must_use]
    pub fn nsensor(&self) -> usize {
        self.sensor_type.len()
    }

    /// Total number of sensor values.
    #[must_use]
    pub fn nsensordata(&self) -> usize {
        self.sensor_dim.iter().sum()
    }

    /// The number of values of a sensor that its parameters give.
    pub(crate) fn sensor_values(&self, i: usize) -> usize {
        let [bits, _, number] = self.sensor_intprm[i];
        let count = |number: i32| usize::try_from(number).unwrap_or(0);
        let id = usize::try_from(self.sensor_objid[i]).ok();
        let camera = id.and_then(|id| self.cam_resolution.get(id));
        let number = match (self.sensor_type[i], self.sensor_objtype[i], camera) {
            (SensorType::Contact, ..) => count(number),
            (SensorType::Rangefinder, ObjectType::Camera, Some(&[width, height])) => {
                count(width).saturating_mul(count(height)).min(1 << 24)
            }
            _ => 1,
        };
        self.sensor_type[i].values(bits, number)
    }

    /// The last degree of freedom of a body, or of its nearest ancestor that has one; -1 if there
    /// is none.
    pub(crate) fn last_dof(&self, mut body: usize) -> i32 {
        while body > 0 && self.body_dofnum[body] == 0 {
            body = self.body_parentid[body];
        }
        match self.body_dofnum[body] {
            0 => -1,
            number => self.body_dofadr[body] + number as i32 - 1,
        }
    }

    /// The geoms of a body.
    pub(crate) fn geoms_of(&self, body: usize) -> Range<usize> {
        let first = usize::try_from(self.body_geomadr[body]);
        first.map_or(0..0, |first| first..first + self.body_geomnum[body])
    }

    /// The object of a kind and name: MuJoCo's `mj_name2id`.
    #[must_use]
    pub fn id(&self, kind: ObjectType, name: &str) -> Option<usize> {
        position(self.names_of(kind), name)
    }

    /// The name of an object: MuJoCo's `mj_id2name`. `None` if it has none, or does not exist.
    #[must_use]
    pub fn name(&self, kind: ObjectType, id: usize) -> Option<&str> {
        self.names_of(kind).get(id)?.as_deref()
    }

    fn names_of(&self, kind: ObjectType) -> &[Option<String>] {
        let names = &self.names;
        match kind {
            ObjectType::Unknown => &[],
            ObjectType::Body | ObjectType::XBody => &names.body,
            ObjectType::Joint => &names.joint,
            ObjectType::Geom => &names.geom,
            ObjectType::Site => &names.site,
            ObjectType::Camera => &names.camera,
            ObjectType::Tendon => &names.tendon,
            ObjectType::Actuator => &names.actuator,
        }
    }
}

impl CompiledModel {
    /// The body of that name.
    #[must_use]
    pub fn body_id(&self, name: &str) -> Option<usize> {
        position(&self.names.body, name)
    }

    /// The geom of that name.
    #[must_use]
    pub fn geom_id(&self, name: &str) -> Option<usize> {
        position(&self.names.geom, name)
    }

    /// The site of that name.
    #[must_use]
    pub fn site_id(&self, name: &str) -> Option<usize> {
        position(&self.names.site, name)
    }

    /// The camera of that name.
    #[must_use]
    pub fn camera_id(&self, name: &str) -> Option<usize> {
        position(&self.names.camera, name)
    }

    /// The joint of that name.
    #[must_use]
    pub fn joint_id(&self, name: &str) -> Option<usize> {
        position(&self.names.joint, name)
    }

    /// The tendon of that name.
    #[must_use]
    pub fn tendon_id(&self, name: &str) -> Option<usize> {
        position(&self.names.tendon, name)
    }

    /// The actuator of that name.
    #[must_use]
    pub fn actuator_id(&self, name: &str) -> Option<usize> {
        position(&self.names.actuator, name)
    }

    /// The sensor of that name.
    #[must_use]
    pub fn sensor_id(&self, name: &str) -> Option<usize> {
        position(&self.names.sensor, name)
    }

    /// The keyframe of that name.
    #[must_use]
    pub fn key_id(&self, name: &str) -> Option<usize> {
        position(&self.names.key, name)
    }
}

fn position(names: &[Option<String>], name: &str) -> Option<usize> {
    names.iter().position(|n| n.as_deref() == Some(name))
}
