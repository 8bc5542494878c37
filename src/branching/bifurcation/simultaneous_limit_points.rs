//! Limit points shared by several motions: those of uncoupled or weakly coupled parts that are alike.
//!
//! Where the load rate is zero the equations of a mode without their load have a null vector. Of several uncoupled
//! parts each has a null vector, and where the parts are alike all of them appear at once. Then the equations bordered
//! by the path's direction are singular too, and Newton's method finds no point nearby. The point is found on the cubic
//! Hermite interpolant between regular points on both sides, closer and closer, as bifurcation points are (`locate`),
//! and accepted by its residual as every other point is.
//!
//! Second order determines which way each part continues. With `v_i` the null vectors, each of one part, and `φ_i` the
//! left null vectors, the load along `x = b_i v_i + ...` is
//!
//! ```text
//! s = s* + ½ σ_i b_i²,     σ_i = -φ_i·F''(v_i, v_i) / φ_i·F_s
//! ```
//!
//! and is the same for all parts: `b_i = ±|σ_i|^(-1/2)` for those that move. A part that slides against friction cannot
//! reverse, but may rest while the load falls; any other part continues or reverses. So there are `2^n` combinations
//! for `n` parts, including the one in which all rest. A small step confirms each direction.

use crate::algebra::scalar_root::find_root;
use crate::algebra::{nearest_null_space, null_space_as_scaled};
use crate::branching::bifurcation::branch_directions::{Branches, SingularPoint};
use crate::branching::bifurcation::locate::WIDTHS;
use crate::branching::bifurcation::singularity::tolerances::SINGULAR_PIVOT;
use crate::branching::bifurcation::tolerances::{COUPLING_TOLERANCE, DIFFERENCE_STEP, INCOMING_COSINE, RESTING_SPEED};
use crate::branching::directions::candidate::CandidateDirection;
use crate::branching::directions::feasible_direction::{DirectionChoice, potential_rate, sign_of};
use crate::branching::directions::trial_step::confirm_by;
use crate::complementarity::rates::cartesian_product::{combinations, count};
use crate::mechanics::contact::{Mode, Reaction, vector};
use crate::mechanics::equations::scaled_rows::scaled_rows;
use crate::mechanics::equations::{ModeSystem, matrix, rate_recovery};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::state::{Rate, State, dot};
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use crate::step::corrector::cost_counters::Work;
use crate::step::corrector::newton;
use crate::step::corrector::tolerances::ACCEPTED_RESIDUAL;
use crate::step::event_functions::EventFunction;
use crate::step::interpolation::{PlacedPoint, between, placed, unit};
use crate::step::mode_step::{Reached, StepStart};
use nalgebra::{DMatrix, DVector};

/// Lengths of the trial steps.
const TRIALS: [f64; 3] = [1e-3, 1e-2, 1e-4];

