//! Generators that take less memory.

use std::fmt;

use rand::Rng;
use rand_pcg::Pcg64;

use super::Generator;

/// The stream of random numbers of one environment in a vector: a [`Generator`], or the part of its
/// state that the environment needs.
pub trait Stream: Clone + fmt::Debug + Send + 'static {
    /// Makes a stream that continues where `generator` is.
    fn new(generator: Generator) -> Self;

    /// Calls `f` with the stream as a [`Generator`].
    fn lend<R>(&mut self, f: impl FnOnce(&mut Generator) -> R) -> R;

    /// Returns [`Generator::words`].
    fn words(&self) -> [u64; 5];

    /// Makes a stream from [`Generator::words`].
    ///
    /// # Errors
    /// The errors of [`Generator::from_words`].
    fn from_words(words: [u64; 5]) -> Result<Self, String> {
        Generator::from_words(words).map(Self::new)
    }

    /// Draws a [`Generator::random`].
    #[inline(always)]
    fn random(&mut self) -> f64 {
        self.lend(Generator::random)
    }

    /// Draws a [`random`](Self::random) and drops it.
    #[inline(always)]
    fn skip(&mut self) {
        self.lend(Rng::next_u64);
    }
}

impl Stream for Generator {
    fn new(generator: Generator) -> Self {
        generator
    }

    #[inline(always)]
    fn lend<R>(&mut self, f: impl FnOnce(&mut Generator) -> R) -> R {
        f(self)
    }

    fn words(&self) -> [u64; 5] {
        self.words()
    }
}

/// The [`Stream`] of an environment that draws only whole words, such as
/// [`random`](Generator::random) and [`uniform`](Generator::uniform). It takes 32 bytes, because it
/// stores no half word.
#[derive(Clone, Debug)]
pub struct WordStream(Pcg64);

impl Stream for WordStream {
    fn new(generator: Generator) -> Self {
        Self(generator.pcg)
    }

    #[inline(always)]
    fn lend<R>(&mut self, f: impl FnOnce(&mut Generator) -> R) -> R {
        let mut generator = Generator {
            pcg: self.0.clone(),
            half: None,
        };
        let result = f(&mut generator);
        debug_assert!(generator.half.is_none(), "half a word would be lost");
        self.0 = generator.pcg;
        result
    }

    fn words(&self) -> [u64; 5] {
        Generator {
            pcg: self.0.clone(),
            half: None,
        }
        .words()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stream_continues_its_generator() {
        let mut rng = Generator::from(3);
        rng.random();
        let mut stream = WordStream::new(rng.clone());
        for _ in 0..5 {
            assert_eq!(stream.random(), rng.random());
            stream.skip();
            rng.random();
            assert_eq!(
                stream.lend(|rng| rng.uniform(-2.0, 3.0)),
                rng.uniform(-2.0, 3.0)
            );
        }
        assert_eq!(size_of::<WordStream>(), 32);
    }
}
