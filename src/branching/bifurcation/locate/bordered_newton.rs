//! The first crossing of a step for many unknowns, by sparse factorisations.
//!
//! Between two points of the path the equations change from `J` at some place by approximately `δ D`, with `D` their
//! rate of change between the points. Crossings are therefore expected where `(J + δ D) φ = 0`; block inverse iteration
//! with `J⁻¹ D` finds those nearest to the place first (B. N. Parlett, *The Symmetric Eigenvalue Problem*, SIAM 1998,
//! chapter 14). From there Newton's method finds the point (`singular_point`).

use crate::algebra::SystemFactorisation;
use crate::branching::bifurcation::locate::singular_point::LocatedSingularity;
use crate::branching::bifurcation::locate::tolerances::{
    BRACKET_MARGIN, CLUSTER_WIDTH, CONTINUATION_COSINE, COUNTING_OFFSET, DISTANCE_FROM_PATH, ORTHOGONAL_REMAINDER,
    REAL_EIGENVALUE_TOLERANCE, START_DISTANCE, TEST_FUNCTION_TOLERANCE,
};
use crate::branching::bifurcation::locate::{Crossing, Located};
use crate::branching::bifurcation::singularity::null_vectors::NullVectors;
use crate::branching::bifurcation::singularity::test_functions::{Signature, SignatureChange};
use crate::mechanics::equations::{Kind, ModeSystem, matrix, mode_factorisation, rate_recovery};
use crate::mechanics::problem::state::{Rate, State};
use crate::resources::budget;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::interpolation::{PlacedPoint, between, placed, unit};
use crate::step::mode_step::{Reached, StepStart};
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Rounds of block inverse iteration.
const ROUNDS: usize = 10;
/// Vectors of the block beyond the expected crossings: other eigenvalues nearby slow the convergence.
const BESIDE: usize = 3;
/// Largest number of vectors of the block: for more crossings eigenvalues are counted in shorter and shorter parts of
/// the step.
const MOST_IN_BLOCK: usize = 8;
/// Places in the bracket, relative to its length, from which its crossings are sought, one after another.
const FROM: [f64; 3] = [0.5, 0.2, 0.8];
/// Most brackets in which the first of several crossings is sought.
const MOST_BRACKETS: usize = 6;

/// An expected crossing.
struct Expected {
    place: f64,
    /// Motions that become free there.
    motions: Vec<Rate>,
}

/// The first crossing of a step, as [`crate::branching::bifurcation::locate::locate`] returns it; `None` where this
/// method does not find it.
pub(super) fn locate(
    start: &StepStart<'_>,
    before: Signature,
    change: SignatureChange,
    reached: &Reached,
) -> Option<Located> {
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    let origin = PlacedPoint { place: 0.0, state: start.state.clone(), rate: start.rate.clone() };
    let mut search = BorderedNewton { start, system: &system, left: origin, right: placed(start, reached) };
    for _ in 0..MOST_BRACKETS {
        let located = search.within(before, change)?;
        let is_first = match change {
            SignatureChange::Count { net, .. } if located.crossing.eigenvalues >= net.unsigned_abs() => true,
            SignatureChange::Count { .. } => search.is_first_counted(&located, before),
            SignatureChange::None | SignatureChange::Odd => search.is_first_by_sign(&located, before),
        };
        if is_first {
            return Some(located);
        }
        search.right = placed(start, &located.point);
    }
    None
}

struct BorderedNewton<'s, 'a> {
    start: &'s StepStart<'a>,
    system: &'s ModeSystem<'a>,
    left: PlacedPoint,
    right: PlacedPoint,
}

impl BorderedNewton<'_, '_> {
    /// A crossing between the ends of the bracket.
    fn within(&mut self, before: Signature, change: SignatureChange) -> Option<Located> {
        let count = match change {
            SignatureChange::Count { net, .. } => net.unsigned_abs(),
            SignatureChange::None | SignatureChange::Odd => 1,
        };
        let width = self.right.place - self.left.place;
        FROM.iter().find_map(|part| {
            let expected = self.expected(self.left.place + part * width, count)?;
            let mut from = 0;
            while let Some(first) = expected.get(from) {
                // Crossings close to the first may coincide with it.
                let near = |other: &&Expected| other.place - first.place <= CLUSTER_WIDTH * width;
                let close = expected[from..].iter().take_while(near).count();
                let located = self.crossing(&expected[from..from + close], before, change);
                if located.is_some() {
                    return located;
                }
                from += close;
            }
            None
        })
    }

