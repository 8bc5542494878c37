//! Acceleration of a fixed-point iteration `x ← g(x)` by Anderson's method: the next point is the combination of the last
//! images whose combined residual `g(x) - x` is least. With one unknown it is the secant method; for linear `g` it is
//! equivalent to GMRES.
//!
//! D. G. Anderson, J. ACM 12 (1965) 547, doi:10.1145/321296.321305; H. F. Walker, P. Ni, SIAM J. Numer. Anal. 49 (2011)
//! 1715, doi:10.1137/10078356X.

use nalgebra::{DMatrix, DVector};

/// Largest number of differences that are combined.
const DEPTH: usize = 8;
/// Differences whose part across the later ones is smaller, relative to the largest, are left out.
const SMALLEST_PART: f64 = 1e-10;

/// The last points of an iteration with their images.
#[derive(Debug, Default)]
pub(crate) struct Acceleration {
    residuals: Vec<DVector<f64>>,
    images: Vec<DVector<f64>>,
}

impl Acceleration {
    /// The next point, after a point and its image, both of the length of those before; residuals are compared by these
    /// weights.
    pub fn next(&mut self, point: &[f64], image: &[f64], weights: &[f64]) -> Vec<f64> {
        let weights = DVector::from_column_slice(weights);
        let image = DVector::from_column_slice(image);
        self.residuals.push(&image - DVector::from_column_slice(point));
        self.images.push(image);
        if self.residuals.len() > DEPTH + 1 {
            self.residuals.remove(0);
            self.images.remove(0);
        }
        let last = self.residuals.len() - 1;
        for count in (1..=last.min(point.len())).rev() {
            // The latest differences come first: they stay where later columns depend on them.
            let differences = |of: &[DVector<f64>]| {
                let columns: Vec<_> = (0..count).map(|back| &of[last - back] - &of[last - back - 1]).collect();
                DMatrix::from_columns(&columns)
            };
            let weighted = DMatrix::from_diagonal(&weights) * differences(&self.residuals);
            let (orthogonal, triangular) = weighted.qr().unpack();
            let part = |column: usize| triangular[(column, column)].abs();
            let largest = (0..count).map(part).fold(0.0, f64::max);
            if (0..count).any(|column| part(column) <= SMALLEST_PART * largest) {
                continue;
            }
            let projected = orthogonal.transpose() * self.residuals[last].component_mul(&weights);
            if let Some(shares) = triangular.solve_upper_triangular(&projected) {
                let next = &self.images[last] - differences(&self.images) * shares;
                if next.iter().all(|value| value.is_finite()) {
                    return next.as_slice().to_vec();
                }
            }
        }
        self.images[last].as_slice().to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::Acceleration;

    /// Passes until the residual is below a bound.
    fn passes(map: impl Fn(&[f64]) -> Vec<f64>, start: &[f64], is_accelerated: bool) -> usize {
        let (mut acceleration, mut point) = (Acceleration::default(), start.to_vec());
        for pass in 1..200 {
            let image = map(&point);
            let residual = point.iter().zip(&image).map(|(x, g)| (g - x).abs()).fold(0.0, f64::max);
            if residual <= 1e-12 {
                return pass;
            }
            point = if is_accelerated { acceleration.next(&point, &image, &vec![1.0; point.len()]) } else { image };
        }
        200
    }

    #[test]
    fn one_unknown_converges_as_by_the_secant_method() {
        let map = |x: &[f64]| vec![x[0].cos()];
        assert!(passes(map, &[0.5], true) <= 7);
        assert!(passes(map, &[0.5], false) > 50);
    }

    #[test]
    fn a_linear_map_of_three_unknowns_needs_four_differences_at_most() {
        let map = |x: &[f64]| {
            vec![1.0 - 0.5 * x[0] - 0.4 * x[1], 0.3 - 0.4 * x[0] - 0.5 * x[1] - 0.1 * x[2], 0.2 - 0.6 * x[2]]
        };
        assert!(passes(map, &[0.0, 0.0, 0.0], true) <= 6);
        assert!(passes(map, &[0.0, 0.0, 0.0], false) > 60);
    }

    #[test]
    fn a_point_that_is_its_own_image_stays() {
        let mut acceleration = Acceleration::default();
        for _ in 0..3 {
            assert_eq!(acceleration.next(&[1.0, 2.0], &[1.0, 2.0], &[1.0, 1.0]), [1.0, 2.0]);
        }
    }
}
