//! LZW as GIF has it, of pixels that may have a choice.
//!
//! A pixel that did not change can be transparent or have its colour again, and a decoder does not care which: the
//! encoder takes what makes the longer phrase. It looks one phrase ahead, as a phrase that is a pixel
//! shorter sometimes lets the next one be much longer.

/// What a pixel may be: an entry of the colour table, or another one.
pub(crate) type Choice = [u8; 2];

/// A dictionary has no more codes (GIF89a specification, appendix F).
const CODES: u16 = 4096;
/// Bits of the longest code.
const WIDEST: u32 = 12;
const SLOTS: usize = 4 * CODES as usize;
const EMPTY: u32 = u32::MAX;

/// Compresses, and keeps its buffers.
#[derive(Debug)]
pub(crate) struct Lzw {
    /// The dictionary as a hash table of phrases: the code of all but the last symbol (12 bits), that symbol (8
    /// bits), the code of the phrase (12 bits).
    slots: Vec<u32>,
    /// The first symbol of each phrase.
    firsts: Vec<u8>,
    /// The phrases that the next pixels can be, shorter ones first, and where those of a length end.
    phrases: Vec<u16>,
    ends: Vec<usize>,
}

impl Default for Lzw {
    fn default() -> Self {
        Self {
            slots: vec![EMPTY; SLOTS],
            firsts: vec![0; CODES.into()],
            phrases: Vec::new(),
            ends: Vec::new(),
        }
    }
}

impl Lzw {
    /// The bytes of a picture, as short as they get: the size of the smallest codes, then the codes.
    pub(crate) fn compress(&mut self, pixels: &[Choice]) -> Vec<u8> {
        // a choice that differs from pixel to pixel is harder to find again
        let mut best = self.attempt(pixels, |[_, b]| [b; 2], false);
        let first = self.attempt(pixels, |[a, _]| [a; 2], false);
        let either = self.attempt(pixels, |choice| choice, true);
        for bytes in [first, either] {
            if bytes.len() < best.len() {
                best = bytes;
            }
        }
        best
    }

    /// Compresses pixels whose choices `narrow` narrows down.
    fn attempt(
        &mut self,
        pixels: &[Choice],
        narrow: impl Fn(Choice) -> Choice + Copy,
        ahead: bool,
    ) -> Vec<u8> {
        let largest = pixels.iter().flat_map(|choice| narrow(*choice)).max().unwrap_or(0);
        let bits = (u8::BITS - largest.leading_zeros()).max(2);
        let (clear, end) = (1 << bits, (1 << bits) + 1);
        let mut writer = Writer { bytes: vec![bits as u8], pending: 0, count: 0 };
        let mut next = end + 1;
        writer.put(clear, next);
        self.slots.fill(EMPTY);
        self.firsts.iter_mut().zip(0..=u8::MAX).for_each(|(first, symbol)| *first = symbol);
        let mut rest = pixels;
        let mut before = None;
        while !rest.is_empty() {
            let Some(last) = before else {
                let (length, code) = self.phrase(rest, narrow, ahead);
                writer.put(code, next);
                (rest, before) = (&rest[length..], Some(code));
                continue;
            };
            // The decoder's next phrase is the last one and the first symbol of this one. This one can be that
            // very phrase, if it begins as the last one does.
            let guess = self.firsts[usize::from(last)];
            self.firsts[usize::from(next)] = guess;
            let guessed = self.insert(last, guess, next);
            let (length, code) = self.phrase(rest, narrow, ahead);
            let first = self.firsts[usize::from(code)];
            if first != guess {
                if let Some(slot) = guessed {
                    self.slots[slot] = EMPTY;
                }
                self.insert(last, first, next);
            }
            writer.put(code, next);
            next += 1;
            (rest, before) = (&rest[length..], Some(code));
            if next == CODES {
                writer.put(clear, next);
                self.slots.fill(EMPTY);
                (next, before) = (end + 1, None);
            }
        }
        writer.put(end, next);
        writer.finish()
    }

    /// The phrase to take: its length and its code.
    fn phrase(
        &mut self,
        pixels: &[Choice],
        narrow: impl Fn(Choice) -> Choice + Copy,
        ahead: bool,
    ) -> (usize, u16) {
        let length = self.longest(pixels, narrow);
        let longest = (length, self.oldest(length));
        if !ahead || length == 1 || length == pixels.len() {
            return longest;
        }
        let shorter = (length - 1, self.oldest(length - 1));
        let after = self.longest(&pixels[length..], narrow);
        if self.longest(&pixels[length - 1..], narrow) > after + 1 { shorter } else { longest }
    }

    /// Finds all phrases that the next pixels can be, and returns the length of the longest.
    fn longest(&mut self, pixels: &[Choice], narrow: impl Fn(Choice) -> Choice) -> usize {
        self.phrases.clear();
        self.ends.clear();
        let mut from = 0;
        for choice in pixels {
            let [a, b] = narrow(*choice);
            let known = self.phrases.len();
            if self.ends.is_empty() {
                self.phrases.push(a.into());
                if b != a {
                    self.phrases.push(b.into());
                }
            } else {
                for i in from..known {
                    let phrase = self.phrases[i];
                    self.phrases.extend(self.find(phrase, a).ok());
                    if b != a {
                        self.phrases.extend(self.find(phrase, b).ok());
                    }
                }
            }
            if self.phrases.len() == known {
                break;
            }
            from = known;
            self.ends.push(self.phrases.len());
        }
        self.ends.len()
    }

