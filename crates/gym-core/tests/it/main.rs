//! Tests through the public interface.

#[cfg(target_os = "linux")]
mod affinity;
mod arrays;
mod closed;
mod edges;
mod families;
mod groups;
mod limits;
mod lockstep;
mod made;
mod parts;
mod rare;
mod refusals;
mod reused;
mod seams;
mod spaces;
mod told;
mod window;
