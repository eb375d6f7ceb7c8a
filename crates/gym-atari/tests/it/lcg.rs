use std::ops::Rem;

/// A linear congruential generator of the numbers that choose a program's instructions.
pub(crate) struct Lcg(pub(crate) u32);

impl Lcg {
    pub(crate) fn below<N: From<u16> + Rem<Output = N>>(&mut self, n: N) -> N {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        N::from((self.0 >> 16) as u16) % n
    }
}
