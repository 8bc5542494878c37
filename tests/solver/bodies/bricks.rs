//! Two blocks in space on each other: patch tests, full slip, a wedge, random pairs.

use super::{moved_in_space, support};
use crate::common::paths::{close, judged, request, trace};
use crate::common::random::Numbers;
use arcslip::JobRequest;
use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, Status};
use arcslip::result::stop_reason::StopReason;
use itertools::iproduct;
use serde_json::{Map, Value, json};

/// A mapped mesh of hexahedra, or of six tetrahedra in each of their places.
pub struct Brick {
    pub nodes: Map<String, Value>,
    elements: Vec<Value>,
    prefix: &'static str,
    cells: [usize; 3],
    of_tetrahedra: bool,
}

/// The corners of a cell, in the order of VTK.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
/// Six tetrahedra around the diagonal from the first corner to the seventh.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];

impl Brick {
    pub fn new(
        prefix: &'static str,
        cells: [usize; 3],
        of_tetrahedra: bool,
        place: impl Fn([f64; 3]) -> [f64; 3],
    ) -> Self {
        let mut brick = Self { nodes: Map::new(), elements: Vec::new(), prefix, cells, of_tetrahedra };
        for at in iproduct!(0..=cells[0], 0..=cells[1], 0..=cells[2]) {
            let at = [at.0, at.1, at.2];
            let share = std::array::from_fn(|k| at[k] as f64 / cells[k] as f64);
            brick.nodes.insert(brick.name(at), json!(place(share)));
        }
        for (i, j, k) in iproduct!(0..cells[0], 0..cells[1], 0..cells[2]) {
            let corners = CORNERS.map(|[a, b, c]| brick.name([i + a, j + b, k + c]));
            if of_tetrahedra {
                for tetrahedron in TETRAHEDRA {
                    let nodes = tetrahedron.map(|corner| corners[corner].clone());
                    brick.elements.push(json!({"kind": "tetrahedron4", "nodes": nodes, "material": "matter"}));
                }
            } else {
                brick.elements.push(json!({"kind": "hexahedron8", "nodes": corners, "material": "matter"}));
            }
        }
        brick
    }

    fn name(&self, [i, j, k]: [usize; 3]) -> String {
        format!("{}{i}_{j}_{k}", self.prefix)
    }

    /// The nodes of a layer across the third direction.
    pub fn layer(&self, k: usize) -> Vec<String> {
        iproduct!(0..=self.cells[0], 0..=self.cells[1]).map(|(i, j)| self.name([i, j, k])).collect()
    }

    pub fn top(&self) -> Vec<String> {
        self.layer(self.cells[2])
    }

    /// The nodes of the side at the beginning of a direction.
    pub fn side(&self, axis: usize) -> Vec<String> {
        self.nodes_where(|at| at[axis] == 0)
    }

    /// The nodes of both sides at the ends of a direction.
    pub fn ends(&self, axis: usize) -> Vec<String> {
        self.nodes_where(|at| at[axis] == 0 || at[axis] == self.cells[axis])
    }

    fn nodes_where(&self, chosen: impl Fn([usize; 3]) -> bool) -> Vec<String> {
        let all = iproduct!(0..=self.cells[0], 0..=self.cells[1], 0..=self.cells[2]).map(|(i, j, k)| [i, j, k]);
        all.filter(|at| chosen(*at)).map(|at| self.name(at)).collect()
    }

    /// The faces of the lowest or of the highest layer.
    fn faces(&self, k: usize) -> Value {
        let cells = iproduct!(0..self.cells[0], 0..self.cells[1]);
        let faces = cells.flat_map(|(i, j)| {
            let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[p, q]| self.name([i + p, j + q, k]));
            if self.of_tetrahedra { vec![vec![a.clone(), b, c.clone()], vec![a, c, d]] } else { vec![vec![a, b, c, d]] }
        });
        json!({"faces": faces.collect::<Vec<_>>()})
    }
}

