//! Spaces: the sets of observations and actions of an environment, and random elements of them.
//!
//! A [`Space`] is an immutable description. A [`Sampler`] has the generators that Gymnasium keeps
//! in the space. Names, samples, printed form and rules of membership equal those of Gymnasium
//! 1.4's `gymnasium.spaces`.

mod actions;
mod batch;
mod box_space;
mod dict;
mod differing;
mod discrete;
mod flat_space;
mod flatten;
mod graph;
pub(crate) mod json;
mod mission;
mod multi_binary;
mod multi_discrete;
mod one_of;
mod real_actions;
mod rows;
mod sampler;
mod selection;
mod sequence;
mod text;
mod tuple;
mod weight;
mod zero;

use std::fmt;

use gym_numerics::Seed;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::value::array::{Array, MAX_AXES, element_count as count};
use crate::value::error::shortened;
use crate::value::{DType, Element, Error, Result, Value, numpy_fmt};

pub use crate::value::array::MAX_ELEMENTS;
pub use actions::{ActionColumn, Actions};
#[doc(hidden)]
pub use actions::{block_of, indices};
pub use box_space::BoxSpace;
pub use dict::DictSpace;
pub use discrete::Discrete;
pub use graph::GraphSpace;
pub use mission::MissionSpace;
pub use multi_binary::MultiBinary;
pub use multi_discrete::MultiDiscrete;
pub use one_of::OneOfSpace;
pub use sampler::Sampler;
pub use selection::{Mask, Probabilities, Selection};
pub use sequence::SequenceSpace;
pub use text::TextSpace;
pub use tuple::TupleSpace;

use crate::value::fault::Fault;
use sampler::Streams;
use weight::Weight;

/// A set of values: the observations or the actions of an environment.
///
/// | space | its elements |
/// |---|---|
/// | [`Box`](BoxSpace) | arrays of numbers, each between bounds |
/// | [`Discrete`] | the integers of a range |
/// | [`MultiDiscrete`] | arrays of integers, each from a range of its own |
/// | [`MultiBinary`] | arrays of zeros and ones |
/// | [`Text`](TextSpace) | strings |
/// | [`Mission`](MissionSpace) | the sentences of a pattern |
/// | [`Tuple`](TupleSpace), [`Dict`](DictSpace) | one element of each member space |
/// | [`Sequence`](SequenceSpace) | any number of elements of one space |
/// | [`Graph`](GraphSpace) | nodes and edges |
/// | [`OneOf`](OneOfSpace) | an element of one of several spaces, with its index |
///
/// ```
/// use gym_core::{Space, Value};
/// let space = Space::discrete(3);
/// assert!(space.contains(&Value::Int(2)) && !space.contains(&Value::Int(3)));
/// assert_eq!(space.sampler(7).sample(), Value::Int(2));
/// ```
///
/// It prints as Gymnasium prints it, and its stored form is JSON such as
/// `{"type":"Discrete","n":3,"start":0,"dtype":"int64"}`, checked when it is read. Spaces nested so
/// deep that readers of JSON would refuse them have no stored form: to serialise one is an error.
/// Methods visit members by recursion, so spaces and values of thousands of levels overflow the
/// stack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", remote = "Self")]
#[expect(missing_docs, reason = "the variants are the structs they hold")]
pub enum Space {
    Box(BoxSpace),
    Discrete(Discrete),
    MultiDiscrete(MultiDiscrete),
    MultiBinary(MultiBinary),
    Text(TextSpace),
    Mission(MissionSpace),
    Tuple(TupleSpace),
    Dict(DictSpace),
    Sequence(SequenceSpace),
    Graph(GraphSpace),
    OneOf(OneOfSpace),
}

/// The levels of lists and objects in the stored form of a space. `serde_json` reads at most 128
/// levels, and a spec or snapshot around the space needs some of them.
const MAX_LEVELS: usize = 112;

impl Space {
    /// Whether the stored form has at most `levels` of lists and objects within each other.
    fn fits_levels(&self, levels: usize) -> bool {
        let own = match self {
            Self::Sequence(_) => 1,
            Self::Tuple(_) | Self::OneOf(_) => 2,
            Self::Dict(_) => 3,
            // a graph holds no spaces that hold others
            _ => return levels >= 4 + self.shape().map_or(0, <[usize]>::len),
        };
        let fit = |left| self.members().iter().all(|space| space.fits_levels(left));
        levels.checked_sub(own).is_some_and(fit)
    }
}

impl Serialize for Space {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        if !self.fits_levels(MAX_LEVELS) {
            return Err(serde::ser::Error::custom(format!(
                "spaces are nested too deep to be stored: their JSON has more than {MAX_LEVELS} levels, \
                 and could not be read"
            )));
        }
        Self::serialize(self, serializer)
    }
}

