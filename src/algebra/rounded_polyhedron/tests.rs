use crate::algebra::rounded_polyhedron::filling::filling;
use crate::algebra::rounded_polyhedron::{PolyhedronMistake, RoundedPolyhedron};
use nalgebra::{Matrix3, Vector3};

type Mesh = (Vec<[f64; 3]>, Vec<[usize; 3]>);

/// A box with a corner at the origin.
fn box_of(sides: [f64; 3]) -> Mesh {
    let points = (0..8).map(|corner| std::array::from_fn(|k| ((corner >> k) & 1) as f64 * sides[k])).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    (points, faces.into_iter().flat_map(halves).collect())
}

/// A sphere of radius 1 about the origin: an octahedron whose triangles are cut in four so many times.
fn sphere(cuts: usize) -> Mesh {
    let mut points: Vec<Vector3<f64>> = Vec::new();
    for k in 0..3 {
        for sign in [1.0, -1.0] {
            let mut point = Vector3::zeros();
            point[k] = sign;
            points.push(point);
        }
    }
    let mut triangles = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..cuts {
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: usize, b: usize| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                points.push((points[a] + points[b]).normalize());
                points.len() - 1
            })
        };
        let cut = |[a, b, c]: [usize; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(cut).collect();
    }
    (points.into_iter().map(Into::into).collect(), triangles)
}

fn rounded((points, triangles): &Mesh, rounding: f64) -> RoundedPolyhedron {
    let surface = RoundedPolyhedron::new(points, triangles, rounding).unwrap();
    surface.check_rounding().unwrap();
    surface
}

#[test]
fn next_to_a_flat_face_the_share_is_that_of_a_cap() {
    let surface = rounded(&box_of([4.0, 3.0, 2.0]), 0.5);
    // `∫ (1 - z²)³ π/3 dz` over the cap, in multiples of the whole.
    let cap = |d: f64| 0.5 - 35.0 / 32.0 * (d - d.powi(3) + 0.6 * d.powi(5) - d.powi(7) / 7.0);
    // Above the diagonal of the face, along which two triangles meet.
    for distance in [-0.9, -0.5, -1e-3, -1e-9, -1e-17, 0.0, 1e-17, 1e-9, 0.3, 0.7] {
        let found = filling(&surface.polyhedron, &Vector3::new(4.0, 3.0, 4.0 + distance));
        assert!((found.share - cap(distance)).abs() < 1e-14, "{distance}: {}", found.share);
        assert!((found.gradient.z + 35.0 / 32.0 * (1.0 - distance * distance).powi(3)).abs() < 1e-14);
    }
}

#[test]
fn the_share_at_edges_and_corners_is_a_part_of_the_sphere() {
    let surface = rounded(&box_of([4.0, 3.0, 2.0]), 0.5);
    // Nearer and nearer to an edge, and to a corner.
    for near in [1e-3, 1e-7, 1e-11] {
        for (direction, share) in [([0.4, 1.0, 0.0], 0.25), ([-0.3, -0.8, 0.0], 0.25), ([0.7, 0.2, 0.5], 0.125)] {
            let corner = if share == 0.25 { Vector3::new(0.0, 0.0, 1.7) } else { Vector3::zeros() };
            let found = filling(&surface.polyhedron, &(corner + Vector3::from(direction) * near));
            assert!((found.share - share).abs() < 3.0 * near + 1e-14, "{near} {direction:?}: {}", found.share);
        }
    }
}

