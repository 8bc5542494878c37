//! What a scene does not need is left out: with `keep_all` it is not, and the path is the same.

use crate::common::paths::{Traced, judged, scene};
use arcslip::model::JobRequest;
use arcslip::model::request::{Contact, ContactRange, Obstacle, Record, RecordedContact, RecordedContacts, Side};
use arcslip::result::increment::{Increment, Status};

const SAME: f64 = 1e-10;

fn near(one: f64, other: f64, place: &str) {
    assert!((one - other).abs() <= SAME * (1.0 + one.abs()), "{place}: {one:e} and {other:e}");
}

/// The same points, whatever contacts come after those of the first.
fn assert_same(one: &[Increment], other: &[Increment], name: &str) {
    assert_eq!(one.len(), other.len(), "{name}");
    for (one, other) in one.iter().zip(other) {
        let place = format!("{name}, increment {}", one.index);
        assert_eq!(one.point, other.point, "{place}");
        near(one.load_factor, other.load_factor, &place);
        near(one.step, other.step, &place);
        for (one, other) in one.displacements.values().flatten().zip(other.displacements.values().flatten()) {
            near(*one, *other, &place);
        }
        for (one, other) in one.contacts.iter().zip(&other.contacts) {
            assert_eq!((&one.node, &one.obstacle, one.status), (&other.node, &other.obstacle, other.status), "{place}");
            near(one.gap, other.gap, &place);
            near(one.normal_reaction, other.normal_reaction, &place);
            for (one, other) in one.tangential_reaction.iter().zip(&other.tangential_reaction) {
                near(*one, *other, &place);
            }
        }
        assert_eq!(one.directions.as_ref().map(Vec::len), other.directions.as_ref().map(Vec::len), "{place}");
        for (one, other) in one.directions.iter().flatten().zip(other.directions.iter().flatten()) {
            assert_eq!(one.contacts[..], other.contacts[..one.contacts.len()], "{place}");
            assert_eq!((one.taken, one.retrace, one.mechanism), (other.taken, other.retrace, other.mechanism));
        }
    }
}

/// Contacts of every free node that has one with balls that it never comes near.
fn with_far_contacts(mut request: JobRequest, number: usize) -> JobRequest {
    let model = &mut request.model;
    let nodes: Vec<String> = model.contacts.iter().map(|contact| contact.node.clone()).collect();
    if nodes.is_empty() {
        return request;
    }
    let reach = model.nodes.values().flatten().fold(1.0_f64, |most, value| most.max(value.abs()));
    for index in 0..number {
        let mut center = vec![1e3 * reach; model.dimension];
        center[0] += reach * index as f64;
        let name = format!("far {index}");
        model.obstacles.insert(name.clone(), Obstacle::Ball { center, radius: reach, side: Side::Outside });
        model.contacts.push(Contact::new(nodes[index % nodes.len()].clone(), name, 0.5));
    }
    request
}

fn kept(mut request: JobRequest) -> JobRequest {
    request.analysis.keep_all = true;
    request
}

#[test]
fn every_scene_has_one_path_with_and_without_savings() {
    let mut left_out = 0;
    for built_in in arcslip::check::scenes::ALL {
        let mut request = scene(built_in.name);
        request.analysis.arc_length.jump = false;
        let (saving, keeping) = (judged(&request), judged(&kept(request)));
        assert_same(&saving.increments, &keeping.increments, built_in.name);
        assert_eq!(saving.report.stop_reason, keeping.report.stop_reason);
        left_out += usize::from(saving.plan.left_out.len() > keeping.plan.left_out.len());
    }
    assert!(left_out > 0, "some scene has a contact that is out of reach at first");
}

