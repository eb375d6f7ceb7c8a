//! Tests through the public interface.

mod edges;
mod lockstep;
mod rare;
mod seams;
mod spaces;
