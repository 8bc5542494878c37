//! The directions at a smooth bifurcation point.
//!
//! With the path's direction `t`, null vectors `φ_i` without load and left null vectors `ψ_j` every branch's direction
//! `v = α t + Σ β_i φ_i` satisfies the bifurcation equation (H. B. Keller, in: Applications of Bifurcation Theory,
//! Academic Press 1977, 359; M. A. Crisfield, *Non-linear Finite Element Analysis of Solids and Structures* 2, Wiley
//! 1997, chapter 21)
//!
//! ```text
//! ψ_j F''(v, v) = 0.      One null vector: Q_tt = 0, so the other root is  v = 2 Q_tφ φ - Q_φφ t
//! ```
//!
//! `F''` comes from central differences of the tangent. Where `Q_φφ = 0` (a pitchfork) the direction is the null vector
//! itself. For several null vectors Newton's method seeks points of the branches on a small sphere, from directions
//! spread over the plane of the null vectors. Every point found lies on a branch; the list is not claimed to be
//! complete. For three and more null vectors it is marked `degenerate`, and so is a plane with more directions than the
//! equations have isolated roots: a continuum of branches, of which the list contains samples. For many unknowns, where
//! the null vectors are known from the location of the point, the equations reduced to the null vectors are solved
//! instead (`lyapunov_schmidt`).
//!
//! Where a direction leaves a contact's inequalities at equality (on the cone: the load rate along a branch is zero at
//! first order, and its sign at second order decides whether the contact continues to slip or sticks) a small step
//! determines the contact mode. Every direction in the list has been confirmed by a small step.
//!
//! Other modes of the contacts that can change have their own branches where their equations are singular at this
//! point, too: see `in_other_modes`. Where no direction of first order continues the path, `second_order_by_contact_mode`
//! examines the directions at second order.

pub(crate) mod lyapunov_schmidt;
pub(crate) mod null_plane_at_fold;
pub(crate) mod other_contact_modes;
pub(crate) mod second_derivatives;
pub(crate) mod second_order_by_contact_mode;
#[cfg(test)]
mod tests;
pub(crate) mod tolerances;

pub use second_order_by_contact_mode::{SecondOrderFindings, in_each_mode};

use crate::algebra::{nearest_null_space, null_space_as_scaled};
use crate::branching::bifurcation::branch_directions::tolerances::{
    COINCIDENCE_COSINE, CURVATURE_TOLERANCE, DERIVATIVE_ROUND_OFF, DOUBTFUL_MARGIN, SEARCH_RADIUS,
};
use crate::branching::bifurcation::singularity::null_vectors::NullVectors;
use crate::branching::bifurcation::singularity::tolerances::SINGULAR_PIVOT;
use crate::branching::directions::candidate::{Alternative, CandidateDirection};
use crate::branching::directions::feasible_direction::{DirectionChoice, potential_rate, sign_of};
use crate::branching::directions::trial_step::confirm_by;
use crate::mechanics::contact::vector::{add, dot};
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::equations::closing_equation::ArcLengthEquation;
use crate::mechanics::equations::scaled_rows::scaled_rows;
use crate::mechanics::equations::{ModeSystem, rate_recovery};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use crate::step::corrector::newton;
use lyapunov_schmidt::LyapunovSchmidtEquations;
use nalgebra::{DMatrix, DVector};
use second_derivatives::{Derivative, Null};

pub use other_contact_modes::{are_singular_in_all_modes, in_other_modes};

/// Branches at a point.
pub struct Branches {
    /// The path's own direction first.
    pub options: Vec<DirectionChoice>,
    /// Some branch may be missing, or the branches form a continuum.
    pub degenerate: bool,
    /// Modes that were not examined.
    pub unexplored: u64,
}

/// A singular point, with the loading, contact standings and force scale there.
#[derive(Clone, Copy)]
pub struct SingularPoint<'a> {
    pub loading: Loading<'a>,
    pub state: &'a State,
    pub standings: &'a [Standing],
    pub force_scale: f64,
}

/// Radii of the spheres on which branches are tried.
const RADII: [f64; 3] = [1e-3, 1e-2, 1e-4];
/// Directions around the plane of two null vectors.
const AROUND: usize = 36;
/// The most isolated roots besides the path that two cubics in two ratios have, each root taken in both senses.
const MOST_ISOLATED: usize = 8;
/// Modes that are examined besides the path's own.
const MOST_MODES: u64 = 64;

struct BranchingPoint<'a> {
    here: SingularPoint<'a>,
    modes: &'a [Mode],
    system: ModeSystem<'a>,
    /// Eigenvalues that are zero, where known.
    eigenvalues: Option<usize>,
    /// The null vectors, where they are already known.
    nulls: Option<&'a NullVectors>,
}

