//! What the engine works out from a model once: sparsity of the inertia matrix, and pairs of geoms that can touch.

use super::CompiledModel;

/// Precomputed structure of a model.
#[derive(Clone, Debug, Default)]
pub(crate) struct Plan {
    /// First element of each row of the inertia matrix, and the number of all elements.
    ///
    /// Row `i` holds the lower triangle: the degrees of freedom on the way from the root to `i`, ascending, `i` last.
    pub(crate) m_rowadr: Vec<usize>,
    /// Columns of the elements.
    pub(crate) m_colind: Vec<usize>,
}

impl Plan {
    pub(super) fn new(m: &CompiledModel) -> Self {
        let (mut m_rowadr, mut m_colind) = (vec![0], Vec::new());
        for i in 0..m.nv() {
            if let Ok(parent) = usize::try_from(m.dof_parentid[i]) {
                let row: Vec<usize> = m_colind[m_rowadr[parent]..m_rowadr[parent + 1]].to_vec();
                m_colind.extend(row);
            }
            m_colind.push(i);
            m_rowadr.push(m_colind.len());
        }
        Self { m_rowadr, m_colind }
    }
}
