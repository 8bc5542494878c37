//! Distances, events and orders of curves that are known.

use crate::model::request::Method;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::PointKind;
use crate::result::stop_reason::StopReason;
use crate::studies::error_against_time::curve::Curve;
use crate::studies::error_against_time::events::{self, EventsFound};
use crate::studies::error_against_time::matching;
use crate::studies::error_against_time::row::{StudyRow, Time, slope};
use crate::studies::error_against_time::trace::{ScaledPoint, StudyTrace, TracedEvent, TracedStage};

fn path_error(points: &[ScaledPoint], curve: &Curve) -> f64 {
    matching::path_error(points, curve, &CancelFlag::default())
}

fn through(points: Vec<ScaledPoint>, corners: &[usize]) -> Curve {
    let events = corners.iter().map(|point| TracedEvent { kind: PointKind::ContactChange, point: *point }).collect();
    Curve::interpolating(TracedStage { stage: 0, points, events })
}

/// A helix at uneven places: radius 1, rise 0.3 a turn, in four dimensions.
fn helix(angle: f64) -> ScaledPoint {
    vec![angle.cos(), angle.sin(), 0.3 * angle, 0.1]
}

/// Angles from 0 to 3 with a mean spacing, neighbours up to three times as far apart.
fn angles(count: u32) -> Vec<f64> {
    (0..=count).map(|k| f64::from(k) / f64::from(count)).map(|x| 3.0 * (x + 0.1 * (9.0 * x).sin() / 9.0)).collect()
}

#[test]
fn a_smooth_curve_is_followed_to_eighth_order() {
    let between: Vec<ScaledPoint> =
        (0..=500).map(|k| helix(3.0 * (1.0 + 0.1 * 9.0_f64.sin() / 9.0) * f64::from(k) / 500.0)).collect();
    let errors: Vec<f64> = [20, 40, 80]
        .iter()
        .map(|count| path_error(&between, &through(angles(*count).into_iter().map(helix).collect(), &[])))
        .collect();
    assert!(errors[0] < 1e-5 && errors[2] < 1e-9, "{errors:?}");
    // Eighth order: a factor of 256 each.
    assert!(errors[0] / errors[1] > 100.0 && errors[1] / errors[2] > 100.0, "{errors:?}");
}

#[test]
fn points_beside_a_curve_are_as_far_as_they_are() {
    let curve = through(angles(60).into_iter().map(helix).collect(), &[]);
    for aside in [1e-3, 1e-6, 1e-9] {
        let points: Vec<ScaledPoint> = (1..30)
            .map(|k| helix(0.1 * f64::from(k)))
            .map(|point| vec![point[0], point[1], point[2], 0.1 + aside])
            .collect();
        let error = path_error(&points, &curve);
        assert!((error / aside - 1.0).abs() < 1e-2, "{aside}: {error:e}");
    }
}

/// Two straight lines at an angle: with the corner known the curve is exact, without it is rounded off.
#[test]
fn corners_are_not_smoothed() {
    let along = |x: f64| if x <= 1.0 { vec![x, 0.0] } else { vec![1.0 + 0.8 * (x - 1.0), 0.6 * (x - 1.0)] };
    let points: Vec<ScaledPoint> = (0..=20).map(|k| along(f64::from(k) / 10.0)).collect();
    let between: Vec<ScaledPoint> = (0..=200).map(|k| along(f64::from(k) / 100.0)).collect();
    assert!(path_error(&between, &through(points.clone(), &[10])) < 1e-15);
    assert!(path_error(&between, &through(points, &[])) > 1e-4);
}

/// A path that turns back lies on the curve, point by point, and is no path along it.
#[test]
fn order_counts() {
    let line = |x: f64| vec![x, 0.0];
    let curve = through((0..=10).map(|k| line(f64::from(k))).collect(), &[]);
    let forth: Vec<ScaledPoint> = [0.0, 2.5, 5.0].map(line).to_vec();
    assert!(path_error(&forth, &curve) < 1e-15);
    let and_back: Vec<ScaledPoint> = [0.0, 2.5, 5.0, 3.0, 1.0].map(line).to_vec();
    // Best laid with 5 and 1 onto 3.
    assert!((path_error(&and_back, &curve) - 2.0).abs() < 0.05, "{}", path_error(&and_back, &curve));
}

/// A hairpin that a path cuts short is passed, and costs what is nearest.
#[test]
fn a_hairpin_that_is_cut_off_does_not_hold_the_rest_up() {
    let hairpin = |s: f64| match s {
        s if s <= 1.0 => vec![s, 0.0],
        s if s <= 1.1 => vec![1.0, s - 1.0],
        s => vec![2.1 - s, 0.1],
    };
    let curve = through((0..=31).map(|k| hairpin(0.1 * f64::from(k))).collect(), &[10, 11]);
    let cut: Vec<ScaledPoint> = [0.0, 0.3, 0.6, 1.5, 1.8, 2.1, 2.5, 3.0].map(hairpin).to_vec();
    assert!(path_error(&cut, &curve) < 1e-14, "{:e}", path_error(&cut, &curve));
}

