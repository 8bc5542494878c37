//! The ray of one combination of options, exactly: the null vector of its equations in both senses.

use super::problem::RateProblem;
use crate::linear_algebra::null_space;
use nalgebra::{DMatrix, DVector};

/// Inequalities (of rates of unit arc length) that hold within this are weak.
pub const WEAK: f64 = 1e-9;
/// Relative pivot that decides the rank of a combination's equations.
pub const RANK: f64 = 1e-11;

/// What the equations of one combination leave.
pub enum Line {
    /// Rays of unit arc length whose inequalities hold, none to two; `true` where one of them holds with equality.
    Rays(Vec<(DVector<f64>, bool)>),
    /// More than one independent vector, one a column.
    Plane(DMatrix<f64>),
    /// A vector along which reactions change and nothing moves.
    Still,
    /// The equations hold a number that is not finite.
    NotFinite,
}

impl RateProblem {
    /// Arc length of a vector of weights.
    pub(super) fn size(&self, weights: &DVector<f64>) -> f64 {
        (&self.motion * weights).norm()
    }

    pub(super) fn line(&self, chosen: &[usize]) -> Line {
        let choices = || self.entities.iter().zip(chosen).map(|(entity, &choice)| &entity.options[choice]);
        let rows: Vec<usize> = choices().flat_map(|choice| choice.zero.iter().copied()).collect();
        let equations = self.forms.select_rows(&rows);
        let Some(basis) = null_space(&equations, RANK) else { return Line::NotFinite };
        if basis.ncols() > 1 {
            return Line::Plane(basis);
        }
        let mut rays = Vec::new();
        if basis.ncols() == 0 {
            return Line::Rays(rays);
        }
        let weights: DVector<f64> = basis.column(0).into_owned();
        let size = self.size(&weights);
        let reactions = &self.reactions * &weights;
        let largest = reactions.amax();
        if size.is_nan() || size <= WEAK * largest {
            return Line::Still;
        }
        for sense in [1.0, -1.0] {
            let weights = &weights * (sense / size);
            if let Some(weak) = self.holds(chosen, &weights) {
                rays.push((weights, weak));
            }
        }
        Line::Rays(rays)
    }

    /// Whether a ray of unit arc length satisfies a combination's equations.
    pub(super) fn is_on(&self, chosen: &[usize], weights: &DVector<f64>) -> bool {
        let force = self.force_tolerance(weights);
        self.entities.iter().zip(chosen).all(|(entity, &choice)| {
            entity.options[choice]
                .zero
                .iter()
                .all(|&form| self.value(form, weights).abs() <= if self.is_force[form] { force } else { WEAK })
        })
    }

    fn force_tolerance(&self, weights: &DVector<f64>) -> f64 {
        WEAK * (&self.reactions * weights).amax().max(f64::MIN_POSITIVE)
    }

    fn value(&self, form: usize, weights: &DVector<f64>) -> f64 {
        self.forms.row(form).iter().zip(weights.iter()).map(|(a, b)| a * b).sum()
    }

    /// Whether a ray of unit arc length satisfies a combination's inequalities; `Some(true)` where one of them holds with
    /// equality.
    pub(super) fn holds(&self, chosen: &[usize], weights: &DVector<f64>) -> Option<bool> {
        if !weights.iter().all(|weight| weight.is_finite()) {
            return None;
        }
        let force = self.force_tolerance(weights);
        let mut weak = false;
        for (entity, &choice) in self.entities.iter().zip(chosen) {
            for signed in &entity.options[choice].nonnegative {
                let value = signed.sign * self.value(signed.form, weights);
                let tolerance = if self.is_force[signed.form] { force } else { WEAK };
                if value.is_nan() || value < -tolerance {
                    return None;
                }
                weak |= value <= tolerance;
            }
        }
        Some(weak)
    }
}
