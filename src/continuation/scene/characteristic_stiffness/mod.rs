//! The characteristic stiffness that resists a stage's load: the basis of the scales of force and load.
//!
//! An element that carries no load must not determine a scale, whether it is soft and parallel to others (a tether) or
//! stiff and in series with them (a link). The share of the load that an element carries shows in its strain energy
//! under the load: for a soft element parallel to others it is proportional to its stiffness `k`, for a stiff element
//! in series with others to `1/k`, and the mean stiffness
//!
//! ```text
//! k = exp(Σ w_e ln k_e / Σ w_e),      w_e the energy of the element e,
//! ```
//!
//! is insensitive to such elements. It does not depend on the order or the number of the elements that share the load.
//!
//! The motion is that of the undeformed structure, `K u = s p`, `p·u = 1` (regular even where `K` is singular and the
//! load acts on an unconstrained motion), with the closed contacts fixed along their normals. Friction yields where the
//! load is large enough, and resists otherwise: it is represented by springs of the usual stiffness. A structure that
//! only a soft element resists at first order may be resisted by others at second order (a bar loaded transversely): a
//! motion of finite size, relaxed by Newton's method, detects this, and closes contacts that it would penetrate. The
//! stiffest result is used: a load scale that is too large costs next to nothing, as the arc length is then that of the
//! displacements.

pub(crate) mod load_response;
pub(crate) mod tolerances;

use crate::continuation::scene::characteristic_stiffness::tolerances::{
    ACCEPTED_CORRECTION, CLOSED_GAP, CONSTRAINT_STIFFNESS, ENERGY_ROUND_OFF, ROUND_OFF_MULTIPLE,
    SMALLEST_ELEMENT_ENERGY,
};
use crate::mechanics::contact::ContactPair;
use crate::mechanics::contact::vector::{Vector, add, dot};
use crate::mechanics::problem::contact_jacobian;
use crate::mechanics::problem::loading::LoadPattern;
use crate::mechanics::structure::assembly::{ElementAt, ForceBuffer, StiffnessBuffer};
use crate::mechanics::structure::elements::Stretching;
use crate::mechanics::structure::{MOST_ANALYSED, Structure};
use nalgebra::DVector;

/// Size of the finite motion, relative to the longest bar; the next is tried where Newton's method does not converge.
const FINITE: [f64; 2] = [0.05, 0.0125];
/// Largest number of Newton iterations.
const MOST_ITERATIONS: usize = 12;
/// Largest number of times that contacts penetrated by a motion are closed.
const MOST_CLOSINGS: usize = 2;

/// The stiffness of the elements that resist a stage's load pattern, as an axial stiffness, dimensionless; `None` where
/// no movable element resists it.
pub(super) fn resisting(structure: &Structure, contacts: &[ContactPair], pattern: &LoadPattern) -> Option<f64> {
    let still = vec![0.0; structure.freedoms()];
    let mut response = StiffnessEstimate::new(structure, contacts, pattern, &still);
    let mut stiffest: Option<f64> = None;
    for _ in 0..=MOST_CLOSINGS {
        let Some(first) = response.at_first_order(&still) else { break };
        let finite = response.relaxed(&still, &first);
        let of_finite = finite.as_ref().and_then(|finite| response.mean(finite, true));
        for mean in [response.mean(&first, false), of_finite].into_iter().flatten() {
            stiffest = Some(stiffest.map_or(mean, |known| known.max(mean)));
        }
        if !finite.is_some_and(|finite| response.close(&finite)) {
            break;
        }
    }
    stiffest
}

/// The dimensionless load at which the undeformed structure would move by the unit of length, by its tangent with the
/// closed contacts fixed; `None` where the load moves nothing, or without bound.
pub(super) fn load_at_unit_displacement(
    structure: &Structure,
    contacts: &[ContactPair],
    pattern: &LoadPattern,
) -> Option<f64> {
    let still = vec![0.0; structure.freedoms()];
    let estimate = StiffnessEstimate::new(structure, contacts, pattern, &still);
    let motion = estimate.at_first_order(&still)?;
    let is_moved = estimate.mean(&motion, false).is_some() && estimate.is_resisted(&motion, &still);
    Some(motion.load.abs()).filter(|load| is_moved && *load > 0.0 && load.is_finite())
}

