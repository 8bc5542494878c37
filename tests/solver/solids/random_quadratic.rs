//! Random bodies of quadratic solids in space in front of obstacles of all kinds, at rest, moving and turning.

use crate::common::paths::{Traced, judged, request};
use crate::common::random::Numbers;
use crate::common::variants::{about_axes, in_reverse, in_units};
use crate::solids::meshes::Mesh;
use arcslip::JobRequest;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Map, Value, json};

const SCENES: u64 = 30;

/// A block below held nodes, its foot flat or bulging, pressed by the obstacle or against it and then pushed or turned.
fn scene(seed: u64) -> Value {
    let mut numbers = Numbers(seed);
    let kind = ["tetrahedron10", "hexahedron20"][numbers.below(2)];
    let cells: [usize; 3] = std::array::from_fn(|_| 1 + numbers.below(2));
    let bulge = [0.0, 0.1, -0.1][numbers.below(3)];
    let mesh = Mesh::new(kind, &cells, |[x, y, z]| {
        let round = 4.0 * ((x - 0.5).powi(2) + (y - 0.5).powi(2)) - 1.0;
        [1.5 * x, y, z - (1.0 - z) * bulge * round]
    });
    let material = ["linear_elastic", "neo_hookean", "saint_venant_kirchhoff"][numbers.below(3)];
    let poisson = [0.0, 0.3, 0.45][numbers.below(3)];
    let mut model = mesh.model(json!({"kind": material, "young": 10, "poisson": poisson}), &json!({}));
    let foot = mesh.side(2, false);
    let places: Vec<Vec<f64>> =
        mesh.positions().filter(|(node, _)| foot.contains(node)).map(|(_, at)| at.clone()).collect();
    let lowest = places.iter().map(|place| place[2]).fold(f64::INFINITY, f64::min);
    let below = lowest - [0.0, 0.02][numbers.below(2)];
    let radius = numbers.between(1.0, 4.0);
    let normal = [numbers.between(-0.2, 0.2), numbers.between(-0.2, 0.2), 1.0];
    let along = |place: &Vec<f64>| place.iter().zip(normal).map(|(a, b)| a * b).sum::<f64>();
    let slanted = places.iter().map(along).fold(f64::INFINITY, f64::min) - (lowest - below);
    let which = numbers.below(4);
    let obstacle = match which {
        0 => json!({"kind": "plane", "point": [0, 0, slanted], "normal": normal}),
        1 => json!({"kind": "ball", "center": [0.75, 0.5, below - radius], "radius": radius}),
        2 => json!({"kind": "cylinder", "point": [0.75, 0.5, below - radius], "axis": [0.5, 1, 0], "radius": radius}),
        _ => json!({"kind": "polyline", "points": [[-3, -0.3], [0.5, below - 0.01], [4, below - 0.3]], "rounding": 1,
            "section": {"origin": [0, 0, 0], "x": [1, 0, 0], "y": [0, 0, 1]}}),
    };
    model["obstacles"] = json!({"table": obstacle});
    let friction = [0.0, 0.2, 0.5, 1.0][numbers.below(4)];
    let contact = |node: &String| json!({"node": node, "obstacle": "table", "friction": friction});
    model["contacts"] = foot.iter().map(contact).collect();
    let head = mesh.side(2, true);
    model["supports"] = head.iter().map(|node| (node.clone(), json!(["x", "y", "z"]))).collect::<Map<_, _>>().into();
    let push = [numbers.between(-0.2, 0.2), numbers.between(0.05, 0.2)];
    let moved = |by: [f64; 3]| head.iter().map(|node| (node.clone(), json!(by))).collect::<Map<_, _>>();
    let first = json!({"name": "press", "obstacle_motion": {"table": [0, 0, 0.06]}, "until": {"load_above": 1}});
    let second = match numbers.below(3) {
        0 => json!({"name": "push", "displacements": moved([push[0], push[1], -0.01]), "until": {"load_above": 1}}),
        1 if which < 3 => json!({"name": "turn", "obstacle_rotation": {"table": {"angle": push[0] + 0.3,
            "about": [0.75, 0.5, 0], "axis": [0.3, push[0], 1]}}, "until": {"load_above": 1}}),
        _ => {
            json!({"name": "drag", "obstacle_motion": {"table": [push[0], push[1], 0.01]}, "until": {"load_above": 1}})
        }
    };
    model["stages"] = json!([first, second]);
    json!({"model": model})
}

fn traced(what: &str, request: &JobRequest) -> Traced {
    let traced = judged(request);
    // A block that a turning drum jams goes back along its way.
    let ends = [StopReason::StagesCompleted, StopReason::Cycle];
    assert!(ends.contains(&traced.report.stop_reason), "{what}: {:?}", traced.report);
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        let off = errors.largest_of_state();
        assert!(off < 1e-10 && errors.energy < 1e-6, "{what}, increment {}: {errors:?}", increment.index);
    }
    traced
}

/// The sum of the normal reactions at the end of each stage, and the energies.
fn results(traced: &Traced) -> Vec<f64> {
    let ends = traced.increments.windows(2).filter(|pair| pair[0].stage != pair[1].stage).map(|pair| &pair[0]);
    let of_end = |end: &arcslip::Increment| {
        let press: f64 = end.contacts.iter().map(|contact| contact.normal_reaction).sum();
        [press, end.energy.strain, end.energy.dissipated]
    };
    ends.chain(traced.increments.last()).flat_map(of_end).collect()
}

/// Every increment is on the measure, and units, axes and order of input do not decide.
#[test]
fn random_quadratic_bodies_in_space() {
    let (mut closed, mut slips) = (0, 0);
    for seed in 0..SCENES {
        let posted = request(&scene(seed).to_string());
        let what = format!("scene {seed}");
        let path = traced(&what, &posted);
        let found = results(&path);
        let contacts = path.increments.iter().flat_map(|increment| &increment.contacts);
        closed += contacts.clone().filter(|contact| contact.normal_reaction > 0.0).count();
        slips += contacts.filter(|contact| contact.slip.iter().any(|slip| *slip != 0.0)).count();
        let axes = [[0.0, 0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, -0.6]];
        for (which, other) in [
            ("units", in_units(posted.clone(), 1e3, 1e-2)),
            ("reverse", in_reverse(posted.clone())),
            ("axes", about_axes(posted.clone(), &axes, [3.0, -2.0, 1.0])),
        ] {
            let turned = traced(&format!("{what}, {which}"), &other);
            assert_eq!(turned.report.stop_reason, path.report.stop_reason, "{what}, {which}");
            let (force, energy) = if which == "units" { (1e-2, 10.0) } else { (1.0, 1.0) };
            // The chord of a turning slip depends on where the steps end.
            for (place, (one, other)) in found.iter().zip(results(&turned)).enumerate() {
                let unit = if place % 3 == 0 { force } else { energy };
                assert!((one - other / unit).abs() < 1e-5 * (1.0 + one.abs()), "{what}, {which}: {one} {other}");
            }
        }
    }
    println!("{closed} closed contacts, {slips} slips");
    assert!(closed > 1000 && slips > 300, "{closed} {slips}");
}
