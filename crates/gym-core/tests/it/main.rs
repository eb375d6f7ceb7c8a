//! Tests through the public interface.

mod lockstep;
mod rare;
mod rooms;
mod seams;
mod spaces;
