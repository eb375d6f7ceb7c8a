//! Integers and indices: numpy's `integers`, `choice`, `geometric`, `shuffle` and `permutation`,
//! and Gymnasium's `categorical_sample`.

use rand::Rng;

use super::Generator;
use crate::math::ln_1p;

/// Lemire's method (<https://arxiv.org/abs/1805.10941>): draws a number below `n` from words of
/// `next`, which have `BITS` bits; `n` must be a word and not 0.
#[inline(always)]
fn below<const BITS: u32>(n: u64, mut next: impl FnMut() -> u64) -> u64 {
    let mut draw = || {
        let product = u128::from(next()) * u128::from(n);
        (
            (product >> BITS) as u64,
            product as u64 & (u64::MAX >> (64 - BITS)),
        )
    };
    let (mut whole, mut rest) = draw();
    // the threshold costs a division, and is below `n`; most draws are above `n` and do not need
    // the threshold
    if rest < n {
        let threshold = ((1 << BITS) - u128::from(n)) as u64 % n;
        while rest < threshold {
            (whole, rest) = draw();
        }
    }
    whole
}

impl Generator {
    /// Draws uniformly from `[low, high)`: numpy's `integers(low, high)`.
    ///
    /// A range of one value draws nothing. An empty range draws nothing and returns `low`.
    #[inline]
    pub fn integers(&mut self, low: i64, high: i64) -> i64 {
        let n = if low < high {
            high.wrapping_sub(low) as u64
        } else {
            1
        };
        let offset = match u32::try_from(n) {
            Ok(1) => 0,
            Ok(n) => below::<32>(n.into(), || self.next_u32().into()),
            Err(_) if n == 1 << 32 => u64::from(self.next_u32()),
            Err(_) => below::<64>(n, || self.next_u64()),
        };
        low.wrapping_add(offset as i64)
    }

    /// Fills `out` uniformly from `[low, high_inclusive]`: numpy's
    /// `integers(low, high_inclusive, size=out.len(), dtype=np.uint8, endpoint=True)`.
    ///
    /// Each 32-bit word gives four bytes, lowest first; unused bytes of the last word are dropped.
    /// A range of one value draws nothing. An empty range draws nothing and returns `low`.
    pub fn integers_u8(&mut self, low: u8, high_inclusive: u8, out: &mut [u8]) {
        if high_inclusive <= low {
            return out.fill(low);
        }
        self.integers_u8_each(low, &[high_inclusive], out);
    }

    /// Draws from `[0, high_inclusive]`: numpy's
    /// `integers(0, high_inclusive, dtype=np.uint16, endpoint=True)`. The draws are halves of 32-bit
    /// words, low half first; the rest of the last word is dropped.
    pub fn integer_u16(&mut self, high_inclusive: u16) -> u16 {
        let Some(n) = high_inclusive.checked_add(1).map(u32::from) else {
            return self.next_u32() as u16;
        };
        if n == 1 {
            return 0;
        }
        let threshold = (u32::from(u16::MAX) - u32::from(high_inclusive)) % n;
        loop {
            let word = self.next_u32();
            for half in [word & 0xffff, word >> 16] {
                let product = half * n;
                if product & 0xffff >= threshold {
                    return (product >> 16) as u16;
                }
            }
        }
    }

    /// Fills `out` with zeros and ones: numpy's `integers(0, 2, size=out.len(), dtype=np.int8)`.
    pub fn tosses(&mut self, out: &mut [i8]) {
        // A call takes whole words of four bytes and drops the unused bytes of the last word. So
        // calls for multiples of four bytes return the same bytes as one call for all.
        let mut bytes = [0; 64];
        for piece in out.chunks_mut(bytes.len()) {
            let bytes = &mut bytes[..piece.len()];
            self.integers_u8(0, 1, bytes);
            for (value, byte) in piece.iter_mut().zip(bytes) {
                *value = *byte as i8;
            }
        }
    }

