//! What a model needs of memory and time, counted before anything is allocated.

use super::{Bounds, CompiledModel, Integrator};
use crate::Result;
use crate::error::ensure;

/// The most bytes of arrays whose size is a product: of degrees of freedom, rows of constraints and
/// bodies.
const MOST_BYTES: usize = 2 << 30;
/// The most products that the inverse weights of a model may take: a few seconds.
const MOST_PRODUCTS: u64 = 4_000_000_000;

/// Refuses a model whose degrees of freedom depend on too many others.
pub(super) fn check_inertia(m: &CompiledModel) -> Result<()> {
    let mut depths = Vec::with_capacity(m.nv());
    for parent in &m.dof_parentid {
        depths.push(1 + usize::try_from(*parent).map_or(0, |parent| depths[parent]));
    }
    let elements: usize = depths.iter().sum();
    // each degree of freedom, and each body along and about three axes
    let forces = m.nv() + 6 * m.nbody();
    ensure!(
        elements as u64 * forces as u64 <= MOST_PRODUCTS,
        "the inertia matrix has {elements} elements, and would be solved for {forces} forces: more than \
         {MOST_PRODUCTS} products are not supported, so let fewer joints follow one another"
    );
    // a row of the matrix has room for the longest chain
    let longest = depths
        .iter()
        .max()
        .map_or(0, |most| most.next_multiple_of(16));
    check_bytes(m, 80 * longest * m.nv())
}

/// Refuses a model whose matrices do not fit in memory, with at most `bounds` rows of constraints.
pub(super) fn check_rows(m: &CompiledModel, bounds: &Bounds, sparse: bool) -> Result<()> {
    let nv = m.nv();
    let implicit = matches!(
        m.opt.integrator,
        Integrator::Implicit | Integrator::ImplicitFast
    );
    // the numbers of the Jacobian and of its copies in the solvers
    let jacobian = 8 * if sparse { 8 } else { 5 } * bounds.rows * nv;
    let hessian = 8 * if sparse { 5 } else { 2 } * nv * nv;
    let slopes = if implicit {
        (16 * nv + 48 * m.nbody()) * nv
    } else {
        0
    };
    check_bytes(m, jacobian + hessian + slopes)
}

fn check_bytes(m: &CompiledModel, bytes: usize) -> Result<()> {
    ensure!(
        bytes <= MOST_BYTES,
        "{} degrees of freedom need matrices of {} MiB: more than {} are not supported",
        m.nv(),
        bytes >> 20,
        MOST_BYTES >> 20
    );
    Ok(())
}
