//! The values of a series: which are drawn, their range and their moving average.

use super::{LARGEST, PADDING};

pub(super) fn is_drawn(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// Returns the range of the finite values, extended by [`PADDING`].
pub(super) fn padded(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (min, max) = values
        .filter(|&value| is_drawn(value))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), value| {
            (min.min(value), max.max(value))
        });
    if min > max {
        return (0.0, 1.0);
    }
    let size = min.abs().max(max.abs());
    // values that differ only by rounding errors count as equal
    let flat = max - min <= 1e-9 * size;
    let space = if !flat {
        PADDING[1] * (max - min)
    } else if size > 0.0 {
        0.5 * size
    } else {
        1.0
    };
    (min - space, max + space)
}

/// Returns for each value the mean of the last `window` finite values; NaN if there is none.
///
/// The values are divided into blocks of `window`. Each mean combines two partial sums, one in the
/// block in which the window ends and one in the block before, so the cost does not depend on
/// `window`.
pub(super) fn moving_average(values: &[f64], window: usize) -> Vec<f64> {
    let add = |(sum, count): (f64, f64), &value: &f64| {
        if is_drawn(value) {
            (sum + value, count + 1.0)
        } else {
            (sum, count)
        }
    };
    let sums = |total: &mut (f64, f64), value| {
        *total = add(*total, value);
        Some(*total)
    };
    let window = window.clamp(1, values.len().max(1));
    let mut before: Vec<(f64, f64)> = Vec::new();
    let mut means = Vec::with_capacity(values.len());
    for block in values.chunks(window) {
        for (i, (sum, count)) in block.iter().scan((0.0, 0.0), sums).enumerate() {
            let (sum_before, count_before) = before.get(i + 1).copied().unwrap_or_default();
            means.push((sum_before + sum) / (count_before + count));
        }
        before = block.iter().rev().scan((0.0, 0.0), sums).collect();
        before.reverse();
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_has_space_around_the_values() {
        assert_eq!(
            padded([0.0, f64::NAN, 100.0, f64::INFINITY].into_iter()),
            (-5.0, 105.0)
        );
        assert_eq!(padded([4.0, 4.0].into_iter()), (2.0, 6.0));
        assert_eq!(padded([0.0].into_iter()), (-1.0, 1.0));
        assert_eq!(padded([f64::NAN].into_iter()), (0.0, 1.0));
    }

    #[test]
    fn the_average_looks_back() {
        assert_eq!(
            moving_average(&[1.0, 2.0, 6.0, f64::NAN, 4.0], 2),
            [1.0, 1.5, 4.0, 6.0, 4.0]
        );
        assert!(moving_average(&[f64::NAN], 3)[0].is_nan());
        assert_eq!(moving_average(&[], 3), [0.0; 0]);
    }

    #[test]
    fn the_average_is_the_mean_of_each_window() {
        // integers: their sums are exact in any order
        let values: Vec<f64> = (0..40)
            .map(|i| {
                if i % 7 == 3 {
                    f64::NAN
                } else {
                    f64::from(i * i % 31)
                }
            })
            .collect();
        for window in [1, 2, 3, 5, 13, 39, 40, 41, usize::MAX] {
            let expected: Vec<f64> = (0..values.len())
                .map(|end| {
                    let last = &values[(end + 1).saturating_sub(window)..=end];
                    let drawn: Vec<f64> = last
                        .iter()
                        .copied()
                        .filter(|value| !value.is_nan())
                        .collect();
                    drawn.iter().sum::<f64>() / drawn.len() as f64
                })
                .collect();
            let means = moving_average(&values, window);
            assert_eq!(
                format!("{means:?}"),
                format!("{expected:?}"),
                "a window of {window}"
            );
        }
    }

    /// The cost does not depend on the window: a million values with a window of 500,000 would take
    /// minutes if each mean were summed separately.
    #[test]
    fn a_large_window_costs_no_more_than_a_small_one() {
        let means = moving_average(&vec![2.0; 1_000_000], 500_000);
        assert!(means.len() == 1_000_000 && means.iter().all(|&mean| mean == 2.0));
    }
}