/// The limit point, shared by several motions, of a step that ends past it, with their number in `motions`; `None` for
/// any other limit point.
pub(crate) fn locate(
    start: &StepStart<'_>,
    event_function: EventFunction,
    end: &Reached,
    work: &mut Work,
) -> Option<Box<Reached>> {
    let system = ModeSystem::new(start.loading, start.modes, start.state);
    if system.has_tracks() || !start.loading.structure.allows_dense() {
        return None;
    }
    let value = |placed: &PlacedPoint| event_function.value(start.loading, start.modes, &placed.state, &placed.rate);
    let root_between = |left: &PlacedPoint, right: &PlacedPoint| {
        let at = |place: f64| {
            let (state, rate) = between(left, right, place);
            Some(event_function.value(start.loading, start.modes, &state, &unit(&rate)))
        };
        let (first, last) = (value(left), value(right));
        (first > 0.0 && last < 0.0).then(|| find_root(at, (left.place, first), (right.place, last), 0.0))?
    };
    let origin = PlacedPoint { place: 0.0, state: start.state.clone(), rate: start.rate.clone() };
    let (mut left, mut right) = (origin.clone(), placed(start, end));
    let (mut root, length) = (root_between(&left, &right)?, right.place);
    let mut best: Option<Box<Reached>> = None;
    let mut error = length.powi(4);
    for width in WIDTHS.map(|width| width * length) {
        let mut near = |place: f64| {
            let guess = between(&left, &right, place).0;
            start.reach_near(guess, place, work).map(|near| placed(start, &near)).ok()
        };
        let nearer = if root > width { near(root - width) } else { Some(origin.clone()) };
        let (Some(nearer), Some(farther)) = (nearer, near(root + width)) else { break };
        let Some(place) = root_between(&nearer, &farther) else { break };
        (left, right, root) = (nearer, farther, place);
        let (state, rate) = between(&left, &right, root);
        let corrected = newton::judged(&system, state, start.force_scale);
        if let Some(best) = &best {
            // The points of each round are at least four times closer.
            error = corrected.state.distance(&best.corrected.state) / 256.0;
        }
        let step = corrected.state.distance(start.state);
        let mut point = Reached::new(corrected, unit(&rate), step, error);
        point.drift = start.drift.cloned();
        best = Some(point);
    }
    let mut point = best.filter(|point| point.corrected.residual <= ACCEPTED_RESIDUAL)?;
    let null_vectors = |state: &State| {
        let (matrix, _) = scaled_rows(&system, start.loading, state);
        null_space_as_scaled(matrix, SINGULAR_PIVOT).map(|basis| basis.ncols())
    };
    point.motions = null_vectors(&point.corrected.state)?;
    // A part that is merely soft compared with a stiff one is not singular: it looks the same a little before the
    // point.
    (point.motions > 1 && null_vectors(&left.state) == Some(1)).then_some(point)
}

/// The motion of one part.
struct PartMotion {
    /// The null vector, scaled by `|σ|^(-1/2)`.
    rate: Rate,
    /// Sign of `σ`.
    sign: f64,
    /// Contacts that slide against friction along the motion.
    slides: Vec<usize>,
}

/// Whether a part continues, reverses or rests.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PartSense {
    On,
    Back,
    Rest,
}

/// The directions along which the load is stationary at a limit point shared by `motions` motions, the path's own
/// first; at most `most` combinations are examined. `None` where the motions are coupled.
pub(crate) fn directions(
    here: SingularPoint<'_>,
    modes: &[Mode],
    incoming: &Rate,
    motions: usize,
    most: u64,
) -> Option<Branches> {
    let parts = parts(here, modes, incoming, motions)?;
    let falls = parts.first()?.sign;
    let mut found = Branches { options: Vec::new(), degenerate: false, unexplored: 0 };
    let ways: Vec<Vec<PartSense>> = parts
        .iter()
        .map(|part| match (part.sign == falls, part.slides.is_empty()) {
            (true, true) => vec![PartSense::On, PartSense::Back],
            (true, false) => vec![PartSense::On, PartSense::Rest],
            (false, _) => vec![PartSense::Rest],
        })
        .collect();
    found.unexplored = count(&ways).saturating_sub(most);
    for chosen in combinations(&ways, most) {
        if chosen.iter().all(|way| *way == PartSense::Rest) {
            continue;
        }
        let mut rate = incoming.clone();
        rate.scale(0.0);
        let mut chosen_modes = modes.to_vec();
        for (part, way) in parts.iter().zip(&chosen) {
            match way {
                PartSense::On => rate.add(&part.rate, 1.0),
                PartSense::Back => rate.add(&part.rate, -1.0),
                PartSense::Rest => part.slides.iter().for_each(|contact| chosen_modes[*contact] = Mode::Stick),
            }
        }
        let Some(rate) = rate.normalised() else { continue };
        let is_own = rate.product(incoming) > INCOMING_COSINE;
        let rate = if is_own { incoming.clone() } else { rate };
        match tried(here, rate, chosen_modes) {
            Some(choice) if is_own => found.options.insert(0, choice),
            Some(choice) => found.options.push(choice),
            None => found.degenerate |= is_own,
        }
    }
    Some(found)
}

