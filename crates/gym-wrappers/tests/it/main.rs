//! Tests through the public interface, in one program that is linked once.

mod around;
mod episodes;
mod given;
mod registered;
mod restores;
mod reverts;
mod spy;
mod unfit;
mod wrappers;
