//! Shape functions and their gradients in natural coordinates, in VTK's order of nodes.
//!
//! Segments, quadrilaterals and hexahedra fill `[-1, 1]^D`, with linear or serendipity functions; triangles and tetrahedra
//! fill the unit simplex, with linear or quadratic functions (O. C. Zienkiewicz, R. L. Taylor, J. Z. Zhu, *The Finite
//! Element Method: Its Basis and Fundamentals*, 2013, chapter 6). All quantities are dimensionless.

use crate::mechanics::structure::elements::solid::shapes::kind::EDGES_OF_SIMPLEX;

/// The shape functions at a quadrature point of an element with `N` nodes and `D` natural coordinates.
#[derive(Debug, Clone, Copy)]
pub struct ShapePoint<const N: usize, const D: usize> {
    /// Weight of the point in natural coordinates.
    pub weight: f64,
    /// Natural coordinates of the point.
    pub place: [f64; D],
    /// Values.
    pub values: [f64; N],
    /// Derivatives by the natural coordinates.
    pub gradients: [[f64; D]; N],
}

/// Natural coordinates of the nodes of a quadratic segment.
pub const SEGMENT: [[f64; 1]; 3] = [[-1.0], [1.0], [0.0]];

/// Natural coordinates of the nodes of a quadratic quadrilateral; the first four are the corners.
pub const QUADRILATERAL: [[f64; 2]; 8] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

/// Natural coordinates of the nodes of a quadratic hexahedron; the first eight are the corners.
pub const HEXAHEDRON: [[f64; 3]; 20] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
];

/// The functions of a segment, quadrilateral or hexahedron: linear for `N = 2^D` nodes, else of the serendipity family.
/// `nodes`: natural coordinates of the nodes, of which the first `N` are used; `point`: place and weight.
pub fn of_cube<const N: usize, const D: usize>(nodes: &[[f64; D]], (at, weight): ([f64; D], f64)) -> ShapePoint<N, D> {
    let is_linear = N == 1 << D;
    let mut shape = ShapePoint { weight, place: at, values: [0.0; N], gradients: [[0.0; D]; N] };
    for ((value, gradient), node) in shape.values.iter_mut().zip(&mut shape.gradients).zip(nodes) {
        // A factor for each coordinate, and its derivative.
        let factors: [[f64; 2]; D] = std::array::from_fn(|axis| {
            let (own, at) = (node[axis], at[axis]);
            if own == 0.0 { [1.0 - at * at, -2.0 * at] } else { [0.5 * (1.0 + own * at), 0.5 * own] }
        });
        let product = |derived: usize| -> f64 {
            factors.iter().enumerate().map(|(axis, factor)| factor[usize::from(axis == derived)]).product()
        };
        *value = factors.iter().map(|factor| factor[0]).product();
        *gradient = std::array::from_fn(product);
        if !is_linear && node.iter().all(|own| *own != 0.0) {
            let along: f64 = node.iter().zip(&at).map(|(own, at)| own * at).sum();
            let factor = along + 1.0 - node.iter().map(|own| own.abs()).sum::<f64>();
            *gradient = std::array::from_fn(|axis| gradient[axis] * factor + *value * node[axis]);
            *value *= factor;
        }
    }
    shape
}

/// The functions of a triangle or tetrahedron: linear for `N = D + 1` nodes, else quadratic. `point`: place and weight.
pub fn of_simplex<const N: usize, const D: usize>((at, weight): ([f64; D], f64)) -> ShapePoint<N, D> {
    // Barycentric coordinates and their gradients.
    let barycentric = |corner: usize| if corner == 0 { 1.0 - at.iter().sum::<f64>() } else { at[corner - 1] };
    let slope = |corner: usize, axis: usize| match corner {
        0 => -1.0,
        _ if corner == axis + 1 => 1.0,
        _ => 0.0,
    };
    let mut shape = ShapePoint { weight, place: at, values: [0.0; N], gradients: [[0.0; D]; N] };
    for (place, (value, gradient)) in shape.values.iter_mut().zip(&mut shape.gradients).enumerate() {
        if let Some([one, other]) = place.checked_sub(D + 1).and_then(|edge| EDGES_OF_SIMPLEX.get(edge)) {
            let (first, second) = (barycentric(*one), barycentric(*other));
            *value = 4.0 * first * second;
            *gradient = std::array::from_fn(|axis| 4.0 * (slope(*one, axis) * second + first * slope(*other, axis)));
        } else {
            let own = barycentric(place);
            let (of_value, of_slope) = if N == D + 1 { (own, 1.0) } else { (own * (2.0 * own - 1.0), 4.0 * own - 1.0) };
            *value = of_value;
            *gradient = std::array::from_fn(|axis| of_slope * slope(place, axis));
        }
    }
    shape
}
