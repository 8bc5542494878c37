//! The checks on requests that JSON text cannot express, and what must pass.

use crate::check::scenes;
use crate::model::JobRequest;
use crate::model::check::check;
use crate::model::decode::decode;
use crate::model::request::{Component, Contact, DisplacementBound, Element, Obstacle, Side, Until};

fn one_bar() -> JobRequest {
    decode(scenes::find("one-bar-truss").unwrap().request.as_bytes()).unwrap()
}

fn pointers(request: &JobRequest) -> Vec<String> {
    check(request).err().unwrap_or_default().0.into_iter().map(|error| error.pointer).collect()
}

#[test]
fn built_in_scenes_decode_and_check_clean() {
    for scene in scenes::ALL {
        let request = decode(scene.request.as_bytes()).unwrap_or_else(|errors| panic!("{}: {errors}", scene.name));
        assert_eq!(check(&request), Ok(()), "{}", scene.name);
    }
}

#[test]
fn numbers_that_are_not_finite_are_refused_everywhere() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut request = one_bar();
        request.model.nodes["tip"][1] = value;
        request.model.contacts[0].friction = value;
        request.model.stages[0].forces["tip"][0] = value;
        request.model.stages[0].displacements.insert("pin".to_owned(), vec![0.0, value]);
        request.model.stages[0].obstacle_motion.insert("floor".to_owned(), vec![value, 0.0]);
        request
            .model
            .obstacles
            .insert("drum".to_owned(), Obstacle::Ball { center: vec![value, 0.0], radius: value, side: Side::Inside });
        request.analysis.arc_length.min = value;
        let Element::Bar { axial_stiffness, .. } = &mut request.model.elements[0] else { panic!() };
        *axial_stiffness = value;
        let expected = [
            "/model/nodes/tip/1",
            "/model/elements/0/axial_stiffness",
            "/model/obstacles/drum/center/0",
            "/model/obstacles/drum/radius",
            "/model/contacts/0/friction",
            "/model/stages/0/forces/tip/0",
            "/model/stages/0/displacements/pin/1",
            "/model/stages/0/obstacle_motion/floor/0",
            "/analysis/arc_length/min",
        ];
        assert_eq!(pointers(&request), expected);
    }
}

#[test]
fn units_far_apart_are_taken() {
    for scale in [1e-30, 1e-12, 1e12, 1e30] {
        let mut request = one_bar();
        for position in request.model.nodes.values_mut() {
            position.iter_mut().for_each(|coordinate| *coordinate *= scale);
        }
        assert_eq!(check(&request), Ok(()), "{scale:e}");
    }
}

#[test]
fn rounding_is_not_penetration() {
    let mut request = one_bar();
    request.model.nodes["tip"][1] = -1e-13;
    assert_eq!(check(&request), Ok(()));
    request.model.nodes["tip"][1] = -1e-11;
    assert_eq!(pointers(&request), ["/model/contacts/0"]);
}

#[test]
fn a_force_on_a_support_is_taken_beside_another() {
    let mut request = one_bar();
    request.model.stages[0].forces.insert("pin".to_owned(), vec![1.0, 1.0]);
    assert_eq!(check(&request), Ok(()));
}

/// One bar with its tip on top of a ball of that radius.
fn bar_on_a_ball(radius: f64, side: Side) -> JobRequest {
    let mut request = one_bar();
    let below = if side == Side::Outside { -radius } else { radius };
    let tip = &request.model.nodes["tip"];
    let center = vec![tip[0], tip[1] + below];
    request.model.obstacles["floor"] = Obstacle::Ball { center, radius, side };
    request
}

#[test]
fn rounding_is_not_penetration_of_a_ball() {
    for side in [Side::Outside, Side::Inside] {
        for (radius, rounding, deep) in [(1.0, 1e-13, 1e-11), (1e6, 1e-10, 1e-8)] {
            let deeper = |depth: f64| {
                let mut request = bar_on_a_ball(radius, side);
                let Obstacle::Ball { radius, .. } = &mut request.model.obstacles["floor"] else { panic!() };
                *radius += if side == Side::Outside { depth } else { -depth };
                pointers(&request)
            };
            assert_eq!(deeper(0.0), [""; 0], "{side:?} {radius}");
            assert_eq!(deeper(rounding), [""; 0], "{side:?} {radius}");
            assert_eq!(deeper(deep), ["/model/contacts/0"], "{side:?} {radius}");
        }
    }
}

