//! Forces in the increments: elements, supports, loads, contacts in global axes, total slip; their balance by the measure.

use crate::common::paths::{close, judge, judged, request, scene, trace};
use arcslip::model::JobRequest;
use arcslip::model::request::{Component, ElementReference, ForceRange, Record, RecordedElements, RecordedSupports};
use arcslip::output::table::Table;
use arcslip::result::increment::Increment;
use serde_json::{Map, Value, json};

fn recorded(name: &str, record: Record) -> JobRequest {
    let mut request = scene(name);
    request.analysis.record = Some(record);
    request
}

/// `N = EA (L/L0 - 1)`; the pin holds the bar's end, and with load and floor it holds the whole structure.
#[test]
fn a_bar_its_pin_and_its_floor_have_the_forces_of_the_closed_form() {
    let request = scene("one-bar-truss");
    let (increments, _) = trace(&request);
    let rest = 1.5_f64.hypot(1.0);
    for increment in &increments {
        let tip = &increment.displacements["tip"];
        let (x, y) = (-1.5 + tip[0], -1.0 + tip[1]);
        let length = x.hypot(y);
        let axial = length / rest - 1.0;
        let [state] = &increment.elements[..] else { panic!("{:?}", increment.elements) };
        close(state.axial_force.expect("a bar"), axial, 1e-14, "axial force");
        assert_eq!((state.element, &state.name, &state.force), (0, &None, &None));
        let pin = &increment.supports["pin"];
        close(pin[0], -axial * x / length, 1e-13, "reaction of the pin along x");
        close(pin[1], -axial * y / length, 1e-13, "reaction of the pin along y");
        let contact = &increment.contacts[0];
        close(contact.reaction[0], contact.tangential_reaction[0], 0.0, "the floor's tangent is x");
        close(contact.reaction[1], contact.normal_reaction, 0.0, "the floor's normal is y");
        assert_eq!(increment.applied_forces[..], [increment.load_factor, 0.0]);
        for ((pin, contact), applied) in pin.iter().zip(&contact.reaction).zip(&increment.applied_forces) {
            close(pin + contact + applied, 0.0, 1e-13, "sum of the forces");
        }
    }
    assert!(increments.len() > 50);
}

/// `f = K u`; the total slip is the way from where the node first slips.
#[test]
fn a_spring_has_its_stiffness_times_its_motion_and_slips_add_up() {
    let request = scene("klarbring");
    let stiffness = match &request.model.elements[0] {
        arcslip::model::request::Element::Spring { stiffness, .. } => stiffness.clone(),
        other => panic!("{other:?}"),
    };
    let (increments, _) = trace(&request);
    let mut total = 0.0;
    for increment in &increments {
        let u = &increment.displacements["node"];
        let force = increment.elements[0].force.as_ref().expect("a spring");
        for (row, force) in stiffness.iter().zip(force) {
            close(*force, row[0] * u[0] + row[1] * u[1], 1e-14, "force of the spring");
        }
        assert!(increment.supports.is_empty() && increment.elements[0].axial_force.is_none());
        total += increment.contacts[0].slip[0];
        assert_eq!(increment.contacts[0].slip_total[0], total);
    }
    assert!(total > 1.0, "{total}");
}

/// A node that goes to and fro: the total slip is signed, its increments add up along the tangents of each.
#[test]
fn total_slip_comes_back_with_the_node_and_is_carried_on_by_stages() {
    let back = request(
        r#"{"model": {"dimension": 2, "nodes": {"block": [0, 0]}, "elements": [
              {"kind": "spring", "nodes": ["block"], "stiffness": [[1, 0], [0, 1]], "name": "anchor"}],
            "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
            "contacts": [{"node": "block", "obstacle": "floor", "friction": 0.5}],
            "stages": [{"name": "press", "forces": {"block": [0, -1]}, "until": {"load_above": 1}},
                       {"name": "push", "forces": {"block": [1, 0]}, "until": {"load_above": 2}},
                       {"name": "pull", "forces": {"block": [-1, 0]}, "until": {"load_above": 4}}]}}"#,
    );
    let (increments, _) = trace(&back);
    let end_of = |stage: &str| increments.iter().rfind(|increment| &*increment.stage == stage).expect("the stage");
    // Slip from 0.5 to 2, x = 1.5; back from a load of 2 - 2 x 0.5 at which it slips the other way: x = 4 - 2 - 0.5.
    close(end_of("push").contacts[0].slip_total[0], 1.5, 1e-14, "to");
    close(end_of("pull").contacts[0].slip_total[0], -1.5, 1e-14, "fro");
    let last = end_of("pull");
    assert_eq!(last.elements[0].name.as_deref(), Some("anchor"));
    close(last.elements[0].force.as_ref().expect("a spring")[0], -1.5, 1e-14, "anchor");
    // Loads of stages that have ended are part of what is applied.
    assert_eq!(last.applied_forces[..], [-2.0, -1.0]);
}

