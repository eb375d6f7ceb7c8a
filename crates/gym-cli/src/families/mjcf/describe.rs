//! What a model has, in lines for a reader.

use std::collections::BTreeMap;
use std::fmt::{self, Display, Write};

use gym::sim::engine::Model;
use gym::sim::engine::model::{GeomType, JointType, ObjectType, TransmissionType};
use gym::sim::keyframes;

/// Describes a model: a line for each body, joint, actuator, tendon, sensor, camera and keyframe.
pub(super) fn model(m: &Model) -> String {
    let mut text = String::new();
    // (writing to a string cannot fail)
    let _ = write(m, &mut text);
    text
}

fn write(m: &Model, out: &mut String) -> fmt::Result {
    let mass: f64 = m.body_mass.iter().sum();
    writeln!(
        out,
        "{}: {}, {}, {} of freedom, {}, {}, {mass:.4} kg",
        if m.model.is_empty() {
            "model without a name"
        } else {
            &m.model
        },
        counted(m.nbody() - 1, "body", "bodies"),
        counted(m.njnt(), "joint", "joints"),
        counted(m.nv(), "degree", "degrees"),
        counted(m.ngeom(), "geom", "geoms"),
        counted(m.nu(), "actuator", "actuators"),
    )?;
    writeln!(
        out,
        "with the numbers of MuJoCo {}: timestep {} s, integrator {:?}, solver {:?} with {:?} cones, nq {}, na {}, nsensordata {}",
        m.revision,
        m.opt.timestep,
        m.opt.integrator,
        m.opt.solver,
        m.opt.cone,
        m.nq(),
        m.na(),
        m.nsensordata(),
    )?;
    bodies(m, out)?;
    assets(m, out)?;
    actuators(m, out)?;
    section(out, "tendons", m.ntendon(), |i, out| {
        let [low, high] = m.tendon_range[i];
        write!(
            out,
            "{}, {}",
            Name(m, ObjectType::Tendon, i),
            counted(m.tendon_num[i], "part", "parts")
        )?;
        if m.tendon_limited[i] {
            write!(out, ", {low} to {high} m")?;
        }
        Ok(())
    })?;
    section(out, "equality constraints", m.neq(), |i, out| {
        write!(out, "{:?}", m.eq_type[i])?;
        for id in [m.eq_obj1id[i], m.eq_obj2id[i]] {
            if let Ok(id) = usize::try_from(id) {
                write!(out, " {}", Name(m, m.eq_objtype[i], id))?;
            }
        }
        Ok(())
    })?;
    section(out, "sensors", m.nsensor(), |i, out| {
        let name = m.names.sensor.get(i).and_then(Option::as_deref);
        let (dim, kind) = (m.sensor_dim[i], m.sensor_type[i]);
        write!(
            out,
            "{}: {kind:?}, {}",
            name.unwrap_or("without a name"),
            counted(dim, "number", "numbers")
        )?;
        match usize::try_from(m.sensor_objid[i]) {
            Ok(id) => {
                let kind = m.sensor_objtype[i];
                write!(out, ", {} {}", word(kind), Name(m, kind, id))
            }
            Err(_) => Ok(()),
        }
    })?;
    section(out, "cameras", m.cam_mode.len(), |i, out| {
        write!(
            out,
            "{} on {}",
            Name(m, ObjectType::Camera, i),
            Name(m, ObjectType::Body, m.cam_bodyid[i])
        )
    })?;
    if !m.key_qpos.is_empty() {
        writeln!(out, "\nkeyframes: {}", keyframes(m).join(", "))?;
    }
    Ok(())
}

/// A number of things.
fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// A heading and a line for each object; nothing if there are none.
fn section(
    out: &mut String,
    heading: &str,
    count: usize,
    line: impl Fn(usize, &mut String) -> fmt::Result,
) -> fmt::Result {
    if count > 0 {
        writeln!(out, "\n{heading}")?;
    }
    for i in 0..count {
        out.push_str("  ");
        line(i, out)?;
        out.push('\n');
    }
    Ok(())
}

/// The tree of bodies, with their joints and geoms.
fn bodies(m: &Model, out: &mut String) -> fmt::Result {
    let mut depths = vec![0; m.nbody()];
    writeln!(out, "\nbodies, joints and geoms")?;
    for b in 0..m.nbody() {
        if b > 0 {
            depths[b] = depths[m.body_parentid[b]] + 1;
        }
        let indent = "  ".repeat(depths[b].min(20) + 1);
        write!(out, "{indent}{}", Name(m, ObjectType::Body, b))?;
        if b > 0 {
            write!(out, ", {:.4} kg", m.body_mass[b])?;
        }
        if m.body_mocapid[b] >= 0 {
            write!(out, ", mocap")?;
        }
        let geoms = (0..m.ngeom()).filter(|g| m.geom_bodyid[*g] == b);
        out.push_str(&shapes(m, geoms));
        out.push('\n');
        for j in (0..m.njnt()).filter(|j| m.jnt_bodyid[*j] == b) {
            write!(out, "{indent}  joint {}: ", Name(m, ObjectType::Joint, j))?;
            let turns = m.jnt_type[j] != JointType::Slide;
            write!(out, "{}", format!("{:?}", m.jnt_type[j]).to_lowercase())?;
            if m.jnt_limited[j] {
                let [low, high] = m.jnt_range[j];
                let unit = if turns { "rad" } else { "m" };
                write!(out, ", {low:.4} to {high:.4} {unit}")?;
            }
            out.push('\n');
        }
    }
    Ok(())
}

