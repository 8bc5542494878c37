//! Smooth bifurcations of models whose matrices are sparse: where closed forms put them, and at bounded work.

use crate::common::paths::{trace, typed};
use arcslip::algebra::factorisations;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind, Status};
use serde_json::{Map, Value, json};

/// Factorisations that an increment may take that ends at a bifurcation point, its directions included.
const MOST: u64 = 20;

/// A shallow lattice arch of 602 nodes over a floor that 181 of them may touch, loaded at the crown.
fn arch_of_600_nodes() -> Value {
    const PANELS: usize = 300;
    let (mut nodes, mut elements) = (Map::new(), Vec::new());
    let mut bar = |first: String, second: String| {
        elements.push(json!({"kind": "bar", "nodes": [first, second], "axial_stiffness": 1e6}));
    };
    for post in 0..=PANELS {
        let x = 100.0 * post as f64 / PANELS as f64;
        let y = 32.0 * x * (100.0 - x) / 1e4;
        nodes.insert(format!("b{post}"), json!([x, y]));
        nodes.insert(format!("t{post}"), json!([x, y + 1.0]));
        bar(format!("b{post}"), format!("t{post}"));
        if let Some(before) = post.checked_sub(1) {
            bar(format!("b{before}"), format!("b{post}"));
            bar(format!("t{before}"), format!("t{post}"));
            bar(format!("b{before}"), format!("t{post}"));
            bar(format!("t{before}"), format!("b{post}"));
        }
    }
    let contacts: Vec<Value> =
        (60..=240).map(|post| json!({"node": format!("b{post}"), "obstacle": "floor", "friction": 0.3})).collect();
    json!({
        "model": {
            "dimension": 2, "nodes": nodes, "elements": elements,
            "supports": {"b0": ["x", "y"], "b300": ["x", "y"]},
            "obstacles": {"floor": {"kind": "plane", "point": [0, 5], "normal": [0, 1]}},
            "contacts": contacts,
            "stages": [{"name": "push", "forces": {"t150": [0, -100]}}]
        },
        "analysis": {"max_increments": 110}
    })
}

/// The increments of a path with the sparse factorisations that each took, as the algebra counts them.
fn counted(path: Path<'_>) -> impl Iterator<Item = (Increment, u64)> {
    let mut begun = factorisations();
    path.map(move |increment| {
        let taken = factorisations() - begun;
        begun = factorisations();
        (increment, taken)
    })
}

/// One point beside the free floor, one with two nodes that slip on it: the list of each is what dense matrices give, in a
/// hundred times the time.
#[test]
fn an_arch_of_600_nodes() {
    let request = typed(arch_of_600_nodes());
    let scene = Scene::new(&request).expect("a scene");
    let (mut found, mut before) = (Vec::new(), 0);
    for (increment, taken) in counted(Path::new(&scene, CancelFlag::default())) {
        let of_points = increment.diagnostics.bifurcation_factorisations;
        if increment.point.kind == PointKind::SmoothBifurcation {
            assert!((1..=MOST).contains(&taken), "{taken}");
            assert!(of_points > before && of_points - before <= taken, "{of_points} {before} {taken}");
            found.push(increment);
        } else {
            assert_eq!(of_points, before, "{}", increment.index);
        }
        before = of_points;
    }
    let loads = [7.07348277, 4810.82694399];
    assert_eq!(found.len(), loads.len());
    for (point, load) in found.iter().zip(loads) {
        assert!((point.load_factor / load - 1.0).abs() < 1e-8, "{}", point.load_factor);
        assert_eq!(point.point.event.as_deref(), Some("one eigenvalue crosses zero"));
        assert!(!point.point.degenerate && point.diagnostics.residual <= 1e-11);
    }
    let rates = |point: &Increment| -> Vec<f64> {
        point.directions.as_ref().expect("directions").iter().map(|direction| direction.load_rate).collect()
    };
    let close = |found: &[f64], expected: &[f64]| {
        found.len() == expected.len()
            && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-6 * b.abs().max(1e-3))
    };
    let [first, second] = [rates(&found[0]), rates(&found[1])];
    assert!((first[0] - 0.0740156).abs() < 1e-7 && (first[1] + 0.0740156).abs() < 1e-7, "{first:?}");
    assert!(first[2..].iter().all(|rate| rate.abs() < 1e-9), "{first:?}");
    assert!(close(&second, &[612.6351626, -660.0934114]), "{second:?}");
}

/// Bars of EA = 10 and length 1 one upon the other, their joints held sideways by springs.
struct Column {
    bars: usize,
    /// Along x, and in space along y.
    springs: Vec<f64>,
    /// A block beside it that slips on a floor.
    block: bool,
}

const STIFFNESS: f64 = 10.0;

