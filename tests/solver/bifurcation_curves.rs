//! Bifurcation points and contact changes followed in a parameter, beside closed forms and beside paths of their own.

use crate::common::paths::{close, scene_file};
use crate::common::random::random_scene;
use crate::limit_curves::{curve_of, ended, followed, off_points_of_path};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{Events, StageControl};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::PointKind;
use arcslip::studies::critical_curves::{CurveFound, CurveRow};
use serde_json::{Map, Value, json};

/// Two bars of half span 1 that carry a load at a height at which they buckle sideways. Of Green's strain.
fn tall_truss(height: f64) -> JobRequest {
    let bar = |foot: &str| json!({"kind": "bar", "nodes": [foot, "apex"], "axial_stiffness": 1, "strain": "green"});
    let request = json!({"model": {
        "dimension": 2,
        "nodes": {"left": [-1, 0], "right": [1, 0], "apex": [0, height]},
        "elements": [bar("left"), bar("right")],
        "supports": {"left": ["x", "y"], "right": ["x", "y"]},
        "stages": [{
            "name": "press", "forces": {"apex": [0, -1]},
            "until": {"displacement": {"node": "apex", "component": "y", "below": -2 * height.ceil() as i64}},
        }],
    }});
    serde_json::from_value(request).expect("a request")
}

/// The load at which the truss buckles: where `d2V/dx2 = 0` at `x = 0`, the strain is `-1/L^2` and the apex at `y`.
fn buckling(height: f64) -> (f64, f64) {
    let (length, apex) = (1.0_f64.hypot(height), (height * height - 2.0).sqrt());
    (2.0 * apex / length.powi(3), apex)
}

/// The index of the first point of a kind on the path of a request.
fn index_of(request: &JobRequest, kind: PointKind, which: usize) -> u64 {
    let scene = Scene::new(request).expect("a scene");
    let mut points = Path::new(&scene, CancelFlag::default()).filter(|one| one.point.kind == kind);
    points.nth(which).expect("such a point").index
}

fn curve(request: &JobRequest, kind: PointKind, which: usize, settings: &Value) -> CurveFound {
    let mut settings = settings.clone();
    settings["increment"] = index_of(request, kind, which).into();
    followed(&curve_of(request, &settings).expect("a curve")).expect("a curve")
}

fn changes(found: &CurveFound) -> Vec<&CurveRow> {
    found.rows.iter().filter(|row| row.codimension_two).collect()
}

#[test]
fn the_buckling_load_of_a_tall_truss_over_its_height() {
    let settings = json!({"parameter": "/model/nodes/apex/1", "range": [1.5, 3], "step": 0.1});
    let found = curve(&tall_truss(2.5), PointKind::SmoothBifurcation, 0, &settings);
    println!("{:?}", found.summary);
    let summary = ended(&found);
    assert_eq!(summary.ends_above.as_deref(), Some("the end of the range is reached"));
    assert_eq!(summary.ends_below.as_deref(), Some("the end of the range is reached"));
    assert!(found.rows.len() >= 16, "{}", found.rows.len());
    let mut worst: f64 = 0.0;
    for row in &found.rows {
        assert_eq!(row.kind, PointKind::SmoothBifurcation);
        let (load, apex) = buckling(row.value);
        let at = row.displacements.get("apex").expect("the apex");
        worst = worst.max((row.load_factor - load).abs() / load).max((at[1] + row.value - apex).abs()).max(at[0].abs());
    }
    println!("{worst:e} from the closed form");
    assert!(worst <= 1e-9, "{worst:e}");
    // Where the apex comes to its limit point at `h / sqrt(3)` as it buckles.
    let changes = changes(&found);
    let [change] = changes[..] else { panic!("{changes:?}") };
    close(change.value, 3.0_f64.sqrt(), 1e-8, "the height at which it buckles at its limit point");
    assert_eq!(change.event.as_deref(), Some("the load turns at the bifurcation point"));
}

#[test]
fn branches_that_a_parameter_parts_are_not_followed_as_if_they_met() {
    let settings = json!({"parameter": "/model/nodes/apex/0", "range": [-0.1, 0.1], "step": 0.01});
    let found = curve(&tall_truss(2.5), PointKind::SmoothBifurcation, 0, &settings);
    let summary = ended(&found);
    assert_eq!(found.rows.len(), 1);
    for end in [&summary.ends_below, &summary.ends_above] {
        let end = end.as_deref().expect("an end");
        assert!(end.contains("past it the branches no longer meet"), "{end}");
    }
}

