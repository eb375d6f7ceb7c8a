//! Checks the arrays of meshes: ranges follow each other, numbers exist, lists end, and what is
//! said twice is said alike.

use std::ops::Range;

use super::check::{same, same_length};
use super::values::{LENGTH, finite, length};
use crate::error::ensure;
use crate::model::{CompiledModel, GeomType, Meshes};
use crate::{Error, Result};

pub(super) fn check(m: &CompiledModel) -> Result<()> {
    geoms(m)?;
    if m.meshes.is_checked() {
        return Ok(());
    }
    lengths(&m.meshes)?;
    numbers(&m.meshes)?;
    lists(&m.meshes)
}

fn lists(m: &Meshes) -> Result<()> {
    let vertices = ranges(
        "mesh_vert",
        &m.mesh_vertadr,
        &m.mesh_vertnum,
        m.mesh_vert.len(),
    )?;
    let (adr, num) = (&m.mesh_normaladr, &m.mesh_normalnum);
    ranges("mesh_normal", adr, num, m.mesh_normal.len())?;
    let faces = ranges(
        "mesh_face",
        &m.mesh_faceadr,
        &m.mesh_facenum,
        m.mesh_face.len(),
    )?;
    let (adr, num) = (&m.mesh_polyadr, &m.mesh_polynum);
    let polygons = ranges("mesh_poly", adr, num, m.mesh_polynormal.len())?;
    let (adr, num) = (&m.mesh_polyvertadr, &m.mesh_polyvertnum);
    let corners = ranges("mesh_polyvert", adr, num, m.mesh_polyvert.len())?;
    let (adr, num) = (&m.mesh_polymapadr, &m.mesh_polymapnum);
    let maps = ranges("mesh_polymap", adr, num, m.mesh_polymap.len())?;
    let (mut texture, mut graph) = (0, 0);
    for i in 0..m.mesh_vertadr.len() {
        let (count, textures) = (vertices[i].len(), m.mesh_texcoordnum[i]);
        ensure!(count > 0, "mesh {i} has no vertices");
        ensure!(
            textures <= m.mesh_texcoord.len() - texture,
            "mesh_texcoordnum[{i}] is {textures}, beyond the last"
        );
        let address = if textures > 0 { texture as i32 } else { -1 };
        same("mesh_texcoordadr", i, m.mesh_texcoordadr[i], address)?;
        texture += textures;
        for (name, corners, count) in [
            ("mesh_face", &m.mesh_face, count),
            ("mesh_facenormal", &m.mesh_facenormal, m.mesh_normalnum[i]),
            // 0 where there are none
            ("mesh_facetexcoord", &m.mesh_facetexcoord, textures.max(1)),
        ] {
            below(name, i, corners[faces[i].clone()].as_flattened(), count)?;
        }
        graph += hull(m, i, graph, count)?;
        let polygons = Polygons {
            corners: &corners[polygons[i].clone()],
            maps: &maps[vertices[i].clone()],
        };
        polygons.check(m, i)?;
    }
    for (name, length, expected) in [
        ("mesh_texcoord", m.mesh_texcoord.len(), texture),
        ("mesh_graph", m.mesh_graph.len(), graph),
    ] {
        let complete = length == expected;
        ensure!(
            complete,
            "{name} has {length} elements, expected {expected}"
        );
    }
    Ok(())
}

fn geoms(m: &CompiledModel) -> Result<()> {
    same_length!(m, m.ngeom(), geom_dataid);
    same_length!(m, if m.has_meshes() { m.ngeom() } else { 0 }, geom_aabb);
    for (g, &id) in m.geom_dataid.iter().enumerate() {
        if m.geom_type[g] == GeomType::Hfield {
            continue;
        }
        let exists = usize::try_from(id).is_ok_and(|id| id < m.nmesh());
        let needed = m.geom_type[g] == GeomType::Mesh;
        ensure!(
            exists || id == -1 && !needed,
            "geom_dataid[{g}] is {id}, and there are {} meshes",
            m.nmesh()
        );
    }
    for (g, [.., x, y, z]) in m.geom_aabb.iter().enumerate() {
        let possible = [x, y, z].into_iter().all(|half| *half >= 0.0);
        ensure!(possible, "geom_aabb[{g}] has a negative half size");
    }
    Ok(())
}