#[test]
fn derivatives_of_the_share_are_those_of_differences() {
    let surface = rounded(&box_of([4.0, 3.0, 2.0]), 0.5);
    for center in [[7.8, 5.7, 3.9], [0.1, 3.0, 0.2], [-0.1, -0.1, -0.15], [7.9, 3.0, 4.2], [8.2, 6.1, 4.3]] {
        let center = Vector3::from(center);
        let found = filling(&surface.polyhedron, &center);
        let step = 1e-5;
        let (mut gradient, mut second) = (Vector3::zeros(), Matrix3::zeros());
        for k in 0..3 {
            let mut along = Vector3::zeros();
            along[k] = step;
            let [after, before] = [center + along, center - along].map(|at| filling(&surface.polyhedron, &at));
            gradient[k] = (after.share - before.share) / (2.0 * step);
            second.set_column(k, &((after.gradient - before.gradient) / (2.0 * step)));
        }
        assert!((gradient - found.gradient).amax() < 1e-9, "{center}");
        assert!((second - found.second).amax() < 1e-8, "{center}");
    }
}

/// Distance, normal and curvatures agree with each other, at random places within twice the rounding.
#[test]
fn the_distance_has_the_normal_as_gradient_and_the_curvatures_as_its_change() {
    for (mesh, rounding, low, high) in
        [(box_of([4.0, 3.0, 2.0]), 0.5, [-0.5; 3], [4.5, 3.5, 2.5]), (sphere(2), 0.3, [-1.3; 3], [1.3; 3])]
    {
        let surface = rounded(&mesh, rounding);
        let mut checked = 0;
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        for _ in 0..400 {
            let place: [f64; 3] = std::array::from_fn(|k| low[k] + (high[k] - low[k]) * random());
            let found = surface.closest(place);
            if found.distance.abs() > 0.3 * rounding {
                continue;
            }
            let step = 1e-6;
            for k in 0..3 {
                let [after, before] = [step, -step].map(|by| {
                    let mut moved = place;
                    moved[k] += by;
                    surface.closest(moved)
                });
                let slope = (after.distance - before.distance) / (2.0 * step);
                assert!((slope - found.normal[k]).abs() < 1e-8, "{place:?}: {slope} {}", found.normal);
                let turn = (after.normal - before.normal) / (2.0 * step);
                let expected: Vector3<f64> =
                    found.curvatures.iter().map(|(value, along)| along * (*value * along[k])).sum();
                assert!((turn - expected).amax() < 2e-5 / rounding, "{place:?}: {turn} {expected}");
            }
            checked += 1;
        }
        assert!(checked > 40, "{checked}");
    }
}

#[test]
fn far_from_the_edges_of_a_box_the_surface_is_the_face() {
    let surface = rounded(&box_of([4.0, 3.0, 2.0]), 0.5);
    for (place, distance) in
        [([2.0, 1.5, 3.0], 1.0), ([2.0, 1.5, 2.0], 0.0), ([2.0, 1.5, 1.9], -0.1), ([-3.0, 1.0, 1.0], 3.0)]
    {
        assert!((surface.closest(place).distance - distance).abs() < 1e-14);
    }
}

#[test]
fn edges_are_cut_in_proportion_to_the_rounding() {
    for rounding in [0.5, 0.05] {
        let surface = rounded(&box_of([4.0, 3.0, 2.0]), rounding);
        let edge = surface.closest([4.0, 1.5, 2.0]);
        assert!((edge.distance / rounding - 0.281).abs() < 1e-3, "{}", edge.distance / rounding);
        assert!((surface.closest([4.0, 3.0, 2.0]).distance / rounding - 0.517).abs() < 1e-3);
        // The least radius along the edge, of the surface itself.
        let radius = |across: f64| {
            let place = surface.closest([4.0 - across * rounding, 1.5, 2.0]);
            let sharpest = place.curvatures.iter().map(|(value, _)| *value).fold(0.0, f64::max);
            (1.0 / sharpest - place.distance) / rounding
        };
        let least = (0..100).map(|k| radius(0.01 * f64::from(k))).fold(f64::INFINITY, f64::min);
        assert!((least - 0.56).abs() < 0.01, "{least}");
    }
}