/// A lattice of nodes in space on four sloping, rough footings under its weight and a sidewise load.
fn tower(floors: usize) -> JobRequest {
    let (mut nodes, mut elements) = (Map::new(), Vec::new());
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let name = |floor: usize, corner: usize| format!("{floor}-{}", corner % 4);
    let mut bar = |first: String, second: String| {
        elements.push(json!({"kind": "bar", "nodes": [first, second], "axial_stiffness": 100.0}));
    };
    for floor in 0..floors {
        let width = 1.0 - 0.4 * floor as f64 / floors as f64;
        for (corner, [x, y]) in corners.iter().enumerate() {
            nodes.insert(name(floor, corner), json!([x * width, y * width, floor as f64]));
            bar(name(floor, corner), name(floor, corner + 1));
            if floor > 0 {
                bar(name(floor - 1, corner), name(floor, corner));
                bar(name(floor - 1, corner), name(floor, corner + 1));
                bar(name(floor - 1, corner + 1), name(floor, corner));
            }
        }
        bar(name(floor, 0), name(floor, 2));
    }
    let mut obstacles = Map::new();
    let mut contacts = Vec::new();
    for (corner, [x, y]) in corners.iter().enumerate().take(3) {
        let footing = format!("footing {corner}");
        obstacles.insert(
            footing.clone(),
            json!({"kind": "plane", "point": [x, y, 0.0], "normal": [-0.1 * x, -0.1 * y, 1.0]}),
        );
        contacts.push(json!({"node": name(0, corner), "obstacle": footing, "friction": 0.4}));
    }
    let weight: Map<String, Value> = nodes.keys().map(|node| (node.clone(), json!([0.0, 0.0, -0.01]))).collect();
    let top = name(floors - 1, 0);
    serde_json::from_value(json!({
        "model": {"dimension": 3, "nodes": nodes, "supports": {name(0, 3): ["x", "y", "z"]}, "elements": elements,
            "obstacles": obstacles, "contacts": contacts,
            "stages": [{"name": "weight", "forces": weight, "until": {"load_above": 1.0}},
                       {"name": "wind", "forces": {top: [0.3, 0.2, 0.0]}, "until": {"load_above": 1.0}}]},
        "analysis": {"max_increments": 60}
    }))
    .expect("a request")
}

/// An arch of two chords whose crown is pushed down onto a floor; its feet stand in a pin and on a slope.
fn arch(panels: usize) -> JobRequest {
    let (mut nodes, mut elements) = (Map::new(), Vec::new());
    let mut bar = |first: String, second: String| {
        elements.push(json!({"kind": "bar", "nodes": [first, second], "axial_stiffness": 1000.0}));
    };
    for panel in 0..=panels {
        let angle = std::f64::consts::PI * (0.2 + 0.6 * panel as f64 / panels as f64);
        for (chord, radius) in [("a", 10.0), ("b", 10.4)] {
            nodes.insert(format!("{chord}{panel}"), json!([-radius * angle.cos(), radius * angle.sin()]));
        }
        bar(format!("a{panel}"), format!("b{panel}"));
        if panel > 0 {
            for (from, to) in [("a", "a"), ("b", "b"), ("a", "b"), ("b", "a")] {
                bar(format!("{from}{}", panel - 1), format!("{to}{panel}"));
            }
        }
    }
    let foot = &nodes[&format!("a{panels}")];
    serde_json::from_value(json!({
        "model": {"dimension": 2, "supports": {"a0": ["x", "y"], "b0": ["x", "y"]}, "elements": elements,
            "obstacles": {"slope": {"kind": "plane", "point": foot, "normal": [-0.2, 1.0]}},
            "contacts": [{"node": format!("a{panels}"), "obstacle": "slope", "friction": 0.3}],
            "nodes": nodes, "stages": [{"name": "crown", "forces": {format!("b{}", panels / 2): [0.1, -1.0]}}]},
        "analysis": {"max_increments": 12, "arc_length": {"max": 0.02}}
    }))
    .expect("a request")
}

