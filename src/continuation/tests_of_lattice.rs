//! A lattice arch traced with dense and with sparse matrices: the same path.

use crate::check::scenes::lattice::LatticeArch;
use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::{Increment, PointKind};

fn scene(arch: LatticeArch) -> Scene {
    Scene::new(&arch.request().expect("a request")).expect("a scene")
}

fn traced(scene: &Scene) -> Vec<Increment> {
    Path::new(scene, CancelFlag::default()).collect()
}

fn limits(increments: &[Increment]) -> usize {
    increments.iter().filter(|row| row.point.kind == PointKind::SmoothLimit).count()
}

fn closed(increments: &[Increment]) -> usize {
    let closed = |row: &Increment| row.contacts.iter().filter(|contact| contact.normal_reaction > 0.0).count();
    increments.iter().map(closed).max().unwrap_or(0)
}

#[test]
fn sparse_and_dense_trace_the_same_path() {
    for friction in [0.0, 0.3] {
        let arch = LatticeArch { contacts: 7, friction, increments: 60, ..LatticeArch::of_unknowns(90) };
        let mut scene = scene(arch);
        scene.structure.set_sparse(false);
        let dense = traced(&scene);
        scene.structure.set_sparse(true);
        let sparse = traced(&scene);
        assert_eq!(dense.len(), sparse.len());
        assert!(limits(&dense) >= 1 && closed(&dense) >= 2, "{} {}", limits(&dense), closed(&dense));
        for (one, other) in dense.iter().zip(&sparse) {
            assert_eq!(one.point.kind, other.point.kind, "at {}", one.index);
            assert!((one.load_factor - other.load_factor).abs() <= 1e-10, "at {}", one.index);
            for (a, b) in one.displacements.values().flatten().zip(other.displacements.values().flatten()) {
                assert!((a - b).abs() <= 1e-10, "at {}: {a} {b}", one.index);
            }
            for (a, b) in one.contacts.iter().zip(&other.contacts) {
                assert_eq!(a.status, b.status);
                assert!((a.normal_reaction - b.normal_reaction).abs() <= 1e-10);
            }
        }
    }
}

/// A node that hangs on one bar of a large lattice can swing: sparse matrices detect this as dense ones do.
#[test]
fn a_mechanism_in_a_large_lattice_is_refused() {
    for unknowns in [100, 1_000] {
        let mut request = LatticeArch::of_unknowns(unknowns).request().expect("a request");
        request.model.nodes.insert("hung".to_owned(), vec![0.0, 0.1]);
        request.model.elements.push(
            serde_json::from_value(
                serde_json::json!({"kind": "bar", "nodes": ["c0_2", "hung"], "axial_stiffness": 1.0}),
            )
            .expect("a bar"),
        );
        let refused = Scene::new(&request).expect_err("a mechanism").to_string();
        assert!(refused.contains("the structure is a mechanism: \"hung\" can move"), "{refused}");
    }
}
