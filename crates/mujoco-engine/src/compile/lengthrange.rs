//! The ranges of the lengths of muscles whose text gives none: MuJoCo's `mj_setLengthRange`. It
//! pulls the actuator as far as it goes in each direction.

use crate::math::dense::dot_slices;
use crate::math::libm;
use crate::math::spatial::MINVAL;
use crate::mjcf::spec::{LengthRange, Spec};
use crate::model::{BiasType, CompiledModel, Disable, GainType, TransmissionType};
use crate::physics::{self, solve_m};
use crate::{Data, Model, Result, step1, step2};

/// The largest number of timesteps of all simulations, times degrees of freedom.
const MOST: f64 = 2e7;

/// Computes the missing ranges of `m`, whose other fields are complete.
pub(super) fn add_length_ranges(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    let options = &spec.compiler.length_range;
    let muscle = |m: &CompiledModel, i: usize| {
        m.actuator_gaintype[i] == GainType::Muscle || m.actuator_biastype[i] == BiasType::Muscle
    };
    let missing = |m: &CompiledModel, i: usize| {
        let [low, high] = spec.actuators[i].length_range;
        options.wants(muscle(m, i)) && !(options.use_existing && low < high)
    };
    let wanted: Vec<usize> = (0..m.nu()).filter(|&i| missing(m, i)).collect();
    let Some(&first) = wanted.first() else {
        return Ok(());
    };
    let steps = 2.0 * options.total / options.timestep;
    if (wanted.len() * m.nv()) as f64 * steps > MOST {
        let reason = format!(
            "missing: it would take more than {MOST} timesteps times degrees of freedom to measure: give it, or a smaller inttotal"
        );
        return Err(spec.actuators[first].place.attribute("lengthrange", reason));
    }
    let mut figures = m.clone();
    figures.opt.timestep = options.timestep;
    figures.opt.disableflags = Disable::FrictionLoss as u32
        | Disable::Contact as u32
        | Disable::Spring as u32
        | Disable::Damper as u32
        | Disable::Gravity as u32
        | Disable::Actuation as u32;
    let model = Model::new(figures)?;
    let mut d = Data::new(&model);
    for i in wanted {
        m.actuator_lengthrange[i] = match limit(m, i).filter(|_| options.use_limit) {
            Some(range) => range,
            None => measured(&model, &mut d, i, options)
                .map_err(|reason| spec.actuators[i].place.attribute("lengthrange", reason))?,
        };
    }
    Ok(())
}

/// The limit of the joint or tendon of an actuator.
fn limit(m: &CompiledModel, i: usize) -> Option<[f64; 2]> {
    let ids = m.actuator_trnid.as_flattened();
    // earlier versions read the list as if each actuator had one number
    let place = if m.revision.finds_limits() { 2 * i } else { i };
    let id = usize::try_from(ids[place]).ok()?;
    match m.actuator_trntype[i] {
        TransmissionType::Joint | TransmissionType::JointInParent => {
            m.jnt_limited.get(id)?.then_some(m.jnt_range[id])
        }
        TransmissionType::Tendon => m.tendon_limited.get(id)?.then_some(m.tendon_range[id]),
        _ => None,
    }
}

fn measured(
    m: &Model,
    d: &mut Data,
    i: usize,
    options: &LengthRange,
) -> std::result::Result<[f64; 2], String> {
    let mut lengths = [[0.0; 2]; 2];
    for (side, lengths) in lengths.iter_mut().enumerate() {
        d.reset(m);
        let mut updated = false;
        while d.time < options.total {
            let before = d.time;
            let length = pulled(m, d, i, side, options);
            // a state that diverged begins anew
            if d.time <= before {
                return Err(
                    "missing: it cannot be measured, because the simulation is unstable".into(),
                );
            }
            if d.time > options.total - options.interval {
                let [low, high] = *lengths;
                *lengths = if updated {
                    [
                        if length < low { length } else { low },
                        if length > high { length } else { high },
                    ]
                } else {
                    [length; 2]
                };
                updated = true;
            }
        }
    }
    let [[low, other_low], [other_high, high]] = [lengths[0], lengths[1]];
    let most = options.tolerance * (high - low);
    if high - low <= 0.0 || other_low - low > most || high - other_high > most {
        return Err(format!(
            "missing: it cannot be measured, because the lengths {low} to {other_low} and {other_high} to {high} do not converge"
        ));
    }
    Ok([low, high])
}

/// Advances a timestep with a force along the actuator; returns its length: MuJoCo's `evalAct`.
fn pulled(m: &Model, d: &mut Data, i: usize, side: usize, options: &LengthRange) -> f64 {
    let rate = libm::exp(-m.opt.timestep / f64::max(0.01, options.time_constant));
    d.qvel.iter_mut().for_each(|x| *x *= rate);
    step1(m, d);
    let moment = physics::moment(d, i, m.nv());
    let norm = |x: &[f64]| dot_slices(x, x).sqrt();
    let mut force = moment.clone();
    solve_m(m, d, &mut force);
    let sign = 2.0 * side as f64 - 1.0;
    let factor = sign * options.acceleration / f64::max(MINVAL, norm(&force));
    for (force, moment) in force.iter_mut().zip(&moment) {
        *force = moment * factor;
    }
    let size = norm(&force);
    if options.max_force > 0.0 && size > options.max_force {
        let factor = options.max_force / f64::max(MINVAL, size);
        force.iter_mut().for_each(|x| *x *= factor);
    }
    d.qfrc_applied.copy_from_slice(&force);
    step2(m, d);
    d.actuator_length[i]
}
