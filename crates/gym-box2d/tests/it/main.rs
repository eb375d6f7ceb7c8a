//! Tests through the public interface, in one program that is linked once.

mod contract;
mod damaged;
mod engines;
mod formulas;
mod lots;
mod rapier;
mod rules;
