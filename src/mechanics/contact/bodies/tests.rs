//! The kinematics of contacts between bodies against difference quotients, rigid motions and closed forms.

use crate::mechanics::contact::bodies::PlaneVector;
use crate::mechanics::contact::bodies::mortar::MortarNode;
use crate::mechanics::contact::bodies::node_to_surface::NodeToSurface;
use crate::mechanics::contact::bodies::opposite_surface::{OppositeSurface, SurfaceError};
use crate::mechanics::contact::kinematics::CoupledKinematics;
use std::sync::Arc;

/// Nodes of the own surface, left to right and free above, then those of the opposite one, right to left.
const PLACES: [PlaneVector; 8] =
    [[0.0, 0.0], [1.0, 0.1], [1.8, -0.1], [2.6, 0.4], [1.9, 0.35], [1.3, 0.5], [0.6, 0.3], [-0.5, 0.6]];
const OPPOSITE: [[usize; 2]; 4] = [[3, 4], [4, 5], [5, 6], [6, 7]];

fn opposite() -> Arc<OppositeSurface> {
    Arc::new(OppositeSurface::new(&OPPOSITE, |node| PLACES[node]).expect("a surface"))
}

fn mortar() -> MortarNode {
    MortarNode::new(1, [Some(0), Some(2)], opposite(), |node| PLACES[node])
}

/// The same at a node whose faces are covered in part, and of faces one of which is not covered.
fn at_an_edge(shift: f64) -> MortarNode {
    let faces = &OPPOSITE[2..];
    let surface = OppositeSurface::new(faces, |node| PLACES[node]).expect("a surface");
    let place = |node: usize| [PLACES[node][0] + if node < 3 { shift } else { 0.0 }, PLACES[node][1]];
    MortarNode::new(1, [Some(0), Some(2)], Arc::new(surface), place)
}

/// A node of the surface through all places in order, which folds upon itself. A closed one ends with the face from 0 to 1.
fn in_itself(node: usize, is_closed: bool) -> MortarNode {
    let faces: Vec<[usize; 2]> = (0..7 + usize::from(is_closed)).map(|k| [k, (k + 1) % 8]).collect();
    let surface = OppositeSurface::new(&faces, |node| PLACES[node]).expect("a surface");
    let at = surface.nodes.iter().position(|one| *one == node).expect("a node");
    MortarNode::in_itself(at, Arc::new(surface))
}

fn all() -> Vec<(&'static str, Arc<dyn CoupledKinematics>)> {
    let end = Arc::new(OppositeSurface::new(&OPPOSITE[..1], |node| PLACES[node]).expect("a surface"));
    vec![
        ("mortar", Arc::new(mortar())),
        ("mortar at the end of its surface", Arc::new(MortarNode::new(2, [Some(1), None], opposite(), |n| PLACES[n]))),
        ("mortar, both faces covered in part", Arc::new(at_an_edge(0.5))),
        ("mortar, a face covered in part", Arc::new(at_an_edge(-0.2))),
        ("mortar of a surface that touches itself", Arc::new(in_itself(5, false))),
        ("mortar at the end of a closed surface that touches itself", Arc::new(in_itself(0, true))),
        ("node to surface", Arc::new(NodeToSurface::new(1, PLACES[1], opposite()))),
        ("node to surface near an end", Arc::new(NodeToSurface::new(0, PLACES[0], opposite()))),
        ("node before a single face", Arc::new(NodeToSurface::new(1, PLACES[1], end))),
    ]
}

/// Contacts of bodies of revolution, whose axis is to the left of all places.
fn revolved() -> Vec<(&'static str, Arc<dyn CoupledKinematics>)> {
    let place = |node: usize| [PLACES[node][0] + 0.7, PLACES[node][1]];
    let surface = |faces: &[[usize; 2]]| {
        let surface = OppositeSurface::new(faces, place).expect("a surface");
        Arc::new(OppositeSurface { is_revolved: true, ..surface })
    };
    let all: Vec<[usize; 2]> = (0..7).map(|k| [k, k + 1]).collect();
    vec![
        ("mortar of revolution", Arc::new(MortarNode::new(1, [Some(0), Some(2)], surface(&OPPOSITE), place))),
        (
            "of revolution, covered in part",
            Arc::new(MortarNode::new(2, [Some(1), None], surface(&OPPOSITE[2..]), place)),
        ),
        ("of revolution, a surface that touches itself", Arc::new(MortarNode::in_itself(5, surface(&all)))),
    ]
}