    /// Fills `out` like [`integers_u8`](Self::integers_u8), cycling through the upper bounds
    /// `highs_inclusive`: numpy's `integers(low, high, dtype=np.uint8, endpoint=True)` with an
    /// array of bounds that is broadcast along the last axis. Without bounds, `out` stays as it is.
    pub fn integers_u8_each(&mut self, low: u8, highs_inclusive: &[u8], out: &mut [u8]) {
        let (mut bytes, mut left) = (0u32, 0);
        let mut next = || {
            if left == 0 {
                (bytes, left) = (self.next_u32(), 4);
            }
            let byte = bytes as u8;
            (bytes, left) = (bytes >> 8, left - 1);
            byte
        };
        for (out, high) in out.iter_mut().zip(highs_inclusive.iter().cycle()) {
            *out = match high.saturating_sub(low) {
                0 => low,
                u8::MAX => next(),
                range => low + below::<8>(u64::from(range) + 1, || next().into()) as u8,
            };
        }
    }

    /// Draws a uniform index below `n`: numpy's `choice` from a sequence of length `n`.
    ///
    /// If `n` is 0, it returns 0 and draws nothing.
    #[inline]
    pub fn choice(&mut self, n: usize) -> usize {
        self.integers(0, i64::try_from(n).unwrap_or(i64::MAX)) as usize
    }

    /// Draws an index into `p` with the probabilities `p`: numpy's `choice(len(p), p=p)`.
    ///
    /// Uses one [`random`](Self::random). The sum of `p` need not be exactly 1. If no partial sum
    /// exceeds the draw, for instance if all are 0, it returns the last index (0 if `p` is empty).
    #[inline]
    pub fn choice_p(&mut self, p: &[f64]) -> usize {
        let total: f64 = p.iter().sum();
        let r = self.random();
        let mut sum = 0.0;
        let above = |p| {
            sum += p;
            sum / total > r
        };
        p.iter()
            .position(above)
            .unwrap_or(p.len().saturating_sub(1))
    }

    /// Draws an index into `p` with the probabilities `p`: Gymnasium's `categorical_sample`
    /// (`envs/toy_text/utils.py`).
    ///
    /// Uses one [`random`](Self::random), even for a single outcome, and returns the first index at
    /// which the partial sum of `p` exceeds it, or 0 if there is none.
    #[inline]
    pub fn categorical(&mut self, p: &[f64]) -> usize {
        let r = self.random();
        let mut sum = 0.0;
        let above = |p| {
            sum += p;
            sum > r
        };
        p.iter().position(above).unwrap_or(0)
    }

    /// Draws the number of trials, with success probability `p`, up to and including the first
    /// success.
    ///
    /// For `p` of 1 or more it returns 1; for `p` of 0 or less, or NaN, it returns `i64::MAX` and
    /// draws nothing.
    pub fn geometric(&mut self, p: f64) -> i64 {
        if p >= 1.0 / 3.0 {
            self.geometric_search(p)
        } else if p > 0.0 {
            // the cast limits larger numbers to `i64::MAX`, as numpy does
            (-self.standard_exponential() / ln_1p(-p)).ceil() as i64
        } else {
            i64::MAX
        }
    }

    /// Sums the probabilities of 1, 2, … until the sum reaches a uniform draw.
    fn geometric_search(&mut self, p: f64) -> i64 {
        let r = self.random();
        let (mut trials, mut term, mut sum) = (1, p, p);
        while r > sum {
            term *= 1.0 - p;
            // rounding can stop the sum below the largest draws; numpy would then never return
            if sum + term == sum {
                break;
            }
            sum += term;
            trials += 1;
        }
        trials
    }

