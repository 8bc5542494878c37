//! A direction that exists, what is known of the way to the point, and the settings by which one direction is taken.

use crate::branching::directions::arrival_tangent::Incoming;
use crate::branching::directions::candidate::difference_of_forces;
use crate::complementarity::rate_search::branch_and_bound::Effort;
use crate::mechanics::contact::Mode;
use crate::mechanics::problem::energy;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_forces::whole_rates;
use crate::mechanics::problem::state::{Rate, State, dot};
use crate::step::corrector::cached_factorisation::AtHand;
use serde::{Deserialize, Serialize};

/// Which direction is taken where there are several. `max_dissipation`: that of largest dissipation per arc length;
/// `min_potential_energy`: that along which the potential energy of structure and loads falls fastest per arc length; ties of
/// both go to the straightest; `straightest`: that whose displacement rate makes the smallest angle with the incoming one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "server", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Selection {
    #[default]
    MaxDissipation,
    MinPotentialEnergy,
    Straightest,
}

/// A direction that exists.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DirectionChoice {
    pub rate: Rate,
    pub modes: Vec<Mode>,
    pub dissipation: f64,
    /// Rate of the potential energy of structure and loads, `Π̇ = -D - ṡ f·u`.
    pub potential_rate: f64,
    /// Sign of the load rate; where that is zero at first order, of the load rate that follows, if it was looked for.
    pub load_sign: f64,
    pub retrace: bool,
    pub mechanism: bool,
    /// The equations of its mode have another null vector here, or as good as that: see `branch_directions`.
    #[serde(default)]
    pub is_singular: bool,
    /// How far off the direction the path is then at a unit arc length; at others by the square root of that.
    #[serde(default)]
    pub beside: Option<Rate>,
    /// A step along it, or second order, has told that it holds; else first order has.
    #[serde(skip)]
    pub is_tried: bool,
    /// For the step along it.
    #[serde(skip)]
    pub at_hand: AtHand,
}

/// What the path was doing before.
#[derive(Debug, Clone, Copy)]
pub enum PriorMotion<'a> {
    Incoming(Incoming<'a>),
    /// A stage begins: the load is to rise; ties go to the motion that the pattern pushes.
    StageStart,
}

/// Load rates (of unit arc length) below this have no sign.
pub const STATIONARY: f64 = 1e-9;

/// Difference to the incoming direction reversed, of unit arc length, within which a direction may be the way back.
pub(crate) const BACK: f64 = 4e-5;

/// The same of the forces on the nodes, relative to the largest.
pub(crate) const BACK_FORCES: f64 = 1e-4;

/// Settings and scales of a decision.
#[derive(Debug, Clone, Copy)]
pub struct Rules<'a> {
    pub selection: Selection,
    pub effort: Effort<'a>,
    pub force_scale: f64,
}

/// Marks the way back. Several directions may run close to it; it is the closest.
pub fn mark_retrace(loading: Loading<'_>, state: &State, options: &mut [DirectionChoice], incoming: &Rate) {
    let off = |option: &DirectionChoice| off_reverse(loading, state, &option.rate, incoming);
    let back = options.iter_mut().filter_map(|option| Some((off(option)?, option)));
    if let Some((_, option)) = back.min_by(|a, b| a.0.total_cmp(&b.0)) {
        option.retrace = true;
    }
}

/// Rate of the potential energy of structure and loads, `Π̇ = -D - ṡ f·u`; what supports and obstacles that move put in
/// comes on top.
pub fn potential_rate(loading: Loading<'_>, state: &State, rate: &Rate, dissipation: f64) -> f64 {
    let driven = if loading.pattern.moves_boundary() {
        energy::boundary_force(loading, (state, rate)).0 * rate.load
    } else {
        0.0
    };
    driven - dissipation - rate.load * dot(&loading.pattern.forces, &state.displacement)
}

/// The sign of a load rate; 0 where it is stationary.
pub fn sign_of(load: f64) -> f64 {
    if load.abs() <= STATIONARY { 0.0 } else { load.signum() }
}

/// How far a direction is from the incoming one reversed, forces on the nodes included; `None` where it is another.
pub(crate) fn off_reverse(loading: Loading<'_>, state: &State, rate: &Rate, incoming: &Rate) -> Option<f64> {
    let sums = rate.displacement.iter().zip(&incoming.displacement).map(|(a, b)| a + b);
    let motion = sums.chain(std::iter::once(rate.load + incoming.load)).map(|sum| sum * sum).sum::<f64>().sqrt();
    if motion > BACK {
        return None;
    }
    let [own, other] = [rate, incoming].map(|rate| whole_rates(loading, state, rate));
    let forces = difference_of_forces(&own, &other, -1.0);
    (forces <= BACK_FORCES).then(|| motion.max(forces))
}

/// Whether two or more directions share the sign of the load rate. `taken_sign` replaces the sign of the direction
/// taken where its load rate is just zero (a smooth limit point: the sign that follows).
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

/// Whether the list says more than "on, or back".
pub fn is_worth_listing(options: &[DirectionChoice]) -> bool {
    match options {
        [] | [_] => false,
        [first, second] => first.rate.product(&second.rate) > -1.0 + 1e-9 || first.modes != second.modes,
        _ => true,
    }
}
