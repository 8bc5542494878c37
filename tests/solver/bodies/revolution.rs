//! Bodies of revolution that touch each other, with the axis at `x = 0`.

use super::random_pairs::revolved_pair;
use super::{Sheet, count_within_the_measure, moved, pair, support, whole_path};
use crate::common::paths::{close, judged, request, trace};
use crate::common::variants::{in_reverse, in_units};
use arcslip::result::increment::{Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// A model of two sheets in the plane of revolution.
fn revolved(lower: &Sheet, upper: &Sheet, material: &Value, friction: f64, swapped: bool) -> Value {
    let mut model = pair(lower, upper, material, friction, swapped);
    for element in model["elements"].as_array_mut().expect("elements") {
        element["plane"] = json!("axisymmetric");
    }
    model
}

/// Names of the nodes of a column of a sheet of so many rows.
fn column(sheet: &Sheet, column: usize, rows: usize) -> Vec<String> {
    (0..=rows).map(|row| sheet.name(column, row)).collect()
}

/// Two rings, or discs, of height 1, meshes 1 : 1.375, with a conical interface of this slope.
fn rings(inner: f64, slope: f64) -> [Sheet; 2] {
    let interface = move |x: f64| 1.0 + slope * (x - 0.5);
    let radius = move |x: f64| inner + x;
    let lower = Sheet::new("l", [8, 4], move |x, y| [radius(x), y * interface(x)]);
    let upper = Sheet::new("u", [11, 4], move |x, y| [radius(x), interface(x) + y * (2.0 - interface(x))]);
    [lower, upper]
}

/// The largest difference between principal stresses, or from those of another element.
fn unevenness(increment: &Increment) -> f64 {
    let stresses = increment.elements.iter().map(|element| element.stress.as_ref().expect("a solid has a stress"));
    let first = increment.elements[0].stress.as_ref().expect("a stress")[0];
    stresses.fold(0.0, |most, stress| {
        stress.iter().take(3).map(|value| value - first).chain([stress[3]]).fold(most, |most, off| most.max(off.abs()))
    })
}

/// A pressure all around two bodies with a conical interface is the pressure everywhere in them, whatever the material, and
/// whichever surface carries the multipliers.
#[test]
fn an_even_pressure_goes_through_a_conical_interface() {
    let materials = [("linear_elastic", 1e3, 0.3), ("neo_hookean", 10.0, 0.3), ("saint_venant_kirchhoff", 30.0, 0.2)];
    for ((kind, young, poisson), inner) in materials.into_iter().flat_map(|material| [(material, 0.0), (material, 0.5)])
    {
        for (slope, friction, swapped) in [(0.0, 0.0, false), (0.3, 0.0, false), (0.3, 0.0, true), (-0.2, 0.4, true)] {
            let [lower, upper] = rings(inner, slope);
            let material = json!({"kind": kind, "young": young, "poisson": poisson});
            let mut model = revolved(&lower, &upper, &material, friction, swapped);
            support(&mut model, &[lower.name(3, 0)], &["y"]);
            let mut around = vec![lower.lowest(), upper.highest(), column(&lower, 8, 4), column(&upper, 11, 4)];
            let inside = [column(&lower, 0, 4), column(&upper, 0, 4)];
            if inner == 0.0 {
                inside.iter().for_each(|nodes| support(&mut model, nodes, &["x"]));
            } else {
                around.extend(inside);
            }
            let faces: Vec<[String; 2]> =
                around.iter().flat_map(|row| row.windows(2).map(|two| [two[0].clone(), two[1].clone()])).collect();
            model["surfaces"]["around"] = json!({"faces": faces});
            model["stages"] = json!([{"name": "press", "pressures": {"around": 1}, "until": {"load_above": 1}}]);
            let posted = json!({"model": model, "analysis": {"record": {"elements": "all"}}});
            let increments = whole_path(&request(&posted.to_string()));
            let last = increments.last().expect("an increment");
            let what = format!("{kind}, from {inner}, slope {slope}, friction {friction}, {swapped}");
            close(unevenness(last), 0.0, 1e-10, &what);
            let pressed = last.elements[0].stress.as_ref().expect("a stress")[1];
            assert!((pressed + 1.0).abs() < if kind == "linear_elastic" { 0.01 } else { 1e-9 }, "{what}: {pressed}");
        }
    }
}

/// A tube of two tubes under pressure inside (Lamé): with meshes that do not match the pressure between them tends to the
/// exact one with second order.
#[test]
fn a_tube_of_two_tubes_follows_lame() {
    let [inside, between, outside, height] = [1.0, 1.5, 2.5, 0.5];
    let exact =
        inside * inside / (outside * outside - inside * inside) * (outside * outside / (between * between) - 1.0);
    for swapped in [false, true] {
        let errors = [2, 4, 8].map(|fineness| {
            // Columns run down along the axis, rows outwards.
            let place = |from: f64, to: f64| move |x: f64, y: f64| [from + y * (to - from), height * (1.0 - x)];
            let inner = Sheet::new("l", [fineness, 2 * fineness], place(inside, between));
            let outer = Sheet::new("u", [fineness + 1, 2 * fineness], place(between, outside));
            let material = json!({"kind": "linear_elastic", "young": 1e6, "poisson": 0.3});
            let mut model = revolved(&inner, &outer, &material, 0.0, swapped);
            for (sheet, columns) in [(&inner, fineness), (&outer, fineness + 1)] {
                support(&mut model, &column(sheet, 0, 2 * fineness), &["y"]);
                support(&mut model, &column(sheet, columns, 2 * fineness), &["y"]);
            }
            model["surfaces"]["bore"] = super::faces(&inner.lowest());
            model["stages"] = json!([{"name": "press", "pressures": {"bore": 1}, "until": {"load_above": 1}}]);
            let increments = whole_path(&request(&json!({"model": model}).to_string()));
            let contacts = &increments.last().expect("an end").contacts;
            let force: f64 = contacts.iter().map(|contact| contact.normal_reaction).sum();
            let pressure = force / (TAU * between * height);
            println!("{fineness}: {pressure:.8}, exact {exact:.8}");
            (pressure / exact - 1.0).abs()
        });
        assert!(errors[2] < 1e-4 && errors.windows(2).all(|two| two[0] > 3.5 * two[1]), "{errors:?}");
    }
}

/// A rigid rod in a sleeve pressed onto it from outside is pulled out with `μ N`.
#[test]
fn a_rod_is_pulled_out_of_a_sleeve() {
    let rod = Sheet::new("l", [5, 1], |x, y| [y, 3.0 - 5.0 * x]);
    let sleeve = Sheet::new("u", [7, 3], |x, y| [1.0 + 0.5 * y, 2.0 - 2.0 * x]);
    let material = json!({"kind": "linear_elastic", "young": 100, "poisson": 0.3});
    let mut model = revolved(&rod, &sleeve, &material, 0.3, false);
    support(&mut model, &rod.lowest(), &["x", "y"]);
    support(&mut model, &rod.highest(), &["x", "y"]);
    // Friction needs nodes that are free along the rod.
    support(&mut model, &column(&sleeve, 0, 3)[1..], &["y"]);
    let all: Vec<String> = [rod.lowest(), rod.highest()].concat();
    model["stages"] = json!([
        {"name": "press", "pressures": {"top": 1}, "until": {"load_above": 1}},
        {"name": "pull", "displacements": moved(&all, [0.0, 0.2]), "until": {"load_above": 1}},
    ]);
    let increments = whole_path(&request(&json!({"model": model}).to_string()));
    let last = increments.last().expect("an end");
    let normal: f64 = last.contacts.iter().map(|contact| contact.normal_reaction).sum();
    let pulled: f64 = last.supports.iter().filter(|(node, _)| node.starts_with('l')).map(|(_, force)| force[1]).sum();
    assert!(last.contacts.iter().all(|contact| contact.status == Status::Slip), "{:?}", last.contacts);
    assert!(normal > 1.0);
    close(pulled.abs(), 0.3 * normal, 1e-10 * normal, "Coulomb's law for the whole");
}

const RADIUS: f64 = 100.0;
const EXTENT: f64 = 60.0;
const POISSON: f64 = 0.3;

fn graded(t: f64) -> f64 {
    EXTENT * (6.0 * t).sinh() / 6.0_f64.sinh()
}

/// Two spheres of the same matter pressed onto each other: the radius of the contact by the second moment of Hertz's
/// pressure, `2 P a²/5`, against `a³ = 3 P R/(4 E)` with half the radius and half the modulus of one sphere.
#[test]
fn elastic_spheres_follow_hertz() {
    let rise = |x: f64| RADIUS - (RADIUS * RADIUS - x * x).sqrt();
    let modulus = 0.5 / (1.0 - POISSON * POISSON);
    for (cells, swapped) in [([32, 36], false), ([32, 36], true)] {
        let lower = Sheet::new("l", [cells[0]; 2], |x, y| [graded(x), -rise(graded(x)) - graded(1.0 - y)]);
        let upper = Sheet::new("u", [cells[1]; 2], |x, y| [graded(x), rise(graded(x)) + graded(y)]);
        let material = json!({"kind": "linear_elastic", "young": 1, "poisson": POISSON});
        let mut model = revolved(&lower, &upper, &material, 0.0, swapped);
        support(&mut model, &column(&lower, 0, cells[0]), &["x"]);
        support(&mut model, &column(&upper, 0, cells[1]), &["x"]);
        support(&mut model, &lower.lowest(), &["x", "y"]);
        support(&mut model, &upper.highest(), &["x", "y"]);
        // Only what may touch.
        for name in ["below", "above"] {
            let radius = |node: &Value| model["nodes"][node.as_str().expect("a name")][0].as_f64().expect("a number");
            let near = |face: &&Value| face.as_array().expect("a face").iter().all(|node| radius(node) < 4.0);
            let all = model["surfaces"][name]["faces"].as_array().expect("faces");
            let faces: Vec<Value> = all.iter().filter(near).cloned().collect();
            model["surfaces"][name]["faces"] = json!(faces);
        }
        model["stages"] = json!([{
            "name": "press", "displacements": moved(&upper.highest(), [0.0, -2.2 / RADIUS]), "until": {"load_above": 1},
        }]);
        let (increments, report) = trace(&request(&json!({"model": model}).to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let contacts = &increments.last().expect("an end").contacts;
        let press: f64 = contacts.iter().map(|contact| contact.normal_reaction).sum();
        let place = |node: &str| model["nodes"][node][0].as_f64().expect("a number");
        let second: f64 = contacts.iter().map(|contact| contact.normal_reaction * place(&contact.node).powi(2)).sum();
        let radius = (2.5 * second / press).sqrt();
        let hertz = (3.0 * press * 0.5 * RADIUS / (4.0 * modulus)).cbrt();
        println!("{cells:?}, {swapped}: {} increments, radius {radius:.5}, Hertz {hertz:.5}", increments.len());
        assert!((radius / hertz - 1.0).abs() < 0.01, "{cells:?}, {swapped}: {radius} {hertz}");
    }
}

/// 60 random pairs: the measure, the energy, and the same events in other units and in another order.
#[test]
fn random_pairs_of_revolution_keep_the_laws() {
    let mut statuses = [0; 3];
    let events = |increments: &[Increment]| -> Vec<(f64, Vec<String>)> {
        let of = |increment: &Increment| {
            let mut words: Vec<String> = increment.point.event.as_deref()?.split("; ").map(str::to_owned).collect();
            words.sort();
            Some((increment.load_factor, words))
        };
        increments.iter().filter_map(of).collect()
    };
    for seed in 0..60 {
        let posted = revolved_pair(seed);
        let traced = judged(&posted);
        count_within_the_measure(&traced, 1e-6, seed, &mut statuses);
        let expected = events(&traced.increments);
        for (what, other) in [("units", in_units(posted.clone(), 1e3, 1e-3)), ("order", in_reverse(posted.clone()))] {
            let found = events(&judged(&other).increments);
            assert_eq!(found.len(), expected.len(), "seed {seed}, {what}: {found:?} {expected:?}");
            for ((load, words), (expected_load, expected_words)) in found.iter().zip(&expected) {
                assert!((load - expected_load).abs() <= 1e-7, "seed {seed}, {what}: {load} {expected_load}");
                assert_eq!(words, expected_words, "seed {seed}, {what}");
            }
        }
    }
    assert!(statuses.iter().all(|count| *count > 200), "{statuses:?}");
}