/// The upper surface of the first brick touches the lower one of the second, which carries the multipliers unless `swapped`.
pub fn pair(lower: &Brick, upper: &Brick, material: &Value, friction: f64, swapped: bool) -> Value {
    let (mut nodes, mut elements) = (lower.nodes.clone(), lower.elements.clone());
    nodes.extend(upper.nodes.clone());
    elements.extend(upper.elements.clone());
    let (surface, against) = if swapped { ("below", "above") } else { ("above", "below") };
    json!({
        "dimension": 3, "nodes": nodes, "elements": elements, "supports": {},
        "materials": {"matter": material},
        "surfaces": {
            "below": lower.faces(lower.cells[2]), "above": upper.faces(0), "top": upper.faces(upper.cells[2]),
        },
        "contacts": [{"surface": surface, "against": against, "friction": friction}],
    })
}

fn material((kind, young): (&str, f64)) -> Value {
    json!({"kind": kind, "young": young, "poisson": 0.3})
}

/// Two blocks of height 1, meshes 1 : 1.375 where the cells are 8 and 11, the interface with these slopes through the middle.
fn pressed(slopes: [f64; 2], friction: f64, swapped: bool, tetrahedra: [bool; 2], cells: [usize; 2]) -> Value {
    let interface = move |x: f64, y: f64| 1.0 + slopes[0] * (x - 0.5) + slopes[1] * (y - 0.5);
    let lower = Brick::new("l", [cells[0], cells[0], 2], tetrahedra[0], move |[x, y, z]| [x, y, z * interface(x, y)]);
    let upper = Brick::new("u", [cells[1], cells[1], 2], tetrahedra[1], move |[x, y, z]| {
        [x, y, interface(x, y) + z * (2.0 - interface(x, y))]
    });
    let mut model = pair(&lower, &upper, &material(("linear_elastic", 1e3)), friction, swapped);
    for brick in [&lower, &upper] {
        support(&mut model, &brick.side(0), &["x"]);
        support(&mut model, &brick.side(1), &["y"]);
    }
    support(&mut model, &lower.layer(0), &["z"]);
    model["stages"] = json!([{"name": "press", "tractions": {"top": [0, 0, -1]}, "until": {"load_above": 1}}]);
    json!({"model": model, "analysis": {"record": {"elements": "all"}}})
}

/// The largest difference of a stress from the uniform state `σ_zz = -1`.
fn largest_difference(increment: &Increment) -> f64 {
    let uniform = [0.0, 0.0, -1.0, 0.0, 0.0, 0.0];
    let stresses = increment.elements.iter().map(|element| element.stress.as_ref().expect("a solid has a stress"));
    let off = stresses.flat_map(|stress| stress.iter().zip(uniform)).map(|(found, exact)| (found - exact).abs());
    off.fold(0.0, f64::max)
}

/// A uniform pressure goes through an interface of meshes that do not match, flat or slanted, frictionless or stuck,
/// of quadrilaterals or triangles, whichever surface carries the multipliers.
#[test]
fn mortar_contacts_in_space_pass_the_patch_test() {
    let hexahedra = [false; 2];
    for (slopes, friction, swapped, tetrahedra, cells) in [
        ([0.0, 0.0], 0.0, false, hexahedra, [8, 11]),
        ([0.0, 0.0], 0.3, true, hexahedra, [3, 4]),
        ([0.0, 0.0], 0.3, false, [false, true], [3, 4]),
        ([0.3, 0.15], 0.8, false, hexahedra, [3, 4]),
        ([0.3, 0.15], 0.8, true, [true, false], [3, 4]),
    ] {
        let posted = pressed(slopes, friction, swapped, tetrahedra, cells);
        let (increments, report) = trace(&request(&posted.to_string()));
        let what = format!("slopes {slopes:?}, friction {friction}, swapped {swapped}, tetrahedra {tetrahedra:?}");
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}");
        close(largest_difference(increments.last().expect("an increment")), 0.0, 1e-10, &what);
    }
}

