//! Two blocks on each other: patch tests, full slip, a wedge.

use super::{Sheet, moved, pair, support, whole_path};
use crate::common::paths::{close, request, trace};
use crate::common::variants::{in_reverse, in_units};
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, Status};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Two blocks of height 1, meshes 1 : 1.375, the interface with a slope through the middle.
fn blocks(slope: f64, cells: [usize; 2]) -> [Sheet; 2] {
    let interface = move |x: f64| 1.0 + slope * (x - 0.5);
    let lower = Sheet::new("l", [cells[0], 4], move |x, y| [x, y * interface(x)]);
    let upper = Sheet::new("u", [cells[1], 4], move |x, y| [x, interface(x) + y * (2.0 - interface(x))]);
    [lower, upper]
}

fn pressed(slope: f64, friction: f64, swapped: bool, material: &Value) -> Value {
    let [lower, upper] = blocks(slope, [8, 11]);
    let mut model = pair(&lower, &upper, material, friction, swapped);
    support(&mut model, &lower.lowest(), &["y"]);
    for (sheet, row) in [(&lower, 0..=4), (&upper, 0..=4)] {
        row.for_each(|row| support(&mut model, &[sheet.name(0, row)], &["x"]));
    }
    model["stages"] = json!([{"name": "press", "tractions": {"top": [0, -1]}, "until": {"load_above": 1}}]);
    model
}

/// The largest difference of a stress from the uniform state `σ_yy = -1`, `σ_zz = -ν`.
fn largest_difference(increment: &Increment) -> f64 {
    let uniform = [0.0, -1.0, -0.3, 0.0];
    let stresses = increment.elements.iter().map(|element| element.stress.as_ref().expect("a solid has a stress"));
    stresses
        .flat_map(|stress| stress.iter().zip(uniform))
        .map(|(found, exact)| (found - exact).abs())
        .fold(0.0, f64::max)
}

const LINEAR: (&str, f64) = ("linear_elastic", 1e3);

fn material((kind, young): (&str, f64)) -> Value {
    json!({"kind": kind, "young": young, "poisson": 0.3})
}

/// A uniform pressure goes through an interface of meshes that do not match, flat or slanted, frictionless or stuck,
/// whichever surface carries the multipliers.
#[test]
fn mortar_contacts_pass_the_patch_test() {
    for (slope, friction) in [(0.0, 0.0), (0.0, 0.3), (0.3, 0.8)] {
        for swapped in [false, true] {
            let model = pressed(slope, friction, swapped, &material(LINEAR));
            let posted = json!({"model": model, "analysis": {"record": {"elements": "all"}}});
            let (increments, report) = trace(&request(&posted.to_string()));
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "slope {slope}, friction {friction}");
            let last = increments.last().expect("an increment");
            close(largest_difference(last), 0.0, 1e-10, &format!("slope {slope}, friction {friction}, {swapped}"));
        }
    }
}

/// Nodes against a surface fail it: where the finer mesh presses, by a fifth of the pressure and more.
#[test]
fn node_to_surface_contacts_fail_the_patch_test() {
    let mut model = pressed(0.0, 0.0, false, &material(LINEAR));
    model["contacts"][0]["discretisation"] = json!("node_to_surface");
    let posted = json!({"model": model, "analysis": {"record": {"elements": "all"}}});
    let (increments, report) = trace(&request(&posted.to_string()));
    assert_eq!(report.stop_reason, StopReason::StagesCompleted);
    let off = largest_difference(increments.last().expect("an increment"));
    assert!((0.05..0.5).contains(&off), "{off}");
}

/// Pressed with 1 and pushed by the upper block's top over a stiff lower block.
fn pushed(friction: f64, until: f64, cells: [usize; 2], swapped: bool) -> Value {
    let [lower, upper] = blocks(0.0, cells);
    let mut model = pair(&lower, &upper, &material(LINEAR), friction, swapped);
    support(&mut model, &lower.lowest(), &["x", "y"]);
    support(&mut model, &upper.highest(), &["x"]);
    model["stages"] = json!([
        {"name": "press", "tractions": {"top": [0, -1]}, "until": {"load_above": 1}},
        {"name": "push", "displacements": moved(&upper.highest(), [1e-2, 0.0]),
            "until": {"load_above": until}},
    ]);
    json!({"model": model})
}

/// The horizontal force that moves the top, and the sums of normal and of tangential reactions.
fn forces(increment: &Increment) -> (f64, f64, f64) {
    let top = increment.supports.iter().filter(|(node, _)| node.starts_with('u'));
    let pulled = top.map(|(_, force)| force[0]).sum();
    let normal = increment.contacts.iter().map(|contact| contact.normal_reaction).sum();
    let tangential = increment.contacts.iter().map(|contact| contact.tangential_reaction[0].abs()).sum();
    (pulled, normal, tangential)
}

