//! Loads against totals, closed forms and difference quotients; faces and their orientation.

use super::meshes::{STRAIN, STRESS, distorted, element, neo_hookean};
use crate::mechanics::structure::basis_transformation::{BasisTransformation, MiddleUnknown, TransformedEdge};
use crate::mechanics::structure::elements::solid::SolidElement;
use crate::mechanics::structure::elements::solid::loads::{
    body_force, dead_traction, pressure_force, write_pressure_stiffness,
};
use crate::mechanics::structure::elements::solid::shapes::faces::{FaceKind, FacePositions, faces_of};
use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, SolidKind};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

type Positions = Vec<[f64; 3]>;

/// Nodal forces of a pressure, or of a traction, on a face of any kind.
pub fn on_face(kind: FaceKind, positions: &[[f64; 3]], idealisation: Idealisation, load: &Load) -> Vec<f64> {
    macro_rules! of {
        ($nodes:literal, $dimension:literal) => {{
            let own: [[f64; $dimension]; $nodes] =
                std::array::from_fn(|node| std::array::from_fn(|axis| positions[node][axis]));
            assert_eq!(<[[f64; $dimension]; $nodes]>::KIND, kind);
            match load {
                Load::Pressure => pressure_force(&own, idealisation, 1.0).as_flattened().to_vec(),
                Load::Traction(traction) => {
                    let traction = std::array::from_fn(|axis| traction[axis]);
                    dead_traction(&own, idealisation, traction).as_flattened().to_vec()
                }
                Load::Stiffness => {
                    let mut stiffness = vec![f64::NAN; $nodes * $nodes * $dimension * $dimension];
                    write_pressure_stiffness(&own, idealisation, 1.0, &mut stiffness);
                    stiffness
                }
            }
        }};
    }
    match kind {
        FaceKind::Segment2 => of!(2, 2),
        FaceKind::Segment3 => of!(3, 2),
        FaceKind::Triangle3 => of!(3, 3),
        FaceKind::Triangle6 => of!(6, 3),
        FaceKind::Quadrilateral4 => of!(4, 3),
        FaceKind::Quadrilateral8 => of!(8, 3),
    }
}

pub enum Load {
    Pressure,
    Traction([f64; 3]),
    Stiffness,
}

/// Positions of one distorted element, quadratic edges bent.
fn bent(kind: SolidKind) -> Positions {
    let mesh = distorted(kind, 1);
    let of = |node: &usize| {
        let [x, y, z] = mesh.positions[*node];
        let depth = if kind.dimension() == 2 { 0.0 } else { z + 0.05 * (4.0 * x).sin() };
        [x + 0.05 * (5.0 * y).sin(), y + 0.06 * (3.0 * x).cos(), depth]
    };
    mesh.elements[0].iter().map(of).collect()
}

fn idealisations(kind: SolidKind) -> Vec<Idealisation> {
    if kind.dimension() == 3 { vec![Idealisation::Space] } else { vec![STRAIN, STRESS, Idealisation::Axisymmetric] }
}

const KINDS: [SolidKind; 8] = super::meshes::KINDS;

#[test]
fn a_pressure_all_around_does_the_work_of_the_volume() {
    for kind in KINDS {
        for idealisation in idealisations(kind) {
            let positions = bent(kind);
            let dimension = kind.dimension();
            let (face, places) = faces_of(kind);
            let (mut total, mut work) = ([0.0; 3], 0.0);
            for places in places {
                assert_eq!(places.len(), face.nodes());
                let own: Positions = places.iter().map(|place| positions[*place]).collect();
                let forces = on_face(face, &own, idealisation, &Load::Pressure);
                for (force, position) in forces.chunks(dimension).zip(&own) {
                    (0..dimension).for_each(|axis| total[axis] += force[axis]);
                    work += force.iter().zip(position).map(|(force, position)| force * position).sum::<f64>();
                }
            }
            // The volume from cells of a fine grid in natural coordinates, independent of the element's rule.
            let volume = volume_of(kind, idealisation, &positions);
            let around = idealisation == Idealisation::Axisymmetric;
            let powers = if around { 3.0 } else { dimension as f64 };
            assert!(
                (work + powers * volume).abs() <= 1e-12 * volume * powers,
                "{kind:?} {idealisation:?}: {work} {volume}"
            );
            // Around an axis radial forces do not balance.
            let components = if around { 1..2 } else { 0..dimension };
            components.for_each(|axis| assert!(total[axis].abs() <= 1e-13 * volume.max(1.0), "{kind:?} {total:?}"));
        }
    }
}

