//! Fills arrays that a serialised model may leave out because it does not use their feature.

use crate::model::bounds::bounding_box;
use crate::model::{
    BiasType, CompiledModel, DynamicsType, Fluid, GainType, GeomType, ObjectType, Parameters,
    SOLIMP, SOLREF, TransmissionType, WrapType, padded,
};
use crate::physics::arrays;

/// Fills an empty array with `length` copies of `value`.
fn fill<T: Clone>(array: &mut Vec<T>, length: usize, value: T) {
    if array.is_empty() {
        *array = vec![value; length];
    }
}

impl CompiledModel {
    /// Fills arrays of features that the model does not use: an empty array means that the feature
    /// is unused.
    pub(super) fn complete(&mut self) {
        let (nbody, njnt, nv, ngeom) = (self.nbody(), self.njnt(), self.nv(), self.ngeom());
        let (nu, ntendon, nkey) = (self.nu(), self.ntendon(), self.key_time.len());
        let (ncam, nmat, nsensor) = (self.cam_bodyid.len(), self.mat_rgba.len(), self.nsensor());
        let (nwrap, neq, nsite) = (self.wrap_objid.len(), self.neq(), self.nsite());
        let npair = self.pair_dim.len();
        let (one, nothing) = (Parameters(padded(&[1.0])), Parameters::default());
        let m = self;
        arrays! { m, fill:
            nbody, -1 => body_mocapid;
            nbody, 0.0 => body_gravcomp;
            njnt, false => jnt_actfrclimited jnt_actgravcomp;
            njnt, [0.0; 2] => jnt_actfrcrange jnt_stiffnesspoly;
            nv, 0.0 => dof_frictionloss;
            nv, [0.0; 2] => dof_dampingpoly;
            nv, SOLREF => dof_solref;
            nv, SOLIMP => dof_solimp;
            ngeom, Fluid::default() => geom_fluid;
            ngeom, -1 => geom_dataid;
            ngeom, [0.0; 6] => geom_surfacevel;
            ngeom, 0.0 => geom_adhesion;
            npair, 0.0 => pair_adhesion;
            ncam, 0 => cam_projection;
            ncam, [1; 2] => cam_resolution;
            ncam, [0.0; 2] => cam_sensorsize;
            ncam, [0.0; 4] => cam_intrinsic;
            ngeom, 0 => geom_group;
            nsite, 0 => site_group;
            nmat, -1 => mat_texid;
            nmat, [1.0; 2] => mat_texrepeat;
            nmat, false => mat_texuniform;
            nmat, 0.0 => mat_emission;
            nmat, 0.5 => mat_specular mat_shininess;
            nu, TransmissionType::Joint => actuator_trntype;
            nu, DynamicsType::None => actuator_dyntype;
            nu, GainType::Fixed => actuator_gaintype;
            nu, BiasType::None => actuator_biastype;
            nu, one => actuator_dynprm actuator_gainprm;
            nu, nothing => actuator_biasprm;
            nu, false => actuator_forcelimited actuator_actlimited actuator_actearly;
            nu, [0.0; 2] => actuator_forcerange actuator_actrange actuator_lengthrange;
            nu, -1 => actuator_actadr;
            nu, 0 => actuator_group;
            nu, 0.0 => actuator_length0 actuator_acc0 actuator_cranklength;
            ntendon, false => tendon_limited tendon_actfrclimited;
            ntendon, [0.0; 2] => tendon_stiffnesspoly tendon_dampingpoly tendon_range tendon_actfrcrange tendon_lengthspring;
            ntendon, 0.0 => tendon_margin tendon_stiffness tendon_damping tendon_frictionloss
            tendon_armature
            tendon_length0 tendon_invweight0;
            ntendon, SOLREF => tendon_solref_lim tendon_solref_fri;
            ntendon, SOLIMP => tendon_solimp_lim tendon_solimp_fri;
            nwrap, WrapType::Joint => wrap_type;
            neq, ObjectType::Body => eq_objtype;
            nsensor, [0; 3] => sensor_intprm;
            nkey, Vec::new() => key_act key_mpos key_mquat;
        }
        if m.has_meshes() {
            fill(&mut m.geom_aabb, ngeom, [0.0; 6]);
        } else {
            m.geom_aabb.clear();
        }
        let known = m.geom_aabb.len().min(m.geom_type.len());
        for g in 0..known.min(m.geom_size.len()) {
            if m.geom_type[g] != GeomType::Mesh {
                let bounds = bounding_box(m, g);
                m.geom_aabb[g].copy_from_slice(bounds.as_flattened());
            }
        }
    }
}