    /// The crossings expected from the equations at a place and their change over the bracket, in order along the path.
    fn expected(&self, place: f64, count: usize) -> Option<Vec<Expected>> {
        let (state, rate) = between(&self.left, &self.right, place);
        let (system, width) = (self.system, self.right.place - self.left.place);
        let iterate = system.iterate(state.clone());
        let Some(SystemFactorisation::Sparse(factors)) =
            mode_factorisation::factorise_bordered(system, &iterate, &unit(&rate))
        else {
            return None;
        };
        let at = |state: &State| matrix::assemble_sparse(system, &system.iterate(state.clone()), Kind::Rates);
        let change = at(&self.right.state)?.minus(&at(&self.left.state)?, 1.0 / width);
        let size = system.size();
        let moving = system.loading.structure.unknowns() + 1;
        let block = (count + BESIDE).min(MOST_IN_BLOCK).min(moving - 1);
        // Components in every direction, the same in every run.
        let mut vectors = DMatrix::from_fn(size, block, |row, column| {
            let part = 0.5 + ((row * (5 + 2 * column) + 3 * column) % 13) as f64 / 26.0;
            if row >= moving {
                0.0
            } else if (row * 7 + row / 3 * column) % 11 < 5 {
                -part
            } else {
                part
            }
        });
        let mut ritz = DMatrix::zeros(block, block);
        for _ in 0..ROUNDS {
            budget::spend(size * block);
            vectors = orthonormal_columns(vectors, moving);
            let mut next = DMatrix::zeros(size, block);
            for (mut next, vector) in next.column_iter_mut().zip(vectors.column_iter()) {
                let mut product = -change.times(&vector.into_owned());
                product[size - 1] = 0.0;
                if !factors.solve_once(&mut product) {
                    return None;
                }
                next.copy_from(&product);
            }
            ritz = vectors.rows(0, moving).transpose() * next.rows(0, moving);
            vectors = next;
        }
        let values = ritz.complex_eigenvalues();
        let mut places: Vec<(f64, f64)> = values
            .iter()
            .filter(|value| value.re != 0.0 && value.im.abs() <= REAL_EIGENVALUE_TOLERANCE * value.re.abs())
            .map(|value| (place + 1.0 / value.re, value.re))
            .filter(|(found, _)| {
                *found >= self.left.place - BRACKET_MARGIN * width
                    && *found <= self.right.place + BRACKET_MARGIN * width
            })
            .collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let rate_of = |weights: DVector<f64>| {
            let values = &vectors * weights;
            rate_recovery::rate_at(system, &iterate, &values, Kind::Rates).normalised()
        };
        let mut expected = Vec::new();
        for close in places.chunk_by(|a, b| b.0 - a.0 <= CLUSTER_WIDTH * width) {
            // The invariant subspace of these eigenvalues.
            let product = close.iter().fold(DMatrix::identity(block, block), |product, (_, value)| {
                let scaled = &ritz / *value - DMatrix::identity(block, block);
                product * scaled
            });
            let vectors = product.svd(false, true).v_t?;
            let motions: Option<Vec<Rate>> =
                (0..close.len()).map(|index| rate_of(vectors.row(block - 1 - index).transpose())).collect();
            let motions = motions?;
            expected.push(Expected { place: close[0].0, motions });
        }
        Some(expected)
    }

    /// The crossing at which the expected motions become free, alone or together.
    fn crossing(&mut self, expected: &[Expected], before: Signature, change: SignatureChange) -> Option<Located> {
        let first = expected.first()?;
        let motions: Vec<Rate> = expected.iter().flat_map(|expected| expected.motions.iter().cloned()).collect();
        let (state, rate) = between(&self.left, &self.right, first.place);
        let mut singular = self.singular(state, &unit(&rate), motions)?;
        if singular.bordering.left.len() > 1 && singular.rest.amax() > TEST_FUNCTION_TOLERANCE {
            // The crossings are close to each other, but distinct.
            let (state, rate, motion) = singular.first_apart(self.start.state)?;
            singular = self.singular(state, &rate, vec![motion])?;
        } else if singular.bordering.left.len() > 1
            && let Some((state, ..)) = singular.first_apart(self.start.state)
        {
            // The crossings coincide within round-off: the point is that of the first.
            singular.state = state;
        }
        self.located(&singular, before, change)
    }

