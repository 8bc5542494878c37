//! Shape functions as polynomials, and the quadrature rules of the elements.
//!
//! The functions of a kind are the polynomials of its space that are 1 at one node and 0 at the others: their coefficients
//! are the columns of the inverse of the matrix of the monomials at the nodes.

use crate::model::request::SolidKind;
use nalgebra::DMatrix;
use std::sync::OnceLock;

/// Natural coordinates; what a kind does not have is 0.
pub type NaturalPlace = [f64; 3];

/// Shape functions at one place.
pub struct ShapeValues {
    pub values: Vec<f64>,
    pub slopes: Vec<NaturalPlace>,
}

/// Number of natural coordinates, and whether the element is a simplex.
pub fn form(kind: SolidKind) -> (usize, bool) {
    match kind {
        SolidKind::Triangle3 | SolidKind::Triangle6 => (2, true),
        SolidKind::Quadrilateral4 | SolidKind::Quadrilateral8 => (2, false),
        SolidKind::Tetrahedron4 | SolidKind::Tetrahedron10 => (3, true),
        SolidKind::Hexahedron8 | SolidKind::Hexahedron20 => (3, false),
    }
}

fn is_quadratic(kind: SolidKind) -> bool {
    matches!(
        kind,
        SolidKind::Triangle6 | SolidKind::Quadrilateral8 | SolidKind::Tetrahedron10 | SolidKind::Hexahedron20
    )
}

/// Natural coordinates of the nodes, in the order of VTK's file format.
pub fn nodes(kind: SolidKind) -> Vec<NaturalPlace> {
    let (dimension, is_simplex) = form(kind);
    let mut corners: Vec<NaturalPlace> = match (dimension, is_simplex) {
        (2, true) => vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        (_, true) => vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        (layers, false) => {
            let heights: &[f64] = if layers == 2 { &[0.0] } else { &[-1.0, 1.0] };
            let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            heights.iter().flat_map(|z| square.iter().map(move |[x, y]| [*x, *y, *z])).collect()
        }
    };
    let edges: &[[usize; 2]] = match kind {
        SolidKind::Triangle6 => &[[0, 1], [1, 2], [2, 0]],
        SolidKind::Quadrilateral8 => &[[0, 1], [1, 2], [2, 3], [3, 0]],
        SolidKind::Tetrahedron10 => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
        SolidKind::Hexahedron20 => {
            &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
        }
        _ => &[],
    };
    for [one, other] in edges {
        corners.push(std::array::from_fn(|axis| 0.5 * (corners[*one][axis] + corners[*other][axis])));
    }
    corners
}

/// The exponents of the monomials of a kind.
fn monomials(kind: SolidKind) -> Vec<[i32; 3]> {
    let (dimension, is_simplex) = form(kind);
    let quadratic = is_quadratic(kind);
    let highest = if dimension == 3 { 2 } else { 0 };
    let all = (0..=2).flat_map(|x| (0..=2).flat_map(move |y| (0..=highest).map(move |z| [x, y, z])));
    let belongs = |exponents: &[i32; 3]| {
        let squares = exponents.iter().filter(|exponent| **exponent == 2).count();
        let degree: i32 = exponents.iter().sum();
        match (is_simplex, quadratic) {
            (true, _) => degree <= if quadratic { 2 } else { 1 },
            (false, true) => squares <= 1,
            (false, false) => squares == 0,
        }
    };
    all.filter(belongs).collect()
}

fn power(base: f64, exponent: i32) -> f64 {
    if exponent < 0 { 0.0 } else { base.powi(exponent) }
}

/// The coefficients of the functions: a row for each monomial, a column for each node.
fn coefficients(kind: SolidKind) -> DMatrix<f64> {
    let (nodes, monomials) = (nodes(kind), monomials(kind));
    let at_nodes = DMatrix::from_fn(nodes.len(), monomials.len(), |node, monomial| {
        (0..3).map(|axis| power(nodes[node][axis], monomials[monomial][axis])).product()
    });
    at_nodes.try_inverse().unwrap_or_else(|| DMatrix::zeros(monomials.len(), nodes.len()))
}

/// Shape functions of a kind, to be evaluated anywhere.
#[derive(Debug)]
pub struct Shape {
    monomials: Vec<[i32; 3]>,
    coefficients: DMatrix<f64>,
}