/// A slab that presses on a rigid body with a surface of this slope and is pushed along it.
fn slab(slope: f64, friction: f64, cells: [usize; 2]) -> Value {
    let lower = Brick::new("l", [cells[0], cells[0], 1], false, move |[x, y, z]| {
        [5.0 * x - 0.5, 4.0 * y - 1.0, z - 1.0 + slope * z * (5.0 * x - 0.5)]
    });
    let upper =
        Brick::new("u", [cells[1], cells[1], 1], false, move |[x, y, z]| [4.0 * x, 2.0 * y, 0.5 * z + slope * 4.0 * x]);
    let mut model = pair(&lower, &upper, &material(("linear_elastic", 100.0)), friction, false);
    support(&mut model, &lower.layer(0), &["x", "y", "z"]);
    support(&mut model, &lower.top(), &["x", "y", "z"]);
    support(&mut model, &upper.top(), &["x", "y"]);
    model["stages"] = json!([
        {"name": "press", "tractions": {"top": [0, 0, -1]}, "until": {"load_above": 1}},
        {"name": "push", "displacements": moved_in_space(&upper.top(), [0.4, 0.0, 0.0]), "until": {"load_above": 1}},
    ]);
    json!({"model": model})
}

/// The force along the first axis that moves the top, and the sum of the reactions' components along it.
fn pulled(increment: &Increment) -> (f64, f64) {
    let top = increment.supports.iter().filter(|(node, _)| node.starts_with('u'));
    (top.map(|(_, force)| force[0]).sum(), increment.contacts.iter().map(|contact| contact.reaction[0]).sum())
}

/// All nodes slip in the end, along the push once it has outlasted the slips of pressing: on a plane of slope 0.1 the force is
/// `F/G = (tan α + μ)/(1 - μ tan α) = 0.412371134` (NAFEMS, benchmark CGS-4).
#[test]
#[ignore = "half a minute in a release build: cargo test --release --test solver bricks -- --ignored"]
fn a_brick_slips_as_a_whole_at_the_limit_of_friction() {
    slips_as_a_whole(0.1);
}

/// On a level plane the force is μ N.
#[test]
#[ignore = "half a minute in a release build: cargo test --release --test solver bricks -- --ignored"]
fn a_brick_slips_as_a_whole_on_a_level_plane() {
    slips_as_a_whole(0.0);
}

fn slips_as_a_whole(slope: f64) {
    let posted = slab(slope, 0.3, [5, 1]);
    let found = judged(&request(&posted.to_string()));
    assert_eq!(found.report.stop_reason, StopReason::StagesCompleted, "slope {slope}");
    for (increment, errors) in found.increments.iter().zip(&found.errors) {
        let what = format!("slope {slope}, increment {}: {errors:?}", increment.index);
        assert!(errors.largest_of_state() <= 1e-9, "{what}");
    }
    let last = found.increments.last().expect("an increment");
    assert!(last.contacts.iter().all(|contact| contact.status == Status::Slip));
    let (top, contacts) = pulled(last);
    close(top, -contacts, 1e-10, "equilibrium");
    // The weight is that of the slanted top over its area.
    let weight = 8.0 * 1.0_f64.hypot(slope);
    close(top / weight, (slope + 0.3) / (1.0 - 0.3 * slope), 1e-10, &format!("slope {slope}"));
    for contact in &last.contacts {
        let size = contact.tangential_reaction[0].hypot(contact.tangential_reaction[1]);
        close(size, 0.3 * contact.normal_reaction, 1e-12, "the law of friction");
    }
}