/// The mean over the ball moves a smooth surface inwards by a part of `h²` times its mean curvature.
#[test]
fn a_finely_cut_sphere_is_smooth() {
    let deviation = |cuts: usize, rounding: f64| {
        let surface = rounded(&sphere(cuts), rounding);
        let places = (0..60).map(|k| {
            let (height, angle) = (1.0 - (2 * k + 1) as f64 / 60.0, 2.4 * k as f64);
            let across = (1.0 - height * height).sqrt();
            [across * angle.cos(), across * angle.sin(), height]
        });
        let found: Vec<f64> = places.map(|place| surface.closest(place).distance).collect();
        let mean = found.iter().sum::<f64>() / 60.0;
        (mean, found.iter().map(|one| (one - mean).abs()).fold(0.0, f64::max))
    };
    let ((coarse, coarse_waves), (fine, fine_waves)) = (deviation(2, 0.6), deviation(3, 0.3));
    assert!(coarse_waves < 8e-3 && fine_waves < 3e-3, "{coarse_waves} {fine_waves}");
    // A quarter, as both the rounding and the mesh are half as large.
    assert!((3.0..5.0).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn the_order_and_the_sense_of_triangles_do_not_matter() {
    let (points, triangles) = box_of([4.0, 3.0, 2.0]);
    let surface = rounded(&(points.clone(), triangles.clone()), 0.5);
    let turned: Vec<[usize; 3]> = triangles.iter().rev().map(|[a, b, c]| [*c, *b, *a]).collect();
    let other = rounded(&(points, turned), 0.5);
    for place in [[4.1, 1.0, 2.1], [-0.1, -0.1, -0.1], [2.0, 1.0, 2.2]] {
        let [one, other] = [&surface, &other].map(|surface| surface.closest(place));
        assert!((one.distance - other.distance).abs() < 1e-13 && (one.normal - other.normal).amax() < 1e-12);
    }
}

#[test]
fn what_makes_no_surface_is_told() {
    let (points, triangles) = box_of([4.0, 3.0, 2.0]);
    let mistake = |points: &[[f64; 3]], triangles: &[[usize; 3]], rounding: f64| {
        RoundedPolyhedron::new(points, triangles, rounding).and_then(|surface| surface.check_rounding()).unwrap_err()
    };
    assert_eq!(mistake(&points, &triangles[..3], 0.5), PolyhedronMistake::TooFew);
    assert!(matches!(mistake(&points, &triangles[1..], 0.5), PolyhedronMistake::Open { .. }));
    let mut turned = triangles.clone();
    turned[0].swap(0, 1);
    assert!(matches!(mistake(&points, &turned, 0.5), PolyhedronMistake::Turned { .. }));
    let mut twice = triangles.clone();
    twice.push(triangles[0]);
    assert!(matches!(mistake(&points, &twice, 0.5), PolyhedronMistake::Shared { .. }));
    let flat: Vec<[f64; 3]> = points.iter().map(|[x, y, _]| [*x, *y, 0.0]).collect();
    assert!(matches!(mistake(&flat, &triangles, 0.5), PolyhedronMistake::NoVolume));
    assert!(matches!(mistake(&points, &triangles, 8.0), PolyhedronMistake::Thin { .. }));
    let (fine, cut) = sphere(4);
    assert!(matches!(mistake(&fine, &cut, 0.9), PolyhedronMistake::WideRounding { .. }));
    // A pyramid whose tip goes through the opposite side of the box.
    let (mut points, mut triangles) = box_of([4.0, 3.0, 2.0]);
    points.extend([[1.0, 1.0, 5.0], [2.0, 1.0, 5.0], [1.0, 2.0, 5.0], [1.3, 1.2, 1.0]]);
    triangles.extend([[8, 9, 10], [8, 11, 9], [9, 11, 10], [10, 11, 8]]);
    assert!(matches!(mistake(&points, &triangles, 0.2), PolyhedronMistake::Crosses { .. }));
}

/// A mesh moved by a vector and made larger; `turned`: with its triangles the other way round.
fn beside((points, triangles): &Mesh, factor: f64, by: [f64; 3], is_turned: bool, before: usize) -> Mesh {
    let moved = points.iter().map(|point| std::array::from_fn(|k| point[k] * factor + by[k])).collect();
    let number = |[a, b, c]: &[usize; 3]| {
        [a + before, if is_turned { c } else { b } + before, if is_turned { b } else { c } + before]
    };
    (moved, triangles.iter().map(number).collect())
}

#[test]
fn a_cavity_runs_the_other_way_round() {
    let outer = beside(&box_of([1.0; 3]), 2.0, [-1.0; 3], false, 0);
    let with = |factor: f64, by: [f64; 3], is_turned: bool| {
        let inner = beside(&box_of([1.0; 3]), factor, by, is_turned, 8);
        RoundedPolyhedron::new(&[outer.0.clone(), inner.0].concat(), &[outer.1.clone(), inner.1].concat(), 0.1)
    };
    let hollow = with(1.0, [-0.5; 3], true).unwrap();
    hollow.check_rounding().unwrap();
    assert!((hollow.closest([0.0, 0.0, 0.74]).distance + 0.24).abs() < 1e-14);
    assert!((hollow.closest([0.0, 0.1, 0.0]).distance - 0.4).abs() < 1e-14);
    assert_eq!(with(1.0, [-0.5; 3], false).unwrap_err(), PolyhedronMistake::Nested { triangle: 12 });
    with(1.0, [1.5, 0.0, 0.0], false).unwrap().check_rounding().unwrap();
    assert_eq!(with(1.0, [1.5, 0.0, 0.0], true).unwrap_err(), PolyhedronMistake::Nested { triangle: 12 });
}

#[test]
fn no_more_parts_are_taken_than_can_be_placed() {
    let row = |count: usize| {
        let bodies = (0..count).map(|k| beside(&box_of([1.0; 3]), 1.0, [2.0 * k as f64, 0.0, 0.0], false, 8 * k));
        let (points, triangles): (Vec<_>, Vec<_>) = bodies.unzip();
        RoundedPolyhedron::new(&points.concat(), &triangles.concat(), 0.1)
    };
    row(100).unwrap();
    assert_eq!(row(101).unwrap_err(), PolyhedronMistake::ManyParts { found: 101 });
}

/// Faces that are cut into many triangles do not cross, however they are turned.
#[test]
fn finely_cut_faces_in_oblique_planes_do_not_cross() {
    let cuts = 4;
    let mut numbers = std::collections::BTreeMap::new();
    let mut points: Vec<Vector3<f64>> = Vec::new();
    let mut number = |place: [i32; 3]| {
        *numbers.entry(place).or_insert_with(|| {
            points.push(Vector3::from(place.map(f64::from)) / f64::from(cuts));
            points.len() - 1
        })
    };
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for (height, is_turned) in [(0, true), (cuts, false)] {
            for (i, j) in (0..cuts).flat_map(|i| (0..cuts).map(move |j| (i, j))) {
                let mut corner = |a: i32, b: i32| {
                    let mut place = [0; 3];
                    (place[axis], place[(axis + 1) % 3], place[(axis + 2) % 3]) = (height, i + a, j + b);
                    number(place)
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                let halves = if is_turned { [[a, c, b], [a, d, c]] } else { [[a, b, c], [a, c, d]] };
                triangles.extend(halves);
            }
        }
    }
    for turn in 0..30 {
        let turn = f64::from(turn);
        let rotation = nalgebra::Rotation3::from_euler_angles(0.7 * turn, 0.3 + 1.1 * turn, 2.3 * turn);
        let shift = Vector3::new(3.0, -700.0, 0.1) * turn;
        let turned: Vec<[f64; 3]> = points.iter().map(|point| (rotation * point + shift).into()).collect();
        let surface = RoundedPolyhedron::new(&turned, &triangles, 0.1).unwrap();
        assert_eq!(surface.check_rounding(), Ok(()), "{turn}");
    }
}
