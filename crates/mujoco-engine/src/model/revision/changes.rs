//! What changed between versions of MuJoCo, and since which revision. A comment names an earlier
//! version with the change. Each rule is a method of [`Revision`]: `m.revision.clips_faces()`.

use super::Revision;

macro_rules! changes {
    ($($(#[$doc:meta])* $name:ident since $first:ident;)*) => {
        impl Revision {
            $(
                $(#[$doc])*
                #[inline]
                pub(crate) fn $name(self) -> bool {
                    self >= Self::$first
                }
            )*
        }
    };
}

// The language and the compiler
changes! {
    /// A range of a tendon's force limits the force without a flag. (3.13)
    limits_by_force_range since V3_17;
    /// The damping ratio of a servo refers to the inertia that the servo moves. (3.14)
    damps_moved_inertia since V3_17;
    /// The rotations to principal axes come from half the tangent, and end by the size of what is
    /// left. (3.14)
    turns_by_half_tangent since V3_17;
    /// With `uselimit`, the range of an actuator's length is the limit of its own joint or tendon.
    finds_limits since V4_0;
    /// An actuator takes parameters only from classes of its own or a fitting kind.
    classes_by_kind since V3_17;
    /// The relative pose of a weld constraint is normalised when it is read.
    normalizes_weld_poses since V3_17;
    /// The parts of fused bodies move to their parents before masses are computed, and cameras and
    /// lights move with them.
    fuses_first since V3_17;
    /// Copies by `replicate` leave the controls and activations in keyframes of attached models.
    keeps_attached_controls since V3_17;
    /// Bodies that cannot sleep from the start, although they are told to, stay awake.
    wakes_from_the_start since V3_17;
    /// Contacts make no constraints where no degree of freedom moves one body relative to the
    /// other.
    drops_rigid_pairs since V3_17;
}

// Meshes
changes! {
    /// A quadrilateral is cut along its shorter diagonal.
    cuts_quadrilaterals since V3_17;
    /// The texture and the normal of a corner in an OBJ file may be 0.
    takes_corner_zero since V3_17;
    /// The hull of a mirrored mesh is turned right side out.
    turns_mirrored_hulls since V3_17;
    /// The hashes of the two angles of a polygon's normal are mixed as in Boost's `hash_combine`.
    mixes_hashes since V4_0;
    /// A polygon of one triangle passes through the same steps as others.
    joins_single_faces since V4_0;
    /// A shape that was fitted to a mesh does not keep it as `geom_dataid`.
    forgets_fitted_meshes since V3_17;
    /// The normal of a polygon takes all corners into account, by Newell's method.
    newell_normals since V3_17;
}

// Contacts
changes! {
    /// The lowest point of an ellipsoid above a plane is its support point. (3.13)
    supports_ellipsoids since V3_17;
    /// The contacts of two convex shapes are found at once, by clipping faces, instead of by turning
    /// the shapes. (3.15)
    clips_faces since V3_17;
    /// The margin of a height field and a shape is that of other pairs.
    treats_prisms_as_shapes since V3_17;
    /// The boxes around moving bodies are not compared in single precision.
    sweeps_otherwise since V3_17;
    /// Convex shapes with a margin are compared without it first.
    shrinks_to_cores since V3_17;
    /// The nearest points of capsules are positions between the ends of their segments.
    tests_capsule_ends since V3_17;
    /// The nearest point of a simplex is the projection of the origin on it, and the polytope
    /// expands until the last bound is reached.
    projects_origin since V4_0;
    /// A side cuts an edge where the heights of its ends above the side tell, instead of the distances
    /// from the origin.
    cuts_by_heights since V4_0;
    /// Where the edges of one shape do not lie on a face of the other, those of the other are tried.
    tries_both_edges since V4_0;
    /// The edge of a cylinder on a face is the line of the curved surface that touches the face,
    /// instead of the line through the first point of the search that found the contact.
    lays_cylinders_on_faces since V4_0_1;
}

// Forces and the solvers
changes! {
    /// Projected Gauss-Seidel scales its improvement by the inertia of the current configuration.
    stops_by_current_inertia since V3_17;
    /// Elliptic cones have their slopes from the unit vector of the sliding direction.
    slopes_by_direction since V4_0;
    /// The area of an ellipsoid in a medium is computed for a longest semiaxis of 1.
    scales_ellipsoids since V3_17;
    /// The angles of a tendon's path around a geom come from arc tangents, and Newton's method solves
    /// for the angle of the point that a tendon inside a geom touches.
    turns_by_arc_tangents since V3_17;
    /// The side of a tendon's path around a geom is that on which the path through the side site
    /// winds.
    winds_past_side since V4_0;
    /// The orientation of a site relative to `refsite` is that of the world.
    refers_to_world since V3_17;
    /// The Cholesky solver substitutes back by columns.
    substitutes_by_columns since V4_0;
    /// A sparse factor of Newton's method is made anew after 32 rows were subtracted from it.
    limits_subtractions since V4_0;
    /// Sparse matrices are factored up to three rows at a time.
    factors_in_blocks since V4_0;
    /// Rows of a sparse matrix are factored together only if the same rows depend on them, instead
    /// of as many.
    compares_dependents since V4_0_1;
}

// Integration and what is shown
changes! {
    /// The terms of quaternion functions are added in pairs.
    adds_in_pairs since V4_0;
    /// Runge and Kutta's stages turn the velocities of free and ball joints into the frame of the
    /// start.
    turns_by_stages since V4_0;
    /// Inverse dynamics of Euler's timesteps leave out the damping of joints if dampers are disabled.
    leaves_out_disabled_dampers since V4_0;
    /// Implicit integrators derive the forces at the clamped controls.
    derives_at_clamped_controls since V3_17;
    /// Implicit integrators derive no force that the range of its joint or tendon clamps.
    leaves_clamped_forces since V4_0;
    /// Implicit integrators derive the gyroscopic forces of a free body about the centre of mass of its
    /// tree, with the inertia that is computed there.
    takes_centre_of_tree since V3_17;
    /// A sensor of a geom's or site's orientation takes that of the body, or of its inertia, if it is
    /// nearly equal.
    reads_mounted_orientations since V4_0;
    /// Sensors of acceleration include gravity on bodies that cannot move.
    accelerates_fixed_bodies since V4_0;
    /// `cfrc_ext` has the forces of tendons through sites.
    shows_tendon_forces since V3_17;
    /// The torque of a weld constraint in `cfrc_ext` is that in the world.
    turns_weld_torques since V3_17;
    /// A sensor of the sum of contacts has a normal and a tangent only if there is a contact.
    sums_no_contacts_to_zero since V3_17;
    /// Springs of bodies that sleep have energy.
    counts_resting_springs since V4_0;
}