    /// The oldest phrase of a length, of those found.
    fn oldest(&self, length: usize) -> u16 {
        let start = if length > 1 { self.ends[length - 2] } else { 0 };
        self.phrases[start..self.ends[length - 1]].iter().copied().min().unwrap_or_default()
    }

    /// The code of a phrase and a symbol, or the slot for it.
    #[inline]
    fn find(&self, phrase: u16, symbol: u8) -> Result<u16, usize> {
        let key = u32::from(phrase) << 8 | u32::from(symbol);
        let mut slot = key.wrapping_mul(0x9e37_79b1) as usize >> (u32::BITS - SLOTS.ilog2());
        loop {
            match self.slots[slot] {
                EMPTY => return Err(slot),
                found if found >> 12 == key => return Ok((found & 0xfff) as u16),
                _ => slot = (slot + 1) % SLOTS,
            }
        }
    }

    /// Adds a phrase and a symbol, if they are not known, and returns the slot.
    fn insert(&mut self, phrase: u16, symbol: u8, code: u16) -> Option<usize> {
        let slot = self.find(phrase, symbol).err()?;
        self.slots[slot] = u32::from(phrase) << 20 | u32::from(symbol) << 12 | u32::from(code);
        Some(slot)
    }
}

/// Packs codes into bytes, lowest bits first.
struct Writer {
    bytes: Vec<u8>,
    pending: u32,
    count: u32,
}

impl Writer {
    /// Writes a code while the dictionary has so many; the decoder's is then one behind.
    fn put(&mut self, code: u16, codes: u16) {
        self.pending |= u32::from(code) << self.count;
        self.count += (u16::BITS - codes.leading_zeros()).min(WIDEST);
        while self.count >= 8 {
            self.bytes.push(self.pending as u8);
            self.pending >>= 8;
            self.count -= 8;
        }
    }

    fn finish(mut self) -> Vec<u8> {
        if self.count > 0 {
            self.bytes.push(self.pending as u8);
        }
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use gif::{ColorOutput, DecodeOptions, Encoder};

    use super::*;

    fn decode(bytes: &[u8], pixels: usize) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = Encoder::new(&mut file, pixels as u16, 1, &[0; 768]).unwrap();
        let (width, buffer) = (pixels as u16, bytes.into());
        let picture = gif::Frame { width, height: 1, buffer, ..gif::Frame::default() };
        encoder.write_lzw_pre_encoded_frame(&picture).unwrap();
        drop(encoder);
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::Indexed);
        let mut decoder = options.read_info(&file[..]).unwrap();
        decoder.read_next_frame().unwrap().unwrap().buffer.to_vec()
    }

    /// Numbers that look random.
    fn noise(seed: u32) -> impl Iterator<Item = u8> {
        let next = |x: &u32| Some(x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
        std::iter::successors(next(&seed), next).map(|x| (x >> 24) as u8)
    }

    #[test]
    fn every_pixel_comes_back_as_one_of_its_choices() {
        let mut lzw = Lzw::default();
        for (seed, colors) in [(1, 1), (2, 2), (3, 5), (4, 40), (5, 255)] {
            for length in [1, 2, 3, 50, 1000, 60_000] {
                for often in [0, 100, 256] {
                    let mut noise = noise(seed);
                    let mut next = || noise.next().map_or(0, usize::from);
                    let pixels: Vec<Choice> = (0..length)
                        .map(|_| {
                            let color = (next() * next() / 256 * colors / 255) as u8 + 1;
                            if next() < often { [0, color] } else { [color; 2] }
                        })
                        .collect();
                    for ahead in [false, true] {
                        let bytes = lzw.attempt(&pixels, |choice| choice, ahead);
                        let decoded = decode(&bytes, length);
                        assert_eq!(decoded.len(), length);
                        assert!(pixels.iter().zip(decoded).all(|(choice, pixel)| choice.contains(&pixel)));
                    }
                    let bytes = lzw.compress(&pixels);
                    assert!(pixels.iter().zip(decode(&bytes, length)).all(|(a, b)| a.contains(&b)));
                }
            }
        }
    }

    #[test]
    fn choices_make_it_shorter() {
        let mut lzw = Lzw::default();
        let changed = noise(7).take(2000).map(|x| if x < 128 { [1; 2] } else { [0, 1] });
        // a plain part, of which some changed, and a colourful one, of which nothing did
        let pixels: Vec<Choice> = changed.chain(noise(8).take(2000).map(|x| [0, 2 + x / 8])).collect();
        let mut size = |narrow: fn(Choice) -> Choice| {
            let pixels: Vec<Choice> = pixels.iter().map(|choice| narrow(*choice)).collect();
            lzw.compress(&pixels).len()
        };
        let [either, transparent, opaque] = [size(|c| c), size(|[a, _]| [a; 2]), size(|[_, b]| [b; 2])];
        assert!(2 * either < transparent.min(opaque), "{either} {transparent} {opaque}");
    }

    #[test]
    fn a_run_is_made_of_phrases_that_grow() {
        assert!(Lzw::default().compress(&[[1; 2]; 5000]).len() < 100);
    }
}