/// The volume by the element, exact where the rule is, else by halving edges: the sum over the parts of a simplex or cube.
fn volume_of(kind: SolidKind, idealisation: Idealisation, positions: &Positions) -> f64 {
    use crate::mechanics::structure::elements::solid::shapes::quadrature::{gauss, triangle_of_degree_4};
    use crate::mechanics::structure::elements::solid::shapes::shape_functions::{
        HEXAHEDRON, QUADRILATERAL, of_cube, of_simplex,
    };
    // Products of the rule of 3 points, collapsed onto the simplex (Stroud's conical product).
    let conical = || {
        gauss::<3>(3).into_iter().map(|([a, b, c], weight)| {
            let [a, b, c] = [a, b, c].map(|value| 0.5 * (1.0 + value));
            ([a, b * (1.0 - a), c * (1.0 - a) * (1.0 - b)], weight / 8.0 * (1.0 - a).powi(2) * (1.0 - b))
        })
    };
    let thickness = |radius: f64| match idealisation {
        Idealisation::Axisymmetric => TAU * radius,
        other => other.thickness(),
    };
    macro_rules! of {
        ($points:expr, $count:literal, $dimension:literal, $functions:expr) => {{
            let mut volume = 0.0;
            for point in $points {
                let shape: crate::mechanics::structure::elements::solid::shapes::shape_functions::ShapePoint<
                    $count,
                    $dimension,
                > = $functions(point);
                let mut jacobian = nalgebra::Matrix3::<f64>::identity();
                let mut radius = 0.0;
                for node in 0..$count {
                    radius += shape.values[node] * positions[node][0];
                    for row in 0..$dimension {
                        for column in 0..$dimension {
                            let start = if node == 0 && row == column { 1.0 } else { 0.0 };
                            jacobian[(row, column)] += positions[node][row] * shape.gradients[node][column] - start;
                        }
                    }
                }
                volume += shape.weight * jacobian.determinant() * thickness(radius);
            }
            volume
        }};
    }
    match kind {
        SolidKind::Triangle3 => of!(triangle_of_degree_4(), 3, 2, of_simplex),
        SolidKind::Triangle6 => of!(triangle_of_degree_4(), 6, 2, of_simplex),
        SolidKind::Quadrilateral4 => of!(gauss::<2>(3), 4, 2, |point| of_cube(&QUADRILATERAL, point)),
        SolidKind::Quadrilateral8 => of!(gauss::<2>(3), 8, 2, |point| of_cube(&QUADRILATERAL, point)),
        SolidKind::Tetrahedron4 => of!(conical(), 4, 3, of_simplex),
        SolidKind::Tetrahedron10 => of!(conical(), 10, 3, of_simplex),
        SolidKind::Hexahedron8 => of!(gauss::<3>(3), 8, 3, |point| of_cube(&HEXAHEDRON, point)),
        SolidKind::Hexahedron20 => of!(gauss::<3>(3), 20, 3, |point| of_cube(&HEXAHEDRON, point)),
    }
}