/// Meshes, materials and textures, in a line each.
fn assets(m: &Model, out: &mut String) -> fmt::Result {
    if m.nmesh() > 0 {
        writeln!(
            out,
            "\n{} of {} vertices and {} triangles",
            counted(m.nmesh(), "mesh", "meshes"),
            m.meshes.mesh_vert.len(),
            m.meshes.mesh_face.len()
        )?;
    }
    if !m.mat_rgba.is_empty() {
        let materials = counted(m.mat_rgba.len(), "material", "materials");
        let textures = counted(m.textures.tex_type.len(), "texture", "textures");
        writeln!(out, "{materials}, {textures}")?;
    }
    Ok(())
}

/// The shapes of geoms with their numbers, such as `; 2 meshes, 1 box that collides`.
fn shapes(m: &Model, geoms: impl Iterator<Item = usize>) -> String {
    let mut counts: BTreeMap<(bool, GeomType), usize> = BTreeMap::new();
    for g in geoms {
        let collides = m.geom_contype[g] != 0 || m.geom_conaffinity[g] != 0;
        *counts.entry((collides, m.geom_type[g])).or_default() += 1;
    }
    let parts = counts.iter().map(|((collides, kind), count)| {
        let name = format!("{kind:?}").to_lowercase();
        let plural = match (count, &name[name.len() - 1..]) {
            (1, _) => "",
            (_, "x" | "h") => "es",
            _ => "s",
        };
        let role = match (collides, count) {
            (false, _) => " to look at",
            (true, 1) => " that collides",
            (true, _) => " that collide",
        };
        format!("{count} {name}{plural}{role}")
    });
    let parts: Vec<String> = parts.collect();
    if parts.is_empty() {
        return String::new();
    }
    format!("; {}", parts.join(", "))
}

fn actuators(m: &Model, out: &mut String) -> fmt::Result {
    section(out, "actuators", m.nu(), |i, out| {
        write!(out, "{}: on ", Name(m, ObjectType::Actuator, i))?;
        let kind = match m.actuator_trntype[i] {
            TransmissionType::Joint | TransmissionType::JointInParent => ObjectType::Joint,
            TransmissionType::Tendon => ObjectType::Tendon,
            TransmissionType::Site | TransmissionType::SliderCrank => ObjectType::Site,
            TransmissionType::Body => ObjectType::Body,
            _ => ObjectType::Unknown,
        };
        let id = usize::try_from(m.actuator_trnid[i][0]).unwrap_or_default();
        write!(out, "{} {}", word(kind), Name(m, kind, id))?;
        let [low, high] = m.actuator_ctrlrange[i];
        match m.actuator_ctrllimited[i] {
            true => write!(out, ", controls {low} to {high}"),
            false => write!(out, ", any control"),
        }
    })
}

/// The word for a kind of object.
fn word(kind: ObjectType) -> String {
    match kind {
        ObjectType::XBody => "body".to_owned(),
        ObjectType::Unknown => "object".to_owned(),
        kind => format!("{kind:?}").to_lowercase(),
    }
}

/// The name of an object; its number if it has no name.
struct Name<'a>(&'a Model, ObjectType, usize);

