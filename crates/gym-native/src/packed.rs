//! The layout of states in the blocks of a native vector, and in snapshots.

use std::fmt;

use gym_core::{Error, Result, Snapshot};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::LANES;

/// The stored form of an environment's state between steps.
pub trait Packed: Copy + fmt::Debug + Send + Sync + 'static {
    /// The numbers of [`LANES`] environments.
    type Block: Clone + fmt::Debug + Send + Sync + 'static;

    /// A block in which each environment has `self`.
    fn splat(self) -> Self::Block;

    /// The value of the environment `lane`, which is below [`LANES`].
    fn get(block: &Self::Block, lane: usize) -> Self;

    /// Overwrites the value of the environment `lane`, which is below [`LANES`].
    fn set(self, block: &mut Self::Block, lane: usize);

    /// Appends the stored form of `self` to `bytes`.
    ///
    /// # Errors
    /// [`Error::Snapshot`] if it has none.
    fn put(self, bytes: &mut Vec<u8>) -> Result<()>;

    /// Reads the value that [`put`](Self::put) wrote, and advances past it; `None` if the bytes do
    /// not fit. [`is_valid`](gym_core::Task::is_valid) decides whether the state is valid.
    fn take(bytes: &mut &[u8]) -> Option<Self>;
}

/// Column by column: number 0 of all environments, then number 1, and so on.
impl<const K: usize> Packed for [f64; K] {
    type Block = [[f64; LANES]; K];

    fn splat(self) -> Self::Block {
        self.map(|x| [x; LANES])
    }

    #[inline(always)]
    fn get(block: &Self::Block, lane: usize) -> Self {
        std::array::from_fn(|k| block[k][lane])
    }

    #[inline(always)]
    fn set(self, block: &mut Self::Block, lane: usize) {
        for k in 0..K {
            block[k][lane] = self[k];
        }
    }

    fn put(self, bytes: &mut Vec<u8>) -> Result<()> {
        self.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        Ok(())
    }

    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let mut numbers = [0.0; K];
        for x in &mut numbers {
            let (first, rest) = bytes.split_first_chunk()?;
            (*x, *bytes) = (f64::from_le_bytes(*first), rest);
        }
        Some(numbers)
    }
}

/// A state that is stored as a whole, not as columns of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Unpacked<S>(pub S);

impl<S> Packed for Unpacked<S>
where
    S: Copy + fmt::Debug + Send + Sync + Serialize + DeserializeOwned + 'static,
{
    type Block = [S; LANES];

    fn splat(self) -> Self::Block {
        [self.0; LANES]
    }

    #[inline(always)]
    fn get(block: &Self::Block, lane: usize) -> Self {
        Self(block[lane])
    }

    #[inline(always)]
    fn set(self, block: &mut Self::Block, lane: usize) {
        block[lane] = self.0;
    }

    /// Writes the length of the state's JSON text, then the text.
    fn put(self, bytes: &mut Vec<u8>) -> Result<()> {
        let text = serde_json::to_vec(&Snapshot::of(&self.0)?);
        let text = text.map_err(|error| Error::Snapshot(error.to_string()))?;
        bytes.extend((text.len() as u64).to_le_bytes());
        bytes.extend(text);
        Ok(())
    }

    fn take(bytes: &mut &[u8]) -> Option<Self> {
        let (len, rest) = bytes.split_first_chunk()?;
        let (text, rest) =
            rest.split_at_checked(usize::try_from(u64::from_le_bytes(*len)).ok()?)?;
        *bytes = rest;
        serde_json::from_slice::<Snapshot>(text)
            .ok()?
            .get()
            .ok()
            .map(Self)
    }
}

#[cfg(test)]
mod tests {
    use serde::{Deserialize, Serializer, ser};

    use super::*;

    #[derive(Clone, Copy, Debug, Deserialize)]
    struct Secret;

    impl Serialize for Secret {
        fn serialize<S: Serializer>(&self, _: S) -> std::result::Result<S::Ok, S::Error> {
            Err(ser::Error::custom("it is secret"))
        }
    }

    #[test]
    fn a_state_without_a_stored_form_is_an_error() {
        let mut bytes = Vec::new();
        let error = Unpacked(Secret).put(&mut bytes).unwrap_err();
        assert!(
            matches!(&error, Error::Snapshot(reason) if reason == "it is secret"),
            "{error}"
        );
        Unpacked((3, true)).put(&mut bytes).unwrap();
        assert_eq!(
            Unpacked::take(&mut &*bytes).map(|Unpacked(state)| state),
            Some((3, true))
        );
    }
}