    /// Shuffles `items`.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.interval(i));
        }
    }

    /// Returns the numbers from 0 to `n - 1` in random order.
    pub fn permutation(&mut self, n: usize) -> Vec<usize> {
        let mut items: Vec<usize> = (0..n).collect();
        self.shuffle(&mut items);
        items
    }

    /// Draws uniformly from `[0, max]` by masked rejection; `max` must not be 0. numpy's C function
    /// `random_interval`, which uses other words than [`integers`](Self::integers).
    fn interval(&mut self, max: usize) -> usize {
        let mask = usize::MAX >> max.leading_zeros();
        let half = u32::try_from(max).is_ok();
        loop {
            let word = if half {
                u64::from(self.next_u32())
            } else {
                self.next_u64()
            };
            let value = word as usize & mask;
            if value <= max {
                return value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw<T, const N: usize>(seed: u64, mut f: impl FnMut(&mut Generator) -> T) -> [T; N] {
        let mut rng = Generator::from(seed);
        std::array::from_fn(|_| f(&mut rng))
    }

    #[test]
    fn integers_are_numpys() {
        let tens = [
            [8, 6, 5, 2, 3, 0, 0, 0],
            [0, 7, 6, 4, 4, 8, 0, 6],
            [0, 6, 5, 0, 9, 2, 2, 1],
        ];
        let wide = [
            [700346781657, 296633628802],
            [850973674774, 482551947687],
            [750253807875, 59176835991],
        ];
        let subseeds = [
            [1826701614, 1367864806],
            [191664963, 1662057957],
            [33158374, 1465339467],
        ];
        let signed = [[7011, 2738], [-8215, 5478], [-9691, 3646]];
        for (i, seed) in [0, 42, 123].into_iter().enumerate() {
            assert_eq!(draw(seed, |rng| rng.integers(0, 10)), tens[i]);
            assert_eq!(draw(seed, |rng| rng.integers(0, 1 << 40)), wide[i]);
            assert_eq!(
                draw(seed, |rng| rng.integers(0, (1 << 31) - 1)),
                subseeds[i]
            );
            assert_eq!(draw(seed, |rng| rng.integers(-9999, 9999)), signed[i]);
        }
    }

    #[test]
    fn integers_of_wide_ranges_are_numpys() {
        assert_eq!(
            draw(42, |rng| rng.integers(0, 1 << 32)),
            [383329928, 3324115917, 2811363265, 1884968545]
        );
        assert_eq!(
            draw(42, |rng| rng.integers(-(1 << 31), 1 << 31)),
            [-1764153720, 1176632269, 663879617, -262515103]
        );
        let mut rng = Generator::from(42);
        assert_eq!(
            [(); 3].map(|()| rng.integers(i64::MIN, i64::MAX)),
            [
                5053597115156604551,
                -1127493779279708224,
                6614964053969868323
            ]
        );
        // about half of these draws are rejected
        assert_eq!(
            [(); 6].map(|()| rng.integers(-(1 << 62), (1 << 62) + 1)),
            [
                -3743053301415296779,
                4386841898189564358,
                2638477514033744800,
                -3430046321267873655,
                -1191677890399598572,
                1326921525630756611
            ]
        );
        assert_eq!(
            [(); 2].map(|()| rng.integers(0, i64::MAX)),
            [7588636456839696474, 4089774122208370449]
        );
        // about a quarter of these draws are rejected
        let mut rng = Generator::from(42);
        assert_eq!(
            [(); 8].map(|()| rng.integers(0, 3 * (1 << 30) + 1)),
            [
                2493086938, 2108522449, 1394839707, 2765737490, 276850281, 648978800, 303366471,
                1695907497
            ]
        );
        assert_eq!(rng.half, Some(4190266093));
    }

    #[test]
    fn ranges_of_one_value_or_none_draw_nothing() {
        let start = Generator::from(1);
        let mut rng = start.clone();
        for (low, high) in [(4, 5), (4, 4), (4, -9), (i64::MAX, i64::MIN)] {
            assert_eq!(rng.integers(low, high), low);
        }
        for high in [7, 3] {
            let mut bytes = [0; 3];
            rng.integers_u8(7, high, &mut bytes);
            assert_eq!(bytes, [7; 3]);
        }
        assert_eq!((rng.choice(1), rng.choice(0)), (0, 0));
        assert_eq!(rng.permutation(1), [0]);
        assert!(rng.permutation(0).is_empty());
        assert_eq!(rng, start);
    }

    #[test]
    fn the_half_word_outlives_whole_words() {
        let mut rng = Generator::from(42);
        let (first, between, second) = (
            rng.integers(0, 1 << 32),
            rng.random(),
            rng.integers(0, 1 << 32),
        );
        assert_eq!([first, second], [383329928, 3324115917]);
        assert_eq!(between, 0.4388784397520523);
    }

    #[test]
    fn bytes_are_numpys() {
        fn bytes<const N: usize>(rng: &mut Generator, low: u8, high: u8) -> [u8; N] {
            let mut out = [0; N];
            rng.integers_u8(low, high, &mut out);
            out
        }
        for (seed, bits) in [
            (0, [0, 1, 1, 1, 1, 1, 0, 1]),
            (42, [1, 0, 1, 0, 1, 1, 0, 1]),
            (123, [1, 1, 1, 0, 1, 1, 1, 1]),
        ] {
            assert_eq!(bytes(&mut Generator::from(seed), 0, 1), bits);
        }
        // unused bytes of the last four are dropped, but an unused half word is kept
        let mut rng = Generator::from(42);
        assert_eq!(bytes(&mut rng, 3, 7), [5, 3, 7, 3, 7, 7, 3]);
        assert_eq!(bytes(&mut rng, 0, 255), [193, 255, 145, 167, 97]);
        assert_eq!(bytes(&mut rng, 250, 255), [250, 250, 255]);
        assert_eq!(rng.integers(0, 1000), 858);
        // a quarter of these draws are rejected
        let mut rng = Generator::from(42);
        assert_eq!(
            bytes::<200>(&mut rng, 0, 192)
                .iter()
                .map(|&x| u32::from(x))
                .sum::<u32>(),
            18548
        );
        assert_eq!(rng.integers(0, 1000), 469);
    }

    #[test]
    fn choices_are_numpys() {
        let p = [0.1, 0.2, 0.3, 0.4];
        let five = [[4, 3, 2, 1, 1, 0], [0, 3, 3, 2, 2, 4], [0, 3, 2, 0, 4, 1]];
        let weighted = [[3, 1, 0, 0, 3, 3], [3, 2, 3, 3, 0, 3], [3, 0, 1, 1, 1, 3]];
        for (i, seed) in [0, 42, 123].into_iter().enumerate() {
            assert_eq!(draw(seed, |rng| rng.choice(5)), five[i]);
            assert_eq!(draw(seed, |rng| rng.choice_p(&p)), weighted[i]);
            assert_eq!(draw(seed, |rng| rng.categorical(&p)), weighted[i]);
            assert_eq!(
                draw(seed, |rng| rng.choice_p(&p.map(|p| p * 8.0))),
                weighted[i]
            );
        }
        assert_eq!(
            draw(42, |rng| rng.choice_p(&[1.0 / 3.0; 3])),
            [2, 1, 2, 2, 0, 2, 2, 2]
        );
    }

    #[test]
    fn weighted_choices_always_draw_once() {
        for p in [
            &[][..],
            &[1.0],
            &[0.0, 0.0],
            &[f64::NAN],
            &[0.0, 1.0],
            &[-1.0, f64::INFINITY],
        ] {
            let mut rng = Generator::from(5);
            assert!(rng.choice_p(p) < p.len().max(1));
            assert!(rng.categorical(p) < p.len().max(1));
            let mut expected = Generator::from(5);
            expected.random();
            expected.random();
            assert_eq!(rng, expected);
        }
        assert_eq!(Generator::from(5).choice_p(&[0.0, 0.0]), 1);
        assert_eq!(Generator::from(5).categorical(&[0.0, 0.0]), 0);
    }

    #[test]
    fn geometric_is_numpys() {
        let quarter = [[3, 4, 1, 1, 2, 6], [9, 9, 9, 1, 1, 6], [3, 1, 1, 2, 1, 9]];
        let half = [
            [2, 1, 1, 1, 3, 4, 2, 2],
            [3, 1, 3, 2, 1, 6, 3, 3],
            [2, 1, 1, 1, 1, 3, 4, 1],
        ];
        let rare = [[6055, 3285, 2], [1047, 71, 1089], [826, 889, 365]];
        let next = [0.033585575305464355, 0.82276161327083, 0.21376296337509548];
        for (i, seed) in [0, 42, 123].into_iter().enumerate() {
            assert_eq!(draw(seed, |rng| rng.geometric(0.25)), quarter[i]);
            let mut rng = Generator::from(seed);
            assert_eq!([(); 8].map(|()| rng.geometric(0.5)), half[i]);
            assert_eq!(rng.geometric(1.0), 1);
            assert_eq!([(); 3].map(|()| rng.geometric(1e-3)), rare[i]);
            assert_eq!(rng.geometric(1e-300), i64::MAX);
            assert_eq!(rng.random(), next[i]);
        }
        // from a third on, the probabilities are summed
        let third = [
            [3, 1, 1, 1, 5, 7, 3, 4, 2, 7, 5, 1],
            [2, 8, 1, 8, 1, 2, 5, 2, 2, 1, 4, 2],
        ];
        for (seed, expected) in third.into_iter().enumerate() {
            assert_eq!(draw(seed as u64, |rng| rng.geometric(1.0 / 3.0)), expected);
        }
    }

    #[test]
    fn geometric_is_defined_for_every_p() {
        let mut rng = Generator::from(3);
        for p in [1.0, 1.5, f64::INFINITY] {
            assert_eq!(rng.geometric(p), 1);
        }
        let start = rng.clone();
        for p in [0.0, -0.0, -0.5, f64::NEG_INFINITY, f64::NAN] {
            assert_eq!(rng.geometric(p), i64::MAX);
        }
        assert_eq!(rng, start);
        let mean = (0..100_000).map(|_| rng.geometric(0.4) as f64).sum::<f64>() / 100_000.0;
        // five standard errors: the standard deviation is sqrt(0.6) / 0.4
        assert!((mean - 2.5).abs() < 0.031);
    }

    #[test]
    fn permutations_are_numpys() {
        for (seed, order) in [
            (0, [4, 6, 2, 7, 3, 5, 9, 0, 8, 1]),
            (42, [5, 6, 0, 7, 3, 2, 4, 9, 1, 8]),
            (123, [7, 4, 0, 2, 1, 5, 6, 8, 3, 9]),
        ] {
            assert_eq!(Generator::from(seed).permutation(10), order);
            let mut items = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"];
            Generator::from(seed).shuffle(&mut items);
            assert_eq!(
                items,
                order.map(|i| ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9"][i])
            );
        }
        let mut rng = Generator::from(42);
        rng.permutation(10);
        assert_eq!(rng.permutation(5), [2, 4, 0, 3, 1]);
        assert_eq!(rng.random(), 0.12811363267554587);
    }

    #[test]
    fn halves_of_words_are_numpys() {
        // `integers(0, high, dtype=np.uint16, endpoint=True)` after `default_rng(5)`, then a word
        let cases: [(u16, [u16; 12], u32); 7] = [
            (0, [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0], 2881021352),
            (1, [1, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0], 2453218244),
            (9, [8, 6, 6, 2, 6, 3, 0, 2, 0, 4, 0, 4], 2453218244),
            (
                999,
                [897, 671, 601, 207, 678, 375, 17, 279, 66, 402, 9, 462],
                2453218244,
            ),
            (
                40000,
                [
                    35884, 26864, 905, 15038, 25209, 11169, 2644, 399, 15334, 5588, 27999, 5242,
                ],
                194455477,
            ),
            (
                65534,
                [
                    58791, 44013, 39412, 13604, 44479, 24638, 1141, 18299, 4332, 26377, 654, 30340,
                ],
                2453218244,
            ),
            (
                65535,
                [
                    58792, 44014, 39413, 13605, 44480, 24639, 1142, 18300, 4333, 26378, 655, 30341,
                ],
                2453218244,
            ),
        ];
        for (high, expected, next) in cases {
            let mut rng = Generator::from(5);
            assert_eq!(
                [(); 12].map(|()| rng.integer_u16(high)),
                expected,
                "0 to {high}"
            );
            assert_eq!(rng.next_u32(), next, "after 0 to {high}");
        }
        // long enough for halves that are drawn again
        for (high, expected) in [(40000, 2430856275), (33000, 3580527703)] {
            let mut rng = Generator::from(7);
            let sum = (0..4000).fold(0_u32, |sum, _| {
                sum.wrapping_mul(31)
                    .wrapping_add(rng.integer_u16(high).into())
            });
            assert_eq!(sum, expected, "0 to {high}");
        }
    }
}
