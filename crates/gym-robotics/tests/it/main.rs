//! Tests through the public interface, in one program that is linked once.

mod adroit;
mod episodes;
mod mazes;
mod robots;
