//! Quadrature rules in natural coordinates: points and weights.
//!
//! On `[-1, 1]^D` products of Gauss's rules; on the unit simplex the symmetric rules of P. C. Hammer and A. H. Stroud
//! (Math. Tables Aids Comput. 10 (1956) 137) and, of degree 4 on triangles, of G. R. Cowper (Int. J. Numer. Methods Eng. 7
//! (1973) 405, doi:10.1002/nme.1620070316). Weights are positive.

/// Points with their weights.
pub type QuadratureRule<const D: usize> = Vec<([f64; D], f64)>;

/// Gauss's rule of 2 or 3 points along each axis, exact to degree 3 or 5.
pub fn gauss<const D: usize>(points: usize) -> QuadratureRule<D> {
    let line: &[(f64, f64)] = if points == 2 {
        &[(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)]
    } else {
        &[
            (-0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
            (0.0, 8.0 / 9.0),
            (0.774_596_669_241_483_4, 0.555_555_555_555_555_6),
        ]
    };
    let mut rule = vec![([0.0; D], 1.0)];
    for axis in 0..D {
        let extended = rule.iter().flat_map(|(place, weight)| {
            line.iter().map(move |(along, factor)| {
                let mut place = *place;
                place[axis] = *along;
                (place, weight * factor)
            })
        });
        rule = extended.collect();
    }
    rule
}

/// The centroid: exact to degree 1.
pub fn centroid<const D: usize>() -> QuadratureRule<D> {
    let corners = (D + 1) as f64;
    let volume = if D == 2 { 0.5 } else { 1.0 / 6.0 };
    vec![([1.0 / corners; D], volume)]
}

/// The rule of 3 points in the triangle and of 4 in the tetrahedron, exact to degree 2.
pub fn interior<const D: usize>() -> QuadratureRule<D> {
    let volume = if D == 2 { 0.5 } else { 1.0 / 6.0 };
    let small = if D == 2 { 1.0 / 6.0 } else { 0.138_196_601_125_010_5 };
    let weight = volume / (D + 1) as f64;
    let near_corner = |corner: usize| {
        let mut place = [small; D];
        if let Some(coordinate) = corner.checked_sub(1).and_then(|axis| place.get_mut(axis)) {
            *coordinate = 1.0 - D as f64 * small;
        }
        (place, weight)
    };
    (0..=D).map(near_corner).collect()
}

/// The rule of 6 points in the triangle, exact to degree 4.
pub fn triangle_of_degree_4() -> QuadratureRule<2> {
    let groups = [
        (0.445_948_490_915_964_9, 0.5 * 0.223_381_589_678_011_5),
        (0.091_576_213_509_770_74, 0.5 * 0.109_951_743_655_321_9),
    ];
    let of_group = |(near, weight): (f64, f64)| {
        let far = 1.0 - 2.0 * near;
        [([near, near], weight), ([far, near], weight), ([near, far], weight)]
    };
    groups.into_iter().flat_map(of_group).collect()
}