/// A foot pressed on a table and pushed a little does the same whatever the stiffness over the pressure.
#[test]
fn stiffness_does_not_decide_what_bodies_do_in_space() {
    let of_stiffness = |young: f64| {
        let lower = Brick::new("l", [3, 3, 1], false, |[x, y, z]| [4.0 * x, 4.0 * y, z - 1.0]);
        let upper = Brick::new("u", [2, 2, 1], false, |[x, y, z]| [1.0 + 2.0 * x, 1.0 + 2.0 * y, z]);
        let mut model = pair(&lower, &upper, &material(("linear_elastic", young)), 0.3, false);
        support(&mut model, &lower.layer(0), &["x", "y", "z"]);
        model["stages"] = json!([
            {"name": "press", "tractions": {"top": [0, 0, -1]}, "until": {"load_above": 1}},
            {"name": "push", "tractions": {"top": [0.2, 0, 0]}, "until": {"load_above": 1}},
        ]);
        super::whole_path(&request(&json!({"model": model}).to_string()))
    };
    let expected = of_stiffness(1e2);
    assert!(expected.iter().filter(|increment| increment.point.event.is_some()).count() > 3);
    for young in [1e6, 1e10] {
        let found = of_stiffness(young);
        assert_eq!(found.len(), expected.len(), "{young}");
        for (one, other) in found.iter().zip(&expected) {
            assert_eq!(one.point.event, other.point.event, "{young}");
        }
    }
}

/// The direction in which a node slips depends on those of its neighbours: the solves in which they settle are few. (Without
/// acceleration the path took 1,582 factorisations.)
#[test]
fn coupled_slips_settle_in_few_solves() {
    let posted = slab(0.1, 0.3, [2, 1]);
    let found = judged(&request(&posted.to_string()));
    assert_eq!(found.report.stop_reason, StopReason::StagesCompleted);
    let factorisations = found.report.factorisations;
    assert!(factorisations <= 700, "{factorisations} factorisations in {} increments", found.increments.len());
}

/// Two small bodies with an interface that leans and bulges a little, pressed and pushed, all in turned axes.
fn random_pair(seed: u64, angle: f64) -> JobRequest {
    let mut numbers = Numbers(seed);
    let slopes = [numbers.between(-0.15, 0.15), numbers.between(-0.15, 0.15)];
    let bulge = numbers.between(-0.02, 0.05);
    let cells = [1 + numbers.below(2), 1 + numbers.below(2)];
    let shift = numbers.between(-0.1, 0.1);
    let gap = if numbers.chance(0.5) { 0.0 } else { numbers.between(0.0, 0.1) };
    let (sine, cosine) = angle.sin_cos();
    let turned = move |[x, y, z]: [f64; 3]| {
        let (x, z) = (cosine * x - sine * z, sine * x + cosine * z);
        [x, cosine * y - sine * z, sine * y + cosine * z]
    };
    let below = move |x: f64, y: f64| 1.0 + slopes[0] * x + slopes[1] * y;
    let above =
        move |x: f64, y: f64| below(x, y) + gap + bulge.max(0.0) * ((2.0 * x - 1.0).powi(2) + (2.0 * y - 1.0).powi(2));
    let tetrahedra = [numbers.chance(0.3), numbers.chance(0.3)];
    let lower = Brick::new("l", [cells[0], cells[0], 1], tetrahedra[0], move |[x, y, z]| {
        let (x, y) = (1.4 * x - 0.2, 1.4 * y - 0.2);
        turned([x, y, z * below(x, y)])
    });
    let upper = Brick::new("u", [cells[1], cells[1], 1], tetrahedra[1], move |[x, y, z]| {
        let (x, y) = (x + shift, y - shift);
        turned([x, y, above(x, y) + z * (2.2 - above(x, y))])
    });
    let kind = ["linear_elastic", "neo_hookean"][numbers.below(2)];
    let material = json!({"kind": kind, "young": 10, "poisson": numbers.between(0.0, 0.4)});
    let mut model = pair(&lower, &upper, &material, numbers.friction().min(1.0), false);
    support(&mut model, &lower.layer(0), &["x", "y", "z"]);
    support(&mut model, &upper.top(), &["x", "y", "z"]);
    let press = turned([0.0, 0.0, -0.2]);
    let push = turned([numbers.between(-0.3, 0.3), numbers.between(-0.2, 0.2), numbers.between(-0.1, 0.02)]);
    model["stages"] = json!([
        {"name": "press", "displacements": moved_in_space(&upper.top(), press), "until": {"load_above": 1}},
        {"name": "push", "displacements": moved_in_space(&upper.top(), push), "until": {"load_above": 1}},
    ]);
    let posted = json!({
        "model": model,
        "analysis": {
            "max_increments": 30, "arc_length": {"displacement_scale": 1, "initial": 0.05},
        },
    });
    request(&posted.to_string())
}