/// Where the apex buckles at the height of its feet, it buckles before and past it at once; below the height
/// `sqrt(2)` it does not buckle at all.
#[test]
fn a_curve_turns_back_where_two_bifurcation_points_meet() {
    let settings = json!({"parameter": "/model/nodes/apex/1", "range": [1.3, 2.1], "step": 0.1});
    let found = curve(&tall_truss(2.0), PointKind::SmoothBifurcation, 0, &settings);
    println!("{:?}", found.summary);
    let meetings: Vec<&CurveRow> = changes(&found)
        .into_iter()
        .filter(|row| row.event.as_deref().is_some_and(|event| event.contains("meet")))
        .collect();
    let [meeting] = meetings[..] else { panic!("{meetings:?}") };
    let event = meeting.event.as_deref().expect("an event");
    let told: f64 =
        event["two bifurcation points meet at ".len()..].split(' ').next().expect("a value").parse().expect("a number");
    close(told, 2.0_f64.sqrt(), 1e-8, "where they meet");
    let mut signs = [0, 0];
    for row in &found.rows {
        let (load, apex) = buckling(row.value);
        let y = row.displacements.get("apex").expect("the apex")[1] + row.value;
        let sign = y.signum();
        signs[usize::from(sign < 0.0)] += 1;
        close(y, sign * apex, 1e-8, "where it buckles");
        close(row.load_factor, sign * load, 1e-8, "the load at which it buckles");
    }
    println!("{signs:?} on either side");
    assert!(signs.iter().all(|count| *count >= 7), "{signs:?}");
}

/// The limit load of the imperfect truss comes to the buckling load of the perfect one, with a cusp over the imperfection.
#[test]
fn limit_loads_over_an_imperfection_have_a_cusp_at_the_bifurcation_point() {
    let mut request = tall_truss(2.5);
    request.model.nodes.insert("apex".to_owned(), vec![0.1, 2.5]);
    let settings = json!({"parameter": "/model/nodes/apex/0", "range": [-0.1, 0.2], "step": 0.02});
    let curve = curve_of(&request, &settings).expect("a curve");
    let found = followed(&curve).expect("a curve");
    let summary = ended(&found);
    assert_eq!(summary.ends_below.as_deref(), Some("the end of the range is reached"));
    assert!(found.rows.len() <= 40, "{}", found.rows.len());
    let changes = changes(&found);
    let [cusp] = changes[..] else { panic!("{changes:?}") };
    let (load, apex) = buckling(2.5);
    println!("cusp at {:e}, load off by {:e}, {} rows", cusp.value, cusp.load_factor / load - 1.0, found.rows.len());
    assert!(cusp.value.abs() <= 1e-9 && (cusp.load_factor / load - 1.0).abs() <= 1e-9, "{cusp:?}");
    close(cusp.displacements.get("apex").expect("the apex")[1] + 2.5, apex, 1e-9, "where it buckles");
    let is_limit = |kind| matches!(kind, PointKind::SmoothLimit | PointKind::NonsmoothLimit);
    for row in found.rows.iter().filter(|row| !row.codimension_two) {
        let off = off_points_of_path(&curve, row, &is_limit).unwrap_or(f64::INFINITY);
        assert!(off <= 1e-8, "{off:e} at {}", row.value);
        // The truss is symmetric.
        if let Some(other) = found.rows.iter().find(|other| other.value == -row.value) {
            close(other.load_factor, row.load_factor, 1e-10, "the load of the mirror image");
        }
    }
    // `1 - load / buckling load` grows with the power 2/3.
    let fall = |row: &CurveRow| 1.0 - row.load_factor / load;
    let near: Vec<&CurveRow> = found.rows.iter().filter(|row| row.value > 0.0 && row.value < 0.01).collect();
    let pairs = near.windows(2).map(|pair| (fall(pair[1]) / fall(pair[0])).ln() / (pair[1].value / pair[0].value).ln());
    let powers: Vec<f64> = pairs.collect();
    println!("{powers:?}");
    assert!(powers.iter().all(|power| (power - 2.0 / 3.0).abs() < 0.03), "{powers:?}");
}

/// Euler's column of 16 beams, pinned at both ends: with sparse matrices.
fn column(bending: f64) -> JobRequest {
    let count = 16;
    let nodes: Map<String, Value> =
        (0..=count).map(|k| (format!("n{k}"), json!([0, f64::from(k) / f64::from(count)]))).collect();
    let beam = |k: i32| {
        let ends = [format!("n{k}"), format!("n{}", k + 1)];
        json!({"kind": "beam", "nodes": ends, "axial_stiffness": 1e4, "bending_stiffness": bending})
    };
    let request = json!({"model": {
        "dimension": 2, "nodes": nodes, "elements": (0..count).map(beam).collect::<Vec<_>>(),
        "supports": {"n0": ["x", "y"], format!("n{count}"): ["x"]},
        "stages": [{"name": "press", "forces": {format!("n{count}"): [0, -1]}, "until": {"load_above": 80}}],
    }});
    serde_json::from_value(request).expect("a request")
}