impl Column {
    fn request(&self, most: f64) -> Value {
        let dimension = 1 + self.springs.len();
        let sideways = &["x", "y"][..dimension - 1];
        let axis = ["x", "y", "z"][dimension - 1];
        let (mut nodes, mut elements) = (Map::new(), Vec::new());
        let node = |joint: usize| format!("j{joint}");
        for joint in 0..=self.bars {
            let mut place = vec![0.0; dimension];
            place[dimension - 1] = joint as f64;
            nodes.insert(node(joint), json!(place));
            if joint > 0 {
                elements.push(json!({
                    "kind": "bar", "nodes": [node(joint - 1), node(joint)], "axial_stiffness": STIFFNESS}));
            }
            if joint > 0 && joint < self.bars {
                let entry = |row: usize, column: usize| match self.springs.get(row) {
                    Some(spring) if row == column => *spring,
                    _ => 0.0,
                };
                let stiffness: Vec<Vec<f64>> =
                    (0..dimension).map(|row| (0..dimension).map(|column| entry(row, column)).collect()).collect();
                elements.push(json!({"kind": "spring", "nodes": [node(joint)], "stiffness": stiffness}));
            }
        }
        let foot: Vec<&str> = sideways.iter().copied().chain([axis]).collect();
        let mut force = vec![0.0; dimension];
        force[dimension - 1] = -1.0;
        let mut request = json!({
            "model": {
                "dimension": dimension, "nodes": nodes, "elements": elements,
                "supports": {node(0): foot, node(self.bars): sideways},
                "stages": [{"name": "press", "forces": {node(self.bars): force}, "until": {"load_above": most}}]
            },
            "analysis": {"max_increments": 300}
        });
        if self.block {
            let parts = &mut request["model"];
            parts["nodes"]["block"] = json!([5, 0]);
            let elements = parts["elements"].as_array_mut().expect("elements");
            elements.push(json!({"kind": "spring", "nodes": ["block"], "stiffness": [[1, 0], [0, 1]]}));
            parts["obstacles"] = json!({"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}});
            parts["contacts"] = json!([{"node": "block", "obstacle": "floor", "friction": 0.3}]);
            parts["stages"][0]["forces"]["block"] = json!([1, -1]);
        }
        request
    }

    /// Where it buckles into `waves` half waves under springs `k`: `P/l = k/(4 sin²(π waves/2n))`, `l = 1 - P/EA`.
    fn load(&self, waves: usize, spring: f64) -> f64 {
        let sine = (std::f64::consts::FRAC_PI_2 * waves as f64 / self.bars as f64).sin();
        let by_length = spring / (4.0 * sine * sine);
        by_length / (1.0 + by_length / STIFFNESS)
    }

    /// All loads in order, with the half waves and the direction.
    fn loads(&self) -> Vec<(f64, usize, usize)> {
        let of = |(direction, spring): (usize, &f64)| {
            (1..self.bars).map(|waves| (self.load(waves, *spring), waves, direction)).collect::<Vec<_>>()
        };
        let mut loads: Vec<_> = self.springs.iter().enumerate().flat_map(of).collect();
        loads.sort_by(|a, b| a.0.total_cmp(&b.0));
        loads
    }

    /// The path past so many loads, and its bifurcation points with what each took.
    fn points(&self, count: usize) -> Vec<(Increment, u64)> {
        let loads = self.loads();
        let request = typed(self.request(0.5 * (loads[count - 1].0 + loads[count].0)));
        trace(&request);
        let scene = Scene::new(&request).expect("a scene");
        let points = counted(Path::new(&scene, CancelFlag::default()));
        points.filter(|(increment, _)| increment.point.kind == PointKind::SmoothBifurcation).collect()
    }
}

/// Six loads close together, up to four of them within one step: each in its turn, whatever the size.
#[test]
fn a_column_on_springs_in_closed_form() {
    for (bars, block) in [(20, false), (40, false), (200, false), (40, true)] {
        let column = Column { bars, springs: vec![0.2], block };
        let points = column.points(6);
        assert_eq!(points.len(), 6, "{bars} {block}");
        for ((point, _), (load, ..)) in points.iter().zip(column.loads()) {
            assert!((point.load_factor - load).abs() < 1e-13, "{bars} {}: {load}", point.load_factor);
            assert_eq!(point.point.event.as_deref(), Some("one eigenvalue crosses zero"));
            let directions = point.directions.as_ref().expect("directions");
            assert_eq!((directions.len(), point.point.degenerate), (4, false), "{bars} {block}: {directions:?}");
            assert!(directions[0].taken && directions.iter().filter(|d| d.load_rate.abs() < 1e-9).count() == 2);
            if block {
                assert!(directions[1..].iter().all(|direction| direction.contacts == [Status::Stick]));
            }
        }
        // Of the first no other is near; where several are within a step some more are looked at.
        assert!(points[0].1 <= MOST, "{bars} {block}: {}", points[0].1);
        let mean = points.iter().map(|(_, taken)| taken).sum::<u64>() / 6;
        assert!(mean <= MOST, "{bars} {block}: {mean}");
    }
}

/// In space two directions: alike they buckle together, and otherwise one after the other, however little apart.
#[test]
fn a_column_in_space_in_closed_form() {
    for difference in [0.0, 1e-7, 1e-5, 1e-3] {
        let column = Column { bars: 20, springs: vec![0.2, 0.2 * (1.0 + difference)], block: false };
        let points = column.points(6);
        let mut loads = column.loads();
        loads.truncate(6);
        if difference == 0.0 {
            loads = loads.into_iter().step_by(2).collect();
        }
        assert_eq!(points.len(), loads.len(), "{difference}");
        for ((point, taken), (load, ..)) in points.iter().zip(&loads) {
            assert!((point.load_factor - load).abs() < 1e-13, "{difference} {}: {load}", point.load_factor);
            let event = point.point.event.as_deref();
            if difference == 0.0 {
                assert_eq!(event, Some("two eigenvalues cross zero together"));
                // It may bend in any direction.
                assert!(point.point.degenerate);
            } else {
                assert_eq!(event, Some("one eigenvalue crosses zero"));
                assert_eq!(point.directions.as_ref().map(Vec::len), Some(4));
                assert!(!point.point.degenerate, "{difference}");
            }
            assert!(*taken <= MOST + 4, "{difference}: {taken}");
        }
    }
}

/// Each branch that is listed is followed: every point is in equilibrium, and it begins as the mode does, in so many half
/// waves.
#[test]
fn branches_begin_as_their_modes_do() {
    let column = Column { bars: 40, springs: vec![0.2], block: false };
    let loads = column.loads();
    let request = typed(column.request(0.5 * (loads[2].0 + loads[3].0)));
    let scene = Scene::new(&request).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    for (_, waves, _) in loads.iter().take(3) {
        let point = path.by_ref().find(|i| i.point.kind == PointKind::SmoothBifurcation).expect("a bifurcation");
        let directions = point.directions.as_ref().expect("directions");
        let mut sides = Vec::new();
        for (number, direction) in directions.iter().enumerate() {
            if direction.load_rate.abs() > 1e-9 {
                continue;
            }
            let followed = Path::follow(&scene, path.checkpoint(), number, String::new(), CancelFlag::default());
            let (next, taken) = counted(followed.expect("a path")).nth(1).expect("an increment");
            assert!(next.diagnostics.residual <= 1e-11 && taken <= MOST, "{taken}");
            let sideways = |joint: usize| next.displacements[&*format!("j{joint}")][0];
            let shape = |joint: usize| (std::f64::consts::PI * (*waves * joint) as f64 / 40.0).sin();
            let most = (1..40).fold(0.0_f64, |most, joint| sideways(joint).abs().max(most));
            let by_first = sideways(1) / shape(1);
            let off = (1..40).map(|joint| (sideways(joint) - by_first * shape(joint)).abs()).fold(0.0, f64::max);
            assert!(most > 1e-6 && off < 0.05 * most, "{waves}: {off} of {most}");
            sides.push(by_first.signum());
        }
        sides.sort_by(f64::total_cmp);
        assert_eq!(sides, [-1.0, 1.0]);
    }
}

/// A search is broken off at whatever look at the flag it is.
#[test]
fn a_search_looks_at_the_cancel_flag() {
    use arcslip::resources::budget::{cancel_at_look, looks};
    let request = typed(Column { bars: 40, springs: vec![0.2], block: false }.request(0.0502));
    let scene = Scene::new(&request).expect("a scene");
    let mut path = Path::new(&scene, CancelFlag::default());
    let mut begun = looks();
    let mut before = None;
    while let Some(increment) = path.next() {
        if increment.point.kind == PointKind::SmoothBifurcation {
            let took = looks() - begun;
            let (index, from): (u64, arcslip::continuation::path::checkpoint::Checkpoint) =
                before.expect("an increment before");
            assert_eq!(index + 1, increment.index);
            for part in 1..8 {
                let again = Path::resume(&scene, from.clone(), CancelFlag::default()).expect("a path");
                let mut again = again;
                cancel_at_look(looks() + part * took / 8);
                assert!(again.next().is_none(), "{part}");
                cancel_at_look(u64::MAX);
            }
            return;
        }
        before = Some((increment.index, path.checkpoint()));
        begun = looks();
    }
    panic!("no bifurcation");
}
