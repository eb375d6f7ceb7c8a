//! Numbers, vectors and matrices, with the roundings of libmujoco.

pub(crate) mod dense;
pub(crate) mod libm;
pub(crate) mod number;
pub(crate) mod spatial;