#[test]
fn the_buckling_loads_of_a_column_over_its_bending_stiffness() {
    let request = column(1.0);
    let settings = json!({"parameter": "/model/elements/*/bending_stiffness", "range": [0.5, 2], "step": 0.25});
    for (which, factor) in [(0, 1.0), (1, 4.0)] {
        let found = curve(&request, PointKind::SmoothBifurcation, which, &settings);
        let summary = ended(&found);
        println!("{} rows, {summary:?}", found.rows.len());
        assert!(found.rows.len() >= 7 && summary.ends_below == summary.ends_above, "{summary:?}");
        assert_eq!(summary.ends_above.as_deref(), Some("the end of the range is reached"));
        let of = curve_of(&request, &settings).expect("a curve");
        for row in &found.rows {
            let is_bifurcation = |kind| kind == PointKind::SmoothBifurcation;
            let off = off_points_of_path(&of, row, &is_bifurcation).unwrap_or(f64::INFINITY);
            assert!(off <= 1e-8, "{off:e} at {}", row.value);
            let euler = factor * std::f64::consts::PI.powi(2) * row.value;
            // Of 16 linear elements.
            assert!((row.load_factor / euler - 1.0).abs() <= 0.02 * factor, "{} beside {euler}", row.load_factor);
        }
    }
}

#[test]
fn the_load_at_which_a_slider_slips_is_followed_over_friction() {
    let request = scene_file("slider-chain");
    let settings = json!({"parameter": "/model/contacts/*/friction", "range": [0.25, 1], "step": 0.25});
    // The blocks slip one after another at as many times the friction.
    for which in 0..3 {
        let found = curve(&request, PointKind::ContactChange, which, &settings);
        println!("{:?}", found.summary);
        assert!(found.rows.len() >= 4, "{}", found.rows.len());
        for row in &found.rows {
            assert_eq!(row.kind, PointKind::ContactChange);
            close(row.load_factor, (which + 1) as f64 * row.value, 1e-12, "the load at which it slips");
        }
    }
}

/// A block of weight 1 that is pulled along a floor slips at a pull of `(mu - n) / (1 + mu n)`, where the floor's normal is
/// `(n, 1)`: the frames of the contact turn with the parameter.
#[test]
fn a_block_slips_on_a_floor_that_is_tilted_more_and_more() {
    let request: JobRequest = serde_json::from_value(json!({"model": {
        "dimension": 2, "nodes": {"block": [0, 0]},
        "elements": [{"kind": "spring", "nodes": ["block"], "stiffness": [[2, 0], [0, 0]]}],
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "contacts": [{"node": "block", "obstacle": "floor", "friction": 0.3}],
        "stages": [
            {"name": "press", "forces": {"block": [0, -1]}, "until": {"load_above": 1}},
            {"name": "pull", "forces": {"block": [1, 0]}, "until": {"load_above": 2}},
        ],
    }}))
    .expect("a request");
    let settings = json!({"parameter": "/model/obstacles/floor/normal/0", "range": [-0.25, 0.25], "step": 0.05});
    let found = curve(&request, PointKind::ContactChange, 0, &settings);
    assert!(found.rows.len() >= 11, "{}", found.rows.len());
    for row in &found.rows {
        let tilt = row.value;
        close(row.load_factor, (0.3 - tilt) / (1.0 + 0.3 * tilt), 1e-12, "the pull at which it slips");
    }
}

/// Random scenes: every point of a curve of contact changes or bifurcation points is on a path of its own.
#[test]
fn contact_changes_and_bifurcations_of_random_scenes_agree_with_paths() {
    let (mut points, mut changes, mut faults) = (0, 0, Vec::new());
    let mut curves = [0, 0];
    for seed in 0..120 {
        let mut request = random_scene(seed);
        request.model.stages.iter_mut().for_each(|stage| stage.control = StageControl::Path);
        request.analysis.events = Events::All;
        let own = request.model.contacts.first().map_or(0.0, |contact| contact.friction);
        let Ok(scene) = Scene::new(&request) else { continue };
        let path: Vec<_> = Path::new(&scene, CancelFlag::default()).collect();
        for (count, kind) in curves.iter_mut().zip([PointKind::ContactChange, PointKind::SmoothBifurcation]) {
            let of_kind: Vec<_> = path.iter().filter(|one| one.point.kind == kind).collect();
            let Some(asked) = of_kind.get(of_kind.len() / 2).filter(|_| own > 0.0) else { continue };
            let settings = json!({
                "parameter": "/model/contacts/0/friction", "range": [0.9 * own, 1.1 * own], "step": 0.05 * own,
                "increment": asked.index,
            });
            let Ok(curve) = curve_of(&request, &settings) else { continue };
            let Ok(found) = followed(&curve) else { continue };
            *count += 1;
            points += found.rows.len();
            changes += self::changes(&found).len();
            let is_crowded = |row: &CurveRow| {
                let beside = found.rows.iter().filter(|other| other.place != row.place);
                beside.map(|other| (other.value - row.value).abs()).any(|width| width < 1e-3 * own)
            };
            let is_meant = |other: PointKind| {
                other == kind || kind == PointKind::ContactChange && other == PointKind::NonsmoothLimit
            };
            for row in found.rows.iter().filter(|row| !row.codimension_two && !is_crowded(row)) {
                let off = off_points_of_path(&curve, row, &is_meant).unwrap_or(f64::INFINITY);
                if off > 1e-8 {
                    faults.push((seed, kind, row.value / own, off));
                }
            }
        }
    }
    println!("{curves:?} curves, {points} points, {changes} changes; off: {faults:?}");
    assert!(curves[0] > 20, "{curves:?}");
    assert!(faults.is_empty(), "{faults:?}");
}
