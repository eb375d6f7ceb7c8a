//! The meshes of a model: read, compiled, and added to its arrays.

use std::collections::HashSet;

use super::body::address;
use super::geom::is_visual;
use super::mesh::{Builtin, Format, Mesh, Source};
use crate::Result;
use crate::mjcf::spec::{self, Spec};
use crate::mjcf::store::Assets;
use crate::model::{CompiledModel, GeomType, Meshes};

/// How many bytes of files a vertex of a shape without a file counts as.
const BYTES: u64 = 32;

/// Reads and compiles the meshes.
pub(super) fn compile_meshes(spec: &Spec, assets: &mut Assets<'_>) -> Result<Vec<Mesh>> {
    let colliding = colliding(spec);
    let mut names = HashSet::new();
    let mut meshes = Vec::with_capacity(spec.meshes.len());
    for mesh in &spec.meshes {
        let (place, name) = (&mesh.place, &*mesh.name);
        if !names.insert(name) {
            return Err(place.attribute("name", format!("there is a mesh {name:?} already")));
        }
        let file = mesh.path.as_deref();
        let fault = |reason: String| match file {
            Some(path) => place.attribute("file", format!("{}: {reason}", path.display())),
            None => place.error(reason),
        };
        let source = source(mesh, spec, assets).map_err(&fault)?;
        let mut options = mesh.options;
        options.collides = colliding.contains(name);
        let compiled = Mesh::compile(source, &options, spec.revision);
        meshes.push(compiled.map_err(|error| fault(error.to_string()))?);
    }
    Ok(meshes)
}

/// The names of meshes that geoms collide with.
fn colliding(spec: &Spec) -> HashSet<&str> {
    let pairs = spec.pairs.iter().flat_map(|pair| &pair.geoms).flatten();
    let paired: HashSet<&str> = pairs.map(String::as_str).collect();
    let geoms = spec.bodies.iter().flat_map(|body| &body.geoms);
    let geoms = geoms.filter(|geom| {
        let named = geom
            .name
            .as_deref()
            .is_some_and(|name| paired.contains(name));
        geom.shape == GeomType::Mesh && (geom.contype != 0 || geom.conaffinity != 0 || named)
    });
    geoms.filter_map(|geom| geom.mesh.as_deref()).collect()
}

/// What the file and the attributes of a mesh give.
fn source(mesh: &spec::Mesh, spec: &Spec, assets: &mut Assets<'_>) -> Result<Source, String> {
    let attributes = Source {
        vertices: mesh.vertices.clone(),
        normals: mesh.normals.clone(),
        texture: mesh.texture.clone(),
        faces: mesh.faces.clone(),
        ..Source::default()
    };
    if let Some((name, params)) = &mesh.builtin {
        // what it makes stands in the place of the attributes
        let shape = Builtin::of(name, params).map_err(|reason| format!("params {reason}"))?;
        assets.count(BYTES * shape.vertices())?;
        return Ok(Source {
            texture: attributes.texture,
            ..shape.source()
        });
    }
    let Some(path) = &mesh.path else {
        return Ok(attributes);
    };
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let kind = mesh.content_type.as_deref().unwrap_or(&extension);
    let format = Format::named(kind)
        .ok_or_else(|| format!("{kind:?} is no format of meshes: use stl, obj or msh"))?;
    let bytes = assets.read(path)?;
    let mut source =
        Source::read(format, &bytes, spec.revision).map_err(|error| error.to_string())?;
    source
        .complete(attributes)
        .map_err(|error| error.to_string())?;
    Ok(source)
}

/// Adds the meshes to the model whose geoms refer to them; with `discardvisual` only those that a geom
/// has.
pub(super) fn add_meshes(m: &mut CompiledModel, spec: &Spec, meshes: Vec<Mesh>) {
    let geoms = spec.bodies.iter().flat_map(|body| &body.geoms);
    let kept = geoms.filter(|geom| !is_visual(geom, spec));
    let named: HashSet<&str> = kept.filter_map(|geom| geom.mesh.as_deref()).collect();
    let mut numbers = Vec::with_capacity(meshes.len());
    for (mesh, about) in meshes.into_iter().zip(&spec.meshes) {
        numbers.push(m.nmesh() as i32);
        if !spec.compiler.discard_visual || named.contains(&*about.name) {
            add(&mut m.meshes, mesh);
        }
    }
    for (id, shape) in m.geom_dataid.iter_mut().zip(&m.geom_type) {
        if let (Ok(number), true) = (usize::try_from(*id), *shape != GeomType::Hfield) {
            *id = numbers[number];
        }
    }
}

/// Adds the lists of a mesh to those of all.
fn add(all: &mut Meshes, mut mesh: Mesh) {
    all.mesh_vertadr.push(all.mesh_vert.len());
    all.mesh_vertnum.push(mesh.vertices.len() / 3);
    all.mesh_vert.extend(mesh.vertices.as_chunks().0);
    all.mesh_normaladr.push(all.mesh_normal.len());
    all.mesh_normalnum.push(mesh.normals.len() / 3);
    all.mesh_normal.extend(mesh.normals.as_chunks().0);
    all.mesh_texcoordadr
        .push(address(all.mesh_texcoord.len(), mesh.texture.len() / 2));
    all.mesh_texcoordnum.push(mesh.texture.len() / 2);
    all.mesh_texcoord.extend(mesh.texture.as_chunks().0);
    all.mesh_faceadr.push(all.mesh_face.len());
    all.mesh_facenum.push(mesh.faces.len());
    let numbers = |corners: &[i32; 3]| corners.map(|number| number as u32);
    all.mesh_face.extend(mesh.faces.iter().map(numbers));
    let corners = mesh.face_normals;
    all.mesh_facenormal
        .extend(corners.as_chunks().0.iter().map(numbers));
    let corners = mesh.face_texture;
    all.mesh_facetexcoord
        .extend(corners.as_chunks().0.iter().map(numbers));
    all.mesh_facetexcoord.resize(all.mesh_face.len(), [0; 3]);

    let graph = mesh
        .graph
        .take()
        .map_or(Vec::new(), |graph| graph.to_integers());
    all.mesh_graphadr
        .push(address(all.mesh_graph.len(), graph.len()));
    all.mesh_graph.extend(graph);
    all.mesh_extrema
        .push(mesh.extrema.map(|vertex| vertex as u32));
    all.mesh_polyadr.push(all.mesh_polynormal.len());
    all.mesh_polynum.push(mesh.polygons.len());
    all.mesh_polynormal.append(&mut mesh.polygon_normals);
    for corners in mesh.polygons {
        all.mesh_polyvertadr.push(all.mesh_polyvert.len());
        all.mesh_polyvertnum.push(corners.len());
        all.mesh_polyvert
            .extend(corners.iter().map(|corner| *corner as u32));
    }
    for polygons in mesh.polygons_of_vertex {
        all.mesh_polymapadr.push(all.mesh_polymap.len());
        all.mesh_polymapnum.push(polygons.len());
        all.mesh_polymap
            .extend(polygons.iter().map(|polygon| *polygon as u32));
    }
    all.mesh_pos.push(mesh.position);
    all.mesh_quat.push(mesh.orientation);
}
