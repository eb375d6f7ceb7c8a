//! Masks and probabilities for a sampler.

use super::weight::Weight;
use super::{Discrete, GraphSpace, MultiDiscrete, Space, TextSpace};
use crate::value::fault::Fault;

/// A description of sampling other than uniform, in the structure of the space; a [`Mask`] or
/// [`Probabilities`].
///
/// | space | selection |
/// |---|---|
/// | any | `Any`: as an ordinary sample |
/// | `Discrete` | `Values`: one entry per element of the space, from `start` on |
/// | `MultiDiscrete` | `Each`: for each number, in row-major order, one entry per value of it |
/// | `MultiBinary` | `Values`: one entry per number, in row-major order |
/// | `Text` | `Text` |
/// | `Tuple`, `OneOf` | `Tuple`: a selection per space |
/// | `Dict` | `Dict`: a selection per key; keys left out count as `Any` |
/// | `Sequence` | `Sequence` |
/// | `Graph` | `Graph` |
///
/// A `Box` takes `Any` alone.
///
/// ```
/// use gym_core::{Space, Value, spaces::Mask};
/// let mut sampler = Space::discrete(4).sampler(0);
/// let mask = Mask::from([0, 0, 1, 0]);
/// assert_eq!(sampler.sample_masked(&mask)?, Value::Int(2));
/// # Ok::<(), gym_core::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Selection<T> {
    /// The ordinary sample.
    #[default]
    Any,
    /// An entry per element of a `Discrete`, or per number of a `MultiBinary`.
    Values(Vec<T>),
    /// A list per number of a `MultiDiscrete`, with an entry per value of that number.
    Each(Vec<Vec<T>>),
    /// For a `Text`.
    Text {
        /// The number of characters; `None` for a uniform length.
        length: Option<usize>,
        /// An entry per character of the set; `None` for uniform characters.
        characters: Option<Vec<T>>,
    },
    /// A selection per member of a `Tuple`, or per space of a `OneOf`, whose index stays uniform.
    Tuple(Vec<Selection<T>>),
    /// Selections for members of a `Dict`.
    Dict(Vec<(String, Selection<T>)>),
    /// For a `Sequence`.
    Sequence {
        /// The lengths to choose from uniformly; `None` for a geometric length.
        lengths: Option<Vec<usize>>,
        /// For each element of the sequence.
        member: Box<Selection<T>>,
    },
    /// For a `Graph`. If nodes or edges are of a `Discrete` space, their selection is `Values` (the
    /// same for all) or `Each` (a list per node or edge); otherwise it is `Any`.
    Graph {
        /// The number of nodes, 1 or more; `None` for 10.
        num_nodes: Option<usize>,
        /// The number of edges; `None` for a uniform number below that of ordered pairs of nodes.
        num_edges: Option<usize>,
        /// For the nodes.
        nodes: Box<Selection<T>>,
        /// For the edges. `Each` needs `num_edges`.
        edges: Box<Selection<T>>,
    },
}

/// The elements that a sample may be: 1 for allowed, 0 for not. If none is allowed, the sample is
/// the first.
///
/// For a `MultiBinary` an entry is the value of its number: 0, 1, or 2 for either. If no character
/// of a `Text` is allowed, the sample is empty, if the space allows that.
pub type Mask = Selection<i8>;

/// The probability of each element: numbers from 0 to 1 that sum to 1.
///
/// For a `MultiBinary` it is the probability of a 1, for each number.
pub type Probabilities = Selection<f64>;

impl<T> From<Vec<T>> for Selection<T> {
    fn from(values: Vec<T>) -> Self {
        Self::Values(values)
    }
}

impl<T, const N: usize> From<[T; N]> for Selection<T> {
    fn from(values: [T; N]) -> Self {
        Self::Values(values.into())
    }
}

impl<T: Clone> From<&[T]> for Selection<T> {
    fn from(values: &[T]) -> Self {
        Self::Values(values.to_vec())
    }
}

/// numpy's `choice` tolerates a sum that is off by the square root of the precision of `f64`.
/// Gymnasium's own, wider tolerance decides for the spaces that rescale the sum to 1.
const CHOICE_TOLERANCE: f64 = 1.490_116_119_384_765_6e-8;
/// The tolerance of numpy's `isclose` to 1.
const RESCALED_TOLERANCE: f64 = 1e-5 + 1e-8;

impl<T> Selection<T> {
    /// The selection of the member with an index.
    pub(super) fn at(&self, index: usize) -> &Self {
        match self {
            Self::Tuple(members) => members.get(index).unwrap_or(&Self::Any),
            _ => &Self::Any,
        }
    }