    /// Newton's method for the singular point.
    fn singular(&self, state: State, along: &Rate, motions: Vec<Rate>) -> Option<LocatedSingularity<'_>> {
        let reach = self.right.place - self.left.place;
        let is_ahead = |state: &State| state.distance(self.start.state) > START_DISTANCE;
        LocatedSingularity::near(self.system, state, (along, motions), (reach, &is_ahead))
    }

    /// The singular point as the end of a step, where it continues the path.
    fn located(
        &self,
        singular: &LocatedSingularity<'_>,
        before: Signature,
        change: SignatureChange,
    ) -> Option<Located> {
        let BorderedNewton { start, system, .. } = self;
        let place = singular.state.distance(start.state);
        if place <= START_DISTANCE || place > self.right.place {
            return None;
        }
        let (near, rate) = between(&self.left, &self.right, place);
        if near.distance(&singular.state) > DISTANCE_FROM_PATH * self.right.place {
            return None;
        }
        let rate = singular.continued(&unit(&rate), CONTINUATION_COSINE)?;
        let corrected = newton::accepted(system, singular.state.clone(), start.force_scale)?;
        let corank = singular.bordering.left.len();
        let eigenvalues = match change {
            SignatureChange::Count { net, .. } => corank.min(net.unsigned_abs()),
            SignatureChange::None | SignatureChange::Odd => corank,
        };
        let (right, left) = (singular.bordering.right.clone(), singular.bordering.left.clone());
        let nulls = (eigenvalues == corank).then(|| Arc::new(NullVectors { right, left }));
        let mut after = before.past(change, eigenvalues)?;
        if change == SignatureChange::Odd && before.negative.is_some() {
            // Whether the count includes these motions is unknown: it excludes motions that move slipping contacts.
            after.negative = self.counted(&corrected.state, &rate, 1.0, after);
        }
        let crossing = Crossing { eigenvalues, grazing: false, after, nulls };
        let error = singular.bordering.state.distance(&singular.state);
        let mut point = Reached::new(corrected, rate, place, error.powi(2).max(f64::EPSILON));
        point.drift = start.drift.cloned();
        Some(Located { point, crossing, between: None })
    }

    /// Whether an even number of other crossings lies before this one.
    fn is_first_by_sign(&self, located: &Located, before: Signature) -> bool {
        let Reached { corrected, rate, .. } = &*located.point;
        let state = corrected.state.advanced(rate, -COUNTING_OFFSET * self.right.place);
        let factors = mode_factorisation::factorise_bordered(self.system, &self.system.iterate(state), rate);
        factors.is_some_and(|factors| factors.determinant_sign() == before.determinant)
    }

    /// Whether no other crossing lies before this one.
    fn is_first_counted(&self, located: &Located, before: Signature) -> bool {
        let Reached { corrected, rate, .. } = &*located.point;
        self.counted(&corrected.state, rate, -1.0, before) == before.negative
    }

    /// The number of negative eigenvalues just past a point (`way` 1) or just before it (`way` -1).
    fn counted(&self, point: &State, rate: &Rate, way: f64, signature: Signature) -> Option<usize> {
        let state = point.advanced(rate, way * COUNTING_OFFSET * self.right.place);
        let StepStart { loading, modes, state: start, .. } = *self.start;
        let mut work = Work::default();
        Signature::with_determinant(loading, modes, start, &state, signature.determinant, &mut work)?.negative
    }
}

/// Orthonormalises columns over their first rows; a column in the span of the others becomes zero.
fn orthonormal_columns(mut vectors: DMatrix<f64>, rows: usize) -> DMatrix<f64> {
    for index in 0..vectors.ncols() {
        let before = vectors.column(index).rows(0, rows).norm();
        for _ in 0..2 {
            for other in 0..index {
                let product = vectors.column(index).rows(0, rows).dot(&vectors.column(other).rows(0, rows));
                let other = vectors.column(other).into_owned();
                vectors.column_mut(index).axpy(-product, &other, 1.0);
            }
        }
        let size = vectors.column(index).rows(0, rows).norm();
        if size > ORTHOGONAL_REMAINDER * before && size.is_finite() {
            vectors.column_mut(index).unscale_mut(size);
        } else {
            vectors.column_mut(index).fill(0.0);
        }
    }
    vectors
}
