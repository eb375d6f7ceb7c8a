//! Meshes in compiled models.

use mujoco_engine::model::GeomType;
use mujoco_engine::{CompiledModel, Model};

/// A ball of the shape of a tetrahedron, with a convex hull.
fn tetrahedron() -> CompiledModel {
    let text = "<mujoco><worldbody><geom size=\"1\"/><geom size=\"2\"/></worldbody></mujoco>";
    let mut m = Model::from_xml(text).unwrap().into_compiled();
    let faces = [[1, 0, 2], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let neighbors = [[1, 2, 3, -1], [0, 2, 3, -1], [0, 1, 3, -1], [0, 1, 2, -1]];
    m.geom_type[0] = GeomType::Mesh;
    m.geom_dataid = vec![0, -1];
    m.geom_aabb = vec![[0.25, 0.25, 0.25, 0.25, 0.25, 0.25], [0.0; 6]];
    let mesh = &mut *m.meshes;
    mesh.mesh_vertadr = vec![0];
    mesh.mesh_vertnum = vec![4];
    mesh.mesh_vert = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.1]];
    mesh.mesh_normaladr = vec![0];
    mesh.mesh_normalnum = vec![1];
    mesh.mesh_normal = vec![[0.0, 0.0, 1.0]];
    mesh.mesh_texcoordadr = vec![0];
    mesh.mesh_texcoordnum = vec![2];
    mesh.mesh_texcoord = vec![[0.0, 1.0], [0.5, 0.3]];
    mesh.mesh_faceadr = vec![0];
    mesh.mesh_facenum = vec![4];
    mesh.mesh_face = faces.to_vec();
    mesh.mesh_facenormal = vec![[0; 3]; 4];
    mesh.mesh_facetexcoord = vec![[0, 1, 0]; 4];
    mesh.mesh_graphadr = vec![0];
    mesh.mesh_graph = vec![4, 4, 0, 4, 8, 12, 0, 1, 2, 3];
    mesh.mesh_graph.extend(neighbors.as_flattened());
    mesh.mesh_graph
        .extend(faces.as_flattened().iter().map(|v| *v as i32));
    mesh.mesh_extrema = vec![[3; 27]];
    mesh.mesh_polyadr = vec![0];
    mesh.mesh_polynum = vec![4];
    mesh.mesh_polynormal = vec![[0.0, 0.0, 1.0]; 4];
    mesh.mesh_polyvertadr = vec![0, 3, 6, 9];
    mesh.mesh_polyvertnum = vec![3; 4];
    mesh.mesh_polyvert = faces.as_flattened().to_vec();
    mesh.mesh_polymapadr = vec![0, 3, 6, 9];
    mesh.mesh_polymapnum = vec![3; 4];
    mesh.mesh_polymap = vec![0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3];
    mesh.mesh_pos = vec![[0.0; 3]];
    mesh.mesh_quat = vec![[1.0, 0.0, 0.0, 0.0]];
    m
}

/// A model with a mesh is the same after it was stored, to the last bit of a single.
#[test]
fn meshes_are_stored() {
    let mut m = Model::new(tetrahedron()).unwrap();
    assert_eq!(m.nmesh(), 1);
    assert_eq!(m.geom_aabb[1], [0.0, 0.0, 0.0, 2.0, 2.0, 2.0]);
    let text = serde_json::to_string(&m).unwrap();
    let read: Model = serde_json::from_str(&text).unwrap();
    assert_eq!(CompiledModel::clone(&m), CompiledModel::clone(&read));
    // what follows from other sizes follows them, and the mesh keeps its own
    m.change(|m| m.geom_size = vec![[3.0; 3]; 2]).unwrap();
    assert_eq!(m.geom_aabb[1], [0.0, 0.0, 0.0, 3.0, 3.0, 3.0]);
    assert_eq!(m.geom_aabb[0], [0.25; 6]);
    assert_eq!(m.geom_rbound[..], [1.0, 3.0]);
}

/// A model without meshes has no word of them.
#[test]
fn no_meshes_are_not_stored() {
    let text = "<mujoco><worldbody><geom size=\"1\"/></worldbody></mujoco>";
    let mut figures = Model::from_xml(text).unwrap().into_compiled();
    // as libmujoco has it
    figures.geom_aabb = vec![[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]];
    figures.geom_dataid = vec![-1];
    let text = serde_json::to_string(&Model::new(figures).unwrap()).unwrap();
    for word in ["mesh", "aabb", "dataid"] {
        assert!(!text.contains(word), "{word}: {text}");
    }
}

/// Copies of a model share its meshes until one changes them; the change is checked.
#[test]
fn meshes_are_checked_when_they_change() {
    let mut m = Model::new(tetrahedron()).unwrap();
    let same = CompiledModel::clone(&m);
    assert!(std::ptr::eq(&*m.meshes, &*same.meshes));
    m.change(|m| m.meshes.mesh_vert[3][2] = 0.5).unwrap();
    assert_eq!(
        (same.meshes.mesh_vert[3][2], m.meshes.mesh_vert[3][2]),
        (0.1, 0.5)
    );
    let error = m.change(|m| m.meshes.mesh_face[0][0] = 4).unwrap_err();
    assert!(
        error.to_string().contains("mesh_face has the number 4"),
        "{error}"
    );
    assert_eq!(m.meshes.mesh_face[0][0], 1);
}

