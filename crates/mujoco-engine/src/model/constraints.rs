//! Equality constraints, dry friction and tendon limits: their properties that do not depend on the
//! state.

use super::{CompiledModel, Disable, EqualityType, ObjectType, Softness};

/// All such constraints, in the order of their rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct ModelConstraints {
    pub(crate) equalities: Vec<Equality>,
    /// Dry friction of degrees of freedom.
    pub(crate) dof_frictions: Vec<Scalar>,
    /// Dry friction of tendons.
    pub(crate) tendon_frictions: Vec<Scalar>,
    /// Limits of tendons.
    pub(crate) tendon_limits: Vec<Scalar>,
}

/// An equality constraint.
#[derive(Clone, Debug)]
pub(crate) struct Equality {
    pub(crate) id: usize,
    pub(crate) kind: EqualityType,
    /// For connect and weld, the two bodies.
    pub(crate) bodies: [usize; 2],
    pub(crate) softness: Softness,
    /// Sums of the bodies' inverse weights: of translation (or, for joints and tendons, of the
    /// whole), and of rotation.
    pub(crate) diag: [f64; 2],
}

/// A constraint of one row, on a degree of freedom or a tendon.
#[derive(Clone, Debug)]
pub(crate) struct Scalar {
    pub(crate) id: usize,
    pub(crate) softness: Softness,
    pub(crate) diag: f64,
    /// The friction loss.
    pub(crate) loss: f64,
}

impl ModelConstraints {
    /// The connect or weld constraint `id`; `None` for a constraint of joints or tendons.
    pub(crate) fn of_bodies(&self, id: usize) -> Option<&Equality> {
        let place = self
            .equalities
            .binary_search_by_key(&id, |equality| equality.id);
        let equality = &self.equalities[place.ok()?];
        matches!(equality.kind, EqualityType::Connect | EqualityType::Weld).then_some(equality)
    }

    pub(crate) fn new(m: &CompiledModel) -> Self {
        let on = |part| !m.opt.disables(Disable::Constraint) && !m.opt.disables(part);
        let mut constraints = Self::default();
        if on(Disable::Equality) {
            let active = (0..m.neq()).filter(|&i| m.eq_active0[i]);
            constraints.equalities = active.map(|i| equality(m, i)).collect();
        }
        if on(Disable::FrictionLoss) {
            let rough = (0..m.nv()).filter(|&i| m.dof_frictionloss[i] != 0.0);
            constraints.dof_frictions = rough
                .map(|i| Scalar {
                    id: i,
                    softness: Softness::new(m.dof_solref[i], m.dof_solimp[i], &m.opt),
                    diag: m.dof_invweight0[i],
                    loss: m.dof_frictionloss[i],
                })
                .collect();
            let rough = (0..m.ntendon()).filter(|&t| m.tendon_frictionloss[t] > 0.0);
            constraints.tendon_frictions = rough
                .map(|t| Scalar {
                    id: t,
                    softness: Softness::new(m.tendon_solref_fri[t], m.tendon_solimp_fri[t], &m.opt),
                    diag: m.tendon_invweight0[t],
                    loss: m.tendon_frictionloss[t],
                })
                .collect();
        }
        if on(Disable::Limit) {
            let limited = (0..m.ntendon()).filter(|&t| m.tendon_limited[t]);
            constraints.tendon_limits = limited
                .map(|t| Scalar {
                    id: t,
                    softness: Softness::new(m.tendon_solref_lim[t], m.tendon_solimp_lim[t], &m.opt),
                    diag: m.tendon_invweight0[t],
                    loss: 0.0,
                })
                .collect();
        }
        constraints
    }

    /// Whether some constraints can pull as well as push.
    pub(crate) fn can_pull(&self) -> bool {
        !self.equalities.is_empty()
            || !self.dof_frictions.is_empty()
            || !self.tendon_frictions.is_empty()
    }

    /// Whether some constraint acts on a tendon.
    pub(crate) fn pulls_tendons(&self) -> bool {
        let mut equalities = self.equalities.iter();
        !self.tendon_limits.is_empty()
            || !self.tendon_frictions.is_empty()
            || equalities.any(|equality| equality.kind == EqualityType::Tendon)
    }

    /// The largest number of blocks and of rows.
    pub(crate) fn most(&self) -> (usize, usize) {
        let scalars = self.dof_frictions.len() + self.tendon_frictions.len();
        let limits = 2 * self.tendon_limits.len();
        let equalities = self.equalities.iter();
        let rows: usize = equalities.map(|equality| equality.kind.rows()).sum();
        let blocks = self.equalities.len() + scalars + limits;
        (blocks, rows + scalars + limits)
    }
}

fn equality(m: &CompiledModel, i: usize) -> Equality {
    let ids = [m.eq_obj1id[i], m.eq_obj2id[i]];
    let body = |id: i32| {
        let id = usize::try_from(id).unwrap_or(0);
        match m.eq_objtype[i] {
            ObjectType::Site => m.site_bodyid[id],
            ObjectType::Body => id,
            _ => 0,
        }
    };
    let weight = |id: i32, part: usize| match (m.eq_type[i], usize::try_from(id)) {
        (_, Err(_)) => 0.0,
        (EqualityType::Joint, Ok(id)) => m.dof_invweight0[m.jnt_dofadr[id]],
        (EqualityType::Tendon, Ok(id)) => m.tendon_invweight0[id],
        _ => m.body_invweight0[body(id)][part],
    };
    Equality {
        id: i,
        kind: m.eq_type[i],
        bodies: ids.map(body),
        softness: Softness::new(m.eq_solref[i], m.eq_solimp[i], &m.opt),
        diag: [0, 1].map(|part| weight(ids[0], part) + weight(ids[1], part)),
    }
}
