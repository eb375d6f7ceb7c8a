//! Random elements of a space.

use std::any::type_name;
use std::marker::PhantomData;

use gym_numerics::{Generator, Seed};
use serde::{Deserialize, Serialize};

use crate::value::{Array, DType, Element, Error, GraphInstance, Result, Value};

use super::selection::{Mask, Probabilities, Selection};
use super::weight::Weight;
use super::{MultiBinary, Space};

/// Draws random elements of a space.
///
/// [`Space::sampler`] makes it. The same seed gives the same elements as Gymnasium's
/// `space.seed(seed)` and `space.sample()`. A cloned or stored sampler continues like the original.
///
/// ```
/// use gym_core::{Space, Value};
/// let mut sampler = Space::discrete(5).sampler(42);
/// assert_eq!([sampler.sample(), sampler.sample()], [Value::Int(0), Value::Int(3)]);
/// let mut typed = Space::boxed([-1.0, 0.0], [1.0, 2.0]).sampler(42).typed::<[f32; 2]>()?;
/// assert_eq!(typed.sample(), [0.547_912_1, 0.877_756_9]);
/// # Ok::<(), gym_core::Error>(())
/// ```
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Stored", bound = "")]
pub struct Sampler<A: Element = Value> {
    space: Space,
    streams: Streams,
    #[serde(skip)]
    buffer: Value,
    #[serde(skip)]
    element: PhantomData<fn() -> A>,
}

/// Endless random elements, from [`sample`](Sampler::sample).
///
/// ```
/// use gym_core::{Space, Value};
/// let actions: Vec<Value> = Space::discrete(5).sampler(42).take(3).collect();
/// assert_eq!(actions[..2], [Value::Int(0), Value::Int(3)]);
/// ```
impl<A: Element> Iterator for Sampler<A> {
    type Item = A;

    fn next(&mut self) -> Option<A> {
        Some(self.sample())
    }
}

impl Sampler<Value> {
    pub(super) fn new(space: Space, seed: &Seed) -> Self {
        let streams = Streams::new(&space, seed);
        Self::with_streams(space, streams)
    }

    /// The same sampler with elements of another type.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the type cannot hold the elements of the space; see
    /// [`sample`](Self::sample).
    pub fn typed<A: Element>(self) -> Result<Sampler<A>> {
        Sampler::with_streams(self.space, self.streams).checked()
    }
}

impl<A: Element> Sampler<A> {
    fn with_streams(space: Space, streams: Streams) -> Self {
        Self {
            space,
            streams,
            buffer: Value::Null,
            element: PhantomData,
        }
    }

    /// Fails if the type does not hold the first or the last element of the space.
    fn checked(self) -> Result<Self> {
        for high in [false, true] {
            let value = corner(&self.space, high);
            if A::from_value(&value).is_none() {
                let (name, space) = (type_name::<A>(), &self.space);
                let reason = format!(
                    "`{name}` cannot hold {value}, an element of {space}: choose another type"
                );
                return Err(Error::argument("a sampler", reason));
            }
        }
        Ok(self)
    }

    /// The space.
    pub fn space(&self) -> &Space {
        &self.space
    }

    /// Restarts as a new sampler with this seed.
    pub fn seed(&mut self, seed: impl Into<Seed>) {
        self.streams = Streams::new(&self.space, &seed.into());
    }

    /// A random element.
    ///
    /// # Panics
    /// If the type `A` holds the smallest and the largest elements of the space but not this one,
    /// which no type of this library does.
    pub fn sample(&mut self) -> A {
        self.draw(&Mask::Any)
    }

    /// Writes a random element to `out`, as a [`Value`]. If `out` already holds an element of the
    /// space, this allocates nothing for `Box`, `Discrete`, `MultiDiscrete`, `MultiBinary`, and
    /// tuples and dicts of them.
    pub fn sample_into(&mut self, out: &mut Value) {
        self.space.draw(&mut self.streams, &Mask::Any, out);
    }

