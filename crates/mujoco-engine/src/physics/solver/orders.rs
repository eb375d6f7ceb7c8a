//! The orders in which Gauss-Seidel visits rows.

/// The random generator PCG32, from which MuJoCo draws the order of the rows.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Pcg32(u64);

impl Default for Pcg32 {
    fn default() -> Self {
        Self::new()
    }
}

impl Pcg32 {
    pub(in crate::physics) fn new() -> Self {
        let mut generator = Self(0);
        generator.next();
        generator
    }

    #[inline(always)]
    fn next(&mut self) -> u32 {
        let old = self.0;
        self.0 = old.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// Swaps element `i` with a random element of `0..=i`.
    #[inline(always)]
    pub(in crate::physics) fn swap<T>(&mut self, order: &mut [T], i: usize) {
        order.swap(i, (self.next() % (i as u32 + 1)) as usize);
    }

    /// Draws the next order: swaps all elements, from the last to the second.
    #[inline(always)]
    pub(in crate::physics) fn shuffle<T>(&mut self, order: &mut [T]) {
        for i in (1..order.len()).rev() {
            self.swap(order, i);
        }
    }
}

/// The orders of few rows, which depend on their number alone, and are drawn once.
#[derive(Clone, Debug)]
pub(in crate::physics) struct Orders {
    /// For one row, for two rows and so on: the orders of all sweeps.
    all: Vec<u8>,
    /// The numbers of rows whose orders are drawn: a bit for each.
    drawn: u64,
    sweeps: usize,
}

impl Orders {
    /// The largest number of rows.
    const MOST: usize = 48;

    /// Makes room for the orders of as many sweeps; of none if they are many.
    pub(in crate::physics) fn new(sweeps: usize) -> Self {
        let sweeps = if sweeps > 100 { 0 } else { sweeps };
        Self {
            all: vec![0; Self::first(Self::MOST + 1, sweeps)],
            drawn: 0,
            sweeps,
        }
    }

    /// Where the orders of `n` rows start.
    fn first(n: usize, sweeps: usize) -> usize {
        sweeps * n * (n - 1) / 2
    }

    /// Draws the orders of `n` rows.
    pub(in crate::physics) fn draw(&mut self, n: usize) {
        if n == 0 || n > Self::MOST || self.drawn >> n & 1 == 1 {
            return;
        }
        self.drawn |= 1 << n;
        let orders = &mut self.all[Self::first(n, self.sweeps)..][..self.sweeps * n];
        let (mut generator, mut order) = (Pcg32::new(), [0; Self::MOST]);
        for (i, place) in order[..n].iter_mut().enumerate() {
            *place = i as u8;
        }
        for to in orders.chunks_exact_mut(n) {
            generator.shuffle(&mut order[..n]);
            to.copy_from_slice(&order[..n]);
        }
    }

    /// Returns the orders of `n` rows, one sweep after the other; `None` if they were not drawn for
    /// as many as `sweeps` sweeps.
    pub(in crate::physics) fn of(&self, n: usize, sweeps: usize) -> Option<&[u8]> {
        (n <= Self::MOST && self.drawn >> n & 1 == 1 && sweeps <= self.sweeps)
            .then(|| &self.all[Self::first(n, self.sweeps)..][..self.sweeps * n])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_orders_are_those_that_the_generator_draws() {
        let mut orders = Orders::new(50);
        for n in [1, 2, 3, 11, Orders::MOST] {
            assert!(orders.of(n, 1).is_none());
            orders.draw(n);
            let mut generator = Pcg32::new();
            let mut order: Vec<u8> = (0..n as u8).collect();
            for known in orders.of(n, 50).unwrap().chunks(n) {
                generator.shuffle(&mut order);
                assert_eq!(known, order, "{n}");
            }
        }
        assert!(orders.of(3, 51).is_none());
        orders.draw(Orders::MOST + 1);
        assert!(orders.of(Orders::MOST + 1, 1).is_none());
        let mut none = Orders::new(101);
        none.draw(3);
        assert!(none.of(3, 1).is_none());
    }
}
