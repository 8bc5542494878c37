//! The directions at a point within a mode whose contacts on the cone all slip, where a cheap test proves that there
//! are exactly two.
//!
//! Keep every contact on the cone closed, and let `b` be the slip velocities and `x` the other free motions.
//! Equilibrium along `x`, and along the slips with `μ` times the normal added, so that the friction forces drop out, is
//!
//! ```text
//! a = A (x, b) + q ṡ,      a_x = 0,      0 <= a_b ⊥ b >= 0,      A = Wᵀ K T (and the rotation of reactions)
//! ```
//!
//! with the motions `T` and the tests `W = T + μ n`; `a_b` is the rate at which the tractions leave the cone. Where the
//! symmetric part of `A` is positive definite, so is that of the matrix condensed on the slips (`b` with the resulting
//! `x`), which is then a P-matrix: each sign of the load rate has one ray (see `rates::p_matrix`). One ray continues
//! the path. The other usually has all contacts stuck, which its own equations confirm. Where the symmetric part is not
//! definite it may be definite across the load, and each sign of the load's power has one ray (see
//! `sparse_uniqueness::proof`); or the slips are few, and their condensed matrix is formed (see
//! `rates::parametric_lcp`), which is not needed for a single slip.
//!
//! [`stuck_direction_sparse`] treats sparse matrices, [`static_condensation`] condenses dense ones.
//!
//! `None` is returned where any condition fails or holds by less than a wide margin: `directions` then searches all
//! modes.

pub(crate) mod static_condensation;
pub(crate) mod stuck_direction_sparse;
#[cfg(test)]
mod tests;
pub(crate) mod tolerances;

use crate::branching::directions::candidate::is_mechanism;
use crate::branching::directions::feasible_direction::{DirectionChoice, Rules, mark_retrace, potential_rate, sign_of};
use crate::branching::uniqueness::all_slipping::tolerances::{SMALLEST_LOAD_RATE, STRICT_MARGIN};
use crate::complementarity::rates::p_matrix::is_definite;
use crate::complementarity::rates::parametric_lcp::slip_or_stick;
use crate::mechanics::contact::vector::{Vector, dot};
use crate::mechanics::contact::{Mode, Reaction};
use crate::mechanics::multi_contact::changeable_contacts::Standing;
use crate::mechanics::problem::loading::Loading;
use crate::mechanics::problem::state::{Rate, State};
use crate::step::corrector::cached_factorisation::CachedFactorisation;
use nalgebra::{DMatrix, DVector};
use smallvec::{SmallVec, smallvec};
use static_condensation::CondensedResponse;

/// Largest number of unknowns for which matrices are dense: they have few entries, and only the profile is factorised.
const MOST_DENSE: usize = 40;

/// A contribution of an unknown to the motion of a degree of freedom, and the weight of the degree of freedom's
/// equation in the unknown's equation.
#[derive(Clone, Copy)]
struct MotionTerm {
    unknown: usize,
    motion: f64,
    test: f64,
}

/// The motion of a degree of freedom.
struct FreedomMotion {
    /// Index of its first term and their number.
    first: usize,
    count: usize,
    /// Velocity per load rate.
    driven: f64,
}

struct Unknown {
    is_slip: bool,
    /// A degree of freedom at the unknown's own node, different for each unknown.
    freedom: usize,
}

/// A contact that slips.
struct Slip {
    contact: usize,
    direction: Vector,
}

/// The unknowns `(x, b)`, in the order of the nodes; stored without allocation for few nodes.
struct ReducedUnknowns<'a> {
    loading: Loading<'a>,
    state: &'a State,
    /// One for each degree of freedom.
    places: SmallVec<[FreedomMotion; 6]>,
    parts: SmallVec<[MotionTerm; 4]>,
    slips: SmallVec<[Slip; 1]>,
    unknowns: SmallVec<[Unknown; 4]>,
    /// Entries of the diagonal blocks due to the rotation of reactions with the motion.
    turning: SmallVec<[(usize, usize, f64); 1]>,
    /// The closed contact of each node.
    holder: SmallVec<[Option<usize>; 2]>,
}

/// The motions of the degrees of freedom.
#[derive(Clone, Copy)]
struct Motions<'a> {
    places: &'a [FreedomMotion],
    parts: &'a [MotionTerm],
}

