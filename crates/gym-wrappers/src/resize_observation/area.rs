//! Resizes 8-bit images like OpenCV's `resize` with `INTER_AREA`
//! (`modules/imgproc/src/resize.cpp`), in its order of operations.

/// A resizer from one image size to another.
#[derive(Clone, Debug)]
pub struct AreaResize {
    source: (usize, usize),
    channels: usize,
    method: Method,
}

#[derive(Clone, Debug)]
enum Method {
    /// Both sizes shrink by an integer factor: a result pixel is the mean of a block of this height
    /// and width.
    Blocks {
        height: usize,
        width: usize,
        out_width: usize,
    },
    /// No size grows: for each row and column of the result, the source rows and columns that it
    /// covers, with their weights.
    Shares {
        rows: Vec<Vec<(usize, f32)>>,
        columns: Vec<Vec<(usize, f32)>>,
    },
    /// A size grows: for each row and column of the result, the two nearest source rows and
    /// columns, with their weights in units of 1/2048.
    Between { rows: Vec<Pair>, columns: Vec<Pair> },
}

type Pair = [(usize, i32); 2];

impl AreaResize {
    /// A resizer from images of the size `source`, `(height, width)`, to the size `target`. No size
    /// may be 0.
    pub fn new(source: (usize, usize), target: (usize, usize), channels: usize) -> Self {
        let inverse = |source: usize, target: usize| target as f64 / source as f64;
        let (inverse_y, inverse_x) = (inverse(source.0, target.0), inverse(source.1, target.1));
        let (scale_y, scale_x) = (1.0 / inverse_y, 1.0 / inverse_x);
        let is_whole = |scale: f64| (scale - scale.round()).abs() < f64::EPSILON;
        let method = if scale_y < 1.0 || scale_x < 1.0 {
            Method::Between {
                rows: between(source.0, target.0, scale_y, inverse_y),
                columns: between(source.1, target.1, scale_x, inverse_x),
            }
        } else if is_whole(scale_y) && is_whole(scale_x) {
            let (height, width) = (scale_y.round() as usize, scale_x.round() as usize);
            Method::Blocks {
                height,
                width,
                out_width: target.1,
            }
        } else {
            Method::Shares {
                rows: shares(source.0, target.0),
                columns: shares(source.1, target.1),
            }
        };
        Self {
            source,
            channels,
            method,
        }
    }

    /// Whether an image has the source size.
    pub fn fits(&self, source: &[u8]) -> bool {
        source.len() == self.source.0 * self.source.1 * self.channels
    }

    /// Fills `out`; both are row by row, a pixel's channels together.
    ///
    /// # Panics
    /// If `source` does not [fit](Self::fits).
    pub fn resize(&self, source: &[u8], out: &mut [u8]) {
        let channels = self.channels;
        let at = |y: usize, x: usize, c: usize| source[(y * self.source.1 + x) * channels + c];
        match &self.method {
            Method::Blocks {
                height,
                width,
                out_width,
            } => {
                let scale = 1.0 / (height * width) as f32;
                for (i, out) in out.iter_mut().enumerate() {
                    let (pixel, c) = (i / channels, i % channels);
                    let (y, x) = (pixel / out_width * height, pixel % out_width * width);
                    let rows = (y..y + height).flat_map(|y| (x..x + width).map(move |x| (y, x)));
                    let sum: u32 = rows.map(|(y, x)| u32::from(at(y, x, c))).sum();
                    *out = match (height, width, channels) {
                        (2, 2, 1 | 3 | 4) => ((sum + 2) >> 2) as u8,
                        _ => saturate(sum as f32 * scale),
                    };
                }
            }
            Method::Shares { rows, columns } => {
                let out = &mut out.iter_mut();
                for row in rows {
                    for column in columns {
                        for (c, out) in (0..channels).zip(&mut *out) {
                            let mut sum = 0.0;
                            for (y, beta) in row {
                                let part = column.iter().fold(0.0, |part, (x, alpha)| {
                                    part + f32::from(at(*y, *x, c)) * alpha
                                });
                                sum += beta * part;
                            }
                            *out = saturate(sum);
                        }
                    }
                }
            }
            Method::Between { rows, columns } => {
                let out = &mut out.iter_mut();
                for row in rows {
                    for [(left, a), (right, b)] in columns {
                        for (c, out) in (0..channels).zip(&mut *out) {
                            let across = |y: usize| {
                                i32::from(at(y, *left, c)) * a + i32::from(at(y, *right, c)) * b
                            };
                            let [upper, lower] =
                                row.map(|(y, share)| (share * (across(y) >> 4)) >> 16);
                            *out = ((upper + lower + 2) >> 2) as u8;
                        }
                    }
                }
            }
        }
    }
}