/// A slab that presses on a rigid body with a surface of this slope and is pushed along it: the surface stays plane.
fn slab(slope: f64, friction: f64, cells: [usize; 2], swapped: bool) -> Value {
    let lower = Sheet::new("l", [cells[0], 1], move |x, y| [5.0 * x - 0.5, (y - 1.0) + slope * y * (5.0 * x - 0.5)]);
    let upper = Sheet::new("u", [cells[1], 2], move |x, y| [4.0 * x, 0.5 * y + slope * 4.0 * x]);
    let mut model = pair(&lower, &upper, &material(("linear_elastic", 100.0)), friction, swapped);
    support(&mut model, &lower.lowest(), &["x", "y"]);
    support(&mut model, &lower.highest(), &["x", "y"]);
    support(&mut model, &upper.highest(), &["x"]);
    model["stages"] = json!([
        {"name": "press", "tractions": {"top": [0, -1]}, "until": {"load_above": 1}},
        {"name": "push", "displacements": moved(&upper.highest(), [0.1, 0.0]), "until": {"load_above": 1}},
    ]);
    json!({"model": model})
}

/// Every node's slip is an event of its own or one of several together; then the force is μ N.
#[test]
fn a_block_on_a_block_slips_as_a_whole_at_the_limit_of_friction() {
    for cells in [[7, 5], [13, 11], [15, 20]] {
        let posted = slab(0.0, 0.3, cells, false);
        let (increments, report) = trace(&request(&posted.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{cells:?}");
        let last = increments.last().expect("an increment");
        let (pulled, normal, tangential) = forces(last);
        close(tangential, 0.3 * normal, 1e-12, "the law of friction");
        close(pulled, 0.3 * 4.0, 1e-10, &format!("{cells:?}"));
        let slips = increments.iter().filter_map(|increment| increment.point.event.as_deref());
        let slips: usize = slips.map(|event| event.matches("to slip").count()).sum();
        assert!(last.contacts.iter().all(|contact| contact.status == Status::Slip) && slips >= cells[1], "{slips}");
    }
}

/// A block pressed on another one and pushed to full slip does the same whatever the stiffness over the pressure: gaps and slips
/// have the rounding of displacements, not of coordinates.
#[test]
fn stiffness_does_not_decide_what_bodies_do() {
    let of_stiffness = |kind: &str, young: f64| {
        let lower = Sheet::new("l", [12, 3], |x, y| [5.0 * x - 0.5, y - 1.0]);
        let upper = Sheet::new("u", [9, 3], |x, y| [4.0 * x, 0.5 * y]);
        let mut model = pair(&lower, &upper, &material((kind, young)), 0.3, false);
        support(&mut model, &lower.lowest(), &["x", "y"]);
        support(&mut model, &upper.highest(), &["x"]);
        model["stages"] = json!([
            {"name": "press", "tractions": {"top": [0, -1]}, "until": {"load_above": 1}},
            {"name": "push", "displacements": moved(&upper.highest(), [1.5 / young, 0.0]), "until": {"load_above": 1}},
        ]);
        let increments = whole_path(&request(&json!({"model": model}).to_string()));
        let (_, normal, tangential) = forces(increments.last().expect("an end"));
        close(tangential, 0.3 * normal, 1e-12, "the law of friction");
        increments
    };
    let expected = of_stiffness("linear_elastic", 1e3);
    let slips = expected.iter().filter(|increment| increment.point.event.is_some()).count();
    assert!(slips > 8, "{slips}");
    for young in [1e6, 1e9, 1e11] {
        let found = of_stiffness("linear_elastic", young);
        assert_eq!(found.len(), expected.len(), "{young}");
        for (one, other) in found.iter().zip(&expected) {
            assert_eq!(one.point.event, other.point.event, "{young}");
        }
    }
    // Large strains are small ones here.
    let events = |increments: &[Increment]| -> Vec<(f64, String)> {
        let of = |increment: &Increment| Some((increment.load_factor, increment.point.event.clone()?));
        increments.iter().filter_map(of).collect()
    };
    let expected = events(&of_stiffness("linear_elastic", 1e9));
    for young in [1e7, 1e10] {
        let found = events(&of_stiffness("saint_venant_kirchhoff", young));
        assert_eq!(found.len(), expected.len(), "{young}: {found:?} {expected:?}");
        for ((load, words), (expected_load, expected_words)) in found.iter().zip(&expected) {
            close(*load, *expected_load, 1e-3, &format!("{young}"));
            assert_eq!(words, expected_words, "{young}");
        }
    }
}

/// A block whose ends stand on nodes of the other one, and stick there: the piece of the face beside such a node is too short to
/// count as covered, and takes no part of the gradient with it.
#[test]
fn ends_may_stand_on_nodes() {
    let lower = Sheet::new("l", [4, 1], |x, y| [2.0 * x - 1.0, y - 1.0]);
    let upper = Sheet::new("u", [1, 1], |x, y| [x - 0.5, y]);
    let mut model = pair(&lower, &upper, &material(("linear_elastic", 1e6)), 0.3, false);
    support(&mut model, &lower.lowest(), &["x", "y"]);
    support(&mut model, &upper.highest(), &["x"]);
    model["stages"] = json!([{"name": "press", "tractions": {"top": [0, -1]}, "until": {"load_above": 1}}]);
    whole_path(&request(&json!({"model": model}).to_string()));
}

/// A block that hovers over another one moves as a rigid body: rounding of its stiffness is no resistance.
#[test]
fn a_block_that_hovers_is_a_mechanism() {
    let lower = Sheet::new("l", [4, 2], |x, y| [2.0 * x, y - 1.0]);
    for height in [1e-6, 1e-2] {
        let upper = Sheet::new("u", [3, 2], |x, y| [0.5 + x, height + y]);
        let mut model = pair(&lower, &upper, &material(LINEAR), 0.3, false);
        support(&mut model, &lower.lowest(), &["x", "y"]);
        support(&mut model, &upper.highest(), &["x"]);
        model["stages"] = json!([{"name": "press", "tractions": {"top": [0, -1]}, "until": {"load_above": 1}}]);
        let error = Scene::new(&request(&json!({"model": model}).to_string())).map(|_| ()).expect_err("a mechanism");
        assert!(error.to_string().contains("the structure is a mechanism"), "{error}");
    }
}

/// A block is pushed up a wedge of slope 0.1 with friction 0.3: `F/G = (tan α + μ)/(1 - μ tan α) = 0.412371134` (NAFEMS,
/// benchmark CGS-4). Where the rigid wedge carries the multipliers, the
/// block's surface is straight in the mean alone.
#[test]
fn a_block_is_pushed_up_a_wedge() {
    for (cells, swapped, bar) in [([13, 11], false, 1e-10), ([9, 20], true, 1e-4)] {
        let posted = slab(0.1, 0.3, cells, swapped);
        let (increments, report) = trace(&request(&posted.to_string()));
        assert_eq!(report.stop_reason, StopReason::StagesCompleted);
        let (pulled, ..) = forces(increments.last().expect("an increment"));
        // The weight is that of the slanted top over its length.
        let weight = 4.0 * 1.0_f64.hypot(0.1);
        close(pulled / weight, (0.1 + 0.3) / (1.0 - 0.3 * 0.1), bar, &format!("swapped {swapped}"));
    }
}

/// A rigid surface with more nodes than the deformable one opposite has more reactions than equilibrium tells apart.
#[test]
fn too_many_multipliers_are_told() {
    let posted = slab(0.0, 0.3, [15, 5], true);
    let (_, report) = trace(&request(&posted.to_string()));
    assert_eq!(report.stop_reason, StopReason::Degenerate);
}

/// The names of an increment's event, in any order.
fn events(posted: &arcslip::JobRequest) -> Vec<(f64, Vec<String>)> {
    let (increments, _) = trace(posted);
    let words = |increment: &Increment| {
        let event = increment.point.event.as_deref()?;
        let mut parts: Vec<String> = event.split("; ").map(str::to_owned).collect();
        parts.sort();
        Some((increment.load_factor, parts))
    };
    increments.iter().filter_map(words).collect()
}

#[test]
fn units_and_order_do_not_decide_what_bodies_do() {
    let posted = request(&pushed(0.3, 1.3, [4, 5], false).to_string());
    let expected = events(&posted);
    assert!(expected.len() > 8);
    let others = [
        ("mm, N", in_units(posted.clone(), 1e3, 1e-3)),
        ("large", in_units(posted.clone(), 1e-6, 1e6)),
        ("reverse", in_reverse(posted.clone())),
    ];
    for (what, other) in others {
        let found = events(&other);
        assert_eq!(found.len(), expected.len(), "{what}");
        for ((load, words), (expected_load, expected_words)) in found.iter().zip(&expected) {
            close(*load, *expected_load, 1e-9, what);
            assert_eq!(words, expected_words, "{what}");
        }
    }
}

/// A path of bodies resumed at every fifth increment is the same path to the last bit.
#[test]
fn a_path_of_bodies_can_be_taken_up_anywhere() {
    let posted = request(&pushed(0.3, 1.3, [4, 5], false).to_string());
    let scene = Scene::new(&posted).expect("a scene");
    let whole: Vec<Increment> = Path::new(&scene, CancelFlag::default()).collect();
    let mut path = Path::new(&scene, CancelFlag::default());
    let mut resumed: Vec<Increment> = Vec::new();
    while let Some(increment) = path.next() {
        resumed.push(increment);
        if resumed.len().is_multiple_of(5) {
            path = Path::resume(&scene, path.checkpoint(), CancelFlag::default()).expect("a path");
        }
    }
    assert_eq!(whole.len(), resumed.len());
    for (one, other) in whole.iter().zip(&resumed) {
        assert_eq!(
            (one.load_factor, &one.displacements, &one.contacts),
            (other.load_factor, &other.displacements, &other.contacts)
        );
    }
}