    /// A random element that the mask allows.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the mask does not fit the space; then nothing is drawn.
    ///
    /// # Panics
    /// As [`sample`](Self::sample).
    pub fn sample_masked(&mut self, mask: &Mask) -> Result<A> {
        self.sample_selected(mask, "mask")
    }

    /// A random element by probabilities.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the probabilities do not fit the space; then nothing is drawn.
    ///
    /// # Panics
    /// As [`sample`](Self::sample).
    pub fn sample_weighted(&mut self, probabilities: &Probabilities) -> Result<A> {
        self.sample_selected(probabilities, "probabilities")
    }

    /// A random graph with these numbers of nodes and edges; `None` for a random number of edges.
    ///
    /// # Errors
    /// [`Error::InvalidArgument`] if the space is not a `Graph`, there are no nodes, or there are
    /// edges but no edge space; then nothing is drawn.
    ///
    /// # Panics
    /// As [`sample`](Self::sample).
    pub fn sample_graph(&mut self, num_nodes: usize, num_edges: Option<usize>) -> Result<A> {
        let [nodes, edges] = [Mask::Any, Mask::Any].map(Box::new);
        let mask = Mask::Graph {
            num_nodes: Some(num_nodes),
            num_edges,
            nodes,
            edges,
        };
        self.sample_selected(&mask, "size of the graph")
    }

    fn sample_selected<T: Weight>(&mut self, selection: &Selection<T>, name: &str) -> Result<A> {
        selection.check(&self.space).map_err(|fault| {
            Error::argument(format!("the {name} of {}", self.space), fault.to_string())
        })?;
        Ok(self.draw(selection))
    }

    fn draw<T: Weight>(&mut self, selection: &Selection<T>) -> A {
        self.space
            .draw(&mut self.streams, selection, &mut self.buffer);
        match A::from_value(&self.buffer) {
            Some(element) => element,
            None => panic!(
                "{} cannot hold {}, an element of {}",
                type_name::<A>(),
                self.buffer,
                self.space
            ),
        }
    }
}

/// The generators of a space and of its members.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Streams {
    pub(super) own: Generator,
    /// In the order of [`Space::members`].
    pub(super) members: Vec<Streams>,
}

impl Streams {
    /// Gymnasium's `Space.seed`: the generator of a space draws the seeds of its members.
    pub(super) fn new(space: &Space, seed: &Seed) -> Self {
        let mut own = Generator::new(seed);
        let mut member = |space| {
            let seed = own.integers(0, i32::MAX.into());
            Self::new(space, &Seed::from(seed.unsigned_abs()))
        };
        let members = space.members().into_iter().map(&mut member).collect();
        // As in Gymnasium, these spaces seed their own generator again after the generator drew the
        // seeds of the members.
        if matches!(
            space,
            Space::OneOf(_) | Space::Sequence(_) | Space::Graph(_)
        ) {
            own = Generator::new(seed);
        }
        Self { own, members }
    }

    /// Whether there is a generator for each member of a space, recursively.
    fn fit(&self, space: &Space) -> bool {
        let members = space.members();
        members.len() == self.members.len()
            && members
                .iter()
                .zip(&self.members)
                .all(|(space, streams)| streams.fit(space))
    }
}

/// The stored form of a [`Sampler`], before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    space: Space,
    streams: Streams,
}

impl<A: Element> TryFrom<Stored> for Sampler<A> {
    type Error = Error;

    fn try_from(Stored { space, streams }: Stored) -> Result<Self> {
        if !streams.fit(&space) {
            return Err(Error::Snapshot(format!(
                "its generators are not those of {space}"
            )));
        }
        Self::with_streams(space, streams).checked()
    }
}

