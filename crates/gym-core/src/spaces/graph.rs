//! `Graph`: nodes, edges and which nodes the edges link.

use std::fmt;

use gym_numerics::Seed;
use serde::{Deserialize, Serialize};

use crate::value::array::Array;
use crate::value::number::Number;
use crate::value::{Error, GraphInstance, Result, Value};

use super::Space;
use super::batch::{batch_space, iterate};
use super::sampler::Streams;
use super::selection::Selection;
use super::weight::Weight;
use crate::value::fault::Fault;

/// Graphs whose nodes, and edges if they have features, are elements of a space: Gymnasium's
/// `Graph`.
///
/// ```
/// use gym_core::{Space, spaces::GraphSpace};
/// let space = GraphSpace::new(Space::boxed([0.0; 2], [1.0; 2]), Some(Space::discrete(3)))?;
/// assert_eq!(space.to_string(), "Graph(Box(0.0, 1.0, (2,), float32), Discrete(3))");
/// # Ok::<(), gym_core::Error>(())
/// ```
///
/// An element is a [`GraphInstance`]: the nodes as one value, the edges as another, and the pairs
/// of nodes that the edges link. A sample has 10 nodes and fewer than 90 edges unless the
/// [`Selection`] says otherwise; without an edge space it has no edges.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Description")]
pub struct GraphSpace {
    node_space: Box<Space>,
    edge_space: Option<Box<Space>>,
}

impl GraphSpace {
    /// The default number of nodes of a sample, as in Gymnasium.
    pub(super) const NUM_NODES: usize = 10;

    /// The graphs of such nodes and edges.
    ///
    /// # Errors
    /// [`Error::InvalidSpace`] for a space that does not [batch](Space::batch).
    pub fn new(node_space: impl Into<Space>, edge_space: Option<Space>) -> Result<Self> {
        let node_space = node_space.into();
        for space in std::iter::once(&node_space).chain(&edge_space) {
            space.batch(1)?;
        }
        Ok(Self {
            node_space: Box::new(node_space),
            edge_space: edge_space.map(Box::new),
        })
    }

    /// The space of each node.
    pub fn node_space(&self) -> &Space {
        &self.node_space
    }

    /// The space of each edge, if edges have features.
    pub fn edge_space(&self) -> Option<&Space> {
        self.edge_space.as_deref()
    }

    pub(super) fn contains(&self, value: &Value) -> bool {
        self.check(value).is_ok()
    }

    pub(super) fn check(&self, value: &Value) -> Result<(), Fault> {
        let Value::Graph(graph) = value else {
            return Err(Fault::kind("a graph", value));
        };
        let num_nodes =
            check_rows(&self.node_space, &graph.nodes).map_err(|fault| fault.within(".nodes"))?;
        match (self.edge_space(), &graph.edges, &graph.edge_links) {
            (_, None, None) => Ok(()),
            (None, Some(_), _) => Err(Fault::new("there are edges, but the space has none")),
            (Some(space), Some(edges), Some(links)) => {
                let num_edges = check_rows(space, edges).map_err(|fault| fault.within(".edges"))?;
                check_links(links, num_edges, num_nodes)
                    .map_err(|fault| fault.within(".edge_links"))
            }
            _ => Err(Fault::new(
                "edges and edge_links go together: give both or neither",
            )),
        }
    }

    pub(super) fn draw<T: Weight>(
        &self,
        streams: &mut Streams,
        selection: &Selection<T>,
        out: &mut Value,
    ) {
        let (num_nodes, num_edges, node_selection, edge_selection) = match selection {
            Selection::Graph {
                num_nodes,
                num_edges,
                nodes,
                edges,
            } => (
                num_nodes.unwrap_or(Self::NUM_NODES),
                *num_edges,
                &**nodes,
                &**edges,
            ),
            _ => (Self::NUM_NODES, None, &Selection::Any, &Selection::Any),
        };
        let Streams { own, members } = streams;
        // This fits `i64`, because `Selection::check` bounds the number of nodes.
        let pairs = (num_nodes * (num_nodes - 1)) as i64;
        let num_edges = match num_edges {
            Some(n) => n,
            None if num_nodes > 1 => own.integers(0, pairs) as usize,
            None => 0,
        };
        let nodes = draw_rows(&self.node_space, &mut members[0], node_selection, num_nodes);
        let mut graph = GraphInstance {
            nodes,
            edges: None,
            edge_links: None,
        };
        if let Some(space) = self.edge_space()
            && num_edges > 0
        {
            graph.edges = Some(draw_rows(space, &mut members[1], edge_selection, num_edges));
            let links = (0..2 * num_edges).map(|_| own.integers(0, num_nodes as i64) as i32);
            graph.edge_links = Array::from(links.collect::<Vec<_>>())
                .reshape([num_edges, 2])
                .ok();
        }
        *out = Value::Graph(Box::new(graph));
    }
}

