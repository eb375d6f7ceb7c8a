//! The names of what is observed of each body.

use gym_sim::Naming;

/// Inertia about the centre of mass of the bodies' tree: MuJoCo's `cinert`.
pub(crate) const INERTIA: &[&str] = &[
    "inertia xx of {} (kg m²)",
    "inertia yy of {} (kg m²)",
    "inertia zz of {} (kg m²)",
    "inertia xy of {} (kg m²)",
    "inertia xz of {} (kg m²)",
    "inertia yz of {} (kg m²)",
    "mass times offset along x of {} (kg m)",
    "mass times offset along y of {} (kg m)",
    "mass times offset along z of {} (kg m)",
    "mass of {} (kg)",
];

/// Velocity at the centre of mass of the bodies' tree: MuJoCo's `cvel`.
pub(crate) const VELOCITY: &[&str] = &[
    "angular velocity about x of {} (rad/s)",
    "angular velocity about y of {} (rad/s)",
    "angular velocity about z of {} (rad/s)",
    "velocity along x of {} (m/s)",
    "velocity along y of {} (m/s)",
    "velocity along z of {} (m/s)",
];

/// Contact forces: MuJoCo's `cfrc_ext`.
pub(crate) const FORCES: &[&str] = &[
    "contact torque about x on {} (N m)",
    "contact torque about y on {} (N m)",
    "contact torque about z on {} (N m)",
    "contact force along x on {} (N)",
    "contact force along y on {} (N)",
    "contact force along z on {} (N)",
];

/// Adds names for each body from `first` on.
pub(crate) fn name_bodies(names: &mut Naming<'_>, first: usize, texts: &[&str]) {
    for id in first..names.model().nbody() {
        let body = names.body(id);
        for text in texts {
            names.add(text.replace("{}", &body));
        }
    }
}
