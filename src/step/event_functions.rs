//! The event functions of a mode: quantities that must not become negative while the mode lasts, and the ends of the
//! stage.
//!
//! ```text
//! free: g     stick: μ r_n ± r_t, or μ r_n - |r_t|     slip: r_n and d·ẋ_t     load rate's sign     bounds of a stage
//! ```
//!
//! Between two points each quantity is also interpolated by a cubic Hermite polynomial, so that a dip below zero inside
//! the step is detected.

use crate::algebra::dense::matrix_sink::Sink;
use crate::mechanics::contact::vector::{Vector, add, direction_of, dot, scaled, size};
use crate::mechanics::contact::{Mode, Sliding};
use crate::mechanics::equations::closing_equation::ClosingEquation;
use crate::mechanics::equations::stage_end_criteria::End;
use crate::mechanics::equations::{ModeSystem, matrix};
use crate::mechanics::multi_contact::changeable_contacts::none_from_cone;
use crate::mechanics::multi_contact::planar;
use crate::mechanics::multi_contact::spatial::ContactGroup;
use crate::mechanics::multi_contact::spatial::cone_sum;
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::node_contact_forces;
use crate::mechanics::problem::state::{Rate, State};
use crate::mechanics::problem::tolerances::LARGEST_ROUNDING_OF_FORCE;
use crate::step::tolerances::{EVENT_TOLERANCE, SHORTEST_PART, WAY_MARGIN};

/// An event function; negative values mean that the event has been passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EventFunction {
    Gap(usize),
    Normal(usize),
    /// `μ r_n + side r_t` along a line, `μ r_n - |r_t|` in a plane (side 0).
    Cone {
        contact: usize,
        side: f64,
    },
    Sliding(usize),
    /// The distance of the force on a node that several contacts hold in the plane from a bound of the sum of their
    /// cones.
    Facet {
        corner: usize,
        side: usize,
    },
    /// The margin of the force on such a node in space, or a guided one, against all slides.
    Slide {
        corner: usize,
    },
    /// Where such a node is held beyond any slide, the distance of the force from the bound of the sum of the cones ...
    Hold {
        corner: usize,
    },
    /// ... and its distance from the forces at which a slide is possible.
    Return {
        corner: usize,
    },
    LoadRate {
        sign: f64,
    },
    /// The distance of a closed contact to the end of the surface that it touches.
    SurfaceEnd(usize),
    End(End),
}

/// The event functions that may end a mode continued from a state along a rate.
pub fn of_mode(loading: Loading<'_>, modes: &[Mode], state: &State, rate: &Rate) -> Vec<EventFunction> {
    // Capacity for those of each contact, of the load and of the ends of the stage.
    let mut event_functions = Vec::with_capacity(2 * modes.len() + 2);
    let mut together = Vec::new();
    for (corner, data) in loading.corners.iter().enumerate() {
        let before = together.len();
        together.extend(data.holding(modes));
        if together.len() > before {
            if node_contact_forces::is_in_plane(loading, data) {
                event_functions.extend([0, 1].map(|side| EventFunction::Facet { corner, side }));
            } else if ContactGroup::new(loading, &together[before..], state).keeps(loading, state, rate) {
                event_functions.push(EventFunction::Slide { corner });
            } else {
                event_functions.extend([EventFunction::Hold { corner }, EventFunction::Return { corner }]);
            }
        }
    }
    for (contact, mode) in modes.iter().enumerate() {
        let end = EventFunction::SurfaceEnd(contact);
        if mode.is_active() && end.value(loading, modes, state, rate) < f64::INFINITY {
            event_functions.push(end);
        }
        match mode {
            Mode::Stick if together.contains(&contact) => {}
            Mode::Free => event_functions.push(EventFunction::Gap(contact)),
            Mode::Stick if loading.contacts[contact].sliding == Sliding::Plane => {
                event_functions.push(EventFunction::Cone { contact, side: 0.0 });
            }
            Mode::Stick => event_functions.extend([1.0, -1.0].map(|side| EventFunction::Cone { contact, side })),
            Mode::Slip { .. } => {
                // At a node that sticks to another obstacle, the normal reaction is only a share of the total force.
                if !together.contains(&contact) {
                    event_functions.push(EventFunction::Normal(contact));
                }
                if loading.contacts[contact].tangents() > 0 {
                    event_functions.push(EventFunction::Sliding(contact));
                }
            }
        }
    }
    event_functions
}

