//! Tests through the public interface.

mod lockstep;
mod rare;
mod seams;
mod spaces;
