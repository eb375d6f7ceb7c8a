//! Each check of gym-conform finds the environments that break it.

mod bites;
mod matching;
mod recorded;
mod told;
mod unusual;
mod wrapped;
mod wrong_wrappers;
