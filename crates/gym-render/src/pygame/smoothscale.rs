//! `pygame.transform.smoothscale`, for shrinking.
//!
//! Each sample of the smaller image is the mean of the samples it covers, partly at its ends, in
//! 16-bit integers that round down: a plain image becomes up to two levels darker.

/// One sample of the smaller image: its start and its shares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Phase {
    /// The sample that it takes over from the one before, with the share that is left of it.
    pub(crate) first: usize,
    pub(crate) first_share: u16,
    /// The first sample that belongs to it as a whole.
    pub(crate) begin: usize,
    /// The sample after those that do, and its share.
    pub(crate) last: usize,
    pub(crate) last_share: u16,
    /// The factor that turns a sum into a mean.
    pub(crate) reciprocal: u16,
}

/// A share of 1.
const ONE: u32 = 0x4000;

/// The part of a sample that a share is.
#[inline(always)]
pub(crate) fn part(value: u16, share: u16) -> u16 {
    ((u32::from(4 * value) * u32::from(share)) >> 16) as u16
}

impl Phase {
    /// The mean, from the sum of the whole samples and those at the ends.
    #[inline(always)]
    pub(crate) fn mean(&self, first: u16, whole: u16, last: u16) -> u8 {
        self.of(part(first, self.first_share).wrapping_add(whole), last)
    }

    /// The mean, from the sum of all but the sample at its end.
    #[inline(always)]
    pub(crate) fn of(&self, sum: u16, last: u16) -> u8 {
        let sum = sum.wrapping_add(part(last, self.last_share));
        ((u32::from(sum) * u32::from(self.reciprocal)) >> 16) as u8
    }
}

/// The reduction of `from` samples to `to`, which are fewer.
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
