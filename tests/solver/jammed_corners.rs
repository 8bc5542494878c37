//! Random corners in space in which nodes are jammed: the cones of their two planes together are all of space, so that they stay.

use crate::common::paths::{Traced, judged, request};
use crate::common::variants::{in_reverse, in_units};
use arcslip::model::JobRequest;
use arcslip::result::stop_reason::StopReason;

const MODELS: [(&str, &str); 3] = [
    ("one node", include_str!("models/node-jammed-between-two-planes.json")),
    ("two nodes", include_str!("models/two-nodes-one-jammed.json")),
    ("two nodes in bowls", include_str!("models/two-nodes-in-bowls-before-planes.json")),
];

fn traced(request: &JobRequest, what: &str) -> Traced {
    let traced = judged(request);
    assert_eq!(traced.report.stop_reason, StopReason::StagesCompleted, "{what}: {:?}", traced.increments.last());
    for (increment, errors) in traced.increments.iter().zip(&traced.errors) {
        assert!(errors.largest_of_state() <= 1e-10 && errors.energy <= 1e-6, "{what}: {} {errors:?}", increment.index);
    }
    traced
}

#[test]
fn every_order_unit_and_arc_length_leads_to_the_end_of_the_stages() {
    for (name, model) in MODELS {
        let plain = request(model);
        let mut longer = plain.clone();
        (longer.analysis.arc_length.initial, longer.analysis.arc_length.max) = (0.1, 0.4);
        let mut only_contacts = plain.clone();
        only_contacts.model.contacts.reverse();
        let others = [
            ("contacts reversed", only_contacts, 1.0),
            ("reversed", in_reverse(plain.clone()), 1.0),
            ("in other units", in_units(plain.clone(), 1e3, 1e-6), 1e3),
            ("in units of another size", in_units(plain.clone(), 1e-3, 1e3), 1e-3),
            ("with longer steps", longer, 1.0),
        ];
        let end = |traced: &Traced| traced.increments.last().expect("an end").displacements.clone();
        let own = end(&traced(&plain, name));
        for (how, request, length) in others {
            let other = end(&traced(&request, &format!("{name}, {how}")));
            for (node, u) in own.iter() {
                for (a, b) in u.iter().zip(&other[node]) {
                    assert!((a - b / length).abs() <= 1e-5, "{name}, {how}: {node} at {a} and {b}");
                }
            }
        }
    }
}
