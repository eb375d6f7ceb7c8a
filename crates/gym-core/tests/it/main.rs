//! Tests through the public interface.

mod edges;
mod lockstep;
mod rare;
mod rooms;
mod seams;
mod spaces;
