//! Pairs of geoms that collide, and pairs of bodies that do not.

use super::named;
use crate::Result;
use crate::mjcf::spec::Spec;
use crate::model::{CompiledModel, ObjectType, signature};

pub(super) fn add_excludes(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    for exclude in &spec.excludes {
        let id = |name: &str, attribute: &str| {
            named(m, &exclude.place, attribute, ObjectType::Body, name)
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

/// Adds the pairs of geoms, sorted by their bodies.
pub(super) fn add_pairs(m: &mut CompiledModel, spec: &Spec) -> Result<()> {
    let mut pairs = Vec::new();
    for pair in &spec.pairs {
        let place = &pair.place;
        let id = |geom: &Option<String>, attribute: &str| match geom {
            Some(name) => named(m, place, attribute, ObjectType::Geom, name),
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
        m.pair_geom1.push(g1);
        m.pair_geom2.push(g2);
        m.pair_dim.push(pair.condim);
        m.pair_friction.push(pair.friction);
        m.pair_solref.push(pair.solref);
        m.pair_solreffriction.push(pair.solref_friction);
        m.pair_solimp.push(pair.solimp);
        m.pair_margin.push(pair.margin);
        m.pair_gap.push(pair.gap);
        m.pair_adhesion.push(pair.adhesion);
    }
    Ok(())
}
