//! Tests through the public interface, in one program that is linked once.

mod allocations;
mod assets;
mod attributes;
mod changes;
mod common;
mod compiled;
mod contacts;
mod copies;
mod defaults;
mod fields;
mod frames;
mod hfields;
mod language;
mod limits;
mod memory;
mod meshes;
mod mjcf;
mod numbers;
mod polygons;
mod rays;
mod sleep;
mod sparse;
mod steps;
mod substeps;
mod textures;
mod worlds;
