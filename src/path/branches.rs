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
//! itself. Several null vectors: points of the branches on a small sphere are sought by Newton's method from
//! directions spread over their plane. Those found are branches; that they are all is not claimed. For three and more
//! the list is marked `degenerate`. Every direction that is listed was tried with a small step.

use super::advance::MOST_TURN;
use super::critical::SINGULAR;
use super::decide::{Choice, potential_rate, sign_of};
use super::loading::Loading;
use super::mode_system::ModeSystem;
use super::newton::Place;
use super::singular::scaled_rows;
use super::state::{Rate, State};
use super::watch::{self, Watch};
use crate::contact::Mode;
use crate::linear_algebra::null_space_as_scaled;
use nalgebra::{DMatrix, DVector};

/// Branches at a point.
pub struct Branches {
    /// The path's own direction first.
    pub options: Vec<Choice>,
    /// Some branch may be missing.
    pub degenerate: bool,
}

/// Difference step (dimensionless) for the second derivative.
const DIFFERENCE: f64 = 1e-4;
/// Second derivatives up to this, relative to the largest, are zero.
const NO_CURVATURE: f64 = 1e-6;
/// Radii of the spheres on which branches are tried.
const RADII: [f64; 3] = [1e-3, 1e-2, 1e-4];
/// Radius of the sphere on which branches are sought.
const SOUGHT_AT: f64 = 1e-2;
/// Directions around the plane of two null vectors.
const AROUND: usize = 36;
/// Directions closer than this (cosine) are one.
const SAME: f64 = 1.0 - 1e-5;
/// Sliding backward beyond this (unit arc length) is not feasible.
const BACKWARD: f64 = 1e-9;

/// A null vector in both forms.
#[derive(Clone)]
struct Null {
    values: DVector<f64>,
    rate: Rate,
}

struct Point<'a> {
    loading: Loading<'a>,
    modes: &'a [Mode],
    state: &'a State,
    system: ModeSystem<'a>,
    force_scale: f64,
}

/// Lists the directions in the current mode; `tangent` is the path's own.
pub fn branches<'a>(
    loading: Loading<'a>,
    modes: &'a [Mode],
    state: &'a State,
    tangent: &Rate,
    force_scale: f64,
) -> Branches {
    let system = ModeSystem::new(loading, modes, state);
    let point = Point { loading, modes, state, system, force_scale };
    let mut back = tangent.clone();
    back.scale(-1.0);
    let mut found = Branches { options: Vec::new(), degenerate: false };
    found.options.push(point.choice(tangent.clone(), None, false));
    if point.slides_forward(&back) {
        found.options.push(point.choice(back, None, true));
    }
    let Some(directions) = point.directions(tangent, &mut found.degenerate) else {
        found.degenerate = true;
        return found;
    };
    for direction in directions {
        if !point.slides_forward(&direction) {
            continue;
        }
        match point.tried(&direction) {
            Some(sign) => found.options.push(point.choice(direction, Some(sign), false)),
            None => found.degenerate = true,
        }
    }
    found
}