impl EventFunction {
    /// Whether a contact's mode ends where the quantity is zero.
    pub fn is_of_contact(self) -> bool {
        match self {
            Self::Gap(_) | Self::Normal(_) | Self::Cone { .. } | Self::Sliding(_) | Self::Facet { .. } => true,
            Self::Slide { .. } | Self::Hold { .. } => true,
            Self::Return { .. } | Self::LoadRate { .. } | Self::SurfaceEnd(_) | Self::End(_) => false,
        }
    }

    /// Whether the quantity is a force.
    pub fn is_of_forces(self) -> bool {
        match self {
            Self::Normal(_) | Self::Cone { .. } | Self::Facet { .. } => true,
            Self::Slide { .. } | Self::Hold { .. } | Self::Return { .. } => true,
            Self::Gap(_) | Self::Sliding(_) | Self::LoadRate { .. } | Self::SurfaceEnd(_) | Self::End(_) => false,
        }
    }

    /// The value at a point with its direction.
    pub fn value(self, loading: Loading<'_>, modes: &[Mode], state: &State, rate: &Rate) -> f64 {
        match self {
            Self::Gap(contact) => loading.gap(contact, state),
            Self::Normal(contact) => state.reactions[contact].normal,
            Self::Cone { contact, side } => {
                let reaction = &state.reactions[contact];
                let traction = if side == 0.0 {
                    -reaction.tangential_size()
                } else {
                    side * dot(&reaction.tangential, &loading.frame(contact, state).tangents[0])
                };
                loading.contacts[contact].friction.bound(reaction.normal) + traction
            }
            Self::Sliding(contact) => {
                dot(&direction(loading, modes, contact, state), &loading.relative_rate(contact, state, rate))
            }
            Self::Facet { corner, side } => {
                let holding: Vec<usize> = loading.corners[corner].holding(modes).collect();
                // No bound: the node is jammed.
                let Some(inward) = planar::sector(loading, &holding, |contact| modes[contact], state).inward else {
                    return f64::INFINITY;
                };
                dot(&inward[side], &node_contact_forces::total_force(loading, holding.into_iter(), state))
            }
            Self::Slide { corner } | Self::Hold { corner } | Self::Return { corner } => {
                let group = group(loading, corner, modes, state);
                let force = group.force(loading, state);
                match self {
                    Self::Hold { .. } => cone_sum::distance_from_bound(&group, &force),
                    Self::Return { .. } => -group.margin(&force),
                    _ => group.margin(&force),
                }
            }
            Self::LoadRate { sign } => sign * rate.load,
            Self::SurfaceEnd(contact) => {
                contact_jacobian::distance_to_end(loading.structure, &loading.contacts[contact], &state.displacement)
            }
            Self::End(End::Load { bound, sign }) => sign * (bound - state.load),
            Self::End(End::Displacement { freedom, bound, sign }) => sign * (bound - state.displacement[freedom]),
            Self::End(End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_)) => f64::INFINITY,
        }
    }

    /// The derivative by arc length; `None` for quantities that are themselves rates, and for [`Self::Facet`].
    pub fn slope(self, loading: Loading<'_>, modes: &[Mode], state: &State, rate: &Rate) -> Option<f64> {
        match self {
            // Past the end of a surface the distance is a bound that says nothing of its change.
            Self::Gap(contact)
                if contact_jacobian::beyond_end(loading.structure, &loading.contacts[contact], &state.displacement)
                    .is_some() =>
            {
                Some(0.0)
            }
            Self::Gap(contact) => {
                Some(dot(&loading.frame(contact, state).normal, &loading.relative_rate(contact, state, rate)))
            }
            Self::Normal(contact) => Some(rate.reactions[contact].normal),
            Self::Cone { contact, side } => {
                let (reaction, change) = (&state.reactions[contact], &rate.reactions[contact]);
                let traction = if side == 0.0 {
                    dot(&direction_of(&reaction.tangential, &[0.0; 3]), &change.tangential)
                } else {
                    side * dot(&change.tangential, &loading.frame(contact, state).tangents[0])
                };
                Some(loading.contacts[contact].friction.bound(change.normal) + traction)
            }
            Self::Slide { corner } | Self::Hold { corner } | Self::Return { corner } => {
                let group = group(loading, corner, modes, state);
                let (force, change) = (group.force(loading, state), group.force_rate(loading, state, rate));
                Some(match self {
                    Self::Hold { .. } => cone_sum::distance_slope(&group, &force, &change),
                    Self::Return { .. } => -group.margin_slope(&force, &change),
                    _ => group.margin_slope(&force, &change),
                })
            }
            Self::Sliding(_) | Self::LoadRate { .. } | Self::Facet { .. } | Self::SurfaceEnd(_) => None,
            Self::End(End::Load { sign, .. }) => Some(-sign * rate.load),
            Self::End(End::Displacement { freedom, sign, .. }) => Some(-sign * rate.displacement[freedom]),
            Self::End(End::LimitPoints(_) | End::ContactChanges(_) | End::Increments(_)) => None,
        }
    }

    /// The integral over an increment of a quantity that is a rate: the change of `s`, or the distance slid.
    fn change(self, loading: Loading<'_>, modes: &[Mode], start: &State, end: &State) -> Option<f64> {
        match self {
            Self::Sliding(contact) => {
                let chord = loading.relative_motion(contact, start, end);
                let directions =
                    add(&direction(loading, modes, contact, start), 1.0, &direction(loading, modes, contact, end));
                Some(dot(&scaled(&directions, 0.5), &chord))
            }
            Self::LoadRate { sign } => Some(sign * (end.load - start.load)),
            Self::Gap(_) | Self::Normal(_) | Self::Cone { .. } | Self::Facet { .. } => None,
            Self::SurfaceEnd(_) | Self::End(_) => None,
            Self::Slide { .. } | Self::Hold { .. } | Self::Return { .. } => None,
        }
    }

    /// The integral since the start of a quantity that is a rate; `None` where it is no simple difference.
    pub fn whole(self, loading: Loading<'_>, modes: &[Mode], start: &State, state: &State) -> Option<f64> {
        if let Self::Sliding(contact) = self {
            let contact = &loading.contacts[contact];
            if contact.sliding == Sliding::Plane || contact.obstacle.is_curved() {
                return None;
            }
        }
        self.change(loading, modes, start, state)
    }

    /// The scale relative to which the quantity is zero at a state; `force_scale` is the largest force of the path.
    pub fn scale(self, loading: Loading<'_>, state: &State, force_scale: f64) -> f64 {
        match self {
            Self::Normal(contact) | Self::Cone { contact, .. } => loading.force_scale_at(contact, state, force_scale),
            Self::Facet { corner, .. } | Self::Slide { corner } | Self::Hold { corner } | Self::Return { corner } => {
                let of = |contact: &usize| loading.force_scale_at(*contact, state, force_scale);
                loading.corners[corner].contacts.iter().map(of).fold(0.0, f64::max)
            }
            Self::Gap(_) | Self::Sliding(_) | Self::LoadRate { .. } | Self::SurfaceEnd(_) | Self::End(_) => 1.0,
        }
    }

    /// The value up to which a negative quantity does not count as passed.
    pub fn zero(self, loading: Loading<'_>, state: &State, force_scale: f64) -> f64 {
        let scale = self.scale(loading, state, force_scale);
        (EVENT_TOLERANCE * scale).max(self.rounding(loading, state).min(LARGEST_ROUNDING_OF_FORCE * scale))
    }

    /// What the rounding of displacements leaves in a force: more than [`EVENT_TOLERANCE`] of its scale where elements are
    /// so stiff that the forces of the displacements themselves are far larger than those of the path.
    pub fn rounding(self, loading: Loading<'_>, state: &State) -> f64 {
        let of = |contact: &usize| loading.rounding_of_force(*contact, state);
        match self {
            Self::Normal(contact) | Self::Cone { contact, .. } => of(&contact),
            Self::Facet { corner, .. } | Self::Slide { corner } | Self::Hold { corner } | Self::Return { corner } => {
                loading.corners[corner].contacts.iter().map(of).fold(0.0, f64::max)
            }
            Self::Gap(_) | Self::Sliding(_) | Self::LoadRate { .. } | Self::SurfaceEnd(_) | Self::End(_) => 0.0,
        }
    }

    /// Whether a value is above [`Self::zero_within`], with a tolerance above the rounding of forces.
    pub fn is_above_zero(
        self,
        loading: Loading<'_>,
        state: &State,
        value: f64,
        tolerance: f64,
        force_scale: f64,
    ) -> bool {
        let most = if self.is_of_forces() { force_scale } else { 1.0 };
        value > tolerance * most || value > self.zero_within(loading, state, tolerance, force_scale)
    }

    /// The value up to which the quantity counts as zero at a state, for a relative tolerance.
    pub fn zero_within(self, loading: Loading<'_>, state: &State, tolerance: f64, force_scale: f64) -> f64 {
        match self {
            Self::Cone { contact, .. } => none_from_cone(loading, contact, state, tolerance, force_scale),
            _ => tolerance * self.scale(loading, state, force_scale),
        }
    }

    /// The position inside `(0, step)` of the minimum of the quantity's interpolant, if the minimum is below `-zero`.
    pub fn dip(
        self,
        loading: Loading<'_>,
        modes: &[Mode],
        start: (&State, &Rate),
        end: (&State, &Rate),
        step: f64,
        zero: f64,
    ) -> Option<f64> {
        self.dip_of_value(loading, modes, (start, end), step, zero).or_else(|| match self {
            Self::Gap(contact) if loading.contacts[contact].obstacle.is_curved() => {
                dip_along_motion(loading, contact, (start, end), step, zero)
            }
            _ => None,
        })
    }

    fn dip_of_value(
        self,
        loading: Loading<'_>,
        modes: &[Mode],
        (start, end): ((&State, &Rate), (&State, &Rate)),
        step: f64,
        zero: f64,
    ) -> Option<f64> {
        let ends = || (self.value(loading, modes, start.0, start.1), self.value(loading, modes, end.0, end.1));
        let slopes = (self.slope(loading, modes, start.0, start.1), self.slope(loading, modes, end.0, end.1));
        if let (Some(first_slope), Some(last_slope)) = slopes {
            if first_slope >= 0.0 || last_slope <= 0.0 {
                return None;
            }
            let (first, last) = ends();
            return dip_of_cubic(first, first_slope * step, last, last_slope * step, zero).map(|place| place * step);
        }
        let change = self.change(loading, modes, start.0, end.0)?;
        let (first, last) = ends();
        dip_of_slope(change / step, first, last, zero).map(|place| place * step)
    }
}