/// Draws all rows. As in Gymnasium, the draws use a copy of the generators: only the space's
/// generator advances, by one number.
fn draw_rows<T: Weight>(
    space: &Space,
    streams: &mut Streams,
    selection: &Selection<T>,
    n: usize,
) -> Value {
    let rows = draw_batch(space, &mut streams.clone(), selection, n);
    streams.own.random();
    rows
}

/// Draws an element of Gymnasium's `batch_space(space, n)`. If the batched elements are not an
/// array, each element is drawn with a new seed.
fn draw_batch<T: Weight>(
    space: &Space,
    streams: &mut Streams,
    selection: &Selection<T>,
    n: usize,
) -> Value {
    /// One more than the largest seed that Gymnasium draws.
    const SEEDS: i64 = 100_000_000;
    let mut out = Value::Null;
    match space {
        Space::Tuple(space) => {
            let members = space.spaces().iter().zip(&mut streams.members);
            let any = &Selection::<T>::Any;
            Value::Tuple(
                members
                    .map(|(space, streams)| draw_batch(space, streams, any, n))
                    .collect(),
            )
        }
        Space::Dict(space) => {
            let members = space.spaces().iter().zip(&mut streams.members);
            let any = &Selection::<T>::Any;
            Value::Dict(
                members
                    .map(|((key, space), streams)| {
                        (key.clone(), draw_batch(space, streams, any, n))
                    })
                    .collect(),
            )
        }
        _ if space.dtype().is_some() => {
            if let Ok(batch) = batch_space(space, n) {
                batch.draw(streams, selection, &mut out);
            }
            out
        }
        _ => {
            let seeds: Vec<i64> = (0..n).map(|_| streams.own.integers(0, SEEDS)).collect();
            let rows = seeds.into_iter().map(|seed| {
                let mut streams = Streams::new(space, &Seed::from(seed as u64));
                let mut row = Value::Null;
                space.draw(&mut streams, &Selection::<T>::Any, &mut row);
                row
            });
            Value::Tuple(rows.collect())
        }
    }
}

/// Checks that each row is an element of a space, and counts them.
fn check_rows(space: &Space, rows: &Value) -> Result<usize, Fault> {
    let rows = iterate(space, rows)?;
    for (i, row) in rows.iter().enumerate() {
        space.check_value(row).map_err(|fault| fault.at(i))?;
    }
    Ok(rows.len())
}

fn check_links(links: &Array, num_edges: usize, num_nodes: usize) -> Result<(), Fault> {
    if links.dtype().is_float() {
        return Err(Fault::new(format!(
            "the numbers are {} and should be integers",
            links.dtype()
        )));
    }
    if links.shape() != [num_edges, 2] {
        return Err(Fault::new(format!(
            "the shape is {:?} and should be [{num_edges}, 2]",
            links.shape()
        )));
    }
    let is_node = |x: Number| x >= Number::Int(0) && x < Number::Int(num_nodes as i128);
    match Number::all(links.data())
        .enumerate()
        .find(|(_, x)| !is_node(*x))
    {
        None => Ok(()),
        Some((i, x)) => Err(Fault::new(format!(
            "{x} is not the index of one of the {num_nodes} nodes"
        ))
        .at_element(i, links.shape())),
    }
}

/// Prints as Gymnasium does: `Graph(Discrete(2), None)`.
impl fmt::Display for GraphSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.edge_space() {
            Some(edge_space) => write!(f, "Graph({}, {edge_space})", self.node_space),
            None => write!(f, "Graph({}, None)", self.node_space),
        }
    }
}

/// The stored form, before it is checked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    node_space: Space,
    edge_space: Option<Space>,
}

impl TryFrom<Description> for GraphSpace {
    type Error = Error;