/// Rounds half to even, like OpenCV's `saturate_cast<uchar>`.
fn saturate(x: f32) -> u8 {
    x.round_ties_even() as u8
}

/// For each of `target` result pixels, of a result that does not grow: the consecutive source
/// pixels that it covers, with their weights. OpenCV's `computeResizeAreaTab`.
pub fn shares(source: usize, target: usize) -> Vec<Vec<(usize, f32)>> {
    /// Smaller weights are dropped.
    const LEAST: f64 = 1e-3;
    let scale = 1.0 / (target as f64 / source as f64);
    let cell = |i: usize| {
        let start = i as f64 * scale;
        let end = start + scale;
        let width = scale.min(source as f64 - start);
        let last = (end.floor() as usize).min(source - 1);
        let first = (start.ceil() as usize).min(last);
        let mut shares = Vec::new();
        if first as f64 - start > LEAST {
            shares.push((first - 1, ((first as f64 - start) / width) as f32));
        }
        shares.extend((first..last).map(|k| (k, (1.0 / width) as f32)));
        if end - last as f64 > LEAST {
            shares.push((
                last,
                ((end - last as f64).min(1.0).min(width) / width) as f32,
            ));
        }
        shares
    };
    (0..target).map(cell).collect()
}

/// OpenCV's linear coefficients in its area mode.
fn between(source: usize, target: usize, scale: f64, inverse: f64) -> Vec<Pair> {
    const ONE: f32 = 2048.0;
    let pair = |i: usize| {
        let left = (i as f64 * scale).floor() as usize;
        let share = ((i + 1) as f64 - (left + 1) as f64 * inverse) as f32;
        let share = if share <= 0.0 {
            0.0
        } else {
            share - share.floor()
        };
        if left + 1 >= source {
            return [(source - 1, ONE as i32), (source - 1, 0)];
        }
        let units = |share: f32| (share * ONE).round_ties_even() as i32;
        [(left, units(1.0 - share)), (left + 1, units(share))]
    };
    (0..target).map(pair).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The images from which OpenCV 5.0.0 computed the vectors below.
    fn picture(height: usize, width: usize, channels: usize) -> Vec<u8> {
        (0..height * width * channels)
            .map(|i| (i * i * 7 + i * 13) as u8)
            .collect()
    }

    fn resize(source: (usize, usize), target: (usize, usize), channels: usize) -> Vec<u8> {
        let mut out = vec![0; target.0 * target.1 * channels];
        let picture = picture(source.0, source.1, channels);
        AreaResize::new(source, target, channels).resize(&picture, &mut out);
        out
    }

    #[test]
    fn a_picture_of_the_same_size_stays() {
        assert_eq!(resize((5, 4), (5, 4), 3), picture(5, 4, 3));
    }

    #[test]
    fn pictures_are_opencvs() {
        type Case = ((usize, usize), (usize, usize), usize, &'static [u8]);
        let cases: &[Case] = &[
            (
                (10, 9),
                (3, 3),
                1,
                &[133, 116, 157, 122, 133, 124, 122, 134, 101],
            ),
            (
                (10, 9),
                (5, 5),
                1,
                &[
                    66, 122, 121, 150, 151, 173, 136, 129, 165, 116, 94, 136, 121, 136, 123, 129,
                    163, 141, 149, 129, 91, 118, 160, 90, 62,
                ],
            ),
            ((10, 9), (1, 1), 3, &[128, 125, 125]),
            (
                (8, 12),
                (2, 3),
                3,
                &[
                    103, 126, 115, 135, 134, 131, 135, 126, 115, 135, 78, 131, 135, 182, 131, 135,
                    110, 147,
                ],
            ),
            ((8, 12), (2, 3), 1, &[104, 160, 120, 136, 96, 120]),
            (
                (8, 12),
                (4, 6),
                1,
                &[
                    58, 102, 202, 166, 122, 134, 122, 134, 138, 134, 122, 102, 122, 166, 138, 102,
                    186, 134, 122, 134, 74, 70, 58, 102,
                ],
            ),
            // larger in one direction or both
            (
                (4, 3),
                (6, 7),
                1,
                &[
                    0, 0, 13, 20, 31, 54, 54, 51, 51, 78, 92, 110, 147, 147, 102, 102, 143, 164,
                    189, 240, 240, 74, 74, 143, 178, 132, 40, 40, 123, 123, 121, 120, 123, 131,
                    131, 172, 172, 99, 62, 115, 222, 222,
                ],
            ),
            (
                (4, 5),
                (7, 3),
                1,
                &[
                    8, 47, 139, 49, 75, 134, 174, 157, 119, 150, 157, 79, 126, 156, 40, 199, 188,
                    165, 224, 198, 208,
                ],
            ),
            (
                (5, 4),
                (3, 6),
                1,
                &[
                    66, 87, 108, 62, 97, 132, 65, 125, 186, 64, 139, 213, 181, 163, 146, 126, 174,
                    222,
                ],
            ),
            (
                (3, 3),
                (5, 3),
                1,
                &[
                    0, 20, 54, 34, 68, 116, 102, 164, 240, 83, 173, 107, 74, 178, 40,
                ],
            ),
            (
                (2, 3),
                (3, 5),
                3,
                &[
                    0, 20, 54, 34, 68, 116, 102, 164, 240, 83, 173, 107, 74, 178, 40, 86, 41, 138,
                    98, 67, 135, 121, 118, 129, 143, 168, 122, 154, 193, 118, 172, 62, 222, 161,
                    65, 154, 140, 72, 18, 203, 163, 137, 234, 208, 196,
                ],
            ),
        ];
        for (source, target, channels, expected) in cases {
            assert_eq!(
                resize(*source, *target, *channels),
                *expected,
                "{source:?} to {target:?}"
            );
        }
    }

    #[test]
    fn one_colour_stays_one_colour() {
        for target in [(3, 3), (2, 7), (5, 5), (20, 30), (1, 1)] {
            let mut out = vec![0; target.0 * target.1];
            AreaResize::new((10, 9), target, 1).resize(&[77; 90], &mut out);
            assert!(out.iter().all(|x| *x == 77), "{target:?}: {out:?}");
        }
    }

    /// OpenCV 5.0.0 rounds the means of two by two pixels up, except with two channels, and those of
    /// other blocks to even numbers.
    #[test]
    fn halves_are_rounded_as_in_opencv() {
        let rounded = |channels: usize, size: usize, sums: [u8; 2]| {
            let width = 2 * size;
            let mut picture = vec![0; size * width * channels];
            // the sum of each block is in its first column
            for (block, sum) in sums.into_iter().enumerate() {
                for row in 0..size {
                    let part = sum / size as u8 + u8::from(row < usize::from(sum) % size);
                    let at = (row * width + block * size) * channels;
                    picture[at..at + channels].fill(part);
                }
            }
            let mut out = vec![0; 2 * channels];
            AreaResize::new((size, width), (1, 2), channels).resize(&picture, &mut out);
            out
        };
        for channels in [1, 3, 4] {
            let expected = [vec![1; channels], vec![3; channels]].concat();
            assert_eq!(
                rounded(channels, 2, [2, 10]),
                expected,
                "{channels} channels"
            );
        }
        assert_eq!(rounded(2, 2, [2, 10]), [0, 0, 2, 2]);
        assert_eq!(rounded(1, 4, [8, 24]), [0, 2]);
        assert_eq!(rounded(1, 4, [9, 23]), [1, 1]);
    }

    #[test]
    fn whole_blocks_are_opencvs() {
        type Case = ((usize, usize), (usize, usize), usize, &'static [u8]);
        let cases: &[Case] = &[
            ((6, 4), (2, 4), 1, &[68, 144, 63, 167, 197, 100, 102, 203]),
            (
                (6, 4),
                (2, 4),
                4,
                &[
                    123, 111, 113, 129, 159, 117, 90, 162, 163, 92, 121, 163, 135, 120, 34, 218,
                    64, 127, 118, 123, 143, 176, 138, 114, 104, 108, 126, 73, 119, 93, 82, 170,
                ],
            ),
            ((6, 6), (2, 3), 1, &[81, 103, 182, 167, 139, 125]),
            (
                (6, 6),
                (2, 3),
                4,
                &[
                    149, 106, 120, 148, 114, 141, 96, 151, 165, 133, 115, 153, 178, 77, 117, 129,
                    58, 154, 136, 132, 109, 103, 112, 92,
                ],
            ),
            ((6, 6), (2, 2), 1, &[66, 178, 179, 108]),
            (
                (6, 6),
                (2, 2),
                4,
                &[
                    138, 124, 123, 136, 147, 129, 98, 165, 136, 105, 117, 142, 94, 118, 127, 93,
                ],
            ),
        ];
        for (source, target, channels, expected) in cases {
            let place = format!("{source:?} to {target:?}, {channels} channels");
            assert_eq!(resize(*source, *target, *channels), *expected, "{place}");
        }
    }
}
