//! Tests through the public interface.

mod edges;
mod families;
mod groups;
mod lockstep;
mod rare;
mod seams;
mod spaces;
mod window;