impl Display for Name<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(m, kind, id) = self;
        match m.name(*kind, *id) {
            Some(name) => f.write_str(name),
            None => write!(f, "{id}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_has_its_line() {
        let text = r#"<mujoco model="arm"><compiler angle="radian"/><asset><mesh name="t" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
            <worldbody><geom type="plane" size="1 1 1" conaffinity="0"/><camera name="eye"/>
            <body name="upper" pos="0 0 1"><joint name="elbow" range="-1 0.5"/><geom size="0.1" mass="2" contype="0"/><site name="tip"/>
            <geom type="mesh" mesh="t" contype="0" conaffinity="0" mass="0"/></body>
            <body name="hand" mocap="true"/></worldbody>
            <actuator><motor name="pull" joint="elbow" ctrlrange="-2 2"/></actuator>
            <sensor><gyro name="felt" site="tip"/></sensor><keyframe><key name="home"/></keyframe></mujoco>"#;
        let model = Model::from_xml(text).unwrap();
        let text = super::model(&model);
        for line in [
            "arm: 2 bodies, 1 joint, 1 degree of freedom, 3 geoms, 1 actuator, 2.0000 kg",
            "  world; 1 plane that collides",
            "    upper, 2.0000 kg; 1 mesh to look at, 1 sphere that collides",
            "    hand, 0.0000 kg, mocap",
            "      joint elbow: hinge, -1.0000 to 0.5000 rad",
            "1 mesh of 4 vertices and 4 triangles",
            "  pull: on joint elbow, controls -2 to 2",
            "  felt: Gyro, 3 numbers, site tip",
            "  eye on world",
            "keyframes: home",
        ] {
            assert!(
                text.lines().any(|other| other == line),
                "{line}\nin\n{text}"
            );
        }
    }

    /// Returns the lines of a model's description.
    fn lines(text: &str) -> Vec<String> {
        let model = Model::from_xml(text).unwrap();
        super::model(&model).lines().map(str::to_owned).collect()
    }

    #[test]
    fn parts_without_a_name_have_their_number() {
        let lines = lines(
            r#"<mujoco><worldbody><body><joint/><joint type="slide" range="-0.5 2"/><geom size="0.1" mass="1"/><site/>
            <body><joint type="ball"/><geom type="box" size="1 1 1" mass="2"/><geom type="box" size="1 1 1" mass="2"/>
            <geom type="mesh" mesh="t" contype="0" conaffinity="0" mass="0"/><geom type="mesh" mesh="t" contype="0" conaffinity="0" mass="0"/>
            </body></body><body><freejoint/><geom size="1" mass="1"/><camera/></body></worldbody>
            <asset><mesh name="t" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><material name="red"/><material name="blue"/>
            <texture type="2d" builtin="flat" width="4" height="4"/></asset>
            <tendon><spatial range="0.5 1"><site site="s"/><site site="e"/></spatial></tendon></mujoco>"#
                .replace("<site/>", r#"<site name="s"/><site name="e"/>"#)
                .as_str(),
        );
        for line in [
            "model without a name: 3 bodies, 4 joints, 11 degrees of freedom, 6 geoms, 0 actuators, 6.0000 kg",
            "    1, 1.0000 kg; 1 sphere that collides",
            "      joint 0: hinge",
            "      joint 1: slide, -0.5000 to 2.0000 m",
            "      2, 4.0000 kg; 2 meshes to look at, 2 boxes that collide",
            "        joint 2: ball",
            "    3, 1.0000 kg; 1 sphere that collides",
            "      joint 3: free",
            "tendons",
            "  0, 2 parts, 0.5 to 1 m",
            "2 materials, 1 texture",
            "cameras",
            "  0 on 3",
        ] {
            assert!(
                lines.iter().any(|other| other == line),
                "{line}\nin\n{lines:#?}"
            );
        }
        for absent in ["actuators", "sensors", "equality constraints"] {
            assert!(!lines.iter().any(|line| line == absent), "{absent}");
        }
        assert!(!lines.iter().any(|line| line.starts_with("keyframes")));
    }

    #[test]
    fn what_acts_on_parts_names_them() {
        let lines = lines(
            r#"<mujoco model="m"><option timestep="0.004" integrator="RK4" solver="PGS" cone="elliptic"/><worldbody>
            <body name="one"><joint name="a"/><geom name="ball" size="0.1" mass="1"/><site name="tip"/></body>
            <body name="two"><joint name="b"/><geom size="0.1" mass="1"/></body></worldbody>
            <tendon><fixed name="rope"><joint joint="a" coef="1"/><joint joint="b" coef="2"/></fixed></tendon>
            <equality><joint joint1="a" joint2="b"/><connect body1="two" anchor="0 0 0"/><tendon tendon1="rope"/></equality>
            <actuator><motor joint="a"/><position name="pull" tendon="rope" ctrlrange="0 1"/><general site="tip" dyntype="integrator"/>
            <adhesion name="stick" body="one" ctrlrange="0 2"/></actuator>
            <sensor><jointpos joint="b"/><framepos name="where" objtype="body" objname="two"/><clock name="now"/>
            <actuatorfrc actuator="pull"/><tendonpos tendon="rope"/></sensor>
            <keyframe><key/><key name="up" qpos="1 1"/></keyframe></mujoco>"#,
        );
        for line in [
            "m: 2 bodies, 2 joints, 2 degrees of freedom, 2 geoms, 4 actuators, 2.0000 kg",
            "with the numbers of MuJoCo 4.0: timestep 0.004 s, integrator RK4, solver PGS with Elliptic cones, nq 2, na 1, nsensordata 7",
            "  rope, 2 parts",
            "  Joint a b",
            "  Connect two world",
            "  Tendon rope",
            "  0: on joint a, any control",
            "  pull: on tendon rope, controls 0 to 1",
            "  2: on site tip, any control",
            "  stick: on body one, controls 0 to 2",
            "  without a name: JointPos, 1 number, joint b",
            "  where: FramePos, 3 numbers, body two",
            "  now: Clock, 1 number",
            "  without a name: ActuatorFrc, 1 number, actuator pull",
            "  without a name: TendonPos, 1 number, tendon rope",
        ] {
            assert!(
                lines.iter().any(|other| other == line),
                "{line}\nin\n{lines:#?}"
            );
        }
    }
}
