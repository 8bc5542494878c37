//! Bodies of quadratic solids that touch each other: patch tests through meshes that do not match, full slip, what is refused.

use crate::common::paths::{close, judged, request, trace};
use crate::solids::meshes::{Mesh, hold};
use arcslip::result::increment::Status;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// Puts `prefix` in place of the `n` of all names of nodes.
fn renamed(value: &Value, prefix: &str) -> Value {
    let name = |text: &str| match text.strip_prefix('n') {
        Some(rest) if rest.starts_with(|one: char| one.is_ascii_digit()) => format!("{prefix}{rest}"),
        _ => text.to_owned(),
    };
    match value {
        Value::String(text) => name(text).into(),
        Value::Array(all) => all.iter().map(|one| renamed(one, prefix)).collect(),
        Value::Object(all) => all.iter().map(|(key, one)| (name(key), renamed(one, prefix))).collect(),
        other => other.clone(),
    }
}

/// Two blocks of unit size on each other, their interface with a slope, and a unit pressure on the upper one; of kinds of
/// solids and cells along an edge.
fn blocks(kinds: [&'static str; 2], cells: [usize; 2], slope: f64, friction: f64, swapped: bool) -> Value {
    let dimension = if kinds[0].contains("hedron") { 3 } else { 2 };
    let up = dimension - 1;
    let interface = move |x: f64| 1.0 + slope * (x - 0.5);
    let place = |upper: bool| {
        move |point: [f64; 3]| {
            let (x, along) = (point[0], point[up]);
            let mut place = point;
            let height = interface(x);
            place[up] = if upper { height + along * (2.0 - height) } else { along * height };
            place
        }
    };
    let mesh = |which: usize| {
        let mut all = vec![cells[which]; dimension];
        all[up] = 2;
        Mesh::new(kinds[which], &all, place(which == 1))
    };
    let plane = if dimension == 2 { json!({"plane": "strain"}) } else { json!({}) };
    let material = json!({"kind": "linear_elastic", "young": 1e3, "poisson": 0.3});
    let mut bodies = [0, 1].map(|which| {
        let mesh = mesh(which);
        let mut model = mesh.model(material.clone(), &plane);
        // Symmetry on the sides and the foot: the strain is even, and nothing slides.
        (0..up).for_each(|axis| hold(&mut model, &mesh.side(axis, false), &[["x", "y"][axis]]));
        if which == 0 {
            hold(&mut model, &mesh.side(up, false), &[["x", "y", "z"][up]]);
        }
        model["surfaces"] = json!({
            (if which == 0 { "lower" } else { "upper" }): {"faces": mesh.faces(up, which == 0)},
            (if which == 0 { "foot" } else { "top" }): {"faces": mesh.faces(up, which == 1)},
        });
        renamed(&model, ["l", "u"][which])
    });
    let [lower, upper] = &mut bodies;
    for member in ["nodes", "supports", "surfaces"] {
        let more = upper[member].as_object().expect("an object").clone();
        lower[member].as_object_mut().expect("an object").extend(more);
    }
    let more = upper["elements"].as_array().expect("elements").clone();
    lower["elements"].as_array_mut().expect("elements").extend(more);
    let [own, other] = if swapped { ["lower", "upper"] } else { ["upper", "lower"] };
    lower["contacts"] = json!([{"surface": own, "against": other, "friction": friction}]);
    let mut traction = vec![0.0; dimension];
    traction[up] = -1.0;
    lower["stages"] = json!([{"name": "press", "tractions": {"top": traction}, "until": {"load_above": 1}}]);
    lower.clone()
}

const PAIRS: [[&str; 2]; 5] = [
    ["triangle6", "quadrilateral8"],
    ["quadrilateral8", "quadrilateral4"],
    ["tetrahedron10", "hexahedron20"],
    ["hexahedron20", "hexahedron8"],
    ["tetrahedron4", "tetrahedron10"],
];

/// An even pressure goes through an interface of quadratic meshes that do not match, whichever surface carries the
/// multipliers: the stress across is the pressure everywhere, the stress along that of the supports, which is even too.
#[test]
fn quadratic_faces_pass_the_patch_test() {
    for kinds in PAIRS {
        let cells = if kinds[0].contains("hedron") { [2, 3] } else { [8, 11] };
        for (slope, friction) in [(0.0, 0.0), (0.25, 0.8)] {
            for swapped in [false, true] {
                let model = blocks(kinds, cells, slope, friction, swapped);
                let up = model["dimension"].as_u64().expect("a dimension") as usize - 1;
                let posted = json!({"model": model, "analysis": {"record": {"elements": "all"}}});
                let (increments, report) = trace(&request(&posted.to_string()));
                let what = format!("{kinds:?}, slope {slope}, {swapped}");
                assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}: {report:?}");
                let last = increments.last().expect("an increment");
                let stresses = last.elements.iter().filter_map(|element| element.stress.as_ref());
                let off = stresses.map(|stress| (stress[up] + 1.0).abs()).fold(0.0, f64::max);
                close(off, 0.0, 1e-10, &what);
            }
        }
    }
}

