//! Sensors.

use super::{named, scalar_joint};
use crate::Result;
use crate::mjcf::spec::{Sensor, Spec, Target};
use crate::model::{About, CompiledModel, JointType, ObjectType};

pub(super) fn add_sensors(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for sensor in &spec.sensors {
        let object = object_of(m, sensor, sensor.object.as_ref())?;
        let reference = object_of(m, sensor, sensor.reference.as_ref())?;
        if let (About::Joint, Some(target)) = (sensor.kind.about(), &sensor.object) {
            scalar_joint(m, &sensor.place, target.attribute, &target.name)?;
        }
        if sensor.kind.about() == About::Ball
            && m.jnt_type.get(object.1 as usize) != Some(&JointType::Ball)
        {
            return Err(sensor.place.attribute("joint", "must be a ball joint"));
        }
        m.names.sensor.push(sensor.name.clone());
        m.sensor_adr.push(m.nsensordata());
        m.sensor_type.push(sensor.kind);
        m.sensor_intprm.push(sensor.parameters);
        m.sensor_objtype.push(object.0);
        m.sensor_objid.push(object.1);
        m.sensor_reftype.push(reference.0);
        m.sensor_refid.push(reference.1);
        m.sensor_cutoff.push(sensor.cutoff);
        m.sensor_noise.push(sensor.noise);
        let values = m.sensor_values(m.sensor_objid.len() - 1);
        m.sensor_dim.push(values);
    }
    Ok(())
}

fn object_of(
    m: &CompiledModel,
    sensor: &Sensor,
    target: Option<&Target>,
) -> Result<(ObjectType, i32)> {
    let Some(target) = target else {
        return Ok((ObjectType::Unknown, -1));
    };
    let (place, name) = (&sensor.place, &target.name);
    let id = named(m, place, target.attribute, target.kind, name)?;
    Ok((target.kind, id as i32))
}