/// A direction confirmed by a small step along it; `None` where the step does not confirm it.
fn tried(here: SingularPoint<'_>, rate: Rate, modes: Vec<Mode>) -> Option<DirectionChoice> {
    let SingularPoint { loading, state, force_scale, .. } = here;
    let power = |(contact, reaction): (usize, &Reaction)| {
        -vector::dot(&reaction.tangential, &loading.relative_rate(contact, state, &rate))
    };
    let dissipation = state.reactions.iter().enumerate().map(power).sum();
    let candidate = CandidateDirection {
        rate,
        forces: Vec::new(),
        modes,
        alternatives: Vec::new(),
        weak: true,
        dissipation,
        cached: CachedFactorisation::default(),
    };
    let confirmed = |step: &f64| confirm_by(loading, state, &candidate, force_scale, &[*step]);
    let (modes, later) = TRIALS.iter().find_map(confirmed)?;
    let potential_rate = potential_rate(loading, state, &candidate.rate, dissipation);
    Some(DirectionChoice {
        load_sign: sign_of(later),
        potential_rate,
        dissipation,
        rate: candidate.rate,
        modes,
        retrace: false,
        mechanism: false,
        is_singular: false,
        beside: None,
        is_tried: true,
        cached: CachedFactorisation::default(),
    })
}

/// The motions of the parts, each in the sense of the incoming path.
fn parts(here: SingularPoint<'_>, modes: &[Mode], incoming: &Rate, motions: usize) -> Option<Vec<PartMotion>> {
    let SingularPoint { loading, state, standings, .. } = here;
    let system = ModeSystem::new(loading, modes, state);
    let load = loading.structure.unknowns();
    let (scaled, sizes) = scaled_rows(&system, loading, state);
    let square = scaled.remove_column(load);
    let right = nearest_null_space(square.clone(), motions)?;
    let mut left = nearest_null_space(square.transpose(), motions)?;
    left.column_iter_mut().for_each(|mut column| column.component_div_assign(&sizes));
    let by_load = matrix::rate_matrix(&system, state).column(load).rows(0, sizes.len()).into_owned();
    let mut known = Vec::with_capacity(motions);
    for column in right.column_iter() {
        let values = column.into_owned().insert_row(load, 0.0);
        let mut rate = rate_recovery::rate_from(&system, state, &values);
        let size = rate.size();
        if size <= 0.0 {
            return None;
        }
        rate.scale(1.0 / size);
        known.push((rate, values / size));
    }
    // For each left null vector and each pair of motions.
    let mut second = vec![DMatrix::zeros(motions, motions); motions];
    for (i, (along, _)) in known.iter().enumerate() {
        let [ahead, behind] =
            [DIFFERENCE_STEP, -DIFFERENCE_STEP].map(|by| matrix::rate_matrix(&system, &state.advanced(along, by)));
        let change: DMatrix<f64> = (ahead - behind).rows(0, sizes.len()) / (2.0 * DIFFERENCE_STEP);
        for (j, (_, values)) in known.iter().enumerate() {
            let curved: DVector<f64> = &change * values;
            for (k, second) in second.iter_mut().enumerate() {
                let left = left.column(k);
                second[(i, j)] = -left.dot(&curved) / left.dot(&by_load);
            }
        }
    }
    let mut parts = Vec::with_capacity(motions);
    for (i, (mut rate, _)) in known.into_iter().enumerate() {
        // The left null vector of the same part.
        let own = (0..motions).max_by(|a, b| second[*a][(i, i)].abs().total_cmp(&second[*b][(i, i)].abs()))?;
        let value = second[own][(i, i)];
        let rest = second[own].iter().map(|other| other.abs()).sum::<f64>() - value.abs();
        if !value.is_finite() || value == 0.0 || rest > COUPLING_TOLERANCE * value.abs() {
            return None;
        }
        let along = dot(&rate.displacement, &incoming.displacement);
        rate.scale(if along < 0.0 { -1.0 } else { 1.0 } / value.abs().sqrt());
        let slides = |contact: &usize| {
            let moves = vector::size(&loading.relative_rate(*contact, state, &rate)) > RESTING_SPEED * rate.size();
            moves && matches!(standings[*contact], Standing::OnCone { .. })
        };
        let slides = (0..modes.len()).filter(slides).collect();
        parts.push(PartMotion { rate, sign: value.signum(), slides });
    }
    Some(parts)
}