#[test]
fn what_lies_past_the_end_is_as_far_as_the_end() {
    let curve = through((0..=10).map(|k| vec![f64::from(k), 1.0]).collect(), &[]);
    let past = path_error(&[vec![0.0, 1.0], vec![9.0, 1.0], vec![12.5, 1.0]], &curve);
    assert!((past - 2.5).abs() < 1e-12);
    assert_eq!(path_error(&[vec![0.0, 1.0]], &curve), 0.0);
    let point = through(vec![vec![0.0, 1.0]], &[]);
    assert!((path_error(&[vec![0.0, 1.5]], &point) - 0.5).abs() < 1e-15);
}

/// Two neighbours of a polynomial may nearly coincide: round-off must not be magnified between the others.
#[test]
fn points_that_nearly_coincide_do_no_harm() {
    let mut places = angles(40);
    let doubled: Vec<f64> = places.iter().map(|angle| angle + 1e-11).collect();
    places.extend(doubled.iter().take(40));
    places.sort_by(f64::total_cmp);
    let points: Vec<ScaledPoint> = (1..300).map(|k| helix(0.01 * f64::from(k))).collect();
    let error = path_error(&points, &through(places.into_iter().map(helix).collect(), &[]));
    assert!(error < 1e-7, "{error:e}");
}

#[test]
fn events_are_compared_as_a_sequence() {
    use PointKind::{ContactChange, End, NonsmoothLimit, SmoothLimit};
    let stage = |kinds: &[PointKind], shift: f64| TracedStage {
        stage: 0,
        points: (0..=kinds.len()).map(|k| vec![k as f64, shift]).collect(),
        events: kinds.iter().enumerate().map(|(k, kind)| TracedEvent { kind: *kind, point: k + 1 }).collect(),
    };
    let expected = [Curve::interpolating(stage(&[SmoothLimit, ContactChange, NonsmoothLimit, End], 0.0))];
    let found = |kinds: &[PointKind]| events::compare(&StudyTrace { stages: vec![stage(kinds, 0.5)] }, &expected);
    let all = found(&[SmoothLimit, ContactChange, NonsmoothLimit, End]);
    assert_eq!(all, EventsFound { expected: 4, found: 4, others: 0, largest_error: Some(0.5) });
    let one_missing = found(&[SmoothLimit, NonsmoothLimit, End]);
    assert_eq!((one_missing.found, one_missing.others), (3, 0));
    let one_more = found(&[SmoothLimit, SmoothLimit, ContactChange, NonsmoothLimit, End]);
    assert_eq!((one_more.found, one_more.others), (4, 1));
    let swapped = found(&[ContactChange, SmoothLimit, NonsmoothLimit, End]);
    assert_eq!((swapped.found, swapped.others), (3, 1));
    assert_eq!(found(&[]), EventsFound { expected: 4, found: 0, others: 0, largest_error: None });
}

fn row(mean_step: f64, path_error: f64, resolved: bool) -> StudyRow {
    StudyRow {
        row: 0,
        method: Method::Auto,
        value: 1.0,
        mean_step,
        path_error: Some(path_error),
        resolved,
        points_outside: 0,
        events: EventsFound { expected: 0, found: 0, others: 0, largest_error: None },
        largest_estimate: 0.0,
        increments: 1,
        factorisations: 1,
        newton_iterations: 1,
        qp_solves: 0,
        mpec_solves: 0,
        stop_reason: StopReason::StagesCompleted,
        time: None,
        order: None,
    }
}

#[test]
fn orders_are_slopes_of_what_is_resolved() {
    let rows = [0.1, 0.05, 0.02].map(|step: f64| row(step, 7.0 * step.powi(3), true));
    let found = slope(&rows.iter().collect::<Vec<_>>(), true);
    assert!((found.unwrap() - 3.0).abs() < 1e-12);
    let round_off = row(0.01, 1e-15, false);
    let found = slope(&[&rows[0], &rows[1], &round_off], true);
    assert!((found.unwrap() - 3.0).abs() < 1e-12);
    assert_eq!(slope(&[&rows[0], &round_off], true), None);
    // All at one value.
    assert_eq!(slope(&[&rows[0], &rows[1]], false), None);
}

#[test]
fn times_have_a_median_and_a_spread() {
    assert_eq!(Time::of(&[]), None);
    let time = Time::of(&[3.0, 1.0, 2.0, 10.0]).unwrap();
    assert_eq!((time.median_s, time.least_s, time.largest_s, time.repeats), (2.5, 1.0, 10.0, 4));
}
