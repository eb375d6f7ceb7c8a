//! Joints and their degrees of freedom.

use crate::Result;
use crate::mjcf::orientation::{IDENTITY, turned, unit, within};
use crate::mjcf::spec::{Body, Joint};
use crate::model::{CompiledModel, JointType};

/// Adds a joint of a body.
pub(super) fn add_joint(
    m: &mut CompiledModel,
    (body_id, parent): (usize, usize),
    body: &Body,
    joint: &Joint,
) -> Result<()> {
    let Joint {
        place,
        kind,
        compiler,
        ..
    } = joint;
    let (free, ball) = (*kind == JointType::Free, *kind == JointType::Ball);
    let names = ["range", "limited"];
    let range = if ball {
        // a ball joint limits the angle from its initial orientation
        [-1.0, joint.range[1]]
    } else {
        joint.range
    };
    let unlimited = free || (ball && joint.range == [0.0; 2] && joint.limited.is_none());
    let limited = !unlimited && super::limited(joint.limited, range, compiler, place, names)?;
    if ball && limited && joint.range[0] != 0.0 {
        return Err(place.attribute("range", "of a ball joint begins with 0"));
    }
    let names = ["actuatorfrcrange", "actuatorfrclimited"];
    let force_limited = !free
        && !ball
        && super::limited(
            joint.force_limited,
            joint.force_range,
            compiler,
            place,
            names,
        )?;
    if free && parent != 0 {
        let reason = "a free joint belongs to a body directly in the world";
        return Err(place.attribute("type", reason));
    }
    if free && body.joints.len() > 1 {
        return Err(place.attribute("type", "a free joint must be the only joint of its body"));
    }
    let earlier = &body.joints[..m.njnt() - m.body_jntadr[body_id].max(0) as usize];
    let turned_by_ball = earlier.iter().any(|joint| joint.kind == JointType::Ball);
    if turned_by_ball && matches!(kind, JointType::Ball | JointType::Hinge) {
        return Err(place.attribute("type", "nothing that turns follows a ball joint"));
    }
    let to_radians = compiler.degree && matches!(kind, JointType::Hinge | JointType::Ball);
    let angle = |x: f64| {
        if to_radians {
            x * (std::f64::consts::PI / 180.0)
        } else {
            x
        }
    };
    m.names.joint.push(joint.name.clone());
    m.jnt_type.push(*kind);
    m.jnt_qposadr.push(m.nq());
    m.jnt_dofadr.push(m.nv());
    m.jnt_bodyid.push(body_id);
    m.jnt_limited.push(limited);
    m.jnt_pos.push(if free {
        [0.0; 3]
    } else {
        within(joint.frame, (joint.pos, IDENTITY)).0
    });
    m.jnt_axis.push(if free || ball {
        [0.0, 0.0, 1.0]
    } else {
        unit(turned(joint.frame, joint.axis)).0
    });
    m.jnt_range.push(if limited {
        joint.range.map(angle)
    } else {
        joint.range
    });
    m.jnt_margin.push(joint.margin);
    let [stiffness, higher @ ..] = joint.stiffness;
    m.jnt_stiffness.push(stiffness);
    m.jnt_stiffnesspoly.push(higher);
    m.jnt_solref.push(joint.solref);
    m.jnt_solimp.push(joint.solimp);
    m.jnt_actfrclimited.push(force_limited);
    m.jnt_actfrcrange.push(joint.force_range);
    m.jnt_actgravcomp.push(joint.actuator_gravcomp);
    if free {
        let (pos, quat) = (m.body_pos[body_id], m.body_quat[body_id]);
        m.qpos0.extend(pos.iter().chain(&quat));
        m.qpos_spring.extend(pos.iter().chain(&quat));
    } else if ball {
        m.qpos0.extend(IDENTITY);
        m.qpos_spring.extend(IDENTITY);
    } else {
        m.qpos0.push(angle(joint.reference));
        m.qpos_spring.push(angle(joint.spring_reference));
    }
    for _ in 0..kind.nv() {
        let dof = m.nv();
        let first_of_body = dof == 0 || m.dof_bodyid[dof - 1] != body_id;
        let parent = if first_of_body {
            m.last_dof(parent)
        } else {
            dof as i32 - 1
        };
        let new_tree = m.dof_treeid.last().map_or(0, |tree| tree + 1);
        m.dof_bodyid.push(body_id);
        m.dof_jntid.push(m.njnt() - 1);
        m.dof_parentid.push(parent);
        m.dof_treeid
            .push(usize::try_from(parent).map_or(new_tree, |parent| m.dof_treeid[parent]));
        m.dof_armature.push(joint.armature);
        let [damping, higher @ ..] = joint.damping;
        m.dof_damping.push(damping);
        m.dof_dampingpoly.push(higher);
        m.dof_frictionloss.push(joint.friction_loss);
        m.dof_solref.push(joint.solref_friction);
        m.dof_solimp.push(joint.solimp_friction);
    }
    Ok(())
}
