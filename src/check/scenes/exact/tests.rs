//! The built-in scenes of each family are recognised, and no other scene is recognised.

use crate::check::scenes;
use crate::check::scenes::exact::{CurvePlace, Exact, Reach, recognise};
use crate::model::JobRequest;
use crate::model::decode::decode;
use crate::result::increment::PointKind;

fn request(name: &str) -> JobRequest {
    let scene = scenes::find(name).unwrap();
    decode(scene.request.as_bytes()).unwrap()
}

fn exact(name: &str) -> Exact {
    recognise(&request(name)).unwrap()
}

const REACH: Reach = Reach { load: 5.0, displacement: 10.0 };

/// The events of a stage: kind and place.
fn events(exact: &Exact, stage: usize) -> Vec<(PointKind, CurvePlace)> {
    let pieces = exact.stages(REACH).swap_remove(stage).pieces;
    pieces.iter().filter_map(|piece| Some((piece.ends_with?, piece.at(piece.to)))).collect()
}

fn close(found: f64, exact: f64) {
    assert!((found - exact).abs() < 1e-12, "found {found:e}, exact {exact:e}");
}

#[test]
fn families_know_their_scenes_and_no_others() {
    let known: Vec<&str> =
        scenes::ALL.iter().filter(|scene| recognise(&request(scene.name)).is_some()).map(|scene| scene.name).collect();
    let expected = [
        "one-bar-truss",
        "one-bar-truss-rough",
        "klarbring",
        "slider-chain",
        "curving-slip",
        "turning-drag",
        "hump",
        "bowl",
        "von-mises-truss",
    ];
    assert_eq!(known, expected);
}

#[test]
fn another_selection_or_anything_else_in_the_model_has_no_exact_path() {
    let mut selected = request("one-bar-truss");
    selected.analysis.selection = crate::model::request::Selection::Straightest;
    assert!(recognise(&selected).is_none());
    let changes: [fn(&mut crate::model::Model); 6] = [
        |model| model.nodes["tip"][1] = 1e-3,
        |model| model.stages[0].forces["tip"][1] = 0.1,
        |model| model.stages[0].forces["tip"][0] = -1.0,
        |model| model.supports["pin"].truncate(1),
        |model| {
            let again = model.contacts[0].clone();
            model.contacts.push(again);
        },
        |model| {
            let again = model.stages[0].clone();
            model.stages.push(again);
        },
    ];
    for change in changes {
        let mut request = request("one-bar-truss");
        change(&mut request.model);
        assert!(recognise(&request).is_none(), "{:?}", request.model);
    }
}

/// The limit points of the table in the formulation.
#[test]
fn the_one_bar_truss_turns_where_it_is_known_to() {
    let found = events(&exact("one-bar-truss"), 0);
    let kinds: Vec<_> = found.iter().map(|(kind, _)| *kind).collect();
    assert_eq!(kinds, [PointKind::SmoothLimit, PointKind::SmoothLimit, PointKind::End]);
    for ((_, place), (x, s)) in
        found.iter().zip([(-0.557709058500982, 0.2733153855772578), (0.8506427737191122, -0.1139816591452569)])
    {
        close(place.displacements[2] - 1.5, x);
        close(place.load, s);
    }
    close(found[2].1.displacements[2], 3.0);
}

#[test]
fn pieces_join_and_events_are_at_their_places() {
    for (name, stage, loads) in [
        ("klarbring", 1, vec![1.5, 1.25, 3.0]),
        ("slider-chain", 1, vec![0.5, 1.0, 1.5, 2.0, 2.5]),
        ("turning-drag", 1, vec![0.5, 0.75]),
    ] {
        let found: Vec<f64> = events(&exact(name), stage).iter().map(|(_, place)| place.load).collect();
        assert_eq!(found.len(), loads.len(), "{name}: {found:?}");
        found.iter().zip(loads).for_each(|(found, load)| close(*found, load));
    }
    for scene in scenes::ALL {
        let Some(exact) = recognise(&request(scene.name)) else { continue };
        let mut before: Option<Vec<f64>> = None;
        for stage in exact.stages(REACH) {
            let mut load = 0.0;
            for piece in &stage.pieces {
                let start = piece.at(piece.from);
                close(start.load, load);
                for (found, before) in start.displacements.iter().zip(before.iter().flatten()) {
                    close(*found, *before);
                }
                let end = piece.at(piece.to);
                (load, before) = (end.load, Some(end.displacements));
            }
        }
        assert!(!exact.name().is_empty() && !exact.formula().is_empty());
    }
}

/// Limit loads of the published problems in closed form: `P = 2 EA (1 - cos^(2/3) α)^(3/2)` and, with Green strain,
/// `2 EA (h/L0)³/(3√3)`.
#[test]
fn the_von_mises_truss_turns_where_it_is_known_to() {
    use crate::model::request::{Element, Strain};
    let cosine = 1.0 / 1.0_f64.hypot(0.5);
    let engineering = 2.0 * (1.0 - cosine.powf(2.0 / 3.0)).powf(1.5);
    let green = 2.0 * (0.5 * cosine).powi(3) / (3.0 * 3.0_f64.sqrt());
    for (measure, load) in [(Strain::Engineering, engineering), (Strain::Green, green)] {
        let mut request = request("von-mises-truss");
        for element in &mut request.model.elements {
            let Element::Bar { strain, .. } = element else { continue };
            *strain = measure;
        }
        let found = events(&recognise(&request).unwrap(), 0);
        let kinds: Vec<_> = found.iter().map(|(kind, _)| *kind).collect();
        assert_eq!(kinds, [PointKind::SmoothLimit, PointKind::SmoothLimit, PointKind::End]);
        close(found[0].1.load, load);
        close(found[1].1.load, -load);
        close(found[2].1.displacements[3], -1.2);
    }
}