#[test]
fn balls_of_all_units_are_taken() {
    for scale in [1e-30, 1e-12, 1e12, 1e30] {
        let mut request = bar_on_a_ball(2.0, Side::Inside);
        for position in request.model.nodes.values_mut() {
            position.iter_mut().for_each(|coordinate| *coordinate *= scale);
        }
        let Obstacle::Ball { center, radius, .. } = &mut request.model.obstacles["floor"] else { panic!() };
        center.iter_mut().for_each(|coordinate| *coordinate *= scale);
        *radius *= scale;
        assert_eq!(check(&request), Ok(()), "{scale:e}");
    }
}

#[test]
fn a_partly_supported_node_may_face_a_ball_ahead() {
    // Free along x alone: the ball's normal there is along y until the node has moved.
    let mut request = bar_on_a_ball(1.0, Side::Outside);
    request.model.supports.insert("tip".to_owned(), vec![Component::Y]);
    assert_eq!(pointers(&request), ["/model/contacts/0/node"]);
    let Obstacle::Ball { center, .. } = &mut request.model.obstacles["floor"] else { panic!() };
    center[1] -= 0.5;
    assert_eq!(check(&request), Ok(()));
}

#[test]
fn one_node_may_face_one_obstacle_twice_and_several() {
    let mut request = one_bar();
    let contact = request.model.contacts[0].clone();
    let floor = request.model.obstacles["floor"].clone();
    request.model.obstacles.insert("floor again".to_owned(), floor);
    request.model.contacts.push(contact.clone());
    request.model.contacts.push(Contact { obstacle: "floor again".to_owned(), ..contact });
    assert_eq!(check(&request), Ok(()));
}

#[test]
fn a_support_or_an_obstacle_that_moves_is_a_load() {
    let mut displaced = one_bar();
    displaced.model.stages[0].forces.clear();
    let mut pushed = displaced.clone();
    let mut dragged = displaced.clone();
    displaced.model.stages[0].displacements.insert("pin".to_owned(), vec![0.1, 0.0]);
    pushed.model.contacts[0].friction = 0.0;
    pushed.model.stages[0].obstacle_motion.insert("floor".to_owned(), vec![0.1, 0.1]);
    dragged.model.stages[0].obstacle_motion.insert("floor".to_owned(), vec![0.1, 0.0]);
    for request in [displaced, pushed, dragged] {
        assert_eq!(check(&request), Ok(()), "{:?}", request.model.stages[0]);
    }
}

#[test]
fn a_stage_may_end_where_its_own_displacements_bring_a_support() {
    let mut request = one_bar();
    let bound = DisplacementBound { node: "pin".to_owned(), component: Component::X, above: Some(0.05), below: None };
    let mut second = request.model.stages[0].clone();
    second.name = "second".to_owned();
    second.until = Some(Until { displacement: Some(bound.clone()), ..Until::default() });
    request.model.stages[0].until = second.until.clone();
    request.model.stages[0].displacements.insert("pin".to_owned(), vec![0.1, 0.0]);
    assert_eq!(check(&request), Ok(()));
    request.model.stages.push(second);
    assert_eq!(pointers(&request), ["/model/stages/1/until/displacement/component"]);
}

#[test]
fn a_part_may_hang_on_contacts_with_a_ball_alone() {
    let mut request = bar_on_a_ball(1.0, Side::Outside);
    for (name, position) in [("a", [5.0, 5.0]), ("b", [6.0, 5.0])] {
        request.model.nodes.insert(name.to_owned(), position.to_vec());
    }
    let mut joined = request.model.elements[0].clone();
    let Element::Bar { nodes, .. } = &mut joined else { panic!() };
    *nodes = vec!["a".to_owned(), "b".to_owned()];
    request.model.elements.push(joined);
    assert_eq!(pointers(&request), ["/model/nodes/a"]);
    let contact = Contact { node: "b".to_owned(), ..request.model.contacts[0].clone() };
    request.model.contacts.push(contact);
    assert_eq!(check(&request), Ok(()));
}