#[test]
fn linear_structures_jump_from_event_to_event() {
    for (name, most) in [("slider-chain", 8), ("klarbring", 12)] {
        let request = scene(name);
        let (jumping, keeping) = (judged(&request), judged(&kept(request)));
        assert!(jumping.plan.left_out.iter().any(|left| left.what.starts_with("increments between events")), "{name}");
        assert!(jumping.increments.len() <= most && keeping.increments.len() >= 20, "{name}");
        assert!(jumping.errors.iter().all(|errors| errors.largest_of_state() <= 1e-12), "{name}");
        let events = |path: &[Increment]| {
            let named = path.iter().filter(|increment| increment.point.event.is_some());
            named.map(|increment| (increment.point.clone(), increment.stage.clone())).collect::<Vec<_>>()
        };
        assert_eq!(events(&jumping.increments), events(&keeping.increments), "{name}");
        // Every point of the path in steps lies on the straight line between two of the other.
        for point in &keeping.increments {
            let after = jumping
                .increments
                .iter()
                .position(|jump| jump.stage == point.stage && jump.arc_length >= point.arc_length - 1e-12);
            let after = &jumping.increments[after.expect("as long a path")];
            let before = &jumping.increments[after.index.saturating_sub(1) as usize];
            let part = (after.arc_length - point.arc_length) / after.step.max(f64::MIN_POSITIVE);
            let place = format!("{name}, increment {}", point.index);
            near(after.load_factor + part * (before.load_factor - after.load_factor), point.load_factor, &place);
            let ends = after.displacements.values().flatten().zip(before.displacements.values().flatten());
            for ((after, before), found) in ends.zip(point.displacements.values().flatten()) {
                near(after + part * (before - after), *found, &place);
            }
        }
    }
}

#[test]
fn far_contacts_change_nothing() {
    for built_in in arcslip::check::scenes::ALL {
        let alone = judged(&scene(built_in.name));
        let Traced { increments, errors, plan, .. } = judged(&with_far_contacts(scene(built_in.name), 12));
        assert_same(&alone.increments, &increments, built_in.name);
        assert!(errors.iter().all(|errors| errors.largest_of_state() <= 1e-10), "{}", built_in.name);
        let far = increments[0].contacts.len() > alone.increments[0].contacts.len();
        assert_eq!(far, plan.left_out.iter().any(|left| left.what.contains("until the path comes near")) && far);
    }
}

/// The request with so much of its contacts recorded.
fn recording(mut request: JobRequest, contacts: Option<RecordedContacts>) -> JobRequest {
    request.analysis.record = Some(Record { contacts, ..Record::default() });
    request
}

#[test]
fn of_many_contacts_those_out_of_reach_have_no_row_unless_asked_for() {
    let mut listed = 0;
    for name in ["one-bar-truss", "arch-type-truss", "curving-slip"] {
        let many = with_far_contacts(scene(name), 150);
        let own = scene(name).model.contacts.len();
        let short = judged(&many);
        assert!(
            short.plan.left_out.iter().any(|left| left.what.starts_with("rows of contacts out of reach")),
            "{name}"
        );
        assert!(short.errors.iter().all(|errors| errors.largest_of_state() <= 1e-10), "{name}");
        let all = judged(&recording(many.clone(), Some(RecordedContacts::Range(ContactRange::All))));
        assert_eq!(short.increments.len(), all.increments.len());
        for (short, all) in short.increments.iter().zip(&all.increments) {
            assert_eq!(all.contacts.len(), own + 150);
            assert!(short.contacts.len() <= own, "only the scene's own are reached");
            let kept: Vec<bool> = all.contacts.iter().map(|row| short.contacts.contains(row)).collect();
            let rest = all.contacts.iter().zip(&kept).filter(|(_, kept)| !**kept);
            assert!(rest.clone().all(|(row, _)| row.status == Status::Free && row.gap > 0.0));
            for (short, all) in short.directions.iter().flatten().zip(all.directions.iter().flatten()) {
                let statuses = all.contacts.iter().zip(&kept).filter(|(_, kept)| **kept);
                assert!(statuses.map(|(status, _)| status).eq(&short.contacts));
                listed += 1;
            }
        }
        if name == "arch-type-truss" {
            let Contact { node, obstacle, .. } = many.model.contacts[own + 15].clone();
            let asked = RecordedContacts::Named(vec![RecordedContact { node, obstacle }]);
            let named = judged(&recording(many, Some(asked)));
            for (named, all) in named.increments.iter().zip(&all.increments) {
                assert_eq!(named.contacts.last(), Some(&all.contacts[own + 15]));
                assert!(named.contacts.len() <= own + 1);
            }
        }
    }
    assert!(listed > 0, "directions are listed by the contacts that have rows");
}

#[test]
fn the_plan_names_the_contacts_that_are_left_out() {
    let request = with_far_contacts(scene("one-bar-truss"), 12);
    let plan = judged(&request).plan;
    let named = plan.left_out.iter().find(|left| left.what.starts_with("12 of 13 contacts")).expect("named");
    assert!(named.why.contains("cannot close"));
    let plan = judged(&kept(request)).plan;
    assert!(!plan.left_out.iter().any(|left| left.what.contains("of 13 contacts")));
}