/// An element at the lower or upper end of a space: of the smallest or largest numbers, and short
/// if the length varies.
fn corner(space: &Space, high: bool) -> Value {
    let pick = |(start, last): (i64, i64)| if high { last } else { start };
    match space {
        Space::Box(space) => Value::Array(if high { space.high() } else { space.low() }.clone()),
        Space::Discrete(space) => Value::Int(pick((space.start(), space.last()))),
        Space::MultiDiscrete(space) => {
            Value::Array(space.array(&space.ranges().map(pick).collect::<Vec<_>>()))
        }
        Space::MultiBinary(space) => {
            let mut zeros = Array::zeros(MultiBinary::DTYPE, space.shape()).unwrap_or_default();
            zeros
                .as_mut_slice::<i8>()
                .into_iter()
                .flatten()
                .for_each(|x| *x = high.into());
            Value::Array(zeros)
        }
        Space::Text(space) => {
            let ends = [space.charset().first(), space.charset().last()];
            Value::Text(
                ends[usize::from(high)]
                    .into_iter()
                    .cycle()
                    .take(space.min_length())
                    .collect(),
            )
        }
        Space::Mission(space) => space.corner(high),
        Space::Tuple(space) => Value::Tuple(
            space
                .spaces()
                .iter()
                .map(|space| corner(space, high))
                .collect(),
        ),
        Space::Dict(space) => Value::Dict(
            space
                .spaces()
                .iter()
                .map(|(key, space)| (key.clone(), corner(space, high)))
                .collect(),
        ),
        Space::Sequence(space) => {
            // Sequences of two lengths, so that a type of fixed length fails the check.
            let items = vec![corner(space.feature_space(), high); 1 + usize::from(high)];
            space.collect(items).unwrap_or_default()
        }
        Space::Graph(space) => {
            let row = |space: &Space| space.batch(1).ok().map(|batch| corner(&batch, high));
            let edges = space.edge_space().filter(|_| high).and_then(row);
            let edge_links = edges
                .as_ref()
                .and_then(|_| Array::zeros(DType::I32, [1, 2]).ok());
            let nodes = row(space.node_space()).unwrap_or_default();
            Value::Graph(Box::new(GraphInstance {
                nodes,
                edges,
                edge_links,
            }))
        }
        Space::OneOf(space) => {
            let index = if high { space.spaces().len() - 1 } else { 0 };
            Value::OneOf(index, Box::new(corner(&space.spaces()[index], high)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{DictSpace, GraphSpace, OneOfSpace, SequenceSpace, TextSpace, TupleSpace};

    fn spaces() -> Vec<Space> {
        let pair = || TupleSpace::new([Space::discrete(3), Space::boxed([0.0; 2], [1.0; 2])]);
        let one_of = OneOfSpace::new([Space::discrete(3), pair().into()]).unwrap();
        vec![
            Space::discrete(7),
            Space::boxed([0.0, f32::NEG_INFINITY], [1.0, f32::INFINITY]),
            MultiBinary::new([2, 3]).unwrap().into(),
            super::super::MultiDiscrete::new([3, 4]).unwrap().into(),
            TextSpace::new(0, 4).unwrap().into(),
            pair().into(),
            DictSpace::new([("a", pair().into()), ("b", one_of.clone().into())])
                .unwrap()
                .into(),
            SequenceSpace::new(pair()).into(),
            SequenceSpace::stacked(pair()).into(),
            GraphSpace::new(Space::discrete(3), Some(Space::discrete(2)))
                .unwrap()
                .into(),
            GraphSpace::new(MultiBinary::new([2]).unwrap(), None)
                .unwrap()
                .into(),
            one_of.into(),
        ]
    }

    #[test]
    fn samples_and_corners_are_elements() {
        for space in spaces() {
            let mut sampler = space.sampler(3);
            let mut buffer = Value::Null;
            for _ in 0..50 {
                space.check(&sampler.sample()).unwrap();
                sampler.sample_into(&mut buffer);
                space.check(&buffer).unwrap();
            }
            for high in [false, true] {
                space.check(&corner(&space, high)).unwrap();
            }
        }
    }

    #[test]
    fn what_the_buffer_held_does_not_matter() {
        let (mut a, mut b) = (spaces().into_iter().cycle(), Value::Null);
        for _ in 0..3 * spaces().len() {
            let space = a.next().unwrap();
            space.sampler(5).sample_into(&mut b);
            assert_eq!(b, space.sampler(5).sample());
        }
    }

    #[test]
    fn a_stored_or_cloned_sampler_continues() {
        for space in spaces() {
            let mut sampler = space.sampler(1);
            sampler.sample();
            let stored = serde_json::to_string(&sampler).unwrap();
            let mut restored: Sampler = serde_json::from_str(&stored).unwrap();
            let mut cloned = sampler.clone();
            for _ in 0..20 {
                let sample = sampler.sample();
                assert_eq!(restored.sample(), sample);
                assert_eq!(cloned.sample(), sample);
            }
            sampler.seed(1);
            assert_eq!(sampler.sample(), space.sampler(1).sample());
        }
    }

    #[test]
    fn a_stored_sampler_is_checked() {
        let pair = TupleSpace::new([Space::discrete(2), Space::discrete(3)]);
        let sampler = Space::from(pair).sampler(1);
        let mut stored = serde_json::to_value(&sampler).unwrap();
        assert!(serde_json::from_value::<Sampler<(u8, i64)>>(stored.clone()).is_ok());
        assert!(serde_json::from_value::<Sampler<u8>>(stored.clone()).is_err());
        stored["streams"]["members"] = serde_json::json!([]);
        assert!(serde_json::from_value::<Sampler>(stored).is_err());
    }

    #[test]
    fn types_that_do_not_fit_are_refused() {
        let sampler = |n| Space::discrete(n).sampler(0);
        let text = sampler(300).typed::<u8>().unwrap_err().to_string();
        assert!(
            text.contains("`u8` cannot hold 299, an element of Discrete(300)"),
            "{text}"
        );
        assert!(sampler(256).typed::<u8>().is_ok() && sampler(257).typed::<u8>().is_err());
        let square = || Space::boxed([0.0; 2], [1.0; 2]).sampler(0);
        assert!(square().typed::<[f32; 2]>().is_ok());
        assert!(square().typed::<[f32; 3]>().is_err() && square().typed::<[f64; 2]>().is_err());
        let stacked = || Space::from(SequenceSpace::stacked(Space::discrete(3))).sampler(0);
        assert!(stacked().typed::<Array>().is_ok());
        assert!(stacked().typed::<[i64; 1]>().is_err() && stacked().typed::<[i64; 2]>().is_err());
    }

    #[test]
    fn selections_that_do_not_fit_draw_nothing() {
        let mut sampler = Space::discrete(3).sampler(0);
        let streams = sampler.streams.clone();
        let text = sampler
            .sample_masked(&Mask::from([1]))
            .unwrap_err()
            .to_string();
        assert_eq!(
            text,
            "invalid argument for the mask of Discrete(3): there are 1 entries and should be 3"
        );
        assert!(
            sampler
                .sample_weighted(&Probabilities::from([1.0]))
                .is_err()
        );
        assert!(sampler.sample_graph(3, None).is_err());
        assert_eq!(sampler.streams, streams);
    }

    #[test]
    fn graphs_have_the_size_asked_for() {
        let space: Space = GraphSpace::new(Space::discrete(3), Some(Space::discrete(2)))
            .unwrap()
            .into();
        let mut sampler = space.sampler(0);
        let Value::Graph(graph) = sampler.sample_graph(4, Some(6)).unwrap() else {
            panic!()
        };
        let shape = |value: &Value| value.as_array().unwrap().shape().to_vec();
        assert_eq!(shape(&graph.nodes), [4]);
        assert_eq!(shape(&graph.edges.unwrap()), [6]);
        assert_eq!(graph.edge_links.unwrap().shape(), [6, 2]);
        let Value::Graph(graph) = sampler.sample_graph(1, None).unwrap() else {
            panic!()
        };
        assert_eq!((shape(&graph.nodes), graph.edges), (vec![1], None));
        assert!(sampler.sample_graph(0, None).is_err());
    }
}
