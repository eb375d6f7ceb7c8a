//! Surfaces that move along a geom, such as belts and rollers.

use crate::math::spatial::{Vec3, add, cross, rotate, scale, sub};
use crate::model::Cone;
use crate::{Data, Model};

/// Adds the velocities of the surfaces that touch to those of contacts' rows: MuJoCo's
/// `mj_addSurfaceVel`.
#[inline(never)]
pub(super) fn add_velocities(m: &Model, d: &mut Data) {
    for contact in &d.contact {
        let Ok(first) = usize::try_from(contact.efc_address) else {
            continue;
        };
        let (mut slides, mut spins) = ([0.0; 3], [0.0; 3]);
        for (g, sign) in contact.geom.into_iter().zip([-1.0, 1.0]) {
            if m.geom_surfacevel[g] != [0.0; 6] {
                let at = sub(contact.pos, d.geom_xpos[g]);
                let (linear, angular) = velocity(&m.geom_surfacevel[g], &d.geom_xmat[g], at);
                slides = add(slides, scale(linear, sign));
                spins = add(spins, scale(angular, sign));
            }
        }
        // the surface drives in the tangent plane and about the normal
        let [_, x, y] = rotate(&contact.frame, slides);
        let [about, ..] = rotate(&contact.frame, spins);
        let drives = [0.0, x, y, about, 0.0, 0.0];
        let dim = usize::from(contact.dim);
        let rows = &mut d.efc.vel[first..];
        if dim == 1 || m.opt.cone == Cone::Elliptic {
            for (row, drive) in rows.iter_mut().zip(&drives[..dim]) {
                *row += drive;
            }
            continue;
        }
        for k in 1..dim {
            let slide = contact.friction[k - 1] * drives[k];
            rows[2 * (k - 1)] += drives[0] + slide;
            rows[2 * (k - 1) + 1] += drives[0] - slide;
        }
    }
}

/// The linear and the angular velocity of a surface at a point, in the world's frame; `at` is relative
/// to the geom's centre.
fn velocity([x, y, z, u, v, w]: &[f64; 6], mat: &[f64; 9], at: Vec3) -> (Vec3, Vec3) {
    let (linear, angular) = (rotate(mat, [*x, *y, *z]), rotate(mat, [*u, *v, *w]));
    (add(linear, cross(angular, at)), angular)
}