/// The mean diagonal entry of the tangent at each node, which does not depend on the axes.
fn stiffness_at(structure: &Structure, still: &[f64]) -> Vec<f64> {
    let mut diagonal = vec![0.0_f64; structure.freedoms()];
    structure.each_stiffness(still, &mut |row, column, value| {
        if row == column {
            diagonal[row] += value;
        }
    });
    let mean = |node: &[f64]| (node.iter().sum::<f64>() / node.len() as f64).abs();
    let numbering = &structure.numbering;
    (0..numbering.nodes()).map(|node| mean(&diagonal[numbering.translations_of(node)])).collect()
}

/// The (lower) median stiffness of the bars, or of the linear elements where there are no bars. An element's stiffness
/// is the sum of its diagonal entries at a node, which for a bar does not depend on the axes.
fn usual_stiffness(structure: &Structure, still: &[f64]) -> f64 {
    let mut buffer = StiffnessBuffer::default();
    let of_element = |at: ElementAt<'_>| {
        let mut sum = 0.0_f64;
        at.alone().each_stiffness(still, &mut buffer, &mut |row, column, value| {
            if row == column {
                sum += value;
            }
        });
        sum.abs() / at.element.nodes().len() as f64
    };
    let is_linear = structure.resists_linearly();
    let counts = |at: &ElementAt<'_>| !at.element.is_load() && (is_linear || !at.element.is_linear());
    let mut all: Vec<f64> = structure.elements().filter(counts).map(of_element).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len().saturating_sub(1) / 2).copied().unwrap_or(0.0)
}

/// Displacements of all degrees of freedom and the load.
struct Motion {
    displacement: Vec<f64>,
    load: f64,
}

struct StiffnessEstimate<'a> {
    structure: &'a Structure,
    contacts: &'a [ContactPair],
    pattern: &'a LoadPattern,
    /// Stiffness at each node.
    stiffness_at: Vec<f64>,
    /// Stiffness of the springs that represent friction.
    usual: f64,
    /// Whether each contact is fixed.
    held: Vec<bool>,
}

/// A stiffness against the stretch `c·u + b s`.
struct Tie {
    stretching: Stretching,
    /// `b`
    by_load: f64,
}

impl Tie {
    fn stretch(&self, motion: &Motion) -> f64 {
        let along = self.stretching.along.iter().map(|(freedom, value)| value * motion.displacement[*freedom]);
        along.sum::<f64>() + self.by_load * motion.load
    }

    fn energy(&self, motion: &Motion) -> f64 {
        self.stretching.stiffness.abs() * self.stretch(motion).powi(2)
    }
}

impl<'a> StiffnessEstimate<'a> {
    /// Of the undeformed structure, with the closed contacts fixed; `still`: no displacements.
    fn new(structure: &'a Structure, contacts: &'a [ContactPair], pattern: &'a LoadPattern, still: &[f64]) -> Self {
        let held = contacts.iter().map(|contact| contact.gap(&[0.0; 3]) <= CLOSED_GAP).collect();
        let (stiffness_at, usual) = (stiffness_at(structure, still), usual_stiffness(structure, still));
        Self { structure, contacts, pattern, stiffness_at, usual, held }
    }
}

