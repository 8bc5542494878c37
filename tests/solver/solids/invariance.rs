//! Units, axes and the order of input do not decide what a body of solids does.

use crate::common::paths::{request, trace};
use crate::common::variants::{in_reverse, in_units};
use crate::solids::blocks::block;
use crate::solids::meshes::Mesh;
use arcslip::JobRequest;
use serde_json::json;

/// The load factors of all events, with their words.
fn events(request: &JobRequest) -> Vec<(f64, String)> {
    let (increments, _) = trace(request);
    let of = |increment: &arcslip::Increment| Some((increment.load_factor, increment.point.event.clone()?));
    increments.iter().filter_map(of).collect()
}

#[test]
fn units_and_order_do_not_decide() {
    for (material, plane) in [("linear_elastic", "strain"), ("neo_hookean", "stress")] {
        let mesh = Mesh::new("quadrilateral4", &[8, 2], |[x, y, _]| [4.0 * x, y, 0.0]).distorted(0.1);
        let model = block(&mesh, &json!({"kind": material, "young": 10, "poisson": 0.3}), &json!({"plane": plane}));
        let posted = request(&model.to_string());
        let expected = events(&posted);
        assert!(expected.len() > 8, "{expected:?}");
        let others = [
            ("mm, N", in_units(posted.clone(), 1e3, 1e-3)),
            ("large", in_units(posted.clone(), 1e-9, 1e9)),
            ("reverse", in_reverse(posted.clone())),
        ];
        for (what, other) in others {
            let found = events(&other);
            assert_eq!(found.len(), expected.len(), "{material}, {what}");
            for ((load, words), (expected_load, expected_words)) in found.iter().zip(&expected) {
                assert!((load - expected_load).abs() < 1e-10, "{material}, {what}: {load} {expected_load} {words}");
                assert!(what == "reverse" || words == expected_words, "{material}, {what}: {words} {expected_words}");
            }
        }
    }
}
