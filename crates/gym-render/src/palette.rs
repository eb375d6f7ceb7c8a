//! Exact colour tables of a GIF.

use std::cmp::Reverse;
use std::collections::HashMap;

use color_quant::NeuQuant;

/// Red, green, blue.
pub(crate) type Rgb = [u8; 3];

/// The entries of a full colour table.
pub(crate) const ENTRIES: usize = 256;
/// The entry of transparent pixels, which is never a colour.
pub(crate) const TRANSPARENT: u8 = 0;
/// The number of most frequent colours that a reduced colour table contains unchanged.
const COMMON: usize = 128;
/// The approximate number of training colours for the quantizer, which chooses the other entries.
const LESSONS: usize = 6000;

/// Up to 255 colours in the order of their first use, numbered from 1.
#[derive(Clone, Debug)]
pub(crate) struct Palette {
    table: Vec<Rgb>,
    index: HashMap<Rgb, u8>,
}

impl Palette {
    pub(crate) fn new() -> Self {
        Self {
            table: vec![[0; 3]],
            index: HashMap::new(),
        }
    }

    /// Returns the bytes of the colour table: entry 0, then the colours.
    pub(crate) fn bytes(&self) -> &[u8] {
        self.table.as_flattened()
    }

    /// Returns the size of the colour table in a file, in bytes. A file has a table whose length is a
    /// power of two.
    pub(crate) fn size(&self) -> usize {
        self.table.len().max(2).next_power_of_two() * 3
    }

    /// Translates `pixels` to `entries`, `None` to [`TRANSPARENT`], and adds new colours. If the
    /// table has no room for all new colours, `translate` adds none of them and returns false.
    pub(crate) fn translate(&mut self, pixels: &[Option<Rgb>], entries: &mut Vec<u8>) -> bool {
        let known = self.table.len();
        entries.clear();
        // most pixels equal the previous one
        let mut last = (None, TRANSPARENT);
        for &pixel in pixels {
            if pixel != last.0 {
                let Some(entry) = pixel.map_or(Some(TRANSPARENT), |color| self.entry(color)) else {
                    self.forget(known);
                    return false;
                };
                last = (pixel, entry);
            }
            entries.push(last.1);
        }
        true
    }