/// The upper block is pushed over the lower one by its top: all slips at `μ N`.
#[test]
fn a_block_of_quadratic_solids_slips_at_the_limit_of_friction() {
    for (kinds, cells) in [
        (["quadrilateral8", "triangle6"], [5, 4]),
        (["hexahedron20", "tetrahedron10"], [2, 2]),
        (["hexahedron8", "hexahedron20"], [3, 2]),
    ] {
        let mut model = blocks(kinds, cells, 0.0, 0.3, false);
        let dimension = model["dimension"].as_u64().expect("a dimension") as usize;
        // The lower block is wider, and held; the upper one is moved by its top.
        let nodes = model["nodes"].as_object().expect("nodes").clone();
        let all = &["x", "y", "z"][..dimension];
        let mut driven = serde_json::Map::new();
        for (name, place) in &nodes {
            let mut place = place.clone();
            if name.starts_with('l') {
                place[0] = json!(2.0 * place[0].as_f64().expect("a number") - 0.5);
                model["supports"][name] = json!(all);
            } else {
                model["supports"].as_object_mut().expect("supports").remove(name);
                // Low enough for the push not to tilt it.
                let height = place[dimension - 1].as_f64().expect("a number");
                place[dimension - 1] = json!(1.0 + 0.3 * (height - 1.0));
                if height == 2.0 {
                    model["supports"][name] = json!(all[..dimension - 1]);
                    let mut motion = vec![0.0; dimension];
                    motion[0] = 0.01;
                    driven.insert(name.clone(), json!(motion));
                }
            }
            model["nodes"][name] = place;
        }
        let push = json!({"name": "push", "displacements": driven, "until": {"load_above": 1}});
        model["stages"].as_array_mut().expect("stages").push(push);
        let (increments, report) = trace(&request(&json!({"model": model}).to_string()));
        let what = format!("{kinds:?}");
        assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}: {report:?}");
        let last = increments.last().expect("an increment");
        let pulled: f64 =
            last.supports.iter().filter(|(node, _)| node.starts_with('u')).map(|(_, force)| force[0]).sum();
        println!("{what}: {} increments, {} contacts, pulled by {pulled}", increments.len(), last.contacts.len());
        assert!(last.contacts.iter().all(|contact| contact.status == Status::Slip), "{what}");
        close(pulled, 0.3, 1e-10, &what);
    }
}

