//! The plane of two null vectors of a mode's equations, and how paths leave a fold in it.
//!
//! With the left null vector `ψ` and coordinates `w`, `p` along an orthonormal basis the equations are, to second order and
//! beside what the others make of it,
//!
//! ```text
//! σ·(w, p) + ½ ψ·F''(x, x) = 0,      σ = ψ·F_x of the basis.
//! ```
//!
//! `σ` is zero at a point that is singular. Where the form has two roots, branches cross there. Where it has one, twice, all
//! its curvature `c` is along one vector `g`, across the root `f`:
//!
//! ```text
//! σ w + ½ c p² = 0
//! ```
//!
//! but for where `p` is as small as `σ`. With `σ = 0` that is the line along `f`, in both senses. With a `σ` that is not
//! zero, but so small that the path bends within less than a step can tell, it is a parabola whose arms leave along `f` in one
//! sense: `x = f h ± g (2 |σ/c| h)^½`.

use super::super::directions::RANK;
use super::super::singular::scaled_rows;
use super::super::state::Rate;
use super::{NO_CURVATURE, Null, Point};
use crate::linear_algebra::{nearest_null_space, null_space_as_scaled};
use nalgebra::{DMatrix, DVector, Matrix2};

/// Parts of null vectors of which no motion is left are none.
const NO_MOTION: f64 = 1e-8;
/// Parabolas that are no wider than this at a unit arc length are lines: rounding of the equations moves a point at the fold
/// as far.
const NO_WIDTH: f64 = 1e-7;

/// A double root.
pub(super) struct Fold {
    /// `f`
    pub flat: Null,
    /// `g`
    steep: Null,
    /// `(2 |σ/c|)^½`
    width: f64,
    /// In which sense of `f` the arms leave.
    sense: f64,
}

/// The directions of a plane.
pub(super) enum Plane {
    /// All of it, to second order.
    Continuum,
    /// None, or the roots that cross.
    Roots(Vec<Null>),
    Fold(Box<Fold>),
}

impl Fold {
    /// Whether it is a line in both senses.
    pub fn is_straight(&self) -> bool {
        self.width <= NO_WIDTH
    }

    /// The direction in which the arms leave.
    pub fn ahead(&self, point: &Point<'_>) -> Null {
        point.combined(std::slice::from_ref(&self.flat), &[self.sense])
    }

    /// Across that, how far the arm towards a rate lies off it at a unit arc length.
    pub fn beside(&self, towards: &Rate) -> Rate {
        let mut beside = self.steep.rate.clone();
        beside.scale(self.width.copysign(beside.product(towards)));
        beside
    }

    /// Both arms.
    pub fn arms(&self) -> [Rate; 2] {
        let beside = self.beside(&self.steep.rate);
        let mut other = beside.clone();
        other.scale(-1.0);
        [beside, other]
    }
}

impl Point<'_> {
    /// The null vectors of the mode, orthonormal in displacements and load.
    pub(super) fn orthonormal_nulls(&self) -> Option<Vec<Null>> {
        let (matrix, _) = scaled_rows(&self.system, self.here.loading, self.here.state);
        self.orthonormal(&null_space_as_scaled(matrix, RANK)?)
    }

    fn orthonormal(&self, basis: &DMatrix<f64>) -> Option<Vec<Null>> {
        let mut nulls: Vec<Null> = Vec::with_capacity(basis.ncols());
        for column in basis.column_iter() {
            let values = column.into_owned();
            let mut null = Null { rate: self.system.rate_from(self.here.state, &values), values };
            let whole = null.rate.size();
            // Once more for what rounding left.
            for _ in 0..2 {
                for known in &nulls {
                    let share = null.rate.product(&known.rate);
                    null = self.combined(&[null, known.clone()], &[1.0, -share]);
                }
            }
            let size = null.rate.size();
            if !(size.is_finite() && size > NO_MOTION * whole && size > NO_MOTION * null.rate.largest_reaction()) {
                return None;
            }
            nulls.push(self.combined(&[null], &[1.0 / size]));
        }
        Some(nulls)
    }

    /// The plane that comes nearest to two null vectors.
    pub(super) fn plane(&self) -> Option<Plane> {
        let (matrix, sizes) = scaled_rows(&self.system, self.here.loading, self.here.state);
        let left = nearest_null_space(matrix.transpose(), 1)?.column(0).component_div(&sizes);
        let nulls = self.orthonormal(&nearest_null_space(matrix, 2)?)?;
        let [first, second] = &nulls[..] else { return None };
        let [along_first, along_second] = [first, second].map(|null| self.second_derivative(&null.rate));
        let mixed = left.dot(&along_first.times(&second.values));
        let form = Matrix2::new(
            left.dot(&along_first.times(&first.values)),
            mixed,
            mixed,
            left.dot(&along_second.times(&second.values)),
        );
        let size = left.amax() * along_first.amax().max(along_second.amax());
        let eigen = form.symmetric_eigen();
        let (steep, flat) = if eigen.eigenvalues[0].abs() >= eigen.eigenvalues[1].abs() { (0, 1) } else { (1, 0) };
        let (most, least) = (eigen.eigenvalues[steep], eigen.eigenvalues[flat]);
        if !most.is_finite() || most.abs() <= NO_CURVATURE * size {
            return Some(Plane::Continuum);
        }
        let combined = |weights: [f64; 2]| self.unit(&self.combined(&[first.clone(), second.clone()], &weights));
        let [flat, steep] = [flat, steep].map(|column| [0, 1].map(|row| eigen.eigenvectors[(row, column)]));
        if least.abs() > NO_CURVATURE * most.abs() {
            if least * most > 0.0 {
                return Some(Plane::Roots(Vec::new()));
            }
            let part = (-least / most).sqrt();
            let roots = [part, -part].map(|part| combined([0, 1].map(|row| flat[row] + part * steep[row])));
            return Some(Plane::Roots(roots.to_vec()));
        }
        Some(Plane::Fold(Box::new(self.fold(&left, combined(flat), combined(steep)))))
    }

    fn unit(&self, null: &Null) -> Null {
        self.combined(std::slice::from_ref(null), &[1.0 / null.rate.size()])
    }

    fn fold(&self, left: &DVector<f64>, mut flat: Null, steep: Null) -> Fold {
        let curvature = left.dot(&self.second_derivative(&steep.rate).times(&steep.values));
        // Differences along the root itself are exact where it is a straight line, and those along others are not.
        for _ in 0..2 {
            let mixed = left.dot(&self.second_derivative(&flat.rate).times(&steep.values));
            flat = self.unit(&self.combined(&[flat, steep.clone()], &[1.0, -mixed / curvature]));
        }
        let matrix = self.system.matrix(self.here.state);
        let slope = left.dot(&(matrix.rows(0, left.len()) * &flat.values));
        let ratio = slope / curvature;
        Fold { flat, steep, width: (2.0 * ratio.abs()).sqrt(), sense: -ratio.signum() }
    }
}
