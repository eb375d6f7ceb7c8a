//! Pairs of geoms that collide, and pairs of bodies that do not.

use super::named;
use crate::mjcf::spec::Spec;
use crate::model::{CompiledModel, signature};
use crate::{Result, Revision};

pub(super) fn add_excludes(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for exclude in &spec.excludes {
        let id = |name: &str, attribute: &str| {
            named(&exclude.place, attribute, "body", &m.names.body, name)
        };
        let bodies = [
            id(&exclude.bodies[0], "body1")?,
            id(&exclude.bodies[1], "body2")?,
        ];
        m.exclude_signature.push(signature(bodies));
    }
    m.exclude_signature.sort_unstable();
    Ok(())
}

/// Adds the pairs of geoms, sorted by their bodies. Parameters that a pair does not give are mixed
/// from its geoms.
pub(super) fn add_pairs(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    let mut pairs = Vec::new();
    for pair in &spec.pairs {
        let place = &pair.place;
        let id = |geom: &Option<String>, attribute: &str| match geom {
            Some(name) => named(place, attribute, "geom", &m.names.geom, name),
            None => Err(place.attribute(attribute, "missing: it must be given")),
        };
        let geoms = [id(&pair.geoms[0], "geom1")?, id(&pair.geoms[1], "geom2")?];
        let bodies = geoms.map(|g| m.geom_bodyid[g]);
        // geoms in the order of their bodies
        let [g1, g2] = if bodies[0] > bodies[1] {
            [geoms[1], geoms[0]]
        } else {
            geoms
        };
        pairs.push((signature(bodies), g1, g2, pair));
    }
    pairs.sort_by_key(|(signature, ..)| *signature);
    for (_, g1, g2, pair) in pairs {
        let mixed = m.mixed(g1, g2);
        let [slide, spin, roll] = mixed.friction;
        let friction = pair.friction.unwrap_or([slide, slide, spin, roll, roll]);
        m.pair_geom1.push(g1);
        m.pair_geom2.push(g2);
        m.pair_dim.push(pair.condim.unwrap_or(mixed.dim));
        m.pair_friction.push(friction);
        // between geoms of equal priority, MuJoCo 3.12 takes the smaller numbers, whether direct or
        // not
        let solref = if m.revision == Revision::V3_12 && m.geom_priority[g1] == m.geom_priority[g2]
        {
            let (a, b) = (m.geom_solref[g1], m.geom_solref[g2]);
            [a[0].min(b[0]), a[1].min(b[1])]
        } else {
            mixed.solref
        };
        m.pair_solref.push(pair.solref.unwrap_or(solref));
        m.pair_solreffriction.push(pair.solref_friction);
        m.pair_solimp.push(pair.solimp.unwrap_or(mixed.solimp));
        let greater = |numbers: &[f64]| numbers[g1].max(numbers[g2]);
        m.pair_margin
            .push(pair.margin.unwrap_or(greater(&m.geom_margin)));
        m.pair_gap.push(pair.gap.unwrap_or(greater(&m.geom_gap)));
    }
    Ok(())
}