    fn try_from(stored: Description) -> Result<Self> {
        Self::new(stored.node_space, stored.edge_space)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spaces::{DictSpace, TextSpace, TupleSpace};

    fn space() -> GraphSpace {
        GraphSpace::new(Space::discrete(5), Some(Space::discrete(3))).unwrap()
    }

    fn graph(nodes: &[i64], edges: &[i64], links: &[i32]) -> Value {
        Value::Graph(Box::new(GraphInstance {
            nodes: Value::Array(nodes.to_vec().into()),
            edges: Some(Value::Array(edges.to_vec().into())),
            edge_links: Array::from(links.to_vec())
                .reshape([links.len() / 2, 2])
                .ok(),
        }))
    }

    /// Nodes of texts and edges of dicts, drawn as Gymnasium 1.4.0 draws them with seed 3.
    #[test]
    fn nodes_and_edges_may_be_of_any_kind() {
        let text = || {
            Space::from(
                TextSpace::new(1, 3)
                    .unwrap()
                    .with_charset("abcdef")
                    .unwrap(),
            )
        };
        let pair = TupleSpace::new([Space::discrete(5), text()]);
        let dict = DictSpace::new([("a", Space::discrete(3)), ("b", text())]).unwrap();
        let space: Space = GraphSpace::new(pair, Some(dict.into())).unwrap().into();
        let mut sampler = space.sampler(3);
        let mut seen = |links: [i32; 6]| {
            let graph = sampler.sample_graph(2, Some(3)).unwrap();
            space.check_value(&graph).unwrap();
            assert_eq!(space.from_json(&graph.to_json()).unwrap(), graph);
            let texts = |texts: &[&str]| Value::Tuple(texts.iter().map(|&t| t.into()).collect());
            let expected = GraphInstance {
                nodes: Value::Tuple(vec![Value::Array([1i64, 1].into()), texts(&["abf", "c"])]),
                edges: Some(Value::from([
                    ("a", Value::Array([2i64, 1, 2].into())),
                    ("b", texts(&["e", "be", "dfd"])),
                ])),
                edge_links: Array::from(links).reshape([3, 2]).ok(),
            };
            assert_eq!(graph, Value::Graph(Box::new(expected)));
        };
        seen([1, 0, 0, 0, 0, 1]);
        // as in Gymnasium: only the links differ, because the generators of members do not advance
        seen([1, 1, 0, 0, 0, 0]);
        let wrong = GraphInstance {
            nodes: Value::Tuple(vec![
                Value::Array([1i64].into()),
                Value::Tuple(vec!["a".into(), "b".into()]),
            ]),
            edges: None,
            edge_links: None,
        };
        let fault = space
            .check_value(&Value::Graph(Box::new(wrong)))
            .unwrap_err();
        assert!(
            fault.to_string().contains("different numbers of elements"),
            "{fault}"
        );
    }

    #[test]
    fn contains_consistent_graphs() {
        assert!(space().contains(&graph(&[0, 4], &[2], &[0, 1])));
        assert!(space().contains(&graph(&[0], &[0, 0], &[0, 0, 0, 0])));
        assert!(
            !space().contains(&graph(&[5], &[2], &[0, 0]))
                && !space().contains(&graph(&[0], &[3], &[0, 0]))
        );
        assert!(
            !space().contains(&graph(&[0], &[2], &[0, 1]))
                && !space().contains(&graph(&[0], &[2], &[-1, 0]))
        );
        assert!(
            !space().contains(&graph(&[0], &[2, 2], &[0, 0])) && !space().contains(&Value::Null)
        );

        let without = |edges: bool, links: bool| {
            let Value::Graph(mut graph) = graph(&[0], &[0], &[0, 0]) else {
                unreachable!()
            };
            graph.edges = graph.edges.filter(|_| edges);
            graph.edge_links = graph.edge_links.filter(|_| links);
            Value::Graph(graph)
        };
        assert!(space().contains(&without(false, false)));
        assert!(
            !space().contains(&without(true, false)) && !space().contains(&without(false, true))
        );
        let edgeless = GraphSpace::new(Space::discrete(5), None).unwrap();
        assert!(
            edgeless.contains(&without(false, false)) && !edgeless.contains(&without(true, true))
        );
    }

    #[test]
    fn faults_name_the_place() {
        let fault = |value: Value| space().check(&value).unwrap_err().to_string();
        assert_eq!(
            fault(graph(&[0, 5], &[2], &[0, 1])),
            ".nodes[1]: 5 is not between 0 and 4"
        );
        assert_eq!(
            fault(graph(&[0, 1], &[2], &[0, 2])),
            ".edge_links[0, 1]: 2 is not the index of one of the 2 nodes"
        );
    }

    #[test]
    fn prints_as_gymnasium() {
        assert_eq!(space().to_string(), "Graph(Discrete(5), Discrete(3))");
        assert_eq!(
            GraphSpace::new(Space::discrete(2), None)
                .unwrap()
                .to_string(),
            "Graph(Discrete(2), None)"
        );
    }
}