/// Edges that are drawn round become chords: weighed down or turned, bodies are on the measure, and a turn by itself
/// strains nothing.
#[test]
fn edges_that_are_drawn_round_become_chords() {
    for kinds in [["quadrilateral8", "triangle6"], ["hexahedron20", "tetrahedron10"]] {
        let mut model = blocks(kinds, [2, 3], 0.0, 0.2, false);
        let dimension = model["dimension"].as_u64().expect("a dimension") as usize;
        let up = dimension - 1;
        let nodes = model["nodes"].as_object().expect("nodes").clone();
        let mut turned = serde_json::Map::new();
        for (name, place) in &nodes {
            let mut place: Vec<f64> = place.as_array().expect("a place").iter().filter_map(Value::as_f64).collect();
            let is_touching = place[up] == 1.0;
            let is_middle =
                name[1..].split('_').any(|number| number.parse().is_ok_and(|number: usize| number % 2 == 1));
            if is_touching && is_middle {
                place[up] += 0.05;
            }
            if name.starts_with('u') && place[up] == 2.0 {
                // By a tenth about the far edge, and up.
                let (x, height) = (place[0] - 1.0, place[up] - 1.0);
                let (sine, cosine) = 0.1_f64.sin_cos();
                let mut motion = vec![0.0; dimension];
                motion[0] = x * cosine + height * sine - x;
                motion[up] = height * cosine - x * sine - height + 0.1;
                turned.insert(name.clone(), json!(motion));
                model["supports"][name] = json!(&["x", "y", "z"][..dimension]);
            } else if name.starts_with('u') {
                model["supports"].as_object_mut().expect("supports").remove(name);
            }
            model["nodes"][name] = json!(place);
        }
        let mut weight = vec![0.0; dimension];
        weight[up] = -1.0;
        model["materials"]["matter"]["kind"] = json!("neo_hookean");
        let what = format!("{kinds:?}");
        for stages in [
            json!([
                {"name": "weight", "body_forces": {"matter": weight}, "until": {"load_above": 1}}
            ]),
            json!([{"name": "turn", "displacements": turned, "until": {"load_above": 1}}]),
        ] {
            model["stages"] = stages;
            let path = judged(&request(&json!({"model": model}).to_string()));
            assert_eq!(path.report.stop_reason, StopReason::StagesCompleted, "{what}: {:?}", path.report);
            for (increment, errors) in path.increments.iter().zip(&path.errors) {
                assert!(errors.largest_of_state() < 1e-10, "{what}, increment {}: {errors:?}", increment.index);
            }
            let last = path.increments.last().expect("an increment");
            if &*last.stage == "turn" {
                close(last.energy.strain, 0.0, 1e-12, &what);
            }
        }
    }
}

/// What else asks for a middle that follows its ends is refused, with what would do.
#[test]
fn middles_that_follow_are_asked_for_by_nothing_else() {
    let model = || blocks(["quadrilateral8", "quadrilateral8"], [2, 3], 0.0, 0.0, false);
    let middle = "l1_4_0";
    let wrong = [
        ("/model/contacts/1/node", {
            let mut model = model();
            model["obstacles"] = json!({"wall": {"kind": "plane", "point": [-1, 0], "normal": [1, 0]}});
            model["contacts"].as_array_mut().expect("contacts").push(json!({"node": middle, "obstacle": "wall"}));
            model
        }),
        ("/model/contacts/1/node", {
            let mut model = model();
            let more = json!({"node": middle, "surface": "lower", "against": "upper"});
            model["contacts"].as_array_mut().expect("contacts").push(more);
            model
        }),
        ("/model/supports/l1_4_0", {
            let mut model = model();
            hold(&mut model, &[middle.to_owned()], &["x"]);
            model
        }),
        ("/model/elements/10/nodes", {
            let mut model = model();
            let spring = json!({"kind": "spring", "nodes": [middle], "stiffness": [[1, 0], [0, 1]]});
            model["elements"].as_array_mut().expect("elements").push(spring);
            model
        }),
        ("/model/stages/0/until/displacement/node", {
            let mut model = model();
            model["stages"][0]["until"] = json!({"displacement": {"node": middle, "component": "y", "below": -0.1}});
            model
        }),
    ];
    for (place, model) in wrong {
        let mistakes = arcslip::read(json!({"model": model}).to_string().as_bytes()).expect_err(place);
        let found = mistakes.0.iter().find(|mistake| mistake.pointer == place);
        let found = found.unwrap_or_else(|| panic!("{place}: {mistakes}"));
        assert!(found.detail.contains("`l1_4_0` is the middle of an edge"), "{}", found.detail);
    }
}