fn lengths(m: &Meshes) -> Result<()> {
    same_length!(
        m, m.mesh_vertadr.len(),
        mesh_vertnum mesh_normaladr mesh_normalnum mesh_texcoordadr mesh_texcoordnum mesh_faceadr
        mesh_facenum mesh_graphadr mesh_extrema mesh_polyadr mesh_polynum mesh_pos mesh_quat
    );
    same_length!(m, m.mesh_face.len(), mesh_facenormal mesh_facetexcoord);
    same_length!(m, m.mesh_polynormal.len(), mesh_polyvertadr mesh_polyvertnum);
    same_length!(m, m.mesh_vert.len(), mesh_polymapadr mesh_polymapnum);
    Ok(())
}

fn numbers(m: &Meshes) -> Result<()> {
    for (name, numbers) in [
        ("mesh_vert", m.mesh_vert.as_flattened()),
        ("mesh_normal", m.mesh_normal.as_flattened()),
        ("mesh_texcoord", m.mesh_texcoord.as_flattened()),
    ] {
        let wrong = numbers.iter().position(|x| !x.is_finite());
        ensure!(
            wrong.is_none(),
            "number {} of {name} is not finite",
            wrong.unwrap_or_default()
        );
    }
    finite("mesh_pos", m.mesh_pos.as_flattened())?;
    let quats = m.mesh_quat.iter().map(|quat| length(quat));
    let normals = m.mesh_polynormal.iter().map(|normal| length(normal));
    let quats = quats.enumerate().map(|at| ("mesh_quat", at));
    let normals = normals.enumerate().map(|at| ("mesh_polynormal", at));
    for (name, (i, length)) in quats.chain(normals) {
        let one = (length - 1.0).abs() <= LENGTH;
        ensure!(
            one,
            "{name}[{i}] is not of length 1: divide it by its length"
        );
    }
    Ok(())
}

/// The ranges of an array that the elements of two others give: they follow each other to its end.
fn ranges(
    name: &str,
    starts: &[usize],
    counts: &[usize],
    total: usize,
) -> Result<Vec<Range<usize>>> {
    let mut next = 0;
    let mut ranges = Vec::with_capacity(starts.len());
    for (i, (&start, &count)) in starts.iter().zip(counts).enumerate() {
        same(&format!("{name}adr"), i, start, next)?;
        ensure!(
            count <= total - next,
            "{name}num[{i}] is {count}, beyond the last"
        );
        next += count;
        ranges.push(start..next);
    }
    ensure!(
        next == total,
        "{name} has {total} elements, expected {next}"
    );
    Ok(ranges)
}

/// Requires numbers of a mesh to be less than a count.
fn below(name: &str, mesh: usize, numbers: &[u32], count: usize) -> Result<()> {
    match numbers.iter().find(|number| **number as usize >= count) {
        None => Ok(()),
        Some(number) => Err(Error::Model(format!(
            "{name} has the number {number} in mesh {mesh}, where numbers are less than {count}"
        ))),
    }
}

/// Checks the convex hull of a mesh of so many points, which begins at `start` of `mesh_graph`;
/// returns the number of its elements.
fn hull(m: &Meshes, mesh: usize, start: usize, points: usize) -> Result<usize> {
    if m.mesh_graphadr[mesh] == -1 {
        below("mesh_extrema", mesh, &m.mesh_extrema[mesh], 1)?;
        return Ok(0);
    }
    same("mesh_graphadr", mesh, m.mesh_graphadr[mesh], start as i32)?;
    let (vertices, length) = neighbors(&m.mesh_graph[start..], points)
        .map_err(|reason| Error::Model(format!("mesh_graph of mesh {mesh}: {reason}")))?;
    below("mesh_extrema", mesh, &m.mesh_extrema[mesh], vertices)?;
    Ok(length)
}