impl<'a> Motions<'a> {
    /// The terms of a degree of freedom, and its velocity per load rate.
    fn of(self, freedom: usize) -> (&'a [MotionTerm], f64) {
        let FreedomMotion { first, count, driven } = self.places[freedom];
        (&self.parts[first..first + count], driven)
    }
}

/// The direction that continues the path and the other direction, if there are no more.
pub fn all_slipping_directions(
    loading: Loading<'_>,
    state: &State,
    standings: &[Standing],
    modes: &[Mode],
    incoming: &Rate,
    rules: Rules<'_>,
) -> Option<Vec<DirectionChoice>> {
    if !rules.effort.certify {
        return None;
    }
    let reduced = ReducedUnknowns::new(loading, state, standings, modes)?;
    let goes_on =
        |slip: &Slip| dot(&slip.direction, &loading.relative_rate(slip.contact, state, incoming)) > STRICT_MARGIN;
    if reduced.slips.is_empty() || !reduced.slips.iter().all(goes_on) {
        return None;
    }
    let stuck = reduced.stuck(incoming)?;
    let stuck_modes = standings.iter().zip(modes).map(|(standing, mode)| match standing {
        Standing::OnCone { .. } => Mode::Stick,
        Standing::Settled(_) | Standing::Touching | Standing::Cornered { .. } => *mode,
    });
    let dissipation: f64 = reduced
        .slips
        .iter()
        .map(|slip| {
            -dot(&state.reactions[slip.contact].tangential, &loading.relative_rate(slip.contact, state, incoming))
        })
        .sum();
    let choice = |rate: Rate, modes: Vec<Mode>, dissipation: f64| DirectionChoice {
        cached: CachedFactorisation::default(),
        dissipation,
        potential_rate: potential_rate(loading, state, &rate, dissipation),
        load_sign: sign_of(rate.load),
        retrace: false,
        mechanism: is_mechanism(loading, state, &rate),
        is_singular: false,
        beside: None,
        is_tried: false,
        rate,
        modes,
    };
    let slipping_modes = standings.iter().zip(modes).map(|(standing, mode)| match standing {
        Standing::OnCone { direction } => Mode::Slip { direction: *direction },
        Standing::Settled(_) | Standing::Touching | Standing::Cornered { .. } => *mode,
    });
    let mut options = vec![
        choice(stuck, stuck_modes.collect(), 0.0),
        choice(incoming.clone(), slipping_modes.collect(), dissipation),
    ];
    mark_retrace(loading, state, &mut options, incoming);
    Some(options)
}

impl<'a> ReducedUnknowns<'a> {
    /// Sets up the unknowns; `None` where some contact can do more than slip or stick, where several are closed at one
    /// node, and where supports guide a closed node.
    fn new(loading: Loading<'a>, state: &'a State, standings: &[Standing], modes: &[Mode]) -> Option<Self> {
        let structure = loading.structure;
        let freedoms = structure.freedoms();
        let mut holder: SmallVec<[Option<usize>; 2]> = smallvec![None; structure.numbering.nodes()];
        for (contact, (standing, mode)) in standings.iter().zip(modes).enumerate() {
            let agrees = match (standing, mode) {
                (Standing::Settled(Mode::Free), Mode::Free) => continue,
                (Standing::Settled(Mode::Stick), Mode::Stick) => true,
                (Standing::Settled(Mode::Slip { .. }), Mode::Slip { .. }) => loading.contacts[contact].tangents() == 0,
                (Standing::OnCone { direction }, Mode::Slip { direction: along }) => dot(direction, along) > 0.0,
                _ => false,
            };
            let node = loading.contacts[contact].kinematics.node()?;
            let is_free = structure.unknown_of[structure.translations_of(node)].iter().all(Option::is_some);
            if !agrees || !is_free || holder[node].replace(contact).is_some() {
                return None;
            }
        }
        let mut reduced = Self {
            loading,
            state,
            places: SmallVec::with_capacity(freedoms),
            parts: SmallVec::with_capacity(structure.unknowns()),
            slips: SmallVec::new(),
            unknowns: SmallVec::with_capacity(structure.unknowns()),
            turning: SmallVec::new(),
            holder: SmallVec::new(),
        };
        for (node, holder) in holder.iter().enumerate() {
            match holder {
                Some(contact) => reduced.add_closed(node, *contact, &standings[*contact]),
                None => structure.translations_of(node).for_each(|freedom| reduced.add_free(freedom)),
            }
            structure.numbering.rotations_of(node).for_each(|freedom| reduced.add_free(freedom));
        }
        reduced.holder = holder;
        Some(reduced)
    }