    /// The selection of the member under a key.
    pub(super) fn under(&self, key: &str) -> &Self {
        match self {
            Self::Dict(members) => members
                .iter()
                .find(|(name, _)| name == key)
                .map_or(&Self::Any, |(_, member)| member),
            _ => &Self::Any,
        }
    }

    /// Checks that `space` can be sampled with this selection.
    pub(super) fn check(&self, space: &Space) -> Result<(), Fault>
    where
        T: Weight,
    {
        match (space, self) {
            (_, Self::Any) => Ok(()),
            (Space::Discrete(space), Self::Values(weights)) => {
                check_list(weights, space.n(), CHOICE_TOLERANCE)
            }
            (Space::MultiDiscrete(space), Self::Each(lists)) => check_lists(lists, space),
            (Space::MultiBinary(space), Self::Values(weights)) => {
                check_length(weights, space.shape().iter().product::<usize>() as u64)?;
                T::check_tosses(weights)
            }
            (Space::Text(space), Self::Text { length, characters }) => {
                check_text(space, *length, characters.as_deref())
            }
            (Space::Tuple(space), Self::Tuple(members)) => check_members(space.spaces(), members),
            (Space::OneOf(space), Self::Tuple(members)) => check_members(space.spaces(), members),
            (Space::Dict(space), Self::Dict(members)) => {
                members.iter().try_for_each(|(key, member)| {
                    let unknown = || Fault::new(format!("the space has no key {key:?}"));
                    member
                        .check(space.get(key).ok_or_else(unknown)?)
                        .map_err(|fault| fault.under(key))
                })
            }
            (Space::Sequence(space), Self::Sequence { lengths, member }) => {
                if lengths.as_ref().is_some_and(Vec::is_empty) {
                    return Err(Fault::new("there are no lengths to choose from"));
                }
                member
                    .check(space.feature_space())
                    .map_err(|fault| fault.within(".member"))
            }
            (
                Space::Graph(space),
                Self::Graph {
                    num_nodes,
                    num_edges,
                    nodes,
                    edges,
                },
            ) => check_graph(space, *num_nodes, *num_edges, nodes, edges),
            (Space::Box(_), _) => Err(Fault::new(
                "elements of a Box cannot be selected: pass `Any`",
            )),
            _ => Err(Fault::new(
                "another kind of selection is needed: see `Selection`",
            )),
        }
    }
}

fn check_length<T>(weights: &[T], expected: u64) -> Result<(), Fault> {
    let actual = weights.len() as u64;
    if actual == expected {
        return Ok(());
    }
    Err(Fault::new(format!(
        "there are {actual} entries and should be {expected}"
    )))
}

fn check_list<T: Weight>(weights: &[T], n: i64, tolerance: f64) -> Result<(), Fault> {
    check_length(weights, n as u64)?;
    T::check_choice(weights, tolerance)
}

fn check_lists<T: Weight>(lists: &[Vec<T>], space: &MultiDiscrete) -> Result<(), Fault> {
    check_length(lists, space.nvec().len() as u64)?;
    for (i, (weights, &n)) in lists.iter().zip(space.nvec()).enumerate() {
        check_list(weights, n, RESCALED_TOLERANCE).map_err(|fault| fault.at(i))?;
    }
    Ok(())
}

fn check_members<T: Weight>(spaces: &[Space], members: &[Selection<T>]) -> Result<(), Fault> {
    check_length(members, spaces.len() as u64)?;
    for (i, (space, member)) in spaces.iter().zip(members).enumerate() {
        member.check(space).map_err(|fault| fault.at(i))?;
    }
    Ok(())
}

fn check_text<T: Weight>(
    space: &TextSpace,
    length: Option<usize>,
    characters: Option<&[T]>,
) -> Result<(), Fault> {
    let (min, max) = (space.min_length(), space.max_length());
    if let Some(length) = length
        && !(min..=max).contains(&length)
    {
        return Err(Fault::new(format!(
            "the length {length} is not between {min} and {max}"
        )));
    }
    let Some(weights) = characters else {
        return Ok(());
    };
    check_list(weights, space.charset().len() as i64, CHOICE_TOLERANCE)?;
    if min > 0 && T::probabilities(weights).iter().all(|&p| p == 0.0) {
        return Err(Fault::new(
            "the mask allows no character, but the text cannot be empty",
        ));
    }
    Ok(())
}