/// The number of vertices of the hull at the start of `graph`, and the number of its elements.
fn neighbors(graph: &[i32], points: usize) -> Result<(usize, usize), String> {
    let counts = graph.split_first_chunk::<2>();
    let counts = counts.map(|(counts, rest)| (counts.map(usize::try_from), rest));
    let Some(([Ok(vertices), Ok(triangles)], rest)) = counts else {
        return Err("there are no counts of vertices and triangles".to_owned());
    };
    let edges = triangles.saturating_mul(3).saturating_add(vertices);
    let length = edges
        .saturating_add(vertices)
        .saturating_mul(2)
        .saturating_sub(vertices);
    if vertices == 0 || length > rest.len() {
        return Err(format!(
            "it ends before the {vertices} vertices and {triangles} triangles"
        ));
    }
    let (starts, rest) = rest.split_at(vertices);
    let (ids, rest) = rest.split_at(vertices);
    let (edges, rest) = rest.split_at(edges);
    for id in ids.iter().chain(&rest[..3 * triangles]) {
        if usize::try_from(*id).is_ok_and(|id| id < points) {
            continue;
        }
        return Err(format!("it has the point {id}, and there are {points}"));
    }
    let mut next = 0;
    let mut pairs = Vec::new();
    for (v, &start) in starts.iter().enumerate() {
        if start != next as i32 {
            return Err(format!(
                "the neighbours of vertex {v} begin at {start}, expected {next}"
            ));
        }
        let list = edges[next..]
            .split(|other| *other == -1)
            .next()
            .unwrap_or_default();
        next += list.len() + 1;
        if next > edges.len() {
            return Err(format!("the neighbours of vertex {v} do not end with -1"));
        }
        for &other in list {
            if !usize::try_from(other).is_ok_and(|other| other < vertices && other != v) {
                return Err(format!(
                    "vertex {v} has the neighbour {other}, of {vertices} vertices"
                ));
            }
            pairs.push((v as i32, other));
        }
    }
    if next != edges.len() {
        return Err(format!(
            "there are {} numbers of neighbours, expected {next}",
            edges.len()
        ));
    }
    let mut turned: Vec<(i32, i32)> = pairs.iter().map(|(a, b)| (*b, *a)).collect();
    turned.sort_unstable();
    pairs.sort_unstable();
    match pairs
        .iter()
        .zip(&turned)
        .find(|(pair, turned)| pair != turned)
    {
        None => Ok((vertices, 2 + length)),
        Some((pair, turned)) => {
            let (a, b) = pair.min(turned);
            Err(format!(
                "vertices {a} and {b} are neighbours in one list only"
            ))
        }
    }
}

/// The polygons of a mesh's hull: where each has its corners, and each vertex its polygons.
struct Polygons<'a> {
    corners: &'a [Range<usize>],
    maps: &'a [Range<usize>],
}

impl Polygons<'_> {
    fn check(&self, m: &Meshes, mesh: usize) -> Result<()> {
        let (mut corners, mut maps) = (Vec::new(), Vec::new());
        for (i, range) in self.corners.iter().enumerate() {
            let numbers = &m.mesh_polyvert[range.clone()];
            ensure!(
                numbers.len() >= 3,
                "polygon {i} of mesh {mesh} has fewer than 3 corners"
            );
            below("mesh_polyvert", mesh, numbers, self.maps.len())?;
            corners.extend(numbers.iter().map(|v| (*v, i as u32)));
        }
        for (v, range) in self.maps.iter().enumerate() {
            let numbers = &m.mesh_polymap[range.clone()];
            below("mesh_polymap", mesh, numbers, self.corners.len())?;
            maps.extend(numbers.iter().map(|i| (v as u32, *i)));
        }
        corners.sort_unstable();
        maps.sort_unstable();
        ensure!(
            corners == maps,
            "mesh_polymap of mesh {mesh} does not have the polygons of mesh_polyvert"
        );
        Ok(())
    }
}
