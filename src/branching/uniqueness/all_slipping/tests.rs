use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::feasible_direction::PriorMotion;
use crate::branching::selection::selection_rule;
use crate::branching::uniqueness::all_slipping::*;
use crate::check::scenes;
use crate::continuation::path::iterator::Path;
use crate::continuation::scene::Scene;
use crate::resources::cancel::CancelFlag;

/// At every point of the built-in scenes the directions found by the test are those that the full search lists.
#[test]
fn what_is_found_at_once_is_what_is_found_everywhere() {
    let mut found = 0;
    for built_in in scenes::ALL {
        let request = crate::model::decode::decode(built_in.request.as_bytes()).expect("a request");
        let mut scene = Scene::new(&request).expect("a scene");
        // Both dense and sparse matrices.
        for sparse in [false, true] {
            scene.structure.set_sparse(sparse);
            let mut path = Path::new(&scene, CancelFlag::default());
            while let Some(increment) = path.next() {
                let here = &path.trace.at.here;
                let (Some(incoming), true) = (&here.rate, increment.index > 0) else { continue };
                let standings = path.trace.standings(&here.state);
                let (loading, rules) = (path.trace.loading(), path.trace.rules());
                let Some(at_once) =
                    all_slipping_directions(loading, &here.state, &standings, &here.modes, incoming, rules)
                else {
                    continue;
                };
                let before = PriorMotion::Incoming(Incoming::along(incoming));
                let (everywhere, rest) = selection_rule::list(loading, &here.state, &standings, before, rules);
                let place = format!("{} {}", built_in.name, increment.index);
                assert_eq!((rest.unexplored, rest.degenerate), (0, false), "{place}");
                assert_eq!(at_once.len(), everywhere.len(), "{place}");
                for (one, other) in at_once.iter().zip(&everywhere) {
                    assert_eq!(one.modes, other.modes, "{place}");
                    assert_eq!(one.load_sign, other.load_sign, "{place}");
                    let mut difference = one.rate.clone();
                    difference.add(&other.rate, -1.0);
                    assert!(difference.size() < 1e-9, "{place}: {one:?} {other:?}");
                    let forces = 1e-9 * (1.0 + one.rate.largest_reaction());
                    assert!(difference.largest_reaction() < forces, "{place}: {difference:?}");
                    assert_eq!((one.retrace, one.mechanism), (other.retrace, other.mechanism), "{place}");
                    assert!((one.dissipation - other.dissipation).abs() < 1e-9, "{place}");
                    assert!((one.potential_rate - other.potential_rate).abs() < 1e-9, "{place}");
                }
                found += 1;
            }
        }
    }
    assert!(found > 500, "{found}");
}