/// Each wrong number is an error that names its array.
#[test]
fn wrong_meshes_are_refused() {
    type Change = fn(&mut CompiledModel);
    let wrong: [(&str, Change); 37] = [
        ("geom_dataid[0] is 1", |m| m.geom_dataid[0] = 1),
        ("geom_dataid[1] is -2", |m| m.geom_dataid[1] = -2),
        ("geom_dataid[0] is -1", |m| m.geom_dataid[0] = -1),
        ("geom_aabb has 1", |m| m.geom_aabb.truncate(1)),
        ("geom_aabb[0]", |m| m.geom_aabb[0][4] = -1.0),
        ("geom_aabb", |m| m.geom_aabb[0][1] = f64::NAN),
        ("mesh_vert has 4", |m| m.meshes.mesh_vertnum[0] = 0),
        ("mesh_vertadr[0] is 1", |m| m.meshes.mesh_vertadr[0] = 1),
        ("mesh_vertnum[0] is", |m| {
            m.meshes.mesh_vertnum[0] = usize::MAX;
        }),
        ("mesh_vertnum has 2", |m| m.meshes.mesh_vertnum.push(1)),
        ("mesh_vert is not finite", |m| {
            m.meshes.mesh_vert[2][1] = f32::NAN;
        }),
        ("mesh_normal is not finite", |m| {
            m.meshes.mesh_normal[0][0] = f32::INFINITY;
        }),
        ("mesh_normalnum[0] is 2", |m| m.meshes.mesh_normalnum[0] = 2),
        ("mesh_texcoordadr[0]", |m| m.meshes.mesh_texcoordadr[0] = -1),
        ("mesh_texcoordnum[0]", |m| {
            m.meshes.mesh_texcoordnum[0] = usize::MAX;
        }),
        ("mesh_texcoord has 3", |m| {
            m.meshes.mesh_texcoord.push([0.0; 2]);
        }),
        ("mesh_face has the number 4", |m| {
            m.meshes.mesh_face[3][2] = 4;
        }),
        ("mesh_facenormal has the number 1", |m| {
            m.meshes.mesh_facenormal[0][0] = 1;
        }),
        ("mesh_facetexcoord has the number 2", |m| {
            m.meshes.mesh_facetexcoord[0][0] = 2;
        }),
        ("mesh_facenormal has 3", |m| {
            m.meshes.mesh_facenormal.truncate(3);
        }),
        ("mesh_graphadr[0] is 2", |m| m.meshes.mesh_graphadr[0] = 2),
        ("mesh_graph has 39", |m| m.meshes.mesh_graph.push(0)),
        ("mesh_graph of mesh 0: it ends", |m| {
            m.meshes.mesh_graph.truncate(36);
        }),
        ("mesh_graph of mesh 0: it ends", |m| {
            m.meshes.mesh_graph[1] = i32::MAX;
        }),
        ("no counts", |m| m.meshes.mesh_graph[0] = -1),
        ("vertex 1 begin at 5", |m| m.meshes.mesh_graph[3] = 5),
        ("point 4", |m| m.meshes.mesh_graph[9] = 4),
        ("neighbour 4", |m| m.meshes.mesh_graph[10] = 4),
        ("neighbour 0", |m| m.meshes.mesh_graph[10] = 0),
        ("in one list only", |m| m.meshes.mesh_graph[10] = 2),
        ("do not end", |m| m.meshes.mesh_graph[25] = 1),
        ("mesh_extrema has the number 4", |m| {
            m.meshes.mesh_extrema[0][5] = 4;
        }),
        ("mesh_polynormal[1]", |m| {
            m.meshes.mesh_polynormal[1] = [0.5; 3];
        }),
        ("mesh_polyvertadr[1]", |m| m.meshes.mesh_polyvertadr[1] = 2),
        ("mesh_polyvert has the number 9", |m| {
            m.meshes.mesh_polyvert[4] = 9;
        }),
        ("mesh_polymap has the number 4", |m| {
            m.meshes.mesh_polymap[4] = 4;
        }),
        ("mesh_polymap of mesh 0", |m| m.meshes.mesh_polymap[5] = 2),
    ];
    for (message, change) in wrong {
        let mut m = tetrahedron();
        change(&mut m);
        let error = Model::new(m).unwrap_err().to_string();
        assert!(error.contains(message), "{message}: {error}");
    }
    let mut m = tetrahedron();
    m.meshes.mesh_quat[0][0] = 2.0;
    let error = Model::new(m).unwrap_err().to_string();
    assert!(error.contains("mesh_quat[0] is not of length 1"), "{error}");
}

/// A mesh without a hull, and without texture, has no place for them.
#[test]
fn meshes_may_lack_hulls_and_textures() {
    let mut m = tetrahedron();
    let mesh = &mut *m.meshes;
    mesh.mesh_graphadr[0] = -1;
    mesh.mesh_graph.clear();
    mesh.mesh_texcoordadr[0] = -1;
    mesh.mesh_texcoordnum[0] = 0;
    mesh.mesh_texcoord.clear();
    mesh.mesh_facetexcoord = vec![[0; 3]; 4];
    let error = Model::new(m.clone()).unwrap_err().to_string();
    assert!(error.contains("mesh_extrema has the number 3"), "{error}");
    m.meshes.mesh_extrema[0] = [0; 27];
    Model::new(m).unwrap();
}