/// By the measure, and by a sum over what the increments report.
#[test]
fn towers_and_arches_are_in_equilibrium_as_a_whole() {
    for (what, mut request) in [("a tower of 60 nodes", tower(15)), ("an arch of 600 nodes", arch(299))] {
        let elements = Some(RecordedElements::Range(ForceRange::All));
        request.analysis.record = Some(Record { elements, ..Record::default() });
        let (nodes, dimension) = (request.model.nodes.len(), request.model.dimension);
        assert_eq!(nodes, if dimension == 3 { 60 } else { 600 });
        let traced = judged(&request);
        let largest = traced.errors.iter().map(|errors| errors.global_equilibrium).fold(0.0, f64::max);
        assert!(largest <= 1e-10, "{what}: {largest:e}");
        assert!(traced.increments.len() > 10, "{what}: {}", traced.report.sentence);
        for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
            assert!(errors.largest_of_state() <= 1e-10, "{what}, {}: {errors:?}", increment.index);
            assert_eq!(increment.elements.len(), request.model.elements.len());
            let largest = increment.elements.iter().filter_map(|state| state.axial_force);
            let size = largest.fold(1.0_f64, |size, axial| size.max(axial.abs()));
            for k in 0..dimension {
                let of_contacts: f64 = increment.contacts.iter().map(|contact| contact.reaction[k]).sum();
                let of_supports: f64 = increment.supports.values().map(|reaction| reaction[k]).sum();
                close(of_contacts + of_supports + increment.applied_forces[k], 0.0, 1e-10 * size, what);
            }
        }
    }
}

/// Each figure that is falsified is found by the measure.
#[test]
fn a_false_force_is_found() {
    let request = scene("arch-type-truss");
    let traced = judged(&request);
    type Falsify = fn(&mut Increment);
    let falsified: [(&str, Falsify); 6] = [
        ("axial force", |increment| {
            increment.elements[1].axial_force = increment.elements[1].axial_force.map(|n| n + 1e-6)
        }),
        ("reaction of a contact", |increment| increment.contacts[0].reaction[1] += 1e-6),
        ("applied force", |increment| increment.applied_forces[0] += 1e-6),
        ("total slip", |increment| increment.contacts[0].slip_total[0] += 1e-6),
        ("element", |increment| increment.elements.swap(0, 1)),
        ("reaction of a support", |increment| {
            let name = increment.supports.keys().next().expect("a support").to_string();
            increment.supports[&name][0] += 1e-6;
        }),
    ];
    for (what, falsify) in falsified {
        let mut judge = judge(&request, &traced.plan);
        for (increment, honest) in traced.increments.iter().zip(&traced.errors) {
            let mut increment = increment.clone();
            let last = increment.index == 20;
            if last {
                falsify(&mut increment);
            }
            let errors = judge.judge(&increment);
            if last {
                assert!(errors.largest_of_state() > 1e-8, "{what}: {errors:?}");
                break;
            }
            assert_eq!(errors, *honest);
        }
    }
}

#[test]
fn elements_and_supports_are_recorded_as_asked() {
    let listed = vec![ElementReference::Place(2), ElementReference::Name("crown".to_owned())];
    let mut request = recorded(
        "arch-type-truss",
        Record {
            elements: Some(RecordedElements::Listed(listed)),
            supports: Some(RecordedSupports::Named(Vec::new())),
            ..Record::default()
        },
    );
    if let arcslip::model::request::Element::Bar { name, .. } = &mut request.model.elements[0] {
        *name = Some("crown".to_owned());
    }
    let kept: Vec<Increment> = {
        let scene = arcslip::continuation::scene::Scene::new(&request).expect("a scene");
        let cancel = arcslip::resources::cancel::CancelFlag::default();
        arcslip::check::judged::JudgedPath::new(&request, &scene, cancel).map(|judged| judged.increment).collect()
    };
    for increment in &kept {
        let states = &increment.elements;
        let places: Vec<(u64, Option<&str>)> =
            states.iter().map(|state| (state.element, state.name.as_deref())).collect();
        assert_eq!(places, [(0, Some("crown")), (2, None)]);
        assert!(increment.supports.is_empty());
    }
    let header = Table::of(&request).header();
    assert!(header.contains(",elements/crown.axial_force,elements/2.axial_force,applied_force_x,"), "{header}");
    assert!(!header.contains("elements/1."), "{header}");
}

