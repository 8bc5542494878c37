//! Mortar contacts in space against difference quotients, rigid motions and closed forms.

use crate::mechanics::contact::bodies::space::mortar::MortarNodeInSpace;
use crate::mechanics::contact::bodies::space::surface::{SurfaceInSpace, SurfaceInSpaceError};
use crate::mechanics::contact::bodies::tests::random;
use crate::mechanics::contact::kinematics::CoupledKinematics;
use crate::mechanics::contact::vector::{Vector, cross};
use smallvec::SmallVec;
use std::sync::Arc;

type Faces = Vec<SmallVec<[usize; 4]>>;

/// A grid of `count` by `count` cells of quadrilaterals, or of two triangles each, with normals up or down; nodes from `first`.
fn grid(count: usize, triangles: bool, up: bool, first: usize) -> Faces {
    let node = |i: usize, j: usize| first + i * (count + 1) + j;
    let mut faces = Faces::new();
    for (i, j) in itertools::iproduct!(0..count, 0..count) {
        let mut corners = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
        if !up {
            corners.reverse();
        }
        if triangles {
            faces.push(SmallVec::from_slice(&[corners[0], corners[1], corners[2]]));
            faces.push(SmallVec::from_slice(&[corners[0], corners[2], corners[3]]));
        } else {
            faces.push(SmallVec::from_slice(&corners));
        }
    }
    faces
}

/// Places of both grids: the own one of 2 by 2 cells on a wavy surface, the opposite one of 3 by 3 cells above it.
fn place(node: usize, shift: Vector) -> Vector {
    if node < 9 {
        let (x, y) = ((node / 3) as f64, (node % 3) as f64);
        return [x, y + 0.1 * x, 0.15 * (1.3 * x + 0.4).sin() * (y - 0.8)];
    }
    let (x, y) = (((node - 9) / 4) as f64, ((node - 9) % 4) as f64);
    let wave = 0.1 * (x - 0.7 * y).sin();
    [0.9 * x - 0.4 + 0.05 * y + shift[0], 0.8 * y - 0.2 + shift[1], 0.3 + wave + shift[2]]
}

fn contact(own: usize, triangles: [bool; 2], shift: Vector, held: Option<usize>) -> MortarNodeInSpace {
    let at = |node: usize| place(node, shift);
    let surface = SurfaceInSpace::new(&grid(2, triangles[0], true, 0), at).expect("a surface");
    let opposite = SurfaceInSpace::new(&grid(3, triangles[1], false, 9), at).expect("a surface");
    let own = surface.nodes.iter().position(|node| *node == own).expect("a node");
    MortarNodeInSpace::new(own, &surface, Arc::new(opposite), |node| Some(node) == held)
}

fn all() -> Vec<(&'static str, MortarNodeInSpace, Vector)> {
    let still = [0.0; 3];
    let beside = [0.93, 0.37, 0.0];
    vec![
        ("quadrilaterals", contact(4, [false; 2], still, None), still),
        ("triangles", contact(4, [true; 2], still, None), still),
        ("triangles on quadrilaterals, a corner", contact(0, [true, false], still, None), still),
        ("covered in part", contact(4, [false, true], beside, None), beside),
        ("covered in part, at an edge", contact(1, [false, false], beside, None), beside),
        ("covered in part, a node supported", contact(4, [false, false], beside, Some(1)), beside),
    ]
}

fn columns(contact: &MortarNodeInSpace, u: &[f64]) -> Vec<Vector> {
    let mut columns = vec![[0.0; 3]; u.len()];
    contact.each_column(&|k| u[k], &mut |k, column| (0..3).for_each(|row| columns[k][row] += column[row]));
    columns
}

#[test]
fn rows_are_the_derivatives_of_gap_and_motion() {
    for (name, contact, _) in all() {
        let count = 3 * contact.nodes().len();
        let u = random(count, 0.02, 7);
        let rows = columns(&contact, &u);
        let step = 1e-5;
        for k in 0..count {
            let [low, high] = [-step, step].map(|step| {
                let mut moved = u.clone();
                moved[k] += step;
                moved
            });
            let motion = contact.motion(&|k| low[k], &|k| high[k]);
            for (part, row) in motion.iter().zip(&rows[k]) {
                assert!((part / (2.0 * step) - row).abs() <= 1e-8, "{name}, {k}: {} {row}", part / (2.0 * step));
            }
        }
    }
}

#[test]
fn curvatures_are_the_derivatives_of_the_rows() {
    for (name, contact, _) in all() {
        let count = 3 * contact.nodes().len();
        let u = random(count, 0.02, 11);
        for force in [[0.0, 0.0, 1.3], [0.7, 0.0, 0.0], [0.4, -0.8, 1.1]] {
            let mut curvature = vec![0.0; count * count];
            contact.each_curvature(&|k| u[k], &force, &mut |row, column, value| {
                curvature[count * row + column] += value;
            });
            let step = 1e-5;
            for column in 0..count {
                let rows = [-step, step].map(|step| {
                    let mut moved = u.clone();
                    moved[column] += step;
                    columns(&contact, &moved)
                });
                for row in 0..count {
                    let slope =
                        (0..3).map(|k| force[k] * (rows[1][row][k] - rows[0][row][k])).sum::<f64>() / (2.0 * step);
                    let found = curvature[count * row + column];
                    let what = format!("{name}, {force:?}, {row} {column}: {found} {slope}");
                    assert!((slope - found).abs() <= 1e-6 * (1.0 + found.abs()), "{what}");
                }
            }
        }
    }
}

