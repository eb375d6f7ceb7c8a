//! Tests of live windows; a crate of its own, because only they need a program that inspects
//! windows.