/// Lists the directions in the current mode, in which `eigenvalues` eigenvalues are zero; `tangent` is the path's own
/// direction, and `nulls` are the null vectors, where they are already known.
pub fn branches(
    here: SingularPoint<'_>,
    modes: &[Mode],
    tangent: &Rate,
    eigenvalues: usize,
    nulls: Option<&NullVectors>,
) -> Branches {
    let system = ModeSystem::new(here.loading, modes, here.state);
    let point = BranchingPoint { here, modes, system, eigenvalues: Some(eigenvalues), nulls };
    let mut back = tangent.clone();
    back.scale(-1.0);
    let mut found = Branches { options: Vec::new(), degenerate: false, unexplored: 0 };
    found.options.push(point.choice(tangent.clone(), modes.to_vec(), None, false));
    let keeps = |alternatives: Vec<Vec<Alternative>>| {
        alternatives.iter().all(|all| all.iter().any(|one| one.iter().all(|(contact, mode)| modes[*contact] == *mode)))
    };
    if point.alternatives(&back).is_some_and(keeps) {
        found.options.push(point.choice(back, modes.to_vec(), None, true));
    }
    let Some(directions) = point.directions(tangent, &mut found.degenerate) else {
        found.degenerate = true;
        return found;
    };
    for direction in directions {
        point.add_if_tried(direction, &mut found);
    }
    found
}