/// A position inside `(0, step)` at which a gap from a curved obstacle is below `-zero`. The gap of a thin obstacle has a
/// kink within it, where the closest point jumps to the other side, which no interpolant of the gap shows: the motion is
/// interpolated instead. A gap changes by no more than the motion; where two gaps exceed the way between them by a
/// margin, no gap between is closed.
fn dip_along_motion(
    loading: Loading<'_>,
    contact: usize,
    (start, end): ((&State, &Rate), (&State, &Rate)),
    step: f64,
    zero: f64,
) -> Option<f64> {
    let [first, last] = [start.0, end.0].map(|state| loading.relative(contact, state));
    let [leaves, arrives] = [start, end].map(|at| scaled(&loading.relative_rate(contact, at.0, at.1), step));
    let chord = add(&last, -1.0, &first);
    let gap_at = |x: f64| {
        let y = 1.0 - x;
        // Hermite's cubic, from the start.
        let moved = add(&scaled(&chord, x * x * (1.0 + 2.0 * y)), x * y * y, &leaves);
        let place = add(&first, 1.0, &add(&moved, -x * x * y, &arrives));
        (x, place, loading.contacts[contact].gap(&place))
    };
    // The earliest first.
    let mut open = vec![(gap_at(0.0), gap_at(1.0))];
    while let Some((low, high)) = open.pop() {
        if low.0 > 0.0 && low.2 < -zero {
            return Some(low.0 * step);
        }
        let way = size(&add(&high.1, -1.0, &low.1));
        if high.0 - low.0 <= SHORTEST_PART || low.2 + high.2 >= WAY_MARGIN * way {
            continue;
        }
        let middle = gap_at(0.5 * (low.0 + high.0));
        open.extend([(middle, high), (low, middle)]);
    }
    None
}

