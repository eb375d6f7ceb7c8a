//! `pygame.transform.smoothscale`, for shrinking.
//!
//! Each output sample is the mean of the input samples that it covers; the first and the last input
//! sample have a weight. The arithmetic uses 16-bit integers that round down, so an image of one
//! colour becomes up to two levels darker.

/// One output sample: the input samples that it covers, with their weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Phase {
    /// The input sample that the previous output sample covers too, with its remaining weight.
    pub(crate) first: usize,
    pub(crate) first_share: u16,
    /// The first completely covered input sample.
    pub(crate) begin: usize,
    /// The input sample after the completely covered samples, and its weight.
    pub(crate) last: usize,
    pub(crate) last_share: u16,
    /// The factor that turns a sum into a mean.
    pub(crate) reciprocal: u16,
}

/// The weight 1.
const ONE: u32 = 0x4000;

/// Returns `value`, weighted by `share`.
#[inline(always)]
pub(crate) fn part(value: u16, share: u16) -> u16 {
    ((u32::from(4 * value) * u32::from(share)) >> 16) as u16
}

impl Phase {
    /// Returns the mean of the first sample `first`, the completely covered samples with the sum
    /// `whole`, and the last sample `last`.
    #[inline(always)]
    pub(crate) fn mean(&self, first: u16, whole: u16, last: u16) -> u8 {
        self.of(part(first, self.first_share).wrapping_add(whole), last)
    }

    /// Returns the mean. `sum` is the weighted sum of all samples except the last sample `last`.
    #[inline(always)]
    pub(crate) fn of(&self, sum: u16, last: u16) -> u8 {
        let sum = sum.wrapping_add(part(last, self.last_share));
        ((u32::from(sum) * u32::from(self.reciprocal)) >> 16) as u8
    }
}

/// Returns the output samples of a reduction from `from` samples to the smaller number `to`.
pub(crate) fn phases(from: usize, to: usize) -> Vec<Phase> {
    let space = (ONE as usize * from / to.max(1)) as u32;
    let reciprocal = (0x4000_0000 / space.max(1)) as u16;
    let (mut at, mut left, mut first, mut first_share) = (0, space, 0, 0);
    (0..to)
        .map(|_| {
            let begin = at;
            while left > ONE {
                left -= ONE;
                at += 1;
            }
            let phase = Phase {
                first,
                first_share,
                begin,
                last: at,
                last_share: left as u16,
                reciprocal,
            };
            (first, first_share) = (at, (ONE - left) as u16);
            left = space - (ONE - left);
            at += 1;
            phase
        })
        .collect()
}
