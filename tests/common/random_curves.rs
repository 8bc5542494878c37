//! Random small scenes in the plane, their floors replaced by wavy ones.

use arcslip::model::JobRequest;
use arcslip::{Obstacle, Polyline};

use super::random::{Numbers, random_scene};

/// A scene of [`random_scene`] in the plane, on a curve that passes through the feet of its tips on the plane floor and
/// dips between them: a cubic spline, or a polygon with rounded corners.
pub fn random_on_curve(seed: u64) -> JobRequest {
    // Every fifth scene is in space.
    let mut request = random_scene(seed + seed / 4 + 1);
    assert_eq!(request.model.dimension, 2);
    let mut numbers = Numbers(seed ^ 0x5bd1_e995);
    let Obstacle::Plane { point, normal } = &request.model.obstacles["floor"] else { panic!("a plane") };
    let size = normal[0].hypot(normal[1]);
    let (normal, point) = ([normal[0] / size, normal[1] / size], point.clone());
    let along = [normal[1], -normal[0]];
    let place = |s: f64, height: f64| [0, 1].map(|k| point[k] + s * along[k] + height * normal[k]).to_vec();
    let tips = request.model.contacts.iter().filter(|contact| contact.obstacle == "floor").map(|contact| &contact.node);
    let mut feet: Vec<f64> =
        tips.map(|tip| (0..2).map(|k| (request.model.nodes[tip][k] - point[k]) * along[k]).sum()).collect();
    feet.sort_by(f64::total_cmp);
    // The feet are on edges, not on corners, which rounding moves.
    let is_polygon = seed.is_multiple_of(2);
    let (first, last) = (feet[0], feet[feet.len() - 1]);
    let mut heights = vec![(first - 1.6, 0.1), (first - 0.8, -numbers.between(0.05, 0.3))];
    for (number, foot) in feet.iter().enumerate() {
        if is_polygon {
            heights.extend([(*foot - 0.3, 0.0), (*foot + 0.3, 0.0)]);
        } else {
            heights.push((*foot, 0.0));
        }
        if let Some(next) = feet.get(number + 1) {
            heights.push((0.5 * (foot + next), -numbers.between(0.05, 0.3)));
        }
    }
    heights.extend([(last + 0.8, -numbers.between(0.05, 0.3)), (last + 1.6, 0.1)]);
    let points = heights.into_iter().map(|(s, height)| place(s, height)).collect();
    let rounding = is_polygon.then_some(0.2);
    request.model.obstacles["floor"] = Obstacle::Polyline(Polyline { points, rounding, ..Polyline::default() });
    request
}