impl StiffnessEstimate<'_> {
    /// Fixes the contacts that a motion penetrates; returns whether there are any.
    fn close(&mut self, motion: &Motion) -> bool {
        let mut closes = false;
        for (index, contact) in self.contacts.iter().enumerate() {
            let passes = !self.held[index] && contact.gap(&self.relative(index, motion)) < 0.0;
            self.held[index] |= passes;
            closes |= passes;
        }
        closes
    }

    /// Displacement of a contact's node relative to its obstacle.
    fn relative(&self, contact: usize, motion: &Motion) -> Vector {
        let moved = contact_jacobian::moved(self.structure, &self.contacts[contact], &motion.displacement);
        add(&moved, -motion.load, &self.pattern.shifts[contact])
    }

    fn support_rate(&self, freedom: usize) -> f64 {
        self.pattern.supports.get(freedom).copied().unwrap_or(0.0)
    }

    /// The ties of the nodes of fixed contacts: first along the normals, then along the tangents.
    fn ties(&self, still: &[f64]) -> [Vec<Tie>; 2] {
        let mut ties = [Vec::new(), Vec::new()];
        for (index, contact) in self.contacts.iter().enumerate().filter(|(index, _)| self.held[*index]) {
            let frame = contact.frame(&[0.0; 3]);
            let of_nodes = contact.kinematics.nodes().iter().map(|node| self.stiffness_at[*node]);
            let stiffness = of_nodes.fold(0.0, f64::max);
            let tie = |vector: &Vector, stiffness: f64| {
                let mut along = Vec::new();
                contact_jacobian::each_column(self.structure, contact, still, |freedom, column| {
                    along.push((freedom, dot(vector, column)));
                });
                let by_load = -dot(vector, &self.pattern.shifts[index]);
                (stiffness > 0.0).then_some(Tie { stretching: Stretching { stiffness, along }, by_load })
            };
            ties[0].extend(tie(&frame.normal, CONSTRAINT_STIFFNESS * stiffness));
            let tangents = frame.tangents.iter().take(contact.tangents());
            ties[1].extend(tangents.filter_map(|tangent| tie(tangent, self.usual)));
        }
        ties
    }

    fn all_ties(&self, still: &[f64]) -> Vec<Tie> {
        self.ties(still).into_iter().flatten().collect()
    }

    /// The motion `K u = s p`, `p·u = 1`; `None` where the load moves nothing, or where the motion is not determined.
    fn at_first_order(&self, still: &[f64]) -> Option<Motion> {
        let ties = self.all_ties(still);
        let pushed = load_response::pushed(self, still, &ties);
        let size = pushed.iter().map(|value| value * value).sum::<f64>().sqrt();
        if size <= 0.0 || !size.is_finite() {
            return None;
        }
        let row: Vec<f64> = pushed.iter().map(|value| value / size).collect();
        let mut values = DVector::zeros(row.len() + 1);
        values[row.len()] = 1.0;
        if !load_response::factorise(self, still, &ties, &row)?.solve(&mut values) {
            return None;
        }
        let mut motion = self.motion(values.as_slice());
        let numbering = &self.structure.numbering;
        let of_nodes = (0..numbering.nodes()).map(|node| &motion.displacement[numbering.freedoms_of(node)]);
        let largest =
            of_nodes.map(|node| node.iter().map(|value| value * value).sum::<f64>().sqrt()).fold(0.0_f64, f64::max);
        if largest <= 0.0 || !largest.is_finite() {
            return None;
        }
        motion.displacement.iter_mut().for_each(|value| *value /= largest);
        motion.load /= largest;
        Some(motion)
    }

    /// Whether the load that moves the structure is more than what rounding leaves in the forces of its elements, as where the
    /// structure moves as a rigid body. Stretchings are resolved apart, whatever their stiffness.
    fn is_resisted(&self, motion: &Motion, still: &[f64]) -> bool {
        let mut rounding = vec![0.0; self.structure.freedoms()];
        self.structure.each_stiffness_across(still, &mut |row, column, value| {
            rounding[row] += f64::EPSILON * (value * motion.displacement[column]).abs();
        });
        let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let pushed = load_response::pushed(self, still, &self.all_ties(still));
        motion.load.abs() * most(&pushed) > ROUND_OFF_MULTIPLE * most(&rounding)
    }

    /// The motion of all degrees of freedom for values of the unknowns and the load.
    fn motion(&self, values: &[f64]) -> Motion {
        let structure = self.structure;
        let load = values[structure.unknowns()];
        let displacement = structure
            .unknown_of
            .iter()
            .enumerate()
            .map(|(freedom, unknown)| unknown.map_or(load * self.support_rate(freedom), |unknown| values[unknown]))
            .collect();
        Motion { displacement, load }
    }

    /// The motion of finite size along that of first order, relaxed; `None` where every element is linear, or Newton's
    /// method does not converge.
    fn relaxed(&self, still: &[f64], first: &Motion) -> Option<Motion> {
        let structure = self.structure;
        if structure.unknowns() > MOST_ANALYSED || structure.is_linear() {
            return None;
        }
        let along: Vec<f64> = structure.freedom_of.iter().map(|freedom| first.displacement[*freedom]).collect();
        let squared: f64 = along.iter().map(|value| value * value).sum();
        if squared <= 0.0 {
            return None;
        }
        let row: Vec<f64> = along.iter().map(|value| value / squared).collect();
        FINITE.iter().find_map(|size| self.relaxed_at(still, &along, first.load, &row, *size))
    }

    /// The relaxed motion of one size: `f(u) = s p`, `row·u = size`.
    fn relaxed_at(&self, still: &[f64], along: &[f64], load: f64, row: &[f64], size: f64) -> Option<Motion> {
        let structure = self.structure;
        let (ties, unknowns) = (self.all_ties(still), structure.unknowns());
        let mut values: Vec<f64> = along.iter().map(|value| size * value).chain(std::iter::once(size * load)).collect();
        let (mut rest, mut force) = (vec![0.0; structure.freedoms()], vec![0.0; structure.freedoms()]);
        structure.internal_force(still, &mut rest);
        for _ in 0..MOST_ITERATIONS {
            let motion = self.motion(&values);
            structure.internal_force(&motion.displacement, &mut force);
            let mut left_over = DVector::zeros(unknowns + 1);
            for (unknown, freedom) in structure.freedom_of.iter().enumerate() {
                left_over[unknown] = force[*freedom] - rest[*freedom] - motion.load * self.pattern.forces[*freedom];
            }
            for tie in &ties {
                let pull = tie.stretching.stiffness * tie.stretch(&motion);
                load_response::unknowns_of(self, &tie.stretching)
                    .iter()
                    .for_each(|(row, value)| left_over[*row] += pull * value);
            }
            left_over[unknowns] = row.iter().zip(&values).map(|(entry, value)| entry * value).sum::<f64>() - size;
            if !load_response::factorise(self, &motion.displacement, &ties, row)?.solve(&mut left_over) {
                return None;
            }
            values.iter_mut().zip(left_over.iter()).for_each(|(value, change)| *value -= change);
            let correction = left_over.rows(0, unknowns).amax();
            if !correction.is_finite() || correction > 1.0 {
                return None;
            }
            if correction <= ACCEPTED_CORRECTION * size {
                return Some(self.motion(&values));
            }
        }
        None
    }

    /// The mean stiffness weighted by the elements' energies in a motion, of finite size or at first order; `None`
    /// where the elements store next to no energy.
    fn mean(&self, motion: &Motion, is_finite: bool) -> Option<f64> {
        let still = vec![0.0; motion.displacement.len()];
        let (mut stored, mut logarithms, mut most) = (0.0, 0.0, 0.0);
        let (mut buffer, mut matrix_buffer) = (ForceBuffer::default(), StiffnessBuffer::default());
        for element in self.structure.elements() {
            let energy = if is_finite {
                let after = element.energy(&motion.displacement, &mut buffer);
                2.0 * (after - element.energy(&still, &mut buffer)).abs()
            } else {
                energy_at_first_order(element, &still, motion, &mut matrix_buffer)
            };
            let stiffness = element.axial_stiffness(&motion.displacement, &mut buffer);
            most += most_energy(element, &still, motion, &mut matrix_buffer);
            if energy > 0.0 && stiffness > 0.0 {
                stored += energy;
                logarithms += energy * stiffness.ln();
            }
        }
        let [held, _] = self.ties(&still);
        let held: f64 = held.iter().map(|tie| tie.energy(motion)).sum();
        (stored > SMALLEST_ELEMENT_ENERGY * held && stored > ENERGY_ROUND_OFF * most && stored.is_finite())
            .then(|| (logarithms / stored).exp())
    }
}

/// The energy of an element if the contributions of the displacements did not cancel.
fn most_energy(element: ElementAt<'_>, still: &[f64], motion: &Motion, buffer: &mut StiffnessBuffer) -> f64 {
    let mut most = 0.0;
    element.alone().each_stiffness(still, buffer, &mut |row, column, value| {
        most += (motion.displacement[row] * value * motion.displacement[column]).abs();
    });
    most
}

/// `u·K_e u`
fn energy_at_first_order(element: ElementAt<'_>, still: &[f64], motion: &Motion, buffer: &mut StiffnessBuffer) -> f64 {
    let of = |stretching: Stretching| Tie { stretching, by_load: 0.0 }.energy(motion);
    let stretched: f64 = element.stretching(still).map(of).sum();
    let mut across = 0.0;
    element.alone().each_stiffness_across(still, buffer, &mut |row, column, value| {
        across += motion.displacement[row] * value * motion.displacement[column];
    });
    stretched + across.abs()
}
