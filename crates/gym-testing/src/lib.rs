//! What the tests of several crates share.

mod count;
mod digest;
mod kept;
mod native;
mod replay;

pub use count::Count;
pub use digest::{Digest, Sum};
pub use kept::kept;
pub use native::native_equals_sync;
pub use replay::{lines, replay};
