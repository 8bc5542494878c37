//! The eigenvalues of one contact mode, and their motions.

use crate::branching::stability::AssessedState;
use crate::branching::stability::tolerances::{
    CLEAR_OF_SHIFT, INVERSE_ERROR, MOST_ITERATIONS, MULTIPLE, NEUTRAL, REAL, SHIFTS,
};
use crate::mechanics::contact::Mode;
use crate::mechanics::equations::rate_recovery::rate_from;
use crate::mechanics::equations::{ModeSystem, matrix};
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cost_counters::Work;
use nalgebra::{Complex, DMatrix, DVector, Schur};

/// The eigenvalues of a contact mode.
pub(super) struct ModeEigenvalues<'a> {
    system: ModeSystem<'a>,
    state: &'a State,
    /// The inverse of the rate equations at a constant load, of `K - shift` in the place of `K`.
    inverse: DMatrix<f64>,
    shift: f64,
    /// The eigenvalues `κ` in order; those of motions that contacts hold are left out.
    eigenvalues: Vec<Complex<f64>>,
}

impl<'a> ModeEigenvalues<'a> {
    /// The eigenvalues of a mode; `None` where they are not found.
    ///
    /// The inverse has the soft motions exactly, however stiff others are. Where one of them has next to no stiffness its
    /// compliance hides the others, and the equations are shifted away from it.
    pub fn in_modes(at: AssessedState<'a>, modes: &'a [Mode], work: &mut Work) -> Option<Self> {
        let plain = Self::shifted(at, modes, 0.0, work).filter(|plain| !plain.is_neutral());
        let shifted = || {
            // An eigenvalue close to the shift would hide the others likewise.
            let is_clear = |found: &Self| {
                found.eigenvalues.iter().all(|value| (value - found.shift).norm() >= CLEAR_OF_SHIFT * found.shift)
            };
            SHIFTS.iter().find_map(|shift| Self::shifted(at, modes, *shift, work).filter(is_clear))
        };
        plain.or_else(shifted)
    }

    fn shifted(at: AssessedState<'a>, modes: &'a [Mode], shift: f64, work: &mut Work) -> Option<Self> {
        let AssessedState { loading, state, .. } = at;
        let unknowns = loading.structure.unknowns();
        let system = ModeSystem::new(loading, modes, state);
        let size = system.size() - 1;
        let mut equations = matrix::rate_matrix(&system, state).remove_row(size).remove_column(unknowns);
        (0..unknowns).for_each(|place| equations[(place, place)] -= shift);
        work.factorisations += 1;
        // The inverse of a matrix that is singular up to round-off is none, whatever its entries are.
        let is_inverse = |inverse: &DMatrix<f64>| {
            let error = (&equations * inverse - DMatrix::identity(size, size)).amax();
            error.is_finite() && error <= INVERSE_ERROR
        };
        let inverse = equations.clone().try_inverse().filter(is_inverse)?;
        let block = inverse.view((0, 0), (unknowns, unknowns)).into_owned();
        let asymmetry = (&block - block.transpose()).amax();
        let all: Vec<Complex<f64>> = if asymmetry <= REAL * block.amax() {
            let symmetric = (&block + block.transpose()) * 0.5;
            symmetric.symmetric_eigenvalues().iter().map(|value| Complex::new(*value, 0.0)).collect()
        } else {
            let most = MOST_ITERATIONS.saturating_mul(unknowns.max(1));
            Schur::try_new(block, f64::EPSILON, most)?.complex_eigenvalues().iter().copied().collect()
        };
        // As many as the contacts leave motions: the others are zero up to round-off.
        let mut compliances = all;
        compliances.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        compliances.truncate((2 * unknowns).saturating_sub(size));
        let mut eigenvalues: Vec<Complex<f64>> = compliances.iter().map(|value| value.inv() + shift).collect();
        // The order of an eigenvalue does not depend on the iteration that found it.
        eigenvalues.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        Some(Self { system, state, inverse, shift, eigenvalues })
    }

    /// Eigenvalues that are zero up to the accuracy of a located point, where their signs are by chance, left out.
    fn clear(&self) -> impl Iterator<Item = &Complex<f64>> {
        self.eigenvalues.iter().filter(|value| value.norm() > NEUTRAL)
    }

    /// Number of eigenvalues with a negative real part.
    pub fn negative(&self) -> usize {
        self.clear().filter(|value| value.re < 0.0).count()
    }

    /// Whether two eigenvalues are a complex pair.
    pub fn is_complex(&self) -> bool {
        self.clear().any(|value| value.im.abs() > REAL * value.norm())
    }

    /// Whether an eigenvalue is zero up to the accuracy of a located point.
    pub fn is_neutral(&self) -> bool {
        self.eigenvalues.iter().any(|value| value.norm() <= NEUTRAL)
    }

    /// The motions that grow, one for each negative real eigenvalue; `None` for an eigenvalue that has several.
    pub fn growing(&self) -> impl Iterator<Item = Option<Rate>> + '_ {
        let real = self.clear().filter(|value| value.re < 0.0 && value.im.abs() <= REAL * value.norm());
        real.map(|value| {
            let near = |other: &&Complex<f64>| (*other - value).norm() <= MULTIPLE * value.norm();
            if self.clear().filter(near).count() > 1 { None } else { self.motion(value.re) }
        })
    }

    /// The motion of a simple eigenvalue with its reactions, by inverse iteration.
    fn motion(&self, eigenvalue: f64) -> Option<Rate> {
        let unknowns = self.system.loading.structure.unknowns();
        let compliance = 1.0 / (eigenvalue - self.shift);
        let mut shifted = self.inverse.view((0, 0), (unknowns, unknowns)).into_owned();
        // Beside the eigenvalue, where the matrix is regular.
        let beside = compliance * (1.0 + 0.01 * MULTIPLE);
        (0..unknowns).for_each(|place| shifted[(place, place)] -= beside);
        let factors = shifted.lu();
        // No eigenvector is perpendicular to the whole of a start of incommensurable components, but by chance.
        let mut motion = DVector::from_fn(unknowns, |place, _| 1.0 + 0.5 * (1.0 + place as f64).sqrt().fract());
        for _ in 0..4 {
            motion = factors.solve(&motion)?;
            let size = motion.amax();
            if !(size.is_finite() && size > 0.0) {
                return None;
            }
            motion /= size;
        }
        let mut whole = DVector::zeros(self.inverse.nrows());
        whole.rows_mut(0, unknowns).copy_from(&motion);
        let values = &self.inverse * whole / compliance;
        Some(rate_from(&self.system, self.state, &values.insert_row(unknowns, 0.0)))
    }
}