pub(super) fn random(count: usize, size: f64, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| size * next()).collect()
}

fn columns(contact: &dyn CoupledKinematics, u: &[f64]) -> Vec<[f64; 2]> {
    let mut columns = vec![[0.0; 2]; u.len()];
    contact.each_column(&|k| u[k], &mut |k, column| {
        columns[k][0] += column[0];
        columns[k][1] += column[1];
    });
    columns
}

#[test]
fn rows_are_the_derivatives_of_gap_and_motion() {
    for (name, contact) in all().into_iter().chain(revolved()) {
        let count = 2 * contact.nodes().len();
        let u = random(count, 0.02, 7);
        let rows = columns(contact.as_ref(), &u);
        let step = 1e-5;
        for k in 0..count {
            let moved = |sign: f64| {
                let mut moved = u.clone();
                moved[k] += sign * step;
                moved
            };
            let (low, high) = (moved(-1.0), moved(1.0));
            let motion = contact.motion(&|k| low[k], &|k| high[k]);
            for (part, row) in motion.iter().zip(&rows[k]) {
                assert!((part / (2.0 * step) - row).abs() <= 1e-8, "{name}, {k}: {} {row}", part / (2.0 * step));
            }
        }
    }
}

#[test]
fn curvatures_are_the_derivatives_of_the_rows() {
    for (name, contact) in all().into_iter().chain(revolved()) {
        let count = 2 * contact.nodes().len();
        let u = random(count, 0.02, 11);
        let force = [0.7, 1.3, 0.0];
        let mut curvature = vec![0.0; count * count];
        contact.each_curvature(&|k| u[k], &force, &mut |row, column, value| curvature[count * row + column] += value);
        let step = 1e-5;
        for column in 0..count {
            let rows = [-1.0, 1.0].map(|sign| {
                let mut moved = u.clone();
                moved[column] += sign * step;
                columns(contact.as_ref(), &moved)
            });
            for row in 0..count {
                let slope: f64 =
                    (0..2).map(|k| force[k] * (rows[1][row][k] - rows[0][row][k])).sum::<f64>() / (2.0 * step);
                let found = curvature[count * row + column];
                assert!((slope - found).abs() <= 2e-7 * (1.0 + found.abs()), "{name}, {row} {column}: {found} {slope}");
            }
        }
    }
}

/// Forces and moments of the two bodies cancel, and a rigid motion of both changes nothing.
#[test]
fn both_bodies_carry_opposite_forces() {
    for (name, contact) in all() {
        let count = contact.nodes().len();
        let u = random(2 * count, 0.02, 13);
        let rows = columns(contact.as_ref(), &u);
        let place = |k: usize| {
            let [x, y] = PLACES[contact.nodes()[k]];
            let shift = if name.contains("both") && contact.nodes()[k] < 3 { 0.5 } else { 0.0 };
            let shift = if name.contains("a face covered") && contact.nodes()[k] < 3 { -0.2 } else { shift };
            [x + shift + u[2 * k], y + u[2 * k + 1]]
        };
        for which in [0, 1] {
            let row = |freedom: usize| rows[freedom][which];
            let force: [f64; 2] = [0, 1].map(|axis| (0..count).map(|k| row(2 * k + axis)).sum());
            let moment: f64 = (0..count).map(|k| place(k)[0] * row(2 * k + 1) - place(k)[1] * row(2 * k)).sum();
            assert!(force[0].abs().max(force[1].abs()).max(moment.abs()) <= 1e-12, "{name}: {force:?} {moment}");
        }
        let (angle, start) = (0.8_f64, contact.place(&|k| u[k]));
        let turned: Vec<f64> = (0..count)
            .flat_map(|k| {
                let ([x, y], [sine, cosine]) = (place(k), [angle.sin(), angle.cos()]);
                let original = [place(k)[0] - u[2 * k], place(k)[1] - u[2 * k + 1]];
                [cosine * x - sine * y + 3.0 - original[0], sine * x + cosine * y - 1.0 - original[1]]
            })
            .collect();
        let end = contact.place(&|k| turned[k]);
        assert!((0..2).all(|k| (start[k] - end[k]).abs() <= 1e-13), "{name}: {start:?} {end:?}");
    }
}