impl<'de> Deserialize<'de> for Space {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        Self::deserialize(deserializer)
    }
}

macro_rules! from {
    ($($variant:ident $space:ident),* $(,)?) => {$(
        impl From<$space> for Space {
            fn from(space: $space) -> Self {
                Self::$variant(space)
            }
        }
    )*};
}
from! {
    Box BoxSpace, Discrete Discrete, MultiDiscrete MultiDiscrete, MultiBinary MultiBinary, Text TextSpace,
    Mission MissionSpace,    Tuple TupleSpace, Dict DictSpace, Sequence SequenceSpace, Graph GraphSpace, OneOf OneOfSpace,
}

/// Evaluates `$body` with `$inner` bound to the inner space of any type.
macro_rules! each {
    ($space:expr, $inner:ident => $body:expr) => {
        match $space {
            Space::Box($inner) => $body,
            Space::Discrete($inner) => $body,
            Space::MultiDiscrete($inner) => $body,
            Space::MultiBinary($inner) => $body,
            Space::Text($inner) => $body,
            Space::Mission($inner) => $body,
            Space::Tuple($inner) => $body,
            Space::Dict($inner) => $body,
            Space::Sequence($inner) => $body,
            Space::Graph($inner) => $body,
            Space::OneOf($inner) => $body,
        }
    };
}

impl Space {
    /// The integers `0, ..., n - 1`. For other starts and types, or an `n` that may be invalid, see
    /// [`Discrete`].
    ///
    /// # Panics
    /// If `n` is below 1.
    pub fn discrete(n: i64) -> Self {
        match Discrete::new(n) {
            Ok(space) => space.into(),
            Err(error) => panic!("{error}"),
        }
    }

    /// The `float32` arrays of `N` numbers between bounds. For other types and shapes, or bounds
    /// that may be invalid, see [`BoxSpace`].
    ///
    /// # Panics
    /// If a bound is NaN, or a low bound above its high bound.
    pub fn boxed<const N: usize>(low: [f32; N], high: [f32; N]) -> Self {
        match BoxSpace::new(low, high) {
            Ok(space) => space.into(),
            Err(error) => panic!("{error}"),
        }
    }

    /// Whether a value is an element.
    ///
    /// Arrays must have the exact shape, but may have any type whose numbers fit the space's type:
    /// `float32` in a `float64` box, not the reverse. Members of dicts may come in any order.
    pub fn contains(&self, value: &Value) -> bool {
        each!(self, space => space.contains(value))
    }

    /// The reason why a value is not an element, if it is not.
    ///
    /// ```
    /// use gym_core::{Space, Value, spaces::TupleSpace};
    /// let space = Space::from(TupleSpace::new([Space::boxed([0.0; 2], [1.0; 2])]));
    /// let error = space.check(&Value::Tuple(vec![Value::Array([0.5f32, 2.0].into())])).unwrap_err();
    /// assert_eq!(
    ///     error.to_string(),
    ///     "[0][1]: 2.0 is not between 0.0 and 1.0: \
    ///      ([0.5 2.0]) is not an element of Tuple(Box(0.0, 1.0, (2,), float32))"
    /// );
    /// ```
    ///
    /// # Errors
    /// [`Error::NotInSpace`] if [`contains`](Self::contains) is false, with the place in the value.
    pub fn check(&self, value: &Value) -> Result<()> {
        if self.contains(value) {
            return Ok(());
        }
        self.check_value(value)
            .map_err(|fault| self.refuse(value, &fault))
    }

    fn check_value(&self, value: &Value) -> Result<(), Fault> {
        each!(self, space => space.check(value))
    }

    /// [`Error::NotInSpace`] for `value`, of which a long text is cut.
    fn refuse(&self, value: &impl fmt::Display, fault: &Fault) -> Error {
        not_in(value, self, fault)
    }

    /// [`Error::InvalidAction`] for an action of another kind, type or shape than those of this
    /// space, or that is not finite.
    pub fn refuse_action(&self, action: &impl Element) -> Error {
        let action = action.to_value();
        let hint = match (self.check_value(&action), &action, self.dtype()) {
            (_, action, _) if !action.is_finite() => "numbers must be finite".to_owned(),
            (Err(fault), ..) => fault.to_string(),
            (Ok(()), Value::Array(array), Some(dtype)) if array.dtype() != dtype => {
                format!(
                    "the numbers are {} and should be {dtype}: convert them first",
                    array.dtype()
                )
            }
            (Ok(()), ..) => String::new(),
        };
        Error::InvalidAction {
            action: action.to_string(),
            space: self.to_string(),
            hint,
        }
    }

    /// Random elements, by Gymnasium's `seed` and `sample`.
    pub fn sampler(&self, seed: impl Into<Seed>) -> Sampler {
        Sampler::new(self.clone(), &seed.into())
    }

