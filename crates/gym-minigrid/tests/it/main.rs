//! Tests through the public interface, in one program that is linked once.

mod arguments;
mod episodes;
mod refusals;
mod registered;
mod stored;
mod view;