/// In a body of revolution the gap is the mean of the distance with the weight of the radius: of a node with one face from
/// `r = 0` to 1 before a line of the distance `r` it is that of the node, and the force on the other body is that of the
/// pressure around the axis.
#[test]
fn radii_weigh_the_gaps_of_bodies_of_revolution() {
    let place = |node: usize| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0]][node];
    let surface = OppositeSurface::new(&[[2, 3]], place).expect("a surface");
    let surface = Arc::new(OppositeSurface { is_revolved: true, ..surface });
    let [inner, outer] = [(0, [None, Some(1)]), (1, [Some(0), None])]
        .map(|(node, beside)| MortarNode::new(node, beside, Arc::clone(&surface), place));
    assert!(inner.initial_gap().abs() <= 1e-15 && (outer.initial_gap() - 1.0).abs() <= 1e-15);
    // ∫ φ r dr = 1/6 and 1/3 for the two nodes of either surface.
    let on_opposite = |node: &MortarNode| {
        let rows = columns(node, &vec![0.0; 2 * node.nodes().len()]);
        let at = |number: usize| node.nodes().iter().position(|one| *one == number).expect("a node");
        [2, 3].map(|number| rows[2 * at(number) + 1][1])
    };
    let [of_inner, of_outer] = [on_opposite(&inner), on_opposite(&outer)];
    let total = [0, 1].map(|k| of_inner[k] / 6.0 + of_outer[k] / 3.0);
    assert!((total[0] - 1.0 / 3.0).abs() <= 1e-14 && (total[1] - 1.0 / 6.0).abs() <= 1e-14, "{total:?}");
}

/// A flat surface at a distance: the gap is the distance, the motion that of the node.
#[test]
fn flat_surfaces_have_their_distance_and_their_slip() {
    let place =
        |node: usize| [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.7, 0.5], [1.2, 0.5], [0.4, 0.5], [-0.9, 0.5]][node];
    let surface = OppositeSurface::new(&[[3, 4], [4, 5], [5, 6]], place).expect("a surface");
    let surface = Arc::new(surface);
    let contacts: [Arc<dyn CoupledKinematics>; 2] = [
        Arc::new(MortarNode::new(1, [Some(0), Some(2)], Arc::clone(&surface), place)),
        Arc::new(NodeToSurface::new(1, place(1), Arc::clone(&surface))),
    ];
    for contact in contacts {
        let mut u = vec![0.0; 2 * contact.nodes().len()];
        // The own nodes move by (-0.3, 0.1): towards the end of the opposite surface.
        for (at, _) in contact.nodes().iter().enumerate().filter(|(_, node)| **node < 3) {
            (u[2 * at], u[2 * at + 1]) = (-0.3, 0.1);
        }
        let motion = contact.motion(&|_| 0.0, &|k| u[k]);
        assert!((motion[0] - 0.3).abs() <= 1e-14 && (motion[1] + 0.1).abs() <= 1e-14, "{motion:?}");
        let rows = columns(contact.as_ref(), &u);
        assert!((rows[0][0] + 1.0).abs() <= 1e-13 && (rows[1][1] + 1.0).abs() <= 1e-13, "{rows:?}");
        let own: f64 = rows.iter().skip(2).step_by(2).map(|row| row[0]).sum();
        assert!((own - 1.0).abs() <= 1e-13);
    }
}

/// A node that slides around a closed surface comes back to its beginning without a jump.
#[test]
fn a_closed_surface_has_no_seam() {
    let corner = |k: usize| {
        let angle = std::f64::consts::TAU * k as f64 / 12.0;
        [angle.cos(), angle.sin()]
    };
    let place = |node: usize| if node < 12 { corner(node) } else { [1.3, 0.3 * (node as f64 - 13.0)] };
    // Clockwise, free outside.
    let faces: Vec<[usize; 2]> = (0..12).map(|k| [(k + 1) % 12, k]).collect();
    let surface = Arc::new(OppositeSurface::new(&faces, place).expect("a surface"));
    assert!(surface.chains.len() == 1 && surface.chains[0].period.is_some());
    let contacts: [Arc<dyn CoupledKinematics>; 2] = [
        Arc::new(MortarNode::new(13, [Some(12), Some(14)], Arc::clone(&surface), place)),
        Arc::new(NodeToSurface::new(13, place(13), surface)),
    ];
    // Slips are measured along the own face, to which the polygon is inclined, and on a smoothed polygon, which is shorter.
    for contact in contacts {
        let turned = |angle: f64| -> Vec<f64> {
            let each = contact.nodes().iter().flat_map(|node| {
                let ([x, y], [sine, cosine]) = (place(*node), [angle.sin(), angle.cos()]);
                let moves = if *node < 12 { 0.0 } else { 1.0 };
                [moves * (cosine * x - sine * y - x), moves * (sine * x + cosine * y - y)]
            });
            each.collect()
        };
        let steps = 240;
        let mut total = 0.0;
        for step in 0..steps {
            let [from, to] = [step, step + 1].map(|k| turned(std::f64::consts::TAU * k as f64 / steps as f64));
            let motion = contact.motion(&|k| from[k], &|k| to[k]);
            assert!(motion[0] < 0.0 && motion[0] > -0.1, "{motion:?} at {step}");
            total += motion[0];
        }
        let length = 12.0 * 2.0 * (std::f64::consts::PI / 12.0).sin();
        assert!((total + length).abs() <= 5e-2 * length, "{total} {length}");
    }
}

