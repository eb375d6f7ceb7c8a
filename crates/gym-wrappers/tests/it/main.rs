//! Tests through the public interface, in one program that is linked once.

mod episodes;
mod restores;
mod spy;
mod wrappers;
