//! The eigenvalues of one contact mode, and their motions.

use crate::branching::stability::AssessedState;
use crate::branching::stability::tolerances::{MOST_ITERATIONS, MULTIPLE, NEUTRAL, REAL};
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
    /// The inverse of the rate equations at a constant load.
    inverse: DMatrix<f64>,
    /// The eigenvalues of its first block, `1/κ`; those of motions that contacts hold left out.
    compliances: Vec<Complex<f64>>,
    /// An eigenvalue `κ` is zero; it is none of the compliances.
    is_critical: bool,
}

impl<'a> ModeEigenvalues<'a> {
    /// The eigenvalues of a mode; `None` where the tangent is singular. At a critical point the eigenvalue of the present
    /// modes that is zero has a sign by chance, and is left out.
    pub fn in_modes(at: AssessedState<'a>, modes: &'a [Mode], work: &mut Work) -> Option<Self> {
        let AssessedState { loading, state, .. } = at;
        let unknowns = loading.structure.unknowns();
        let system = ModeSystem::new(loading, modes, state);
        let size = system.size() - 1;
        let equations = matrix::rate_matrix(&system, state).remove_row(size).remove_column(unknowns);
        work.factorisations += 1;
        let inverse = equations.try_inverse().filter(|inverse| inverse.iter().all(|value| value.is_finite()))?;
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
        let is_critical = at.is_critical && modes == at.modes && !compliances.is_empty();
        compliances.drain(..usize::from(is_critical));
        // The order of an eigenvalue does not depend on the iteration that found it.
        compliances.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        Some(Self { system, state, inverse, compliances, is_critical })
    }

    /// Number of eigenvalues with a negative real part.
    pub fn negative(&self) -> usize {
        self.compliances.iter().filter(|value| value.re < 0.0).count()
    }

    /// Whether two eigenvalues are a complex pair.
    pub fn is_complex(&self) -> bool {
        self.compliances.iter().any(|value| value.im.abs() > REAL * value.norm())
    }

    /// Whether an eigenvalue is zero up to the accuracy of a located point.
    pub fn is_neutral(&self) -> bool {
        self.is_critical || self.compliances.iter().any(|value| value.norm() * NEUTRAL >= 1.0)
    }

    /// The motions that grow, one for each negative real eigenvalue; `None` for an eigenvalue that has several.
    pub fn growing(&self) -> impl Iterator<Item = Option<Rate>> + '_ {
        let real = self.compliances.iter().filter(|value| value.re < 0.0 && value.im.abs() <= REAL * value.norm());
        real.map(|value| {
            let near = |other: &&Complex<f64>| (*other - value).norm() <= MULTIPLE * value.norm();
            if self.compliances.iter().filter(near).count() > 1 { None } else { self.motion(value.re) }
        })
    }

    /// The motion of a simple eigenvalue with its reactions, by inverse iteration.
    fn motion(&self, compliance: f64) -> Option<Rate> {
        let unknowns = self.system.loading.structure.unknowns();
        let mut shifted = self.inverse.view((0, 0), (unknowns, unknowns)).into_owned();
        // Beside the eigenvalue, where the matrix is regular.
        let shift = compliance * (1.0 + 0.01 * MULTIPLE);
        (0..unknowns).for_each(|place| shifted[(place, place)] -= shift);
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
