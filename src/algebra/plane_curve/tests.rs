use crate::algebra::plane_curve::{CurveMistake, PlaneCurve, PlanePoint};

fn circle(count: usize) -> Vec<PlanePoint> {
    (0..count).map(|k| (std::f64::consts::TAU * k as f64 / count as f64).sin_cos()).map(|(y, x)| [x, y]).collect()
}

#[test]
fn the_spline_through_a_circle_converges_to_it_with_the_fourth_order() {
    let error = |count: usize| {
        let curve = PlaneCurve::through(&circle(count), true).unwrap();
        (0..101)
            .map(|k| {
                let angle = 0.0613 * f64::from(k);
                let found = curve.closest([1.5 * angle.cos(), 1.5 * angle.sin()]);
                // Counter-clockwise: outside is to the right.
                (found.distance + 0.5).abs()
            })
            .fold(0.0, f64::max)
    };
    let errors = [16, 32, 64].map(error);
    assert!(errors[1] < errors[0] / 14.0 && errors[2] < errors[1] / 14.0, "{errors:?}");
    assert!(errors[2] < 1e-6, "{errors:?}");
}

/// The gradient of the distance is the normal, and the normal turns as the curvature says, everywhere near the curve.
#[test]
fn distance_normal_and_curvature_agree_with_differences() {
    let zigzag: [PlanePoint; 5] = [[-1.0, 0.0], [0.0, 0.0], [0.5, 0.7], [1.5, 0.6], [2.0, -0.4]];
    let curves = [
        PlaneCurve::rounded(&zigzag, false, 0.3).unwrap(),
        PlaneCurve::through(&zigzag, false).unwrap(),
        PlaneCurve::rounded(&circle(5), true, 0.4).unwrap(),
        PlaneCurve::through(&circle(7), true).unwrap(),
    ];
    let step = 1e-5;
    for curve in &curves {
        let mut compared = 0;
        for k in 0..400 {
            let place = [-1.5 + 4.0 * f64::from(k % 20) / 19.0, -1.0 + 2.2 * f64::from(k / 20) / 19.0];
            let here = curve.closest(place);
            if here.distance.abs() > 0.1 {
                continue;
            }
            compared += 1;
            let slope = [0, 1].map(|axis| {
                let [before, after] = [-step, step].map(|by| {
                    let mut moved = place;
                    moved[axis] += by;
                    curve.closest(moved)
                });
                let turn = [0, 1].map(|k| (after.normal[k] - before.normal[k]) / (2.0 * step));
                ((after.distance - before.distance) / (2.0 * step), turn)
            });
            for axis in 0..2 {
                assert!((slope[axis].0 - here.normal[axis]).abs() < 1e-8, "{place:?} {here:?} {slope:?}");
                let tangent = [here.normal[1], -here.normal[0]];
                for k in 0..2 {
                    // The third derivative is not continuous: at the joints of pieces the difference is of first order.
                    let turn = -here.curvature_at_place() * tangent[axis] * tangent[k];
                    assert!((slope[axis].1[k] - turn).abs() < 1e-3, "{place:?} {here:?} {slope:?} {turn}");
                }
            }
        }
        assert!(compared > 20, "{compared}");
    }
}

#[test]
fn the_closest_point_is_the_closest_of_many() {
    let points: Vec<PlanePoint> = (0..40).map(|k| [0.1 * f64::from(k), (0.9 * f64::from(k)).sin()]).collect();
    let curve = PlaneCurve::through(&points, false).unwrap();
    for k in 0..200 {
        let place = [0.5 + 0.015 * f64::from(k), (1.7 * f64::from(k)).cos() * 1.3];
        let found = curve.closest(place).distance.abs();
        let sampled = curve
            .pieces
            .iter()
            .flat_map(|piece| (0..=200).map(|step| super::at(piece, f64::from(step) / 200.0)[0]))
            .map(|foot| super::size(super::minus(foot, place)))
            .fold(f64::INFINITY, f64::min);
        assert!(found <= sampled + 1e-12 && found >= sampled - 1e-3, "{place:?}: {found} {sampled}");
    }
}

#[test]
fn the_sides_of_an_open_curve_reach_to_infinity() {
    let step = PlaneCurve::rounded(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [2.0, 1.0]], false, 0.25).unwrap();
    for (place, distance) in [([-100.0, 3.0], 3.0), ([100.0, 3.0], 2.0), ([-50.0, -1.0], -1.0), ([0.5, 0.4], 0.4)] {
        assert!((step.closest(place).distance - distance).abs() < 1e-14, "{place:?}");
    }
}

#[test]
fn points_that_give_no_curve_are_refused() {
    let corner = |rounding| PlaneCurve::rounded(&[[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [4.0, 3.0]], false, rounding);
    assert!(corner(1.0).is_ok());
    assert_eq!(corner(1.2).unwrap_err(), CurveMistake::NoRoom { point: 1, most: 1.0 });
    let through = |points: &[PlanePoint], closed| PlaneCurve::through(points, closed).unwrap_err();
    assert_eq!(through(&[[0.0, 0.0]], false), CurveMistake::TooFew { needed: 2 });
    assert_eq!(through(&[[0.0, 0.0], [1.0, 0.0]], true), CurveMistake::TooFew { needed: 3 });
    assert_eq!(through(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], false), CurveMistake::Coincident { point: 2 });
    assert_eq!(through(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.01]], false), CurveMistake::TurnsBack { point: 1 });
    let eight = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    assert!(matches!(PlaneCurve::rounded(&eight, true, 0.01), Err(CurveMistake::Crosses { .. })));
    let tangle = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [1.0, -2.0]];
    assert!(matches!(PlaneCurve::through(&tangle, false), Err(CurveMistake::Crosses { .. })));
}
