//! `analysis.record`: what is not asked for is left out after every increment was judged; nothing else changes.

use crate::common::paths::scene;
use arcslip::check::judged::{JudgedIncrement, JudgedPath, JudgedReport};
use arcslip::continuation::scene::Scene;
use arcslip::model::JobRequest;
use arcslip::model::request::{
    ForceRange, Record, RecordedContact, RecordedContacts, RecordedElements, RecordedSupports,
};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::increment::{Increment, PointKind};

struct Whole {
    increments: Vec<JudgedIncrement>,
    /// Increment and direction.
    alternatives: Vec<(u64, u64)>,
    /// Increments at which the path can be left along another direction.
    junctions: Vec<u64>,
    report: JudgedReport,
}

fn whole(request: &JobRequest) -> Whole {
    let scene = Scene::new(request).unwrap_or_else(|errors| panic!("{errors}"));
    let mut path = JudgedPath::new(request, &scene, CancelFlag::default());
    let (mut increments, mut alternatives, mut junctions) = (Vec::new(), Vec::new(), Vec::new());
    while let Some(mut judged) = path.next() {
        let index = judged.increment.index;
        alternatives.extend(path.alternatives().iter().map(|direction| (index, *direction)));
        if !path.open_directions().is_empty() {
            let checkpoint = path.checkpoint().expect("a checkpoint where directions are listed");
            assert_eq!(checkpoint.path.index(), index);
            junctions.push(index);
        }
        judged.increment.diagnostics.elapsed_s = 0.0;
        increments.push(judged);
    }
    let mut report = path.report().expect("an ended path has a report");
    report.report.elapsed_s = 0.0;
    Whole { increments, alternatives, junctions, report }
}

fn recorded(name: &str, record: Record) -> JobRequest {
    let mut request = scene(name);
    request.analysis.record = Some(record);
    request
}

fn is_event(increment: &Increment) -> bool {
    increment.point.kind != PointKind::Regular || increment.point.event.is_some()
}

#[test]
fn thinned_rows_are_those_of_the_whole_path() {
    for built_in in arcslip::check::scenes::ALL {
        let all = whole(&scene(built_in.name));
        let thinned = whole(&recorded(built_in.name, Record { every: 7, ..Record::default() }));
        let last = all.increments.last().expect("an increment").increment.index;
        let first_seen = |index: u64| all.alternatives.iter().any(|(at, _)| *at == index);
        let expected: Vec<&JudgedIncrement> = all
            .increments
            .iter()
            .filter(|JudgedIncrement { increment, .. }| {
                let index = increment.index;
                is_event(increment) || index % 7 == 0 || index == last || first_seen(index)
            })
            .collect();
        assert_eq!(thinned.increments.iter().collect::<Vec<_>>(), expected, "{}", built_in.name);
        assert_eq!(thinned.alternatives, all.alternatives, "{}", built_in.name);
        assert_eq!(thinned.report, all.report, "{}", built_in.name);
        let stored = |index: &&u64| expected.iter().any(|judged| judged.increment.index == **index);
        let junctions: Vec<u64> = all.junctions.iter().filter(stored).copied().collect();
        assert_eq!(thinned.junctions, junctions, "{}", built_in.name);
    }
}

#[test]
fn the_last_row_is_kept_where_nothing_ends_there_and_can_be_left() {
    let mut request = scene("arch-type-truss");
    // On the falling stretch, where other directions are listed.
    let falling = whole(&request).junctions;
    let last = *falling.iter().rev().nth(1).expect("a stretch of bifurcation points");
    request.analysis.max_increments = last;
    let all = whole(&request);
    request.analysis.record = Some(Record { every: 1_000, ..Record::default() });
    let thinned = whole(&request);
    assert_eq!(thinned.increments.last(), all.increments.last());
    assert_eq!(thinned.junctions.last(), Some(&last));
    assert!(thinned.increments.len() < all.increments.len());

    // A path that begins there is the same.
    let beginning = |request: &JobRequest| {
        let scene = Scene::new(request).expect("a scene");
        let mut path = JudgedPath::new(request, &scene, CancelFlag::default());
        path.by_ref().last();
        let checkpoint = path.checkpoint().expect("a checkpoint");
        let other = path.open_directions().iter().rposition(|open| *open).expect("an open direction");
        let mut longer = request.clone();
        (longer.analysis.max_increments, longer.analysis.record) = (5, None);
        let scene = Scene::new(&longer).expect("a scene");
        let followed =
            JudgedPath::follow(&longer, &scene, checkpoint, other, "from there".to_owned(), CancelFlag::default());
        let mut increments: Vec<JudgedIncrement> = followed.expect("a path").collect();
        increments.iter_mut().for_each(|judged| judged.increment.diagnostics.elapsed_s = 0.0);
        increments
    };
    let followed = beginning(&request);
    assert!(followed.len() > 2);
    request.analysis.record = None;
    assert_eq!(followed, beginning(&request));
}

#[test]
fn nodes_contacts_and_directions_are_cut_after_the_judgement() {
    let all = whole(&scene("arch-type-truss"));
    let contact = RecordedContact { node: "b4".to_owned(), obstacle: "floor".to_owned() };
    let record = Record {
        nodes: Some(vec!["b4".to_owned(), "b2".to_owned()]),
        contacts: Some(RecordedContacts::Named(vec![contact])),
        ..Record::default()
    };
    let cut = whole(&recorded("arch-type-truss", record));
    assert_eq!(cut.report, all.report);
    assert_eq!((&cut.alternatives, &cut.junctions), (&all.alternatives, &all.junctions));
    assert_eq!(cut.increments.len(), all.increments.len());
    let mut listed = 0;
    for (cut, all) in cut.increments.iter().zip(&all.increments) {
        assert_eq!(cut.measure, all.measure);
        let (cut, all) = (&cut.increment, &all.increment);
        let names: Vec<&str> = cut.displacements.keys().map(|name| &**name).collect();
        assert_eq!(names, ["b2", "b4"], "in the model's order");
        assert!(cut.displacements.iter().all(|(name, values)| all.displacements[&**name] == *values));
        let place = all.contacts.iter().position(|contact| &*contact.node == "b4").expect("the foot's contact");
        assert_eq!(cut.contacts, [all.contacts[place].clone()]);
        for (cut, all) in cut.directions.iter().flatten().zip(all.directions.iter().flatten()) {
            assert_eq!(cut.contacts, [all.contacts[place]]);
            listed += 1;
        }
    }
    assert!(listed > 0);

    let without = whole(&recorded("arch-type-truss", Record { directions: false, ..Record::default() }));
    assert!(without.junctions.is_empty() && without.increments.iter().all(|row| row.increment.directions.is_none()));
    assert_eq!(without.report, all.report);
    let none = RecordedContacts::Named(Vec::new());
    let nothing = Record {
        nodes: Some(Vec::new()),
        contacts: Some(none),
        elements: Some(RecordedElements::Range(ForceRange::None)),
        supports: Some(RecordedSupports::Range(ForceRange::None)),
        every: 1_000,
        directions: false,
        stability: false,
    };
    let bytes = |whole: &Whole| serde_json::to_string(&whole.increments).expect("written").len();
    assert!(4 * bytes(&whole(&recorded("arch-type-truss", nothing))) < bytes(&all));
}
