//! Tests through the public interface, in one program that is linked once.

mod alone;
mod constants;
mod ends;
mod instructions;
mod native;
mod varied;
