//! What the tests of several crates share.

mod count;
mod digest;
mod replay;

pub use count::Count;
pub use digest::{Digest, Sum};
pub use replay::{lines, replay};