/// More than 200 elements or supports have no forces unless they are asked for.
#[test]
fn many_elements_have_no_forces_unasked() {
    let mut request = arch(60);
    request.analysis.max_increments = 2;
    let (increments, _) = trace(&request);
    assert!(request.model.elements.len() > 200);
    assert!(increments.iter().all(|increment| increment.elements.is_empty() && increment.supports.len() == 2));
    assert!(!Table::of(&request).header().contains("elements/"));
}

/// Two contacts of one node with one obstacle have columns of their own.
#[test]
fn contacts_of_the_same_two_are_told_apart() {
    let mut request = scene("one-bar-truss");
    let again = request.model.contacts[0].clone();
    let label = format!("{}/{}", again.node, again.counterpart());
    request.model.contacts.push(again);
    let names = Table::of(&request).names();
    let unlike: std::collections::HashSet<&String> = names.iter().collect();
    assert_eq!(unlike.len(), names.len());
    for wanted in [format!("{label}.gap"), format!("{label}#2.gap")] {
        assert!(names.contains(&wanted), "{wanted}: {names:?}");
    }
}

#[test]
fn a_table_has_the_forces_of_the_increments() {
    let request = scene("one-bar-truss");
    let traced = judged(&request);
    let table = Table::of(&request);
    let header = table.header();
    let columns: Vec<&str> = header.trim_end().split(',').collect();
    for (increment, errors) in traced.increments.iter().zip(&traced.errors).filter(|(one, _)| one.point.event.is_none())
    {
        let row = table.row(increment, Some(errors));
        let cells: Vec<&str> = row.trim_end().split(',').collect();
        assert_eq!(cells.len(), columns.len());
        let cell = |name: &str| -> f64 {
            let place = columns.iter().position(|column| *column == name).unwrap_or_else(|| panic!("{name}: {header}"));
            cells[place].parse().expect("a number")
        };
        let contact = &increment.contacts[0];
        assert_eq!(cell("elements/0.axial_force"), increment.elements[0].axial_force.expect("a bar"));
        assert_eq!(cell("pin.reaction.y"), increment.supports["pin"][1]);
        assert_eq!(cell("tip/floor.reaction.x"), contact.reaction[0]);
        assert_eq!(cell("tip/floor.slip_total.1"), contact.slip_total[0]);
        assert_eq!(cell("applied_force_x"), increment.applied_forces[0]);
        assert_eq!(cell("measure.global_equilibrium"), errors.global_equilibrium);
    }
}

#[test]
fn mistakes_in_names_and_records_are_told_with_what_would_do() {
    let told = |change: fn(&mut JobRequest)| {
        let mut request = scene("arch-type-truss");
        change(&mut request);
        arcslip::model::check::check(&request).expect_err("a mistake").to_string()
    };
    let text = told(|request| {
        for place in [0, 1] {
            if let arcslip::model::request::Element::Bar { name, .. } = &mut request.model.elements[place] {
                *name = Some("rod".to_owned());
            }
        }
    });
    assert!(text.contains("element 0 has the name `rod`, too"), "{text}");
    let text = told(|request| {
        if let arcslip::model::request::Element::Bar { name, .. } = &mut request.model.elements[0] {
            *name = Some("17".to_owned());
        }
    });
    assert!(text.contains("digits alone are an element's place"), "{text}");
    let text = told(|request| {
        let elements = vec![ElementReference::Place(999), ElementReference::Name("rood".to_owned())];
        request.analysis.record =
            Some(Record { elements: Some(RecordedElements::Listed(elements)), ..Record::default() });
    });
    assert!(text.contains("there is no element 999; 0 to") && text.contains("there is no element `rood`"), "{text}");
    let text = told(|request| {
        request.model.supports.insert("b1".to_owned(), vec![Component::X]);
        let supports = vec!["nowhere".to_owned()];
        request.analysis.record =
            Some(Record { supports: Some(RecordedSupports::Named(supports)), ..Record::default() });
    });
    assert!(text.contains("there is no support at a node `nowhere`"), "{text}");
}
