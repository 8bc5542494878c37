//! The plane of two null vectors of a mode's equations, and how paths leave a fold in this plane; likewise for more
//! null vectors.
//!
//! With the left null vector `ψ` and coordinates `w`, `p` along an orthonormal basis the equations are, to second order
//! and apart from contributions of the other unknowns,
//!
//! ```text
//! σ·(w, p) + ½ ψ·F''(x, x) = 0,      σ = ψ·F_x of the basis.
//! ```
//!
//! `σ` is zero at a singular point. Where the quadratic form has two roots, branches cross there. Where it has a double
//! root `f`, all its curvature `c` is along one vector `g` orthogonal to `f`:
//!
//! ```text
//! σ w + ½ c p² = 0
//! ```
//!
//! except where `p` is as small as `σ`. With `σ = 0` the solution is the line along `f`, in both senses. With a `σ`
//! that is not zero, but so small that the path bends within less than a step can resolve, the solution is a parabola
//! whose arms leave along `f` in one sense: `x = f h ± g (2 |σ/c| h)^½`.
//!
//! Where several uncoupled parts are each at a fold, there is one equation for each part, and its form is the square of
//! one coordinate (the forms are of rank one, and their vectors independent):
//!
//! ```text
//! σ_j w + ½ c_j p_j² = 0
//! ```
//!
//! On the line along `f` all `p_j` are zero. Each part whose `σ_j` is not zero has two arms; branches exist only where
//! the arms of all these parts leave in the same sense of `f`.

use crate::algebra::{nearest_null_space, null_space_as_scaled};
use crate::branching::bifurcation::branch_directions::second_derivatives::Derivative;
use crate::branching::bifurcation::branch_directions::tolerances::{
    COORDINATE_RANK_TOLERANCE, CURVATURE_TOLERANCE, REMAINING_MOTION, SMALLEST_PARABOLA_WIDTH,
};
use crate::branching::bifurcation::branch_directions::{BranchingPoint, MOST_MODES, Null};
use crate::complementarity::rates::cartesian_product::combinations;
use crate::mechanics::equations::scaled_rows::scaled_rows;
use crate::mechanics::equations::tolerances::RANK_TOLERANCE;
use crate::mechanics::equations::{matrix, rate_recovery};
use crate::mechanics::problem::state::Rate;
use nalgebra::{DMatrix, DVector, DVectorView, Matrix2};

/// A double root of the bifurcation equation.
pub(super) struct Fold {
    /// `f`
    pub flat: Null,
    parts: Vec<FoldPart>,
}

/// One part of the structure at its fold.
struct FoldPart {
    /// `g`
    steep: Null,
    /// `(2 |σ/c|)^½`
    width: f64,
    /// Sense of `f` in which the arms leave.
    sense: f64,
}

/// The directions in a plane of null vectors.
pub(super) enum Plane {
    /// The whole plane, to second order.
    Continuum,
    /// No root, or the roots that cross.
    Roots(Vec<Null>),
    Fold(Box<Fold>),
}

impl Fold {
    /// Whether the fold is a line in both senses.
    pub fn is_straight(&self) -> bool {
        self.wide().next().is_none()
    }

    /// The parts that have arms.
    fn wide(&self) -> impl Iterator<Item = &FoldPart> {
        self.parts.iter().filter(|part| part.width > SMALLEST_PARABOLA_WIDTH)
    }

    /// The direction in which the arms leave; `None` where the arms of two parts leave in opposite senses.
    pub fn ahead(&self, point: &BranchingPoint<'_>) -> Option<Null> {
        let sense = self.wide().next()?.sense;
        let agree = self.wide().all(|part| part.sense == sense);
        agree.then(|| point.combined(std::slice::from_ref(&self.flat), &[sense]))
    }

    /// The offset, across that direction, of the arm towards a rate at a unit arc length.
    pub fn beside(&self, towards: &Rate) -> Option<Rate> {
        self.sum(self.wide().map(|part| part.width.copysign(part.steep.rate.product(towards))))
    }

    /// The offsets of all combinations of the parts' arms.
    pub fn arms(&self) -> Vec<Rate> {
        let senses: Vec<Vec<f64>> = self.wide().map(|part| vec![part.width, -part.width]).collect();
        combinations(&senses, MOST_MODES).filter_map(|chosen| self.sum(chosen.into_iter())).collect()
    }

    fn sum(&self, shares: impl Iterator<Item = f64>) -> Option<Rate> {
        let scaled = |(part, share): (&FoldPart, f64)| {
            let mut rate = part.steep.rate.clone();
            rate.scale(share);
            rate
        };
        self.wide().zip(shares).map(scaled).reduce(|mut sum, rate| {
            sum.add(&rate, 1.0);
            sum
        })
    }
}

/// The null vectors of the mode, orthonormal in displacements and load.
pub(super) fn orthonormal_nulls(point: &BranchingPoint<'_>) -> Option<Vec<Null>> {
    let (matrix, _) = scaled_rows(&point.system, point.here.loading, point.here.state);
    orthonormal(point, &null_space_as_scaled(matrix, RANK_TOLERANCE)?)
}

fn orthonormal(point: &BranchingPoint<'_>, basis: &DMatrix<f64>) -> Option<Vec<Null>> {
    let mut nulls: Vec<Null> = Vec::with_capacity(basis.ncols());
    for column in basis.column_iter() {
        let values = column.into_owned();
        let mut null = Null { rate: rate_recovery::rate_from(&point.system, point.here.state, &values), values };
        let whole = null.rate.size();
        // A second pass removes what round-off left.
        for _ in 0..2 {
            for known in &nulls {
                let share = null.rate.product(&known.rate);
                null = point.combined(&[null, known.clone()], &[1.0, -share]);
            }
        }
        let size = null.rate.size();
        if !(size.is_finite()
            && size > REMAINING_MOTION * whole
            && size > REMAINING_MOTION * null.rate.largest_reaction())
        {
            return None;
        }
        nulls.push(point.combined(&[null], &[1.0 / size]));
    }
    Some(nulls)
}