    /// The shape of the elements; `[]` for single numbers, `None` if they are neither numbers nor
    /// arrays.
    pub fn shape(&self) -> Option<&[usize]> {
        match self {
            Self::Box(space) => Some(space.shape()),
            Self::Discrete(_) => Some(&[]),
            Self::MultiDiscrete(space) => Some(space.shape()),
            Self::MultiBinary(space) => Some(space.shape()),
            _ => None,
        }
    }

    /// The type of the elements' numbers; `None` if they are neither numbers nor arrays.
    pub fn dtype(&self) -> Option<DType> {
        match self {
            Self::Box(space) => Some(space.dtype()),
            Self::Discrete(space) => Some(space.dtype()),
            Self::MultiDiscrete(space) => Some(space.dtype()),
            Self::MultiBinary(_) => Some(MultiBinary::DTYPE),
            _ => None,
        }
    }

    /// The member spaces, in the order in which Gymnasium seeds them.
    fn members(&self) -> Vec<&Self> {
        match self {
            Self::Tuple(space) => space.spaces().iter().collect(),
            Self::Dict(space) => space.spaces().iter().map(|(_, space)| space).collect(),
            Self::Sequence(space) => vec![space.feature_space()],
            Self::Graph(space) => std::iter::once(space.node_space())
                .chain(space.edge_space())
                .collect(),
            Self::OneOf(space) => space.spaces().iter().collect(),
            _ => Vec::new(),
        }
    }

    /// Leaves a random element in `out`. The selection fits the space.
    fn draw<T: Weight>(&self, streams: &mut Streams, selection: &Selection<T>, out: &mut Value) {
        match self {
            Self::Box(space) => space.draw(&mut streams.own, out),
            Self::Discrete(space) => space.draw(&mut streams.own, selection, out),
            Self::MultiDiscrete(space) => space.draw(&mut streams.own, selection, out),
            Self::MultiBinary(space) => space.draw(&mut streams.own, selection, out),
            Self::Text(space) => space.draw(&mut streams.own, selection, out),
            Self::Mission(space) => space.draw(&mut streams.own, out),
            Self::Tuple(space) => space.draw(streams, selection, out),
            Self::Dict(space) => space.draw(streams, selection, out),
            Self::Sequence(space) => space.draw(streams, selection, out),
            Self::Graph(space) => space.draw(streams, selection, out),
            Self::OneOf(space) => space.draw(streams, selection, out),
        }
    }
}

impl fmt::Display for Space {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        each!(self, space => space.fmt(f))
    }
}

/// [`Error::NotInSpace`], with the start of a long value or space.
fn not_in(value: &impl fmt::Display, space: &impl fmt::Display, fault: &Fault) -> Error {
    let [value, space] =
        [value.to_string(), space.to_string()].map(|text| shortened(&text).into_owned());
    Error::NotInSpace {
        value,
        space,
        reason: fault.to_string(),
    }
}

fn invalid<T>(reason: impl Into<String>) -> Result<T> {
    Err(Error::InvalidSpace(reason.into()))
}

/// The array in `out`, replaced unless it has that type and shape: fills a buffer without
/// allocating.
pub fn array_of<'a>(out: &'a mut Value, dtype: DType, shape: &[usize]) -> &'a mut Array {
    let fits = |array: &Array| array.dtype() == dtype && array.has_shape(shape);
    if !out.as_array().is_some_and(fits) {
        // `shape` is the shape of a space, limited to `MAX_ELEMENTS`, or of an existing array; so
        // `zeros` does not fail
        *out = Value::Array(Array::zeros(dtype, shape).unwrap_or_default());
    }
    match out {
        Value::Array(array) => array,
        _ => unreachable!("`out` was just made an array"),
    }
}

/// The number of elements of a shape.
fn element_count(shape: &[usize]) -> Result<usize, Fault> {
    count(shape)
        .filter(|count| *count <= MAX_ELEMENTS)
        .ok_or_else(|| {
            if shape.len() > MAX_AXES {
                return Fault::new(format!(
                    "the shape has {} axes: at most {MAX_AXES} are possible",
                    shape.len()
                ));
            }
            let shape = numpy_fmt::shape(shape);
            Fault::new(format!(
                "the shape {shape} has too many elements: at most {MAX_ELEMENTS} are possible"
            ))
        })
}

/// `Tuple(Discrete(3), Discrete(2))`.
fn write_list(f: &mut fmt::Formatter<'_>, name: &str, spaces: &[Space]) -> fmt::Result {
    write!(f, "{name}(")?;
    for (i, space) in spaces.iter().enumerate() {
        write!(f, "{}{space}", if i == 0 { "" } else { ", " })?;
    }
    f.write_str(")")
}