/// The measure and the energy of random pairs, and the same path in turned axes.
#[test]
#[ignore = "half a minute in a release build: cargo test --release --test solver bricks -- --ignored"]
fn random_pairs_in_space_keep_the_laws() {
    let mut statuses = [0; 3];
    for seed in 0..8 {
        let found = judged(&random_pair(seed, 0.0));
        super::count_within_the_measure(&found, 1e-5, seed, &mut statuses);
        let scene = Scene::new(&random_pair(seed, 0.7)).expect("a scene");
        let turned: Vec<Increment> = Path::new(&scene, CancelFlag::default()).collect();
        assert_eq!(found.increments.len(), turned.len(), "seed {seed}");
        let ends = [&found.increments, &turned].map(|path| path.last().map_or(0.0, |last| last.load_factor));
        assert!((ends[0] - ends[1]).abs() <= 1e-8, "seed {seed}: {ends:?}");
    }
    assert!(statuses.iter().all(|count| *count > 20), "{statuses:?}");
}

/// Why a changed pair of bricks is refused.
fn refusal(change: impl FnOnce(&mut Value)) -> String {
    let mut posted = pressed([0.0, 0.0], 0.3, false, [false; 2], [1, 1]);
    change(&mut posted["model"]);
    match arcslip::model::decode::decode(posted.to_string().as_bytes()) {
        Err(errors) => errors.to_string(),
        Ok(request) => Scene::new(&request).map(|_| ()).expect_err("a refusal").to_string(),
    }
}

/// Nodes beyond the end of the other surface are free, whether above its level, at it or below.
#[test]
fn a_brick_may_overhang_another() {
    for height in [1e-9, 0.0, -0.4] {
        let mut posted = pressed([0.0, 0.0], 0.3, false, [false; 2], [2, 2]);
        for (name, place) in posted["model"]["nodes"].as_object_mut().expect("nodes") {
            if name.starts_with('u') {
                let [x, z] = [0, 2].map(|k| place[k].as_f64().expect("a number"));
                // Below the level of the other surface the brick is beside it.
                place[0] = json!(x + if height < 0.0 { 5.0 } else { 0.7 });
                place[2] = json!(z + height);
            }
        }
        if height != 0.0 {
            // Nothing else holds a brick that touches nothing.
            support(&mut posted["model"], &["u0_0_0".to_owned()], &["z"]);
        }
        let request = arcslip::model::decode::decode(posted.to_string().as_bytes()).expect("a request");
        let scene = Scene::new(&request);
        assert!(scene.is_ok(), "{height}: {}", scene.err().map_or_else(String::new, |errors| errors.to_string()));
    }
}

#[test]
fn what_makes_no_contact_in_space_is_refused_with_its_place() {
    let found = refusal(|model| model["contacts"][0]["discretisation"] = json!("node_to_surface"));
    assert!(found.contains("contacts[0]") && found.contains("mortar contacts alone"), "{found}");
    let found = refusal(|model| model["contacts"][0]["against"] = json!("above"));
    assert!(found.contains("does not touch itself"), "{found}");
    let found = refusal(|model| model["surfaces"]["above"]["faces"] = model["surfaces"]["below"]["faces"].clone());
    assert!(found.contains("no common nodes"), "{found}");
    // The upper block begins inside the lower one.
    let found = refusal(|model| {
        for (name, place) in model["nodes"].as_object_mut().expect("nodes") {
            if name.starts_with('u') {
                place[2] = json!(place[2].as_f64().expect("a number") - 0.3);
            }
        }
    });
    assert!(found.contains("is behind the surface") && found.contains("gap -0.3"), "{found}");
    // Two opposite corners of a face at one place.
    let found = refusal(|model| model["nodes"]["u1_1_0"] = model["nodes"]["u0_0_0"].clone());
    assert!(found.contains("has no area") && found.contains("`u1_1_0`"), "{found}");
}
