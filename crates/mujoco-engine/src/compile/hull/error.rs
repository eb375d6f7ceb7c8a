//! Why a set of points has no hull.

/// Why a set of points has no hull here. libmujoco refuses the same sets, except those of
/// `Unsupported` and of the limits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum HullError {
    /// Fewer than four points.
    #[error("a hull needs at least 4 points, found {0}")]
    TooFew(usize),
    /// More points than the limit.
    #[error("{found} points: at most {most} are supported; simplify the mesh")]
    TooMany {
        /// The number of points.
        found: usize,
        /// The limit.
        most: usize,
    },
    /// A coordinate that is NaN, infinite or beyond 1e70.
    #[error("point {0} has a coordinate that is not finite, or beyond 1e70")]
    NotFinite(usize),
    /// `maxhullvert` below 4.
    #[error("maxhullvert = {0}: at least 4 are needed")]
    MaxVertices(u32),
    /// All points are nearly in one plane, on one line or at one place.
    #[error(
        "the points are nearly in one plane, on one line or at one place, so they have no hull with a volume"
    )]
    Flat,
    /// Rounding made facets that are too thick.
    #[error("rounding makes a facet of the hull too thick: remove vertices that nearly coincide")]
    Wide,
    /// Rounding leaves too few facets.
    #[error("rounding leaves too few facets for a hull: remove vertices that nearly coincide")]
    TooFewFacets,
    /// A case that no mesh was seen to need: `0` names it.
    #[error(
        "the hull of these points needs {0}, which is not supported: remove vertices that nearly coincide"
    )]
    Unsupported(&'static str),
    /// The facets do not fit together: `0` names how.
    #[error("the hull's facets do not fit together ({0}): remove vertices that nearly coincide")]
    Inconsistent(&'static str),
    /// More facets or work than the limit.
    #[error("the hull takes more than {0}: simplify the mesh, or set maxhullvert")]
    Limit(&'static str),
}
