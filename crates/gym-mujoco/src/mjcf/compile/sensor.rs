//! Sensors.

use super::{named, scalar_joint};
use crate::Result;
use crate::mjcf::spec::{Sensor, Spec, Target};
use crate::model::{About, CompiledModel, JointType, ObjectType};

pub(super) fn add_sensors(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for sensor in &spec.sensors {
        let object = object_of(m, sensor, sensor.object.as_ref())?;
        let reference = object_of(m, sensor, sensor.reference.as_ref())?;
        if let (
            About::Joint,
            Some(Target {
                name, attribute, ..
            }),
        ) = (sensor.kind.about(), &sensor.object)
        {
            scalar_joint(m, &sensor.place, attribute, name)?;
        }
        if sensor.kind.about() == About::Ball
            && m.jnt_type.get(object.1 as usize) != Some(&JointType::Ball)
        {
            return Err(sensor.place.attribute("joint", "must be a ball joint"));
        }
        m.names.sensor.push(sensor.name.clone());
        m.sensor_adr.push(m.nsensordata());
        m.sensor_type.push(sensor.kind);
        m.sensor_dim.push(sensor.kind.dim());
        m.sensor_objtype.push(object.0);
        m.sensor_objid.push(object.1);
        m.sensor_reftype.push(reference.0);
        m.sensor_refid.push(reference.1);
        m.sensor_cutoff.push(sensor.cutoff);
        m.sensor_noise.push(sensor.noise);
    }
    Ok(())
}

fn object_of(
    m: &CompiledModel,
    sensor: &Sensor,
    target: Option<&Target>,
) -> Result<(ObjectType, i32)> {
    let Some(Target {
        kind,
        name,
        attribute,
    }) = target
    else {
        return Ok((ObjectType::Unknown, -1));
    };
    let (word, names) = match kind {
        ObjectType::Joint => ("joint", &m.names.joint),
        ObjectType::Geom => ("geom", &m.names.geom),
        ObjectType::Site => ("site", &m.names.site),
        ObjectType::Camera => ("camera", &m.names.camera),
        ObjectType::Tendon => ("tendon", &m.names.tendon),
        ObjectType::Actuator => ("actuator", &m.names.actuator),
        _ => ("body", &m.names.body),
    };
    let id = named(&sensor.place, attribute, word, names, name)?;
    Ok((*kind, id as i32))
}
