//! The difference between two frames.

use std::ops::Range;

use gym_core::render::Frame;

/// Returns the columns and rows of the smallest rectangle that contains every changed pixel. If no
/// pixel changed, the rectangle is one pixel.
pub(crate) fn changed(old: Option<&Frame>, new: &Frame) -> (Range<usize>, Range<usize>) {
    let Some(old) = old else {
        return (0..new.width() as usize, 0..new.height() as usize);
    };
    let row = new.width() as usize * 3;
    let (mut columns, mut rows) = (row..0, 0..0);
    for (y, (old, new)) in old
        .pixels()
        .chunks_exact(row)
        .zip(new.pixels().chunks_exact(row))
        .enumerate()
    {
        if old == new {
            continue;
        }
        rows = if rows.is_empty() {
            y..y + 1
        } else {
            rows.start..y + 1
        };
        let differs = |(old, new): (&u8, &u8)| old != new;
        let before = old[..columns.start]
            .iter()
            .zip(&new[..columns.start])
            .position(differs);
        columns.start = before.unwrap_or(columns.start);
        let after = old[columns.end..]
            .iter()
            .zip(&new[columns.end..])
            .rposition(differs);
        columns.end += after.map_or(0, |distance| distance + 1);
    }
    if rows.is_empty() {
        (0..1, 0..1)
    } else {
        (columns.start / 3..columns.end.div_ceil(3), rows)
    }
}