/// The closing equation of a zero: an event function with a slope, over its scale.
#[derive(Debug, Clone, Copy)]
pub struct EventZero<'a> {
    pub event_function: EventFunction,
    pub scale: f64,
    /// The approximate direction of the path.
    pub towards: &'a Rate,
}

impl ClosingEquation for EventZero<'_> {
    fn value(&self, system: &ModeSystem<'_>, state: &State) -> f64 {
        self.event_function.value(system.loading, system.modes, state, self.towards) / self.scale
    }

    fn write_gradient(&self, system: &ModeSystem<'_>, _state: &State, matrix: &mut dyn Sink) {
        matrix::border(system, matrix, self.towards);
    }

    fn slope_beside_row(&self, system: &ModeSystem<'_>, state: &State, rate: &Rate) -> Option<f64> {
        self.event_function.slope(system.loading, system.modes, state, rate).map(|slope| slope / self.scale)
    }

    fn has_slope_beside_row(&self) -> bool {
        true
    }
}

/// The obstacles that hold a node in space, or a guided one, in these modes.
fn group(loading: Loading<'_>, corner: usize, modes: &[Mode], state: &State) -> ContactGroup {
    let holding: Vec<usize> = loading.corners[corner].holding(modes).collect();
    ContactGroup::new(loading, &holding, state)
}