    fn add_free(&mut self, freedom: usize) {
        let is_free = self.loading.structure.unknown_of[freedom].is_some();
        let (first, driven) = (self.parts.len(), self.loading.support_rate(freedom));
        self.places.push(FreedomMotion { first, count: usize::from(is_free), driven });
        if is_free {
            self.parts.push(MotionTerm { unknown: self.unknowns.len(), motion: 1.0, test: 1.0 });
            self.unknowns.push(Unknown { is_slip: false, freedom });
        }
    }

    fn add_closed(&mut self, node: usize, contact: usize, standing: &Standing) {
        let dimension = self.loading.structure.dimension;
        let frame = self.loading.frame(contact, self.state);
        let first = self.unknowns.len();
        let normal_reaction = self.state.reactions[contact].normal;
        // Motions and tests.
        let mut along: [(Vector, Vector); 2] = Default::default();
        let count = match standing {
            Standing::OnCone { direction } => {
                let friction = self.loading.contacts[contact].friction;
                along[0] = (*direction, friction.slack_form(&frame.normal, direction));
                let turning = -frame.curvature_along(direction) * normal_reaction;
                self.turning.push((first, first, turning * friction.force_direction_squared()));
                self.slips.push(Slip { contact, direction: *direction });
                1
            }
            Standing::Settled(Mode::Slip { .. }) => {
                for (k, tangent) in frame.tangents.iter().enumerate().take(dimension - 1) {
                    along[k] = (*tangent, *tangent);
                    self.turning.push((first + k, first + k, -frame.curvature_along(tangent) * normal_reaction));
                }
                let across = -frame.curvature_across(&frame.tangents[0], &frame.tangents[1]) * normal_reaction;
                if across != 0.0 {
                    self.turning.extend([(first, first + 1, across), (first + 1, first, across)]);
                }
                dimension - 1
            }
            Standing::Settled(_) | Standing::Touching | Standing::Cornered { .. } => 0,
        };
        let is_slip = matches!(standing, Standing::OnCone { .. });
        let freedom = self.loading.structure.translations_of(node).start;
        self.unknowns.extend((0..count).map(|k| Unknown { is_slip, freedom: freedom + k }));
        for component in 0..dimension {
            let driven = self.loading.pattern.shifts[contact][component];
            self.places.push(FreedomMotion { first: self.parts.len(), count, driven });
            for (k, (motion, test)) in along.iter().enumerate().take(count) {
                self.parts.push(MotionTerm { unknown: first + k, motion: motion[component], test: test[component] });
            }
        }
    }