    /// Copies `entries` to `filled`, with [`TRANSPARENT`] replaced by the entries of the true
    /// colours, and adds missing colours. Returns false and adds no colour if the table has no room
    /// for all missing colours, if a reduced palette has only a similar colour, or if no pixel is
    /// transparent.
    pub(crate) fn fill<'a>(
        &mut self,
        entries: &[u8],
        colors: impl Iterator<Item = &'a Rgb>,
        filled: &mut Vec<u8>,
    ) -> bool {
        let known = self.table.len();
        filled.clear();
        let mut last = (None, TRANSPARENT);
        for (&entry, color) in entries.iter().zip(colors) {
            if entry == TRANSPARENT && last.0 != Some(color) {
                let found = self
                    .entry(*color)
                    .filter(|entry| self.table[usize::from(*entry)] == *color);
                let Some(entry) = found else {
                    self.forget(known);
                    return false;
                };
                last = (Some(color), entry);
            }
            filled.push(if entry == TRANSPARENT { last.1 } else { entry });
        }
        last.0.is_some()
    }

    /// Removes the colours with entries from `known` on.
    fn forget(&mut self, known: usize) {
        for color in self.table.drain(known..) {
            self.index.remove(&color);
        }
    }

    fn entry(&mut self, color: Rgb) -> Option<u8> {
        if let Some(&entry) = self.index.get(&color) {
            return Some(entry);
        }
        let entry = u8::try_from(self.table.len()).ok()?;
        self.table.push(color);
        self.index.insert(color, entry);
        Some(entry)
    }

    /// Returns a palette of 255 colours and translates `pixels` to its entries. The most frequent
    /// colours are unchanged. The other colours are approximated; the quantizer counts each of them
    /// once.
    pub(crate) fn reduce(pixels: &[Option<Rgb>], entries: &mut Vec<u8>) -> Self {
        let mut counts = HashMap::<Rgb, usize>::new();
        for color in pixels.iter().flatten() {
            *counts.entry(*color).or_default() += 1;
        }
        let mut colors: Vec<(Rgb, usize)> = counts.into_iter().collect();
        colors.sort_unstable_by_key(|&(color, count)| (Reverse(count), color));
        let (common, rare) = colors.split_at(COMMON.min(colors.len()));
        let mut palette = Self::new();
        for (color, _) in common {
            palette.entry(*color);
        }
        let first = palette.table.len();
        let rgba = |[r, g, b]: Rgb| [r, g, b, 255];
        // with few colours, the network needs repetitions to learn
        let lessons = rare.iter().cycle().take(rare.len().max(LESSONS));
        let sample: Vec<u8> = lessons.flat_map(|(color, _)| rgba(*color)).collect();
        let factor = (rare.len() / LESSONS).clamp(1, 30) as i32;
        let network = NeuQuant::new(factor, ENTRIES - first, &sample);
        palette.table.extend(network.color_map_rgb().as_chunks().0);
        entries.clear();
        entries.extend(pixels.iter().map(|pixel| {
            pixel.map_or(TRANSPARENT, |color| {
                *palette
                    .index
                    .entry(color)
                    .or_insert_with(|| (first + network.index_of(&rgba(color))) as u8)
            })
        }));
        palette
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shades(range: std::ops::Range<u16>) -> Vec<Option<Rgb>> {
        range.map(|i| Some([(i >> 8) as u8, i as u8, 0])).collect()
    }

    #[test]
    fn colours_are_numbered_as_they_come() {
        let mut palette = Palette::new();
        let mut entries = Vec::new();
        let pixels = [Some([9, 9, 9]), None, Some([0, 0, 0]), Some([9, 9, 9])];
        assert!(palette.translate(&pixels, &mut entries));
        assert_eq!(entries, [1, 0, 2, 1]);
        assert!(palette.translate(&[Some([5, 6, 7])], &mut entries));
        assert_eq!(entries, [3]);
        assert_eq!(palette.bytes(), [0, 0, 0, 9, 9, 9, 0, 0, 0, 5, 6, 7]);
    }

    #[test]
    fn a_full_palette_takes_no_more_and_stays_as_it_was() {
        let mut palette = Palette::new();
        let mut entries = Vec::new();
        assert!(palette.translate(&shades(0..200), &mut entries));
        assert!(!palette.translate(&shades(150..256), &mut entries));
        assert_eq!(palette.bytes().len(), 201 * 3);
        assert!(palette.translate(&shades(150..255), &mut entries));
        assert_eq!(entries, (151..=255).collect::<Vec<u8>>());
        assert!(!palette.translate(&shades(255..256), &mut entries));
    }

    #[test]
    fn transparent_pixels_take_their_true_colours() {
        let mut palette = Palette::new();
        let mut entries = Vec::new();
        let colors = [[9, 9, 9], [0, 0, 0], [9, 9, 9], [9, 9, 9]];
        assert!(palette.translate(
            &[Some(colors[0]), Some(colors[1]), None, None],
            &mut entries
        ));
        let mut filled = Vec::new();
        assert!(palette.fill(&entries, colors.iter(), &mut filled));
        assert_eq!(filled, [1, 2, 1, 1]);
        assert!(palette.fill(
            &[1, TRANSPARENT],
            [[9, 9, 9], [7, 7, 7]].iter(),
            &mut filled
        ));
        assert_eq!((&filled[..], palette.bytes().len()), (&[1, 3][..], 4 * 3));
        assert!(
            !palette.fill(&[1, 2], colors.iter(), &mut filled),
            "nothing is transparent"
        );
    }

    #[test]
    fn transparent_pixels_stay_where_a_palette_lacks_their_colours() {
        let (mut entries, mut filled) = (Vec::new(), Vec::new());
        let mut full = Palette::new();
        assert!(full.translate(&shades(0..254), &mut entries));
        assert!(!full.fill(
            &[TRANSPARENT; 2],
            [[7, 7, 7], [8, 8, 8]].iter(),
            &mut filled
        ));
        assert_eq!(full.bytes().len(), 255 * 3);

        let shades: Vec<_> = (0..64)
            .flat_map(|r| (0..64).map(move |g| Some([r * 4, g * 4, 0])))
            .collect();
        let mut reduced = Palette::reduce(&shades, &mut entries);
        let near = shades
            .iter()
            .flatten()
            .find(|color| !reduced.table.contains(color))
            .unwrap();
        assert!(!reduced.fill(&[TRANSPARENT], [*near].iter(), &mut filled));
    }

    /// The pixels that a moving pole uncovers: a few pixels of sky, with another colour in each
    /// row, and many pixels of the pole.
    #[test]
    fn rare_colours_are_near_and_common_ones_stay() {
        let sky = (0..150_u8).map(|y| [90 + y / 2, 140 + y / 2, 190 + y / 4]);
        let pole = (0..200_u8).map(|x| [x / 8, 170 - x / 2, 160 - x / 3]);
        let pole = pole.flat_map(|color| [Some(color); 30]);
        let pixels: Vec<_> = sky.map(Some).chain(pole).collect();
        let mut entries = Vec::new();
        let palette = Palette::reduce(&pixels, &mut entries);
        let distance = |(pixel, entry): (&Option<Rgb>, &u8)| {
            let near = palette.table[usize::from(*entry)];
            pixel.map_or(0, |color| {
                color
                    .iter()
                    .zip(near)
                    .map(|(a, b)| a.abs_diff(b))
                    .max()
                    .unwrap_or(0)
            })
        };
        let worst = |range: std::ops::Range<usize>| {
            pixels[range.clone()]
                .iter()
                .zip(&entries[range])
                .map(distance)
                .max()
                .unwrap_or(0)
        };
        assert!(worst(0..150) <= 4, "{}", worst(0..150));
        let exact = pixels
            .iter()
            .zip(&entries)
            .filter(|pair| distance(*pair) == 0)
            .count();
        assert!(exact >= 30 * COMMON, "{exact}");
    }

    #[test]
    fn a_reduced_palette_is_near() {
        let pixels: Vec<_> = (0..4096)
            .map(|i| (i % 7 > 0).then_some([(i % 64 * 4) as u8, (i / 64 * 4) as u8, 40]))
            .collect();
        let mut entries = Vec::new();
        let palette = Palette::reduce(&pixels, &mut entries);
        assert_eq!(palette.bytes().len(), 256 * 3);
        for (pixel, &entry) in pixels.iter().zip(&entries) {
            let Some(color) = pixel else {
                assert_eq!(entry, TRANSPARENT);
                continue;
            };
            let near = palette.table[usize::from(entry)];
            assert!(
                color.iter().zip(near).all(|(a, b)| a.abs_diff(b) < 40),
                "{color:?} {near:?}"
            );
        }
    }
}