impl BranchingPoint<'_> {
    fn choice(&self, rate: Rate, modes: Vec<Mode>, later: Option<f64>, retrace: bool) -> DirectionChoice {
        let SingularPoint { loading, state, .. } = self.here;
        let first = sign_of(rate.load);
        let load_sign = if first == 0.0 { later.map_or(0.0, sign_of) } else { first };
        let slides = |(contact, mode): (usize, &Mode)| match mode {
            Mode::Slip { direction } => {
                loading.contacts[contact].friction.bound(state.reactions[contact].normal)
                    * dot(direction, &loading.relative_rate(contact, state, &rate))
            }
            Mode::Free | Mode::Stick => 0.0,
        };
        let dissipation = modes.iter().enumerate().map(slides).sum();
        let potential_rate = potential_rate(loading, state, &rate, dissipation);
        DirectionChoice {
            rate,
            modes,
            dissipation,
            potential_rate,
            load_sign,
            retrace,
            mechanism: false,
            is_singular: false,
            beside: None,
            is_tried: true,
            cached: CachedFactorisation::default(),
        }
    }

    /// Adds a direction that is not in the list yet, if its inequalities hold and a small step stays on a branch that
    /// leaves in this direction.
    fn add_if_tried(&self, direction: Rate, found: &mut Branches) {
        let SingularPoint { loading, state, force_scale, .. } = self.here;
        let Some(alternatives) = self.alternatives(&direction) else { return };
        let forces = direction.largest_reaction().max(f64::MIN_POSITIVE);
        let same = |known: &DirectionChoice| {
            let pairs = known.rate.reactions.iter().zip(&direction.reactions);
            let reactions =
                |(one, other): (&Reaction, &Reaction)| one.difference(other) <= 1e-4 * forces.max(force_scale);
            known.rate.product(&direction) > COINCIDENCE_COSINE && pairs.into_iter().all(reactions)
        };
        if found.options.iter().any(same) {
            return;
        }
        let modes = self.modes.to_vec();
        // Forces distinguish only the rays of the rate problem.
        let forces = Vec::new();
        let candidate = CandidateDirection {
            rate: direction,
            forces,
            modes,
            alternatives,
            weak: true,
            dissipation: 0.0,
            cached: CachedFactorisation::default(),
        };
        let tried = RADII.iter().find_map(|radius| confirm_by(loading, state, &candidate, force_scale, &[*radius]));
        match tried {
            Some((modes, later)) => found.options.push(self.choice(candidate.rate, modes, Some(later), false)),
            None => found.degenerate = true,
        }
    }

    /// The modes that each contact that can change admits along a direction; `None` where some contact admits none.
    fn alternatives(&self, rate: &Rate) -> Option<Vec<Vec<Alternative>>> {
        let SingularPoint { loading, state, standings, force_scale } = self.here;
        let forces = DOUBTFUL_MARGIN * rate.largest_reaction().max(force_scale);
        let mut all = Vec::new();
        for (contact, standing) in standings.iter().enumerate() {
            let (motion, change) = (loading.relative_rate(contact, state, rate), &rate.reactions[contact]);
            let normal = loading.frame(contact, state).normal;
            let friction = loading.contacts[contact].friction;
            // Each mode with the velocity and the force that are zero in it, and those that are nonnegative.
            let options = match standing {
                Standing::Settled(_) | Standing::Cornered { .. } => continue,
                Standing::OnCone { direction } => {
                    let slack = friction.slack(change, direction);
                    let along = dot(direction, &motion);
                    let slip = Mode::Slip { direction: *direction };
                    [(Mode::Stick, [along, 0.0], [0.0, slack]), (slip, [0.0, slack], [along, 0.0])]
                }
                Standing::Touching => {
                    let opening = dot(&normal, &motion);
                    let (closed, still, slack) = if loading.contacts[contact].tangents() > 0 {
                        let along = add(&motion, -opening, &normal);
                        (Mode::Stick, dot(&along, &along).sqrt(), friction.margin(change))
                    } else {
                        (Mode::Slip { direction: [0.0; 3] }, 0.0, change.normal)
                    };
                    let held = opening.abs().max(still);
                    [(closed, [held, 0.0], [0.0, slack]), (Mode::Free, [0.0, change.size()], [opening, 0.0])]
                }
            };
            let holds = |(_, zero, least): &(Mode, [f64; 2], [f64; 2])| {
                zero[0].abs() <= DOUBTFUL_MARGIN
                    && zero[1].abs() <= forces
                    && least[0] >= -DOUBTFUL_MARGIN
                    && least[1] >= -forces
            };
            let alternatives: Vec<Alternative> =
                options.iter().filter(|option| holds(option)).map(|(mode, ..)| vec![(contact, *mode)]).collect();
            if alternatives.is_empty() {
                return None;
            }
            all.push(alternatives);
        }
        Some(all)
    }

    /// Left and right null vectors; the left ones belong to the unscaled equations.
    fn null_vectors(&self) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        if let Some(NullVectors { left, right }) = self.nulls {
            return Some((DMatrix::from_columns(left), DMatrix::from_columns(right)));
        }
        let (matrix, sizes) = scaled_rows(&self.system, self.here.loading, self.here.state);
        let (mut left, right) = match self.eigenvalues {
            Some(count) => (nearest_null_space(matrix.transpose(), count)?, nearest_null_space(matrix, count + 1)?),
            None => (
                null_space_as_scaled(matrix.transpose(), SINGULAR_PIVOT)?,
                null_space_as_scaled(matrix, SINGULAR_PIVOT)?,
            ),
        };
        for mut column in left.column_iter_mut() {
            column.component_div_assign(&sizes);
        }
        Some((left, right))
    }

    /// The directions of the branches, without the path's own two. `None` where the null vectors cannot be determined.
    fn directions(&self, tangent: &Rate, degenerate: &mut bool) -> Option<Vec<Rate>> {
        let (left, basis) = self.null_vectors()?;
        let (own, others) = self.split(&basis, tangent)?;
        if others.is_empty() || left.ncols() != others.len() {
            return None;
        }
        if let [other] = &others[..] {
            return self.second_root(&left.column(0).into_owned(), &own, other, degenerate);
        }
        *degenerate |= others.len() > 2;
        let curved = self.is_curved(&left, &own, &others);
        let found = match self.nulls {
            Some(nulls) => self.solved_for(nulls, &own, &others, curved)?,
            None => self.sought(tangent, &own, &others, curved),
        };
        *degenerate |= found.is_empty() || found.len() % 2 == 1 || found.len() > MOST_ISOLATED;
        Some(found)
    }

    /// All directions of a mode in which no direction is known: the two senses of a line, or the roots of the
    /// bifurcation equation in a plane.
    fn all_directions(&self, degenerate: &mut bool) -> Option<Vec<Rate>> {
        let (left, basis) = self.null_vectors()?;
        let both = |null: &Null| {
            let size = null.rate.size();
            let mut ahead = null.rate.clone();
            ahead.scale(1.0 / size);
            let mut back = ahead.clone();
            back.scale(-1.0);
            [ahead, back]
        };
        let rates: Vec<Rate> = basis
            .column_iter()
            .map(|column| rate_recovery::rate_from(&self.system, self.here.state, &column.into_owned()))
            .collect();
        let largest = rates.iter().max_by(|a, b| a.load.abs().total_cmp(&b.load.abs()));
        let Some(first) = largest else { return Some(Vec::new()) };
        if first.size() <= SINGULAR_PIVOT * first.largest_reaction() {
            return None;
        }
        let (own, others) = self.split(&basis, first)?;
        match (&others[..], left.ncols()) {
            ([], _) => Some(both(&own).to_vec()),
            ([other], 1) => {
                let left = left.column(0).into_owned();
                let (along_own, along) = (self.second_derivative(&own.rate), self.second_derivative(&other.rate));
                let size = left.amax() * along_own.amax().max(along.amax());
                let flat = |value: f64| if value.abs() <= CURVATURE_TOLERANCE * size { 0.0 } else { value };
                let own_own = flat(left.dot(&along_own.times(&own.values)));
                let mixed = flat(left.dot(&along.times(&own.values)));
                let pure = flat(left.dot(&along.times(&other.values)));
                if own_own == 0.0 && mixed == 0.0 && pure == 0.0 {
                    *degenerate = true;
                }
                let discriminant = mixed * mixed - own_own * pure;
                if discriminant < 0.0 {
                    return Some(Vec::new());
                }
                let sum = -(mixed + discriminant.sqrt().copysign(mixed));
                // With the equation own² + 2 mixed m + pure m² = 0 in m: m = sum/pure and own/sum.
                let roots = [[pure, sum], [sum, own_own]].into_iter().filter(|root| root[0] != 0.0 || root[1] != 0.0);
                let combined = |root: [f64; 2]| self.combined(&[own.clone(), other.clone()], &root);
                Some(roots.flat_map(|root| both(&combined(root))).collect())
            }
            _ => None,
        }
    }

    /// The null space as the path's direction and orthonormal null vectors without load.
    fn split(&self, basis: &DMatrix<f64>, tangent: &Rate) -> Option<(Null, Vec<Null>)> {
        let nulls: Vec<Null> = basis
            .column_iter()
            .map(|column| {
                let values = column.into_owned();
                Null { rate: rate_recovery::rate_from(&self.system, self.here.state, &values), values }
            })
            .collect();
        let count = nulls.len();
        let gram = DMatrix::from_fn(count, count, |i, j| nulls[i].rate.product(&nulls[j].rate));
        let along = DVector::from_fn(count, |i, _| nulls[i].rate.product(tangent));
        let weights = gram.lu().solve(&along)?;
        let own = self.combined(&nulls, weights.as_slice());
        let mut others: Vec<Null> = Vec::new();
        let mut rest: Vec<Null> = nulls;
        // Without load where the path has a load rate, orthogonal to the path where it has none.
        let by_load = own.rate.load.abs() > 1e-6;
        for null in &mut rest {
            let share = if by_load { null.rate.load / own.rate.load } else { null.rate.product(&own.rate) };
            *null = self.combined(&[null.clone(), own.clone()], &[1.0, -share]);
        }
        while others.len() + 1 < count {
            for null in &mut rest {
                for other in &others {
                    let share = null.rate.product(&other.rate);
                    *null = self.combined(&[null.clone(), other.clone()], &[1.0, -share]);
                }
            }
            let largest = (0..rest.len()).max_by(|&a, &b| rest[a].rate.size().total_cmp(&rest[b].rate.size()))?;
            let null = rest.swap_remove(largest);
            let size = null.rate.size();
            if size < SINGULAR_PIVOT {
                return None;
            }
            others.push(self.combined(&[null], &[1.0 / size]));
        }
        Some((own, others))
    }

    fn combined(&self, nulls: &[Null], weights: &[f64]) -> Null {
        let mut values = DVector::zeros(self.system.size());
        for (null, weight) in nulls.iter().zip(weights) {
            values.axpy(*weight, &null.values, 1.0);
        }
        Null { rate: rate_recovery::rate_from(&self.system, self.here.state, &values), values }
    }

    fn second_derivative(&self, along: &Rate) -> Derivative {
        Derivative::new(&self.system, self.here.state, along)
    }

    fn second_root(&self, left: &DVector<f64>, own: &Null, other: &Null, degenerate: &mut bool) -> Option<Vec<Rate>> {
        let derivative = self.second_derivative(&other.rate);
        let mixed = left.dot(&derivative.times(&own.values));
        let pure = left.dot(&derivative.times(&other.values));
        let size = left.amax() * derivative.amax();
        let weights = if mixed.abs() > CURVATURE_TOLERANCE * size {
            let ratio = -0.5 * pure / mixed;
            let is_round_off = pure.abs() <= DERIVATIVE_ROUND_OFF * size;
            [1.0, if is_round_off || ratio.abs() <= CURVATURE_TOLERANCE { 0.0 } else { ratio }]
        } else {
            // The eigenvalue does not cross at first order.
            *degenerate = true;
            [1.0, 0.0]
        };
        let null = self.combined(&[other.clone(), own.clone()], &weights);
        let size = null.rate.size();
        let ahead = self.combined(&[null], &[1.0 / size]).rate;
        let mut back = ahead.clone();
        back.scale(-1.0);
        Some(vec![ahead, back])
    }

    /// Whether the bifurcation equations have quadratic terms in the null vectors alone: then branches leave with a
    /// load rate.
    fn is_curved(&self, left: &DMatrix<f64>, own: &Null, others: &[Null]) -> bool {
        let (mut mixed, mut pure) = (0.0_f64, 0.0_f64);
        for other in others {
            let derivative = self.second_derivative(&other.rate);
            mixed = mixed.max((left.transpose() * derivative.times(&own.values)).amax());
            for second in others {
                pure = pure.max((left.transpose() * derivative.times(&second.values)).amax());
            }
        }
        pure > CURVATURE_TOLERANCE * mixed
    }

    /// The directions of the branches by the equations reduced to the null vectors.
    fn solved_for(&self, nulls: &NullVectors, own: &Null, others: &[Null], curved: bool) -> Option<Vec<Rate>> {
        let reduced = LyapunovSchmidtEquations::new(&self.system, self.here.state, nulls, own, others, curved)?;
        let mut all = vec![own.clone()];
        all.extend_from_slice(others);
        let mut found: Vec<Rate> = Vec::new();
        for start in reduced.starts() {
            let Some(mut shares) = reduced.root(start) else { continue };
            if !curved {
                shares[0] = 0.0;
            }
            let Some(direction) = self.combined(&all, shares.as_slice()).rate.normalised() else { continue };
            let is_known = |other: &Rate| direction.product(other) > COINCIDENCE_COSINE;
            if direction.product(&own.rate).abs() < 0.999 * own.rate.size() && !found.iter().any(is_known) {
                found.push(direction);
            }
        }
        Some(found)
    }

    /// The directions of the branches from points on a small sphere, sought from directions around the plane of the
    /// null vectors.
    fn sought(&self, tangent: &Rate, own: &Null, others: &[Null], curved: bool) -> Vec<Rate> {
        let mut found: Vec<Rate> = Vec::new();
        let tilts: &[f64] = if curved { &[0.0, 0.5, -0.5] } else { &[0.0] };
        for (first, one) in others.iter().enumerate() {
            for two in &others[first + 1..] {
                for (tilt, number) in tilts.iter().flat_map(|tilt| (0..AROUND).map(move |number| (*tilt, number))) {
                    let angle = std::f64::consts::TAU * (number as f64 + 0.3) / AROUND as f64;
                    let (sine, cosine) = angle.sin_cos();
                    let mut rate = one.rate.clone();
                    rate.scale(cosine);
                    rate.add(&two.rate, sine);
                    rate.add(&own.rate, tilt);
                    let Some(mut direction) = self.branch_near(&rate) else { continue };
                    if !curved {
                        // No load rate: the part orthogonal to the null vectors is of the order of the radius.
                        let shares: Vec<f64> = others.iter().map(|null| direction.product(&null.rate)).collect();
                        direction = self.combined(others, &shares).rate;
                    }
                    let size = direction.size();
                    let flat: f64 = others.iter().chain([own]).map(|null| direction.product(&null.rate).powi(2)).sum();
                    if size < 0.5 || flat < 0.9 * size * size {
                        continue;
                    }
                    direction.scale(1.0 / size);
                    let known = |other: &Rate| direction.product(other) > COINCIDENCE_COSINE;
                    if direction.product(tangent).abs() < 0.999 && !found.iter().any(known) {
                        found.push(direction);
                    }
                }
            }
        }
        found
    }

    /// The direction of a branch at the point itself: chords to two radii, extrapolated to radius zero.
    fn branch_near(&self, direction: &Rate) -> Option<Rate> {
        let far = self.on_sphere(direction, SEARCH_RADIUS)?;
        let near = self.on_sphere(&far, 0.5 * SEARCH_RADIUS)?;
        let mut rate = near;
        rate.scale(2.0);
        rate.add(&far, -1.0);
        Some(rate)
    }

    /// The unit chord to a branch point at a radius.
    fn on_sphere(&self, direction: &Rate, radius: f64) -> Option<Rate> {
        let mut ahead = direction.clone();
        let size = ahead.size();
        ahead.scale(1.0 / size);
        let SingularPoint { state, force_scale, .. } = self.here;
        let guess = state.advanced(&ahead, radius);
        let closing = ArcLengthEquation { from: state, step: radius };
        let corrected = newton::correct(&self.system, guess, &closing, force_scale).ok()?;
        let mut chord = state.chord(&corrected.state);
        let size = chord.size();
        chord.scale(1.0 / size);
        Some(chord)
    }
}