#[test]
fn a_surface_that_branches_is_refused() {
    let error = OppositeSurface::new(&[[0, 1], [2, 1]], |node| PLACES[node]);
    assert_eq!(error, Err(SurfaceError::Branches(1)));
}

/// Of the two sides of a fold the later one carries the multipliers, and the gaps are those of two surfaces.
#[test]
fn a_fold_touches_as_two_surfaces_do() {
    let later = OppositeSurface::new(&OPPOSITE, |node| PLACES[node]).expect("a surface");
    let earlier = Arc::new(OppositeSurface::new(&[[0, 1], [1, 2]], |node| PLACES[node]).expect("a surface"));
    for (node, beside) in [(4, [3, 5]), (5, [4, 6]), (6, [5, 7])] {
        assert!(later.nodes.contains(&node));
        let pair = MortarNode::new(node, beside.map(Some), Arc::clone(&earlier), |node| PLACES[node]);
        let fold = in_itself(node, false);
        // The end of the earlier side goes on straight where there is no fold.
        let is_inner = node != 4;
        let is_same = (pair.initial_gap() - fold.initial_gap()).abs() < 1e-15;
        assert!(is_same == is_inner, "{node}: {} {}", pair.initial_gap(), fold.initial_gap());
    }
    // The first node looks at nothing.
    let mut columns = 0;
    in_itself(0, false).each_column(&|_| 0.0, &mut |_, _| columns += 1);
    assert_eq!(columns, 0);
}

/// The sides of a slit that is closed at the start touch, whatever the rounding of their places.
#[test]
fn the_sides_of_a_closed_slit_touch() {
    for rounding in [0.0, 1e-16, -1e-16, 1e-3] {
        // There along the lower side, free above, and back along the upper one.
        let place = |node: usize| if node <= 4 { [node as f64, 0.0] } else { [(8 - node) as f64, -rounding] };
        let faces: Vec<[usize; 2]> = (0..8).map(|k| [k, k + 1]).collect();
        let surface = Arc::new(OppositeSurface::new(&faces, place).expect("a surface"));
        let node = MortarNode::in_itself(7, surface);
        assert!((node.initial_gap() + rounding).abs() <= 1e-15, "{}", node.initial_gap());
        let row = columns(&node, &vec![0.0; 2 * node.nodes().len()]);
        assert!((row[1][1] - 1.0).abs() <= 1e-2, "{:?}", row[1]);
    }
}

/// A node of a thin wall whose surface goes around it does not touch the other side of the wall.
#[test]
fn the_sides_of_a_wall_do_not_touch() {
    let count = 10;
    // There along the lower side, back along the upper one, a tenth of a face apart.
    let place = |node: usize| {
        if node <= count { [node as f64, 0.0] } else { [(2 * count + 1 - node) as f64, 0.1] }
    };
    let all = 2 * count + 2;
    let faces: Vec<[usize; 2]> = (0..all).map(|k| [(k + 1) % all, k]).collect();
    let surface = Arc::new(OppositeSurface::new(&faces, place).expect("a surface"));
    for at in 0..all {
        let node = MortarNode::in_itself(at, Arc::clone(&surface));
        let mut columns = 0;
        // The wall bends, which moves its sides along each other.
        let bent = |freedom: usize| {
            let [x, y] = place(node.nodes()[freedom / 2]);
            let (radius, angle) = (5.0, x / 5.0);
            let moved = [(radius - y) * angle.sin(), radius - (radius - y) * angle.cos()];
            moved[freedom % 2] - [x, y][freedom % 2]
        };
        node.each_column(&bent, &mut |_, _| columns += 1);
        assert_eq!(columns, 0, "{at}");
        assert!(node.initial_gap() > 0.0, "{at}");
    }
}
