//! The channels of a node side by side in one word, so that one instruction works at all of them.
//!
//! Three channels of at most 255 are in 16 bits each, one of at most 65,535 in 20 bits and more.

/// Lanes for `N` channels, 1 or 3.
pub(super) struct Lanes<const N: usize>;

impl<const N: usize> Lanes<N> {
    /// Bit offset between adjacent channels.
    const SHIFT: u32 = 16;

    /// One in each lane.
    const ONES: u64 = if N == 1 { 1 } else { 1 | 1 << 16 | 1 << 32 };

    /// A bit above every channel.
    const HIGH_BIT: u32 = if N == 1 { 20 } else { 15 };

    /// All bits below it.
    const LOW: u64 = (1 << Self::HIGH_BIT) - 1;

    const HIGH: u64 = Self::ONES << Self::HIGH_BIT;

    #[inline(always)]
    pub(super) fn pack(channels: [u16; N]) -> u64 {
        (0..)
            .zip(channels)
            .map(|(lane, channel)| u64::from(channel) << (Self::SHIFT * lane))
            .sum()
    }

    /// The lane of a channel. Precondition: no lane is above 65,535 where there are several.
    #[inline(always)]
    pub(super) fn get(word: u64, channel: usize) -> i32 {
        if N == 1 {
            word as i32
        } else {
            i32::from((word >> (Self::SHIFT * channel as u32)) as u16)
        }
    }

    /// Returns the absolute difference of two nodes in each channel, less one where the second is above the first.
    #[inline(always)]
    pub(super) fn differing(one: u64, other: u64) -> u64 {
        let above = (one | Self::HIGH) - other;
        let is_below = (!above & Self::HIGH) >> Self::HIGH_BIT;
        (above & !Self::HIGH) ^ (is_below * Self::LOW)
    }

    /// Returns the limit that [`Lanes::is_within`] compares a difference with.
    pub(super) fn limit(max: u64) -> u64 {
        (Self::LOW - max) * Self::ONES
    }

    /// Returns true if no lane of a difference exceeds the limit.
    #[inline(always)]
    pub(super) fn is_within(differing: u64, limit: u64) -> bool {
        (differing + limit) & Self::HIGH == 0
    }

    /// The number of bits of the largest lane, of differences or of all of them or-ed.
    #[inline(always)]
    pub(super) fn bits(differing: u64) -> u32 {
        let largest = if N == 1 {
            differing
        } else {
            (differing | differing >> 16 | differing >> 32) & 0xffff
        };
        u64::BITS - largest.leading_zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn differ<const N: usize>(one: [u16; N], other: [u16; N], max: u16) {
        type L<const N: usize> = Lanes<N>;
        let found = L::<N>::differing(L::<N>::pack(one), L::<N>::pack(other));
        let expected: Vec<i32> = one
            .iter()
            .zip(other)
            .map(|(&one, other)| i32::from(one) - i32::from(other))
            .map(|differing| if differing < 0 { -differing - 1 } else { differing })
            .collect();
        for (channel, &expected) in expected.iter().enumerate() {
            assert_eq!(L::<N>::get(found, channel), expected);
        }
        let largest = expected.into_iter().max().unwrap_or(0);
        let is_within = L::<N>::is_within(found, L::<N>::limit(u64::from(max)));
        assert_eq!(is_within, largest <= i32::from(max));
        assert_eq!(L::<N>::bits(found), 32 - largest.leading_zeros());
    }

    proptest! {
        #[test]
        fn lanes_are_subtracted_independently(one in any::<[u8; 3]>(), other in any::<[u8; 3]>(), max in any::<u8>()) {
            differ(one.map(u16::from), other.map(u16::from), u16::from(max));
        }

        #[test]
        fn one_lane_may_be_wide(one in any::<u16>(), other in any::<u16>(), max in any::<u16>()) {
            differ([one], [other], max);
        }
    }
}
