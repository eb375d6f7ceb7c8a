//! The flag `sleep`: the engine keeps all bodies awake, so it takes models in which MuJoCo does too.

use crate::Result;
use crate::mjcf::spec::{Sleep, Spec};
use crate::model::{CompiledModel, TransmissionType, WrapType};

use super::fuse::Kept;

/// Refuses models with the flag in which a kinematic tree may fall asleep: one that has no actuator,
/// unless its body says `sleep="never"`.
pub(super) fn check(m: &CompiledModel, spec: &Spec, bodies: &[Kept<'_>]) -> Result<()> {
    let Some(flag) = &spec.sleep else {
        return Ok(());
    };
    let mut awake = vec![false; m.ntree()];
    let tree = |body: usize| usize::try_from(m.body_treeid[body]).ok();
    for i in 0..m.nu() {
        let id = m.actuator_trnid[i][0] as usize;
        let bodies = match m.actuator_trntype[i] {
            TransmissionType::Joint | TransmissionType::JointInParent => vec![m.jnt_bodyid[id]],
            TransmissionType::Site | TransmissionType::SliderCrank => vec![m.site_bodyid[id]],
            TransmissionType::Body => vec![id],
            TransmissionType::Tendon => {
                let parts = m.tendon_adr[id]..m.tendon_adr[id] + m.tendon_num[id];
                let body = |w: usize| match (m.wrap_type[w], m.wrap_objid[w] as usize) {
                    (WrapType::Pulley, _) => 0,
                    (WrapType::Joint, joint) => m.jnt_bodyid[joint],
                    (WrapType::Site, site) => m.site_bodyid[site],
                    (_, geom) => m.geom_bodyid[geom],
                };
                parts.map(body).collect()
            }
        };
        for tree in bodies.into_iter().filter_map(tree) {
            awake[tree] = true;
        }
    }
    for (id, kept) in bodies.iter().enumerate() {
        let Some(tree) = tree(id) else { continue };
        let policy = kept.body.sleep;
        if policy == Sleep::Never {
            awake[tree] = true;
        } else if matches!(policy, Sleep::Allowed | Sleep::Init) {
            let reason = "sleep is not supported: use never, or disable the flag sleep";
            return Err(kept.body.place.attribute("sleep", reason));
        }
    }
    let tired = (0..m.nbody()).find(|&id| tree(id).is_some_and(|tree| !awake[tree]));
    match tired {
        None => Ok(()),
        Some(id) => {
            let name = bodies[id].body.name.as_deref().unwrap_or("");
            Err(flag.attribute(
                "sleep",
                format!(
                    "body {name:?} may fall asleep, which is not supported: give it sleep=\"never\", or disable the flag"
                ),
            ))
        }
    }
}