#[test]
fn the_stiffness_of_a_pressure_is_its_derivative() {
    for kind in KINDS {
        for idealisation in idealisations(kind) {
            let (face, places) = faces_of(kind);
            let positions = bent(kind);
            let own: Positions = places[0].iter().map(|place| positions[*place]).collect();
            let stiffness = on_face(face, &own, idealisation, &Load::Stiffness);
            let size = own.len() * kind.dimension();
            for column in 0..size {
                let forces = |step: f64| {
                    let mut own = own.clone();
                    own[column / kind.dimension()][column % kind.dimension()] += step;
                    on_face(face, &own, idealisation, &Load::Pressure)
                };
                // The forces are quadratic, around an axis cubic in one component: the quotient is exact.
                let step = 0.25;
                let (one, other) = (forces(step), forces(-step));
                let (two, last) = (forces(2.0 * step), forces(-2.0 * step));
                for row in 0..size {
                    let quotient = (8.0 * (one[row] - other[row]) - two[row] + last[row]) / (12.0 * step);
                    assert!((quotient - stiffness[row * size + column]).abs() <= 1e-12, "{kind:?} {idealisation:?}");
                }
            }
        }
    }
}

/// An even traction pulls at the corners of a square of 8 nodes; in the transformed basis it pushes everywhere.
#[test]
fn an_even_traction_pushes_everywhere_in_the_transformed_basis() {
    let edge = |(place, ends)| (place, TransformedEdge { ends, unknown: MiddleUnknown::Extrapolated });
    let edges = [(4, [0, 1]), (5, [1, 2]), (6, [2, 3]), (7, [0, 3])].map(edge);
    let basis = BasisTransformation::new(BTreeMap::from(edges));
    // A constant traction on a square of 8 nodes: -1/12 at the corners, 1/3 in the middle of the edges.
    let square = distorted(SolidKind::Quadrilateral8, 1).lattice;
    let order = distorted(SolidKind::Quadrilateral8, 1).elements[0].clone();
    let own: Positions = order.iter().map(|node| square[*node].map(|place| 0.5 * place as f64)).collect();
    let traction = on_face(FaceKind::Quadrilateral8, &own, Idealisation::Space, &Load::Traction([0.0, 0.0, 1.0]));
    for (place, force) in traction.chunks(3).enumerate() {
        let exact = if place < 4 { -1.0 / 12.0 } else { 1.0 / 3.0 };
        assert!((force[2] - exact).abs() <= 1e-14);
    }
    let mut along: Vec<f64> = traction.chunks(3).map(|force| force[2]).collect();
    basis.edges_among(&[0, 1, 2, 3, 4, 5, 6, 7]).iter().for_each(|edge| edge.distribute(&mut along));
    for (place, force) in along.iter().enumerate() {
        let exact = if place < 4 { 1.0 / 20.0 } else { 1.0 / 5.0 };
        assert!((force - exact).abs() <= 1e-14, "{place} {force}");
    }
}

#[test]
fn body_forces_make_the_weight() {
    let positions = distorted(SolidKind::Quadrilateral4, 1);
    let own: [[f64; 2]; 4] = std::array::from_fn(|place| {
        let [x, y, _] = positions.positions[positions.elements[0][place]];
        [x, y]
    });
    for idealisation in [STRAIN, Idealisation::Axisymmetric] {
        let solid = SolidElement::new([0, 1, 2, 3], &own, idealisation, neo_hookean(0.3)).unwrap();
        let forces = body_force(&solid, [0.0, -3.0]);
        let total: f64 = forces.iter().map(|force| force[1]).sum();
        let padded: Positions = own.iter().map(|[x, y]| [*x, *y, 0.0]).collect();
        let volume = volume_of(SolidKind::Quadrilateral4, idealisation, &padded);
        assert!((total + 3.0 * volume).abs() <= 1e-13 * volume && (solid.volume() - volume).abs() <= 1e-13 * volume);
        // The work in a homogeneous displacement is that of the centre.
        assert!(forces.iter().all(|force| force[0] == 0.0 && force[1] < 0.0));
    }
    assert!(
        element(SolidKind::Quadrilateral4, &[0, 1, 2, 3], &[[0.0; 3]; 4], STRAIN, &neo_hookean(0.3), None).is_err()
    );
}