    fn motions(&self) -> Motions<'_> {
        Motions { places: &self.places, parts: &self.parts }
    }

    /// Calls `add` for every entry of `A`, and of the column of the load rate (`None`).
    fn each_entry(&self, add: &mut impl FnMut(usize, Option<usize>, f64)) {
        let (structure, motions) = (self.loading.structure, self.motions());
        structure.each_stiffness(&self.state.displacement, &mut |row, column, value| {
            for test in motions.of(row).0 {
                let value = test.test * value;
                if value == 0.0 {
                    continue;
                }
                let (parts, driven) = motions.of(column);
                for part in parts {
                    add(test.unknown, Some(part.unknown), value * part.motion);
                }
                if driven != 0.0 {
                    add(test.unknown, None, value * driven);
                }
            }
        });
        for (freedom, force) in self.loading.pattern.forces.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            for test in motions.of(freedom).0 {
                add(test.unknown, None, -test.test * force);
            }
        }
        self.turning.iter().for_each(|(row, column, value)| add(*row, Some(*column), *value));
    }

    /// The direction along which all contacts on the cone stick, if it and the continuation of the path are the only
    /// directions.
    fn stuck(&self, incoming: &Rate) -> Option<Rate> {
        if self.unknowns.len() > MOST_DENSE {
            return stuck_direction_sparse::stuck_among_many(self, incoming);
        }
        let others = self.unknowns_where(false);
        let is_sole = self.slips.len() == 1;
        let (mut matrix, mut load) =
            if is_sole && others.is_empty() { (DMatrix::zeros(0, 0), DVector::zeros(0)) } else { self.equations() };
        let response = CondensedResponse::new(&matrix, &load, &others)?;
        if is_sole {
            // With the other unknowns condensed `0 <= m b + q ṡ ⊥ b >= 0` has two solutions whatever `m` if `q` is not
            // zero, as the stuck rate shows: continued slip with the load rate `-m b / q`, and `b = 0` with `q ṡ > 0`.
            return self.stuck_rate(&others, &response.load);
        }
        if incoming.load.abs() > SMALLEST_LOAD_RATE && is_definite(matrix.clone()) {
            return self.stuck_rate(&others, &response.load).filter(|stuck| stuck.load * incoming.load < 0.0);
        }
        if !others.is_empty() {
            (matrix, load) = response.condensed(&matrix, &load, &others, &self.unknowns_where(true))?;
        }
        if slip_or_stick(matrix, load) { self.stuck_rate(&others, &response.load) } else { None }
    }

    /// `A`, and the column of the load rate, dense.
    fn equations(&self) -> (DMatrix<f64>, DVector<f64>) {
        let count = self.unknowns.len();
        let (mut matrix, mut load) = (DMatrix::zeros(count, count), DVector::zeros(count));
        self.each_entry(&mut |row, column, value| match column {
            Some(column) => matrix[(row, column)] += value,
            None => load[row] += value,
        });
        (matrix, load)
    }

    fn unknowns_where(&self, is_slip: bool) -> SmallVec<[usize; 4]> {
        (0..self.unknowns.len()).filter(|unknown| self.unknowns[*unknown].is_slip == is_slip).collect()
    }

    /// The rate of unit arc length at which nothing slips, in the sense in which all contacts stay within their cones;
    /// `None` where they do not by a wide margin. `response` is the motion of the other unknowns for unit load rate.
    fn stuck_rate(&self, others: &[usize], response: &DVector<f64>) -> Option<Rate> {
        let (loading, structure) = (self.loading, self.loading.structure);
        let mut velocities: SmallVec<[f64; 4]> = smallvec![0.0; self.unknowns.len()];
        others.iter().zip(response.iter()).for_each(|(unknown, value)| velocities[*unknown] = *value);
        let (motions, velocities) = (self.motions(), &velocities[..]);
        let velocity = |freedom: usize| {
            let (parts, driven) = motions.of(freedom);
            let own: f64 = parts.iter().map(|part| part.motion * velocities[part.unknown]).sum();
            own + driven
        };
        let displacement: Vec<f64> = (0..structure.freedoms()).map(velocity).collect();
        let mut forces: SmallVec<[f64; 6]> = SmallVec::from_slice(&loading.pattern.forces);
        let forces = &mut forces[..];
        forces.iter_mut().for_each(|force| *force = -*force);
        structure.add_stiffness_times(&self.state.displacement, &displacement, forces);
        let mut rate = Rate { displacement, load: 1.0, reactions: vec![Reaction::default(); loading.contacts.len()] };
        for (node, contact) in self.holder.iter().enumerate().filter_map(|(node, holder)| Some((node, (*holder)?))) {
            rate.reactions[contact] = loading.taken_by(contact, self.state, &structure.translation_at(node, forces));
        }
        let (size, largest) = (rate.size(), rate.largest_reaction());
        if !size.is_finite() || size <= STRICT_MARGIN * largest {
            return None;
        }
        // The rate at which a contact's force moves into its cone.
        let inward = |slip: &Slip| {
            let reaction = &rate.reactions[slip.contact];
            loading.contacts[slip.contact].friction.slack(reaction, &slip.direction)
        };
        let sense = 1.0_f64.copysign(self.slips.first().map_or(1.0, inward));
        let least = STRICT_MARGIN * largest.max(f64::MIN_POSITIVE);
        if !self.slips.iter().all(|slip| sense * inward(slip) > least) {
            return None;
        }
        rate.scale(sense / size);
        Some(rate)
    }
}