/// The direction of a slip at a state.
fn direction(loading: Loading<'_>, modes: &[Mode], contact: usize, state: &State) -> Vector {
    let Mode::Slip { direction } = modes[contact] else { return [0.0; 3] };
    let data = &loading.contacts[contact];
    if data.sliding == Sliding::Plane {
        // Past the end of contact the traction points the other way.
        let reaction = &state.reactions[contact];
        return if reaction.normal > 0.0 { direction_of(&reaction.tangential, &direction) } else { direction };
    }
    if !data.obstacle.is_curved() {
        return direction;
    }
    let tangent = loading.frame(contact, state).tangents[0];
    if dot(&direction, &tangent) < 0.0 { scaled(&tangent, -1.0) } else { tangent }
}

/// The position on `(0, 1)` of the minimum of the cubic with these end values and slopes, if it is below `-zero`.
fn dip_of_cubic(first: f64, first_slope: f64, last: f64, last_slope: f64, zero: f64) -> Option<f64> {
    if first_slope >= 0.0 || last_slope <= 0.0 {
        return None;
    }
    // p(x) = first + first_slope x + b x² + a x³
    let a = 2.0 * (first - last) + first_slope + last_slope;
    let b = 3.0 * (last - first) - 2.0 * first_slope - last_slope;
    let root = (b * b - 3.0 * a * first_slope).max(0.0).sqrt();
    let place = if b > 0.0 { -first_slope / (b + root) } else { (root - b) / (3.0 * a) };
    let value = first + place * (first_slope + place * (b + place * a));
    (place > 0.0 && place < 1.0 && value < -zero).then_some(place)
}

/// The position on `(0, 1)` of the minimum of the quadratic with these end values and this mean, if it is below
/// `-zero`.
fn dip_of_slope(mean: f64, first: f64, last: f64, zero: f64) -> Option<f64> {
    // q(x) = first + b x + a x²
    let a = 3.0 * (first + last - 2.0 * mean);
    let b = 6.0 * mean - 4.0 * first - 2.0 * last;
    if a <= 0.0 {
        return None;
    }
    let place = -b / (2.0 * a);
    let value = first - b * b / (4.0 * a);
    (place > 0.0 && place < 1.0 && value < -zero).then_some(place)
}

#[cfg(test)]
mod tests {
    use super::{dip_of_cubic, dip_of_slope};

    #[test]
    fn a_dip_between_two_positive_ends_is_seen() {
        // (x - 0.4)(x - 0.6) has its minimum at 0.5.
        let place = dip_of_cubic(0.24, -1.0, 0.24, 1.0, 0.0).unwrap();
        assert!((place - 0.5).abs() < 1e-12);
        assert!(dip_of_cubic(0.3, -1.0, 0.3, 1.0, 0.0).is_none());
        let mean = 1.0 / 3.0 - 0.5 + 0.24;
        assert!((dip_of_slope(mean, 0.24, 0.24, 0.0).unwrap() - 0.5).abs() < 1e-12);
    }
}