impl Shape {
    /// Computed once for each kind.
    pub fn of(kind: SolidKind) -> &'static Self {
        static KNOWN: [OnceLock<Shape>; SolidKind::ALL.len()] = [const { OnceLock::new() }; SolidKind::ALL.len()];
        let new = || Self { monomials: monomials(kind), coefficients: coefficients(kind) };
        KNOWN[kind as usize].get_or_init(new)
    }

    pub fn at(&self, place: NaturalPlace) -> ShapeValues {
        let nodes = self.coefficients.ncols();
        let (mut values, mut slopes) = (vec![0.0; nodes], vec![[0.0; 3]; nodes]);
        for (row, exponents) in self.monomials.iter().enumerate() {
            let factor = |axis: usize| power(place[axis], exponents[axis]);
            let slope = |axis: usize| f64::from(exponents[axis]) * power(place[axis], exponents[axis] - 1);
            let monomial = factor(0) * factor(1) * factor(2);
            let derived =
                [slope(0) * factor(1) * factor(2), factor(0) * slope(1) * factor(2), factor(0) * factor(1) * slope(2)];
            for node in 0..nodes {
                let coefficient = self.coefficients[(row, node)];
                values[node] += coefficient * monomial;
                slopes[node].iter_mut().zip(derived).for_each(|(sum, value)| *sum += coefficient * value);
            }
        }
        ShapeValues { values, slopes }
    }
}

/// The points of a kind's rule with their weights.
pub fn rule(kind: SolidKind, is_axisymmetric: bool) -> Vec<(NaturalPlace, f64)> {
    match (kind, is_axisymmetric) {
        (SolidKind::Triangle3, false) => vec![([1.0 / 3.0, 1.0 / 3.0, 0.0], 0.5)],
        (SolidKind::Tetrahedron4, _) => vec![([0.25; 3], 1.0 / 6.0)],
        (SolidKind::Triangle3, true) | (SolidKind::Triangle6, false) => {
            let (near, far) = (1.0 / 6.0, 2.0 / 3.0);
            vec![([near, near, 0.0], 1.0 / 6.0), ([far, near, 0.0], 1.0 / 6.0), ([near, far, 0.0], 1.0 / 6.0)]
        }
        (SolidKind::Triangle6, true) => of_degree_4(),
        (SolidKind::Tetrahedron10, _) => {
            let near = (5.0 - 5.0_f64.sqrt()) / 20.0;
            let far = 1.0 - 3.0 * near;
            let place = |corner: usize| std::array::from_fn(|axis| if axis + 1 == corner { far } else { near });
            (0..4).map(|corner| (place(corner), 1.0 / 24.0)).collect()
        }
        (SolidKind::Quadrilateral4, _) => gauss(2, 2),
        (SolidKind::Quadrilateral8, _) => gauss(3, 2),
        (SolidKind::Hexahedron8, _) => gauss(2, 3),
        (SolidKind::Hexahedron20, _) => gauss(3, 3),
    }
}

/// The rule of six points on the triangle (G. R. Cowper, Int. J. Numer. Methods Eng. 7 (1973) 405).
fn of_degree_4() -> Vec<(NaturalPlace, f64)> {
    let root = (38.0 - 44.0 * 0.4_f64.sqrt()).sqrt();
    let base = 8.0 - 10.0_f64.sqrt();
    let of_weight = (213_125.0 - 53_320.0 * 10.0_f64.sqrt()).sqrt();
    let groups = [
        ((base + root) / 18.0, 0.5 * (620.0 + of_weight) / 3720.0),
        ((base - root) / 18.0, 0.5 * (620.0 - of_weight) / 3720.0),
    ];
    let of_group = |(near, weight): (f64, f64)| {
        let far = 1.0 - 2.0 * near;
        [([near, near, 0.0], weight), ([far, near, 0.0], weight), ([near, far, 0.0], weight)]
    };
    groups.into_iter().flat_map(of_group).collect()
}

/// Gauss's rule with 2 or 3 points along each axis.
fn gauss(points: usize, dimension: usize) -> Vec<(NaturalPlace, f64)> {
    let line = if points == 2 {
        let place = (1.0_f64 / 3.0).sqrt();
        vec![(-place, 1.0), (place, 1.0)]
    } else {
        let place = 0.6_f64.sqrt();
        vec![(-place, 5.0 / 9.0), (0.0, 8.0 / 9.0), (place, 5.0 / 9.0)]
    };
    let flat = [(0.0, 1.0)];
    let depth: &[(f64, f64)] = if dimension == 3 { &line } else { &flat };
    let mut rule = Vec::new();
    for (x, by_x) in &line {
        for (y, by_y) in &line {
            rule.extend(depth.iter().map(|(z, by_z)| ([*x, *y, *z], by_x * by_y * by_z)));
        }
    }
    rule
}