/// Forces and moments of the two bodies cancel, and a rigid motion of both changes nothing.
#[test]
fn both_bodies_carry_opposite_forces() {
    for (name, contact, shift) in all() {
        let nodes = contact.nodes().to_vec();
        let u = random(3 * nodes.len(), 0.02, 13);
        let rows = columns(&contact, &u);
        let present = |k: usize| -> Vector {
            let at = place(nodes[k], shift);
            [0, 1, 2].map(|axis| at[axis] + u[3 * k + axis])
        };
        for which in [0, 1, 2] {
            let of_node = |k: usize| [0, 1, 2].map(|axis| rows[3 * k + axis][which]);
            let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
            for k in 0..nodes.len() {
                let (vector, arm) = (of_node(k), cross(&present(k), &of_node(k)));
                (0..3).for_each(|axis| {
                    force[axis] += vector[axis];
                    moment[axis] += arm[axis];
                });
            }
            let off = force.iter().chain(&moment).fold(0.0_f64, |most, part| most.max(part.abs()));
            assert!(off <= 1e-12, "{name}: {force:?} {moment:?}");
        }
        let (sine, cosine) = 0.8_f64.sin_cos();
        let turned: Vec<f64> = (0..nodes.len())
            .flat_map(|k| {
                let ([x, y, z], at) = (present(k), place(nodes[k], shift));
                [z + 3.0 - at[0], cosine * x - sine * y - 1.0 - at[1], sine * x + cosine * y - at[2]]
            })
            .collect();
        let motion = contact.motion(&|k| u[k], &|k| turned[k]);
        assert!(motion.iter().all(|part| part.abs() <= 1e-13), "{name}: {motion:?}");
    }
}

/// Flat surfaces at a distance: the gap is the distance, the motion that of the node; edges of the two meshes coincide.
#[test]
fn flat_surfaces_have_their_distance_and_their_slip() {
    for triangles in [[false, false], [true, false], [true, true]] {
        let at = |node: usize| -> Vector {
            let (node, count, height) = if node < 9 { (node, 3, 0.0) } else { (node - 9, 4, 0.5) };
            [(node / count) as f64 - f64::from(count == 4) * 0.5, (node % count) as f64, height]
        };
        let surface = SurfaceInSpace::new(&grid(2, triangles[0], true, 0), at).expect("a surface");
        let opposite = SurfaceInSpace::new(&grid(3, triangles[1], false, 9), at).expect("a surface");
        let own = surface.nodes.iter().position(|node| *node == 4).expect("a node");
        let contact = MortarNodeInSpace::new(own, &surface, Arc::new(opposite), |_| false);
        assert!((contact.initial_gap() - 0.5).abs() <= 1e-15);
        let mut u = vec![0.0; 3 * contact.nodes().len()];
        for (at, _) in contact.nodes().iter().enumerate().filter(|(_, node)| **node < 9) {
            u[3 * at..3 * at + 3].copy_from_slice(&[0.3, 0.0, 0.1]);
        }
        let motion = contact.motion(&|_| 0.0, &|k| u[k]);
        let length = motion[0].hypot(motion[1]);
        assert!((length - 0.3).abs() <= 1e-14 && (motion[2] + 0.1).abs() <= 1e-14, "{triangles:?} {motion:?}");
        let rows = columns(&contact, &u);
        for axis in 0..3 {
            let own: Vector = [0, 1, 2].map(|row| {
                let nodes = contact.nodes().iter().enumerate().filter(|(_, node)| **node < 9);
                nodes.map(|(at, _)| rows[3 * at + axis][row]).sum()
            });
            let across = f64::from(u8::from(axis == 2));
            assert!((own[2] + across).abs() <= 1e-13, "{triangles:?} {own:?}");
            assert!((own[0].hypot(own[1]) - 1.0 + across).abs() <= 1e-13, "{triangles:?} {own:?}");
        }
    }
}

#[test]
fn a_surface_that_branches_or_has_no_area_is_refused() {
    let at = |node: usize| place(node, [0.0; 3]);
    let face = |nodes: &[usize]| SmallVec::from_slice(nodes);
    let error = SurfaceInSpace::new(&[face(&[0, 1, 4]), face(&[0, 1, 3])], at);
    assert_eq!(error, Err(SurfaceInSpaceError::Branches([0, 1])));
    let error = SurfaceInSpace::new(&[face(&[0, 1, 0])], at);
    assert!(matches!(error, Err(SurfaceInSpaceError::NoArea(_))), "{error:?}");
}
