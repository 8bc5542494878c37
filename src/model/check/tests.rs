//! The checks on requests that JSON text cannot express, and what must pass.

use super::check;
use crate::model::request::Element;
use crate::model::{JobRequest, decode::decode};
use crate::scenes;

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
        request.analysis.arc_length.min = value;
        let Element::Bar { axial_stiffness, .. } = &mut request.model.elements[0] else { panic!() };
        *axial_stiffness = value;
        let expected = [
            "/model/nodes/tip/1",
            "/model/elements/0/axial_stiffness",
            "/model/contacts/0/friction",
            "/model/stages/0/forces/tip/0",
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