impl Point<'_> {
    fn choice(&self, rate: Rate, later: Option<f64>, retrace: bool) -> Choice {
        let first = sign_of(rate.load);
        let load_sign = if first == 0.0 { later.unwrap_or(0.0) } else { first };
        let dissipation = (0..self.modes.len())
            .map(|contact| {
                self.loading.contacts[contact].friction
                    * self.state.reactions[contact].normal
                    * self.sliding(contact, &rate)
            })
            .sum();
        let potential_rate = potential_rate(self.loading, self.state, &rate, dissipation);
        let modes = self.modes.to_vec();
        Choice { rate, modes, dissipation, potential_rate, load_sign, retrace, mechanism: false }
    }

    fn sliding(&self, contact: usize, rate: &Rate) -> f64 {
        match self.modes[contact] {
            Mode::Slip { .. } => Watch::Sliding(contact).value(self.loading, self.modes, self.state, rate),
            Mode::Free | Mode::Stick => 0.0,
        }
    }

    fn slides_forward(&self, rate: &Rate) -> bool {
        watch::of_mode(self.loading, self.modes)
            .iter()
            .filter(|watch| matches!(watch, Watch::Sliding(_)))
            .all(|watch| watch.value(self.loading, self.modes, self.state, rate) >= -BACKWARD)
    }

    /// The branches' directions other than the path's own two. `None` where the null vectors cannot be had.
    fn directions(&self, tangent: &Rate, degenerate: &mut bool) -> Option<Vec<Rate>> {
        let (matrix, sizes) = scaled_rows(&self.system, self.loading, self.state);
        let mut left = null_space_as_scaled(matrix.transpose(), SINGULAR)?;
        let basis = null_space_as_scaled(matrix, SINGULAR)?;
        for mut column in left.column_iter_mut() {
            column.component_div_assign(&sizes);
        }
        let (own, others) = self.split(&basis, tangent)?;
        if others.is_empty() || left.ncols() != others.len() {
            return None;
        }
        if let [other] = &others[..] {
            return self.second_root(&left.column(0).into_owned(), &own, other, degenerate);
        }
        *degenerate |= others.len() > 2;
        let curved = self.is_curved(&left, &own, &others);
        let found = self.sought(tangent, &own, &others, curved);
        *degenerate |= found.is_empty() || found.len() % 2 == 1;
        Some(found)
    }

    /// The null space as the path's direction and orthonormal null vectors without load.
    fn split(&self, basis: &DMatrix<f64>, tangent: &Rate) -> Option<(Null, Vec<Null>)> {
        let nulls: Vec<Null> = basis
            .column_iter()
            .map(|column| {
                let values = column.into_owned();
                Null { rate: self.system.rate_from(self.state, &values), values }
            })
            .collect();
        let count = nulls.len();
        let gram = DMatrix::from_fn(count, count, |i, j| nulls[i].rate.product(&nulls[j].rate));
        let along = DVector::from_fn(count, |i, _| nulls[i].rate.product(tangent));
        let weights = gram.lu().solve(&along)?;
        let own = self.combined(&nulls, weights.as_slice());
        let mut others: Vec<Null> = Vec::new();
        let mut rest: Vec<Null> = nulls;
        // Without load where the path has a load rate, across the path where it has none.
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
            if size < SINGULAR {
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
        Null { rate: self.system.rate_from(self.state, &values), values }
    }

    /// `F''(v, ·)` by central differences.
    fn second_derivative(&self, along: &Rate) -> DMatrix<f64> {
        let ahead = self.system.matrix(&self.state.advanced(along, DIFFERENCE));
        let behind = self.system.matrix(&self.state.advanced(along, -DIFFERENCE));
        let rows = self.system.size() - 1;
        (ahead - behind).rows(0, rows) / (2.0 * DIFFERENCE)
    }

    fn second_root(&self, left: &DVector<f64>, own: &Null, other: &Null, degenerate: &mut bool) -> Option<Vec<Rate>> {
        let derivative = self.second_derivative(&other.rate);
        let mixed = left.dot(&(&derivative * &own.values));
        let pure = left.dot(&(&derivative * &other.values));
        let size = left.amax() * derivative.amax();
        let weights = if mixed.abs() > NO_CURVATURE * size {
            let ratio = -0.5 * pure / mixed;
            [1.0, if ratio.abs() <= NO_CURVATURE { 0.0 } else { ratio }]
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

    /// Whether the bifurcation equations have terms in the null vectors alone: then branches leave with a load rate.
    fn is_curved(&self, left: &DMatrix<f64>, own: &Null, others: &[Null]) -> bool {
        let (mut mixed, mut pure) = (0.0_f64, 0.0_f64);
        for other in others {
            let derivative = left.transpose() * self.second_derivative(&other.rate);
            mixed = mixed.max((&derivative * &own.values).amax());
            for second in others {
                pure = pure.max((&derivative * &second.values).amax());
            }
        }
        pure > NO_CURVATURE * mixed
    }

    /// Branches on a small sphere, from directions around the plane of the null vectors.
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
                        // No load rate: the part across the null vectors is of the order of the radius.
                        let shares: Vec<f64> = others.iter().map(|null| direction.product(&null.rate)).collect();
                        direction = self.combined(others, &shares).rate;
                    }
                    let size = direction.size();
                    let flat: f64 = others.iter().chain([own]).map(|null| direction.product(&null.rate).powi(2)).sum();
                    if size < 0.5 || flat < 0.9 * size * size {
                        continue;
                    }
                    direction.scale(1.0 / size);
                    let known = |other: &Rate| direction.product(other) > SAME;
                    if direction.product(tangent).abs() < 0.999 && !found.iter().any(known) {
                        found.push(direction);
                    }
                }
            }
        }
        found
    }

    /// The direction at the point itself of a branch found on the sphere: chords to two radii, extrapolated to none.
    fn branch_near(&self, direction: &Rate) -> Option<Rate> {
        let far = self.on_sphere(direction, SOUGHT_AT)?;
        let near = self.on_sphere(&far, 0.5 * SOUGHT_AT)?;
        let mut rate = near;
        rate.scale(2.0);
        rate.add(&far, -1.0);
        Some(rate)
    }

    /// The unit chord to the point of a branch at a radius.
    fn on_sphere(&self, direction: &Rate, radius: f64) -> Option<Rate> {
        let mut ahead = direction.clone();
        let size = ahead.size();
        ahead.scale(1.0 / size);
        let guess = self.state.advanced(&ahead, radius);
        let place = Place::ArcLength { from: self.state, step: radius };
        let corrected = self.system.correct(guess, place, self.force_scale).ok()?;
        let mut chord = self.state.chord(&corrected.state);
        let size = chord.size();
        chord.scale(1.0 / size);
        Some(chord)
    }

    /// Whether a small step along a direction stays on a branch that leaves this way: the sign of the load rate after it.
    fn tried(&self, direction: &Rate) -> Option<f64> {
        RADII.iter().find_map(|&radius| {
            let guess = self.state.advanced(direction, radius);
            let place = Place::ArcLength { from: self.state, step: radius };
            let corrected = self.system.correct(guess, place, self.force_scale).ok()?;
            if self.state.angle_of_chord(&corrected.state, direction) > 0.5 * MOST_TURN {
                return None;
            }
            let rate = self.system.tangent(&corrected, direction)?;
            Some(sign_of(rate.load))
        })
    }
}

#[cfg(test)]
mod tests;
