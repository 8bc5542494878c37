//! Feasible directions, the prior motion of the path, and the rules by which one direction is taken.

use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::candidate::difference_of_forces;
use crate::branching::directions::tolerances::{RETRACE_FORCES, RETRACE_MOTION, STATIONARY_LOAD_RATE};
use crate::complementarity::rate_search::branch_and_bound::Effort;
use crate::mechanics::contact::Mode;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces::whole_rates;
use crate::mechanics::problem::state::{Rate, State, dot};
use crate::mechanics::problem::work_and_dissipation;
use crate::mechanics::structure::following_loads;
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use serde::{Deserialize, Serialize};

/// Which direction is taken where there are several. `max_dissipation`: that of largest dissipation per arc length;
/// `min_potential_energy`: that along which the potential energy of structure and loads falls fastest per arc length; ties of
/// both go to the straightest; `straightest`: that whose displacement rate makes the smallest angle with the incoming one.
#[warn(missing_docs)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Selection {
    /// The largest dissipation per arc length.
    #[default]
    MaxDissipation,
    /// The fastest fall of the potential energy of structure and loads per arc length.
    MinPotentialEnergy,
    /// The smallest angle of the displacement rate with the incoming one.
    Straightest,
}

/// A feasible direction, confirmed beyond first order where first order does not suffice.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DirectionChoice {
    pub rate: Rate,
    pub modes: Vec<Mode>,
    pub dissipation: f64,
    /// Rate of the potential energy of structure and loads, `Π̇ = -D - ṡ f·u`.
    pub potential_rate: f64,
    /// Sign of the load rate; where it is zero at first order, the sign of the subsequent load rate, if determined.
    pub load_sign: f64,
    pub retrace: bool,
    pub mechanism: bool,
    /// The equations of its mode have a second null vector here, exactly or nearly: see `branch_directions`.
    #[serde(default)]
    pub is_singular: bool,
    /// Offset of the path from such a direction at unit arc length; it grows with the square root of the arc length.
    #[serde(default)]
    pub beside: Option<Rate>,
    /// A step along the direction, or second order, has confirmed it; otherwise it holds at first order.
    #[serde(skip)]
    pub is_tried: bool,
    /// Factorisation for the step along the direction.
    #[serde(skip)]
    pub cached: CachedFactorisation,
}

/// Motion of the path before the point.
#[derive(Debug, Clone, Copy)]
pub enum PriorMotion<'a> {
    Incoming(Incoming<'a>),
    /// A stage begins: the load is to rise; ties go to the motion in the direction of the load pattern. Where the stage
    /// before ended at a limit point and the forces do no work on the motion there, ties go to that motion, `free`, over
    /// all degrees of freedom.
    StageStart {
        free: Option<&'a [f64]>,
    },
}

/// Settings and scales of a decision.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    pub selection: Selection,
    /// Whether directions along which the load falls are taken only where there is no other.
    pub load_rises: bool,
    pub effort: Effort<'a>,
    pub force_scale: f64,
}

/// Marks the direction that retraces the path: the closest to the reversed incoming one, as several may be close.
pub fn mark_retrace(loading: Loading<'_>, state: &State, options: &mut [DirectionChoice], incoming: &Rate) {
    let off = |option: &DirectionChoice| off_reverse(loading, state, &option.rate, incoming);
    let back = options.iter_mut().filter_map(|option| Some((off(option)?, option)));
    if let Some((_, option)) = back.min_by(|a, b| a.0.total_cmp(&b.0)) {
        option.retrace = true;
    }
}

/// Rate of the potential energy of structure and loads, `Π̇ = -D - ṡ f·u`, plus the power of moving supports and
/// obstacles.
pub fn potential_rate(loading: Loading<'_>, state: &State, rate: &Rate, dissipation: f64) -> f64 {
    let driven = if loading.pattern.moves_boundary() {
        work_and_dissipation::boundary_force(loading, (state, rate)).0 * rate.load
    } else {
        0.0
    };
    let mut power = dot(&loading.pattern.forces, &state.displacement);
    if loading.structure.has_following_loads() {
        // At the present place, as a dead load of the same size.
        let by_load = following_loads::force_rates(loading.structure, &state.displacement, &loading.pattern.supports);
        power += dot(&by_load, &state.displacement);
    }
    driven - dissipation - rate.load * power
}

/// The sign of a load rate; 0 where it is stationary.
pub fn sign_of(load: f64) -> f64 {
    if load.abs() <= STATIONARY_LOAD_RATE { 0.0 } else { load.signum() }
}

/// Distance of a direction from the reversed incoming one, forces on the nodes included; `None` where it is another
/// direction.
pub(crate) fn off_reverse(loading: Loading<'_>, state: &State, rate: &Rate, incoming: &Rate) -> Option<f64> {
    let sums = rate.displacement.iter().zip(&incoming.displacement).map(|(a, b)| a + b);
    let motion = sums.chain(std::iter::once(rate.load + incoming.load)).map(|sum| sum * sum).sum::<f64>().sqrt();
    if motion > RETRACE_MOTION {
        return None;
    }
    let [own, other] = [rate, incoming].map(|rate| whole_rates(loading, state, rate));
    let forces = difference_of_forces(&own, &other, -1.0);
    (forces <= RETRACE_FORCES).then(|| motion.max(forces))
}

/// Whether two or more directions share the sign of the load rate. `taken_sign` replaces the sign of the direction
/// taken where its load rate is exactly zero (a smooth limit point: the subsequent sign).
pub fn is_bifurcation(options: &[DirectionChoice], taken: Option<usize>, taken_sign: Option<f64>) -> bool {
    let (mut rising, mut falling) = (0, 0);
    for (index, option) in options.iter().enumerate() {
        let sign = match taken_sign {
            Some(sign) if Some(index) == taken => sign,
            _ => option.load_sign,
        };
        if sign > 0.0 {
            rising += 1;
        } else if sign < 0.0 {
            falling += 1;
        }
    }
    rising >= 2 || falling >= 2
}

/// Whether the list contains more than one direction and its reverse.
pub fn is_worth_listing(options: &[DirectionChoice]) -> bool {
    match options {
        [] | [_] => false,
        [first, second] => first.rate.product(&second.rate) > -1.0 + 1e-9 || first.modes != second.modes,
        _ => true,
    }
}
