//! Tests across crates, in one program that is linked once.

mod allocation;
mod bad_input;
mod book;
mod by_hand;
mod cpu;
mod drawings;
mod inspect;
mod main_job;
mod native;
mod notebook;
mod parity;
mod parity_box2d;
mod places;
mod properties;
mod sizes;
mod stack;
mod vector;
mod vector_calls;
mod vector_maps;
mod vector_mechanism;
mod vector_snapshots;
mod vector_specs;
mod vector_wrappers;
mod wrappers;
mod wrappers_rebuild;
mod wrappers_render;