/// The directions in the plane closest to two null vectors.
pub(super) fn plane(point: &BranchingPoint<'_>) -> Option<Plane> {
    let (matrix, sizes) = scaled_rows(&point.system, point.here.loading, point.here.state);
    let left = nearest_null_space(matrix.transpose(), 1)?.column(0).component_div(&sizes);
    let nulls = orthonormal(point, &nearest_null_space(matrix, 2)?)?;
    let [first, second] = &nulls[..] else { return None };
    let [along_first, along_second] = [first, second].map(|null| point.second_derivative(&null.rate));
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
    if !most.is_finite() || most.abs() <= CURVATURE_TOLERANCE * size {
        return Some(Plane::Continuum);
    }
    let combined = |weights: [f64; 2]| unit(point, &point.combined(&[first.clone(), second.clone()], &weights));
    let [flat, steep] = [flat, steep].map(|column| [0, 1].map(|row| eigen.eigenvectors[(row, column)]));
    if least.abs() > CURVATURE_TOLERANCE * most.abs() {
        if least * most > 0.0 {
            return Some(Plane::Roots(Vec::new()));
        }
        let part = (-least / most).sqrt();
        let roots = [part, -part].map(|part| combined([0, 1].map(|row| flat[row] + part * steep[row])));
        return Some(Plane::Roots(roots.to_vec()));
    }
    Some(Plane::Fold(Box::new(fold(point, &DMatrix::from_columns(&[left]), combined(flat), vec![combined(steep)]))))
}

/// The fold of `count` null vectors; `None` where the equations are not those of uncoupled parts.
pub(super) fn fold_of_parts(point: &BranchingPoint<'_>, count: usize) -> Option<Fold> {
    let (matrix, sizes) = scaled_rows(&point.system, point.here.loading, point.here.state);
    let mut left = nearest_null_space(matrix.transpose(), count.checked_sub(1)?)?;
    left.column_iter_mut().for_each(|mut column| column.component_div_assign(&sizes));
    let nulls = orthonormal(point, &nearest_null_space(matrix, count)?)?;
    let derivatives: Vec<Derivative> = nulls.iter().map(|null| point.second_derivative(&null.rate)).collect();
    let largest = derivatives.iter().map(Derivative::amax).fold(0.0, f64::max);
    // For each form the vector whose square it is.
    let mut squares = DMatrix::zeros(left.ncols(), count);
    for (mut row, left) in squares.row_iter_mut().zip(left.column_iter()) {
        let form = DMatrix::from_fn(count, count, |i, j| left.dot(&derivatives[i].times(&nulls[j].values)));
        let eigen = ((&form + form.transpose()) * 0.5).symmetric_eigen();
        let sizes = eigen.eigenvalues.abs();
        let most = sizes.imax();
        let is_square = (0..count).all(|other| other == most || sizes[other] <= CURVATURE_TOLERANCE * sizes[most]);
        if !(is_square && sizes[most] > CURVATURE_TOLERANCE * left.amax() * largest) {
            return None;
        }
        row.copy_from(&eigen.eigenvectors.column(most).transpose());
    }
    // Motions along each of which one coordinate changes, and the motion along which none does.
    let dual = squares.clone().pseudo_inverse(COORDINATE_RANK_TOLERANCE).ok()?;
    if (&squares * &dual - DMatrix::identity(left.ncols(), left.ncols())).amax() > COORDINATE_RANK_TOLERANCE {
        return None;
    }
    let motion = |weights: &DVector<f64>| unit(point, &point.combined(&nulls, weights.as_slice()));
    let flat = nearest_null_space(squares, 1)?.column(0).into_owned();
    let steep = dual.column_iter().map(|column| motion(&column.into_owned())).collect();
    Some(fold(point, &left, motion(&flat), steep))
}

fn unit(point: &BranchingPoint<'_>, null: &Null) -> Null {
    point.combined(std::slice::from_ref(null), &[1.0 / null.rate.size()])
}

fn fold(point: &BranchingPoint<'_>, left: &DMatrix<f64>, mut flat: Null, steep: Vec<Null>) -> Fold {
    let curvatures: Vec<f64> = left
        .column_iter()
        .zip(&steep)
        .map(|(left, steep)| left.dot(&point.second_derivative(&steep.rate).times(&steep.values)))
        .collect();
    // Differences along the root itself are exact where it is a straight line; differences along other vectors are not.
    for _ in 0..2 {
        let along = point.second_derivative(&flat.rate);
        let (mut nulls, mut weights) = (vec![flat], vec![1.0]);
        for ((left, steep), curvature) in left.column_iter().zip(&steep).zip(&curvatures) {
            weights.push(-left.dot(&along.times(&steep.values)) / curvature);
            nulls.push(steep.clone());
        }
        flat = unit(point, &point.combined(&nulls, &weights));
    }
    let force = matrix::rate_matrix(&point.system, point.here.state).rows(0, left.nrows()) * &flat.values;
    let part = |((left, steep), curvature): ((DVectorView<'_, f64>, Null), &f64)| {
        let ratio = left.dot(&force) / curvature;
        FoldPart { steep, width: (2.0 * ratio.abs()).sqrt(), sense: -ratio.signum() }
    };
    let parts = left.column_iter().zip(steep).zip(&curvatures).map(part).collect();
    Fold { flat, parts }
}