fn check_graph<T: Weight>(
    space: &GraphSpace,
    num_nodes: Option<usize>,
    num_edges: Option<usize>,
    nodes: &Selection<T>,
    edges: &Selection<T>,
) -> Result<(), Fault> {
    /// Nodes are numbered by `int32`.
    const MAX: usize = i32::MAX as usize;
    if num_nodes.is_some_and(|n| !(1..=MAX).contains(&n)) || num_edges.is_some_and(|n| n > MAX) {
        return Err(Fault::new(format!(
            "the number of nodes must be from 1 to {MAX}, of edges at most that"
        )));
    }
    if space.edge_space().is_none()
        && (num_edges.is_some_and(|n| n > 0) || *edges != Selection::Any)
    {
        return Err(Fault::new("the space has no edges: ask for none"));
    }
    let num_nodes = num_nodes.unwrap_or(GraphSpace::NUM_NODES);
    check_rows(space.node_space(), Some(num_nodes), nodes)
        .map_err(|fault| fault.within(".nodes"))?;
    match space.edge_space() {
        None => Ok(()),
        Some(space) => check_rows(space, num_edges, edges).map_err(|fault| fault.within(".edges")),
    }
}

/// Checks the selection of nodes or edges; `n` is their number, if known.
fn check_rows<T: Weight>(
    space: &Space,
    n: Option<usize>,
    selection: &Selection<T>,
) -> Result<(), Fault> {
    let check =
        |space: &Discrete, weights: &[T]| check_list(weights, space.n(), RESCALED_TOLERANCE);
    match (space, selection) {
        (_, Selection::Any) => Ok(()),
        (Space::Discrete(space), Selection::Values(weights)) => check(space, weights),
        (Space::Discrete(space), Selection::Each(lists)) => {
            let Some(n) = n else {
                return Err(Fault::new("lists for each edge need `num_edges`"));
            };
            check_length(lists, n as u64)?;
            lists
                .iter()
                .enumerate()
                .try_for_each(|(i, weights)| check(space, weights).map_err(|fault| fault.at(i)))
        }
        (Space::Discrete(_), _) => Err(Fault::new("pass `Any`, `Values` or `Each`")),
        _ => Err(Fault::new(format!(
            "several elements of {space} cannot be selected: pass `Any`"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{DictSpace, MultiBinary, OneOfSpace, SequenceSpace, TupleSpace};

    fn fault<T: Weight>(space: impl Into<Space>, selection: impl Into<Selection<T>>) -> String {
        selection
            .into()
            .check(&space.into())
            .unwrap_err()
            .to_string()
    }

    fn text(length: Option<usize>, characters: Option<Vec<i8>>) -> Mask {
        Mask::Text { length, characters }
    }

    #[test]
    fn any_fits_all() {
        assert_eq!(Mask::Any.check(&Space::boxed([0.0], [1.0])), Ok(()));
        assert_eq!(Mask::default(), Mask::Any);
        assert!(
            fault(Space::boxed([0.0], [1.0]), [1i8])
                .contains("elements of a Box cannot be selected")
        );
    }

    #[test]
    fn lists_are_checked() {
        assert_eq!(
            fault(Space::discrete(3), [1i8, 0]),
            "there are 2 entries and should be 3"
        );
        assert_eq!(
            fault(Space::discrete(2), [1i8, 2]),
            "[1]: 2 is neither 0 nor 1"
        );
        assert_eq!(
            fault(Space::discrete(2), [0.5, 1.5]),
            "[1]: 1.5 is not between 0 and 1"
        );
        assert_eq!(
            fault(Space::discrete(2), [0.5, 0.4]),
            "the probabilities sum to 0.9 and should sum to 1"
        );
        assert_eq!(
            Probabilities::from([0.5, 0.5]).check(&Space::discrete(2)),
            Ok(())
        );
        assert!(fault(Space::discrete(2), [f64::NAN, 1.0]).contains("NaN"));

        let grid = MultiDiscrete::new([2, 3]).unwrap();
        assert_eq!(
            fault(grid.clone(), Mask::Each(vec![vec![1, 1]])),
            "there are 1 entries and should be 2"
        );
        assert_eq!(
            fault(grid, Mask::Each(vec![vec![1, 1], vec![0, 0]])),
            "[1]: there are 2 entries and should be 3"
        );

        let bits = MultiBinary::new([2]).unwrap();
        assert_eq!(fault(bits.clone(), [3i8, 0]), "[0]: 3 is not 0, 1 or 2");
        assert_eq!(Mask::from([2, 0]).check(&bits.clone().into()), Ok(()));
        assert_eq!(Probabilities::from([0.9, 0.9]).check(&bits.into()), Ok(()));
    }

    /// `MultiDiscrete` rescales the sum to 1 and so tolerates a larger error.
    #[test]
    fn a_sum_of_probabilities_is_nearly_one() {
        let grid = Space::from(MultiDiscrete::new([2]).unwrap());
        for (off, rescaled, chosen) in [
            (0.0, true, true),
            (1e-8, true, true),
            (1e-6, true, false),
            (-1e-6, true, false),
            (2e-5, false, false),
            (-2e-5, false, false),
        ] {
            let list = vec![0.5, 0.5 + off];
            let each = Probabilities::Each(vec![list.clone()]);
            assert_eq!(each.check(&grid).is_ok(), rescaled, "{off}");
            let values = Probabilities::from(list);
            assert_eq!(values.check(&Space::discrete(2)).is_ok(), chosen, "{off}");
        }
    }

    #[test]
    fn texts_are_checked() {
        let space = TextSpace::new(1, 3).unwrap().with_charset("ab").unwrap();
        assert_eq!(
            fault(space.clone(), text(Some(4), None)),
            "the length 4 is not between 1 and 3"
        );
        assert_eq!(
            fault(space.clone(), text(None, Some(vec![1]))),
            "there are 1 entries and should be 2"
        );
        assert!(fault(space, text(None, Some(vec![0, 0]))).contains("cannot be empty"));
        let space: Space = TextSpace::new(0, 3)
            .unwrap()
            .with_charset("ab")
            .unwrap()
            .into();
        assert_eq!(text(Some(0), Some(vec![0, 0])).check(&space), Ok(()));
    }

    #[test]
    fn members_are_checked() {
        let two = || [Space::discrete(2), Space::discrete(3)];
        let bad = || Mask::Tuple(vec![Mask::Any, Mask::from([1, 1])]);
        assert_eq!(
            fault(TupleSpace::new(two()), bad()),
            "[1]: there are 2 entries and should be 3"
        );
        assert_eq!(
            fault(OneOfSpace::new(two()).unwrap(), bad()),
            "[1]: there are 2 entries and should be 3"
        );
        assert_eq!(
            fault(TupleSpace::new(two()), Mask::Tuple(vec![])),
            "there are 0 entries and should be 2"
        );
        let dict = DictSpace::new([("a", Space::discrete(2))]).unwrap();
        let of = |key: &str| Mask::Dict(vec![(key.to_owned(), Mask::from([1]))]);
        assert_eq!(fault(dict.clone(), of("b")), r#"the space has no key "b""#);
        assert_eq!(
            fault(dict, of("a")),
            r#"["a"]: there are 1 entries and should be 2"#
        );
        let sequence = |lengths, member| Mask::Sequence {
            lengths,
            member: Box::new(member),
        };
        let space = SequenceSpace::new(Space::discrete(2));
        assert_eq!(
            fault(space.clone(), sequence(Some(vec![]), Mask::Any)),
            "there are no lengths to choose from"
        );
        assert_eq!(
            fault(space, sequence(None, Mask::from([1]))),
            ".member: there are 1 entries and should be 2"
        );
    }

    #[test]
    fn graphs_are_checked() {
        let graph = |num_nodes, num_edges, nodes, edges| Mask::Graph {
            num_nodes,
            num_edges,
            nodes: Box::new(nodes),
            edges: Box::new(edges),
        };
        let space = GraphSpace::new(Space::discrete(2), Some(Space::discrete(2))).unwrap();
        let check = |mask: Mask| {
            mask.check(&space.clone().into())
                .map_err(|fault| fault.to_string())
        };
        let each = |n| Mask::Each(vec![vec![1, 0]; n]);
        assert_eq!(check(graph(Some(2), Some(3), each(2), each(3))), Ok(()));
        assert_eq!(
            check(graph(None, None, each(10), Mask::from([0, 1]))),
            Ok(())
        );
        assert!(check(graph(Some(0), None, Mask::Any, Mask::Any)).is_err());
        assert!(check(graph(Some(usize::MAX), None, Mask::Any, Mask::Any)).is_err());
        assert!(check(graph(None, Some(usize::MAX), Mask::Any, Mask::Any)).is_err());
        let text = check(graph(None, None, each(9), Mask::Any)).unwrap_err();
        assert_eq!(text, ".nodes: there are 9 entries and should be 10");
        let text = check(graph(None, None, Mask::Any, each(3))).unwrap_err();
        assert_eq!(text, ".edges: lists for each edge need `num_edges`");
        let edgeless = GraphSpace::new(Space::discrete(2), None).unwrap();
        assert!(
            fault(edgeless, graph(None, Some(1), Mask::Any, Mask::Any)).contains("has no edges")
        );
    }
}
