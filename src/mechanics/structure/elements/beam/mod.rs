//! A geometrically exact beam in the plane, of two or three nodes.
//!
//! The strains are those of E. Reissner (J. Appl. Math. Phys. 23 (1972) 795, doi:10.1007/BF01602645; J. C. Simo, Comput.
//! Methods Appl. Mech. Eng. 49 (1985) 55, doi:10.1016/0045-7825(85)90050-7): with the position `x` of the centre line,
//! the rotation `θ` of the cross-section and the undeformed direction `φ`,
//!
//! ```text
//! (1 + ε, γ) = R(φ + θ)ᵀ x',    κ = θ',    W = ½ ∫ EA ε² + GA γ² + EI κ² ds
//! ```
//!
//! Strains and rotations are of any size. The beam is free of stress as drawn. Two nodes are joined by one straight
//! [`segment`], whose formulas say why neither shear nor the length locks, without a penalty and down to beams that do
//! not shear. Three nodes, in order along the beam, are joined by two segments, arcs of the circle through the three
//! nodes: a curved beam is then curved from the outset, and its stiffness and length converge with `h⁴` as they do for
//! straight beams; a chain of straight elements along a curve converges with `h²`, by its shape alone.
//!
//! A rotation counts turns: an end that has turned by `2π` is strained unless the other has turned with it. At a release
//! (a hinge) the element uses a rotation of its own instead of the one that the others at the node share.

mod cardinal_sine;
pub mod segment;
#[cfg(test)]
mod tests;

use crate::mechanics::structure::elements::{BeamEnd, FiniteElement, Resultants};
use segment::{BeamSegment, DeformedSegment, EndForces, EndMotion, SectionStiffness};
use smallvec::SmallVec;

/// Degrees of freedom of a node: two translations and a rotation.
const OF_NODE: usize = 3;

#[derive(Debug, Clone)]
pub struct Beam {
    nodes: SmallVec<[usize; 3]>,
    /// For each node, which of the node's rotations the element uses.
    rotation_at: SmallVec<[usize; 3]>,
    segments: SmallVec<[BeamSegment; 2]>,
}

impl Beam {
    /// A straight beam; `chord` leads from the first node to the second.
    pub fn straight(nodes: [usize; 2], chord: [f64; 2], stiffness: SectionStiffness) -> Self {
        Self {
            nodes: SmallVec::from_slice(&nodes),
            rotation_at: SmallVec::from_slice(&[0; 2]),
            segments: SmallVec::from_slice(&[BeamSegment::new(chord, 0.0, stiffness)]),
        }
    }

    /// A beam along the circle through three nodes (or a straight line); `chords` lead from each node to the next.
    pub fn curved(nodes: [usize; 3], chords: [[f64; 2]; 2], stiffness: SectionStiffness) -> Self {
        // Each chord encloses half its arc's angle with the tangent at the middle node: α + β is the angle between the
        // chords, and their lengths are as sin α and sin β.
        let [one, other] = chords;
        let [first, second] = chords.map(|[x, y]| x.hypot(y));
        let between = (one[0] * other[1] - one[1] * other[0]).atan2(one[0] * other[0] + one[1] * other[1]);
        let (sin, cos) = between.sin_cos();
        let half_turn = (first * sin).atan2(second + first * cos);
        let segments =
            [BeamSegment::new(one, half_turn, stiffness), BeamSegment::new(other, between - half_turn, stiffness)];
        Self {
            nodes: SmallVec::from_slice(&nodes),
            rotation_at: SmallVec::from_slice(&[0; 3]),
            segments: SmallVec::from_slice(&segments),
        }
    }

    /// The beam with another of the node's rotations at the node of this place.
    #[must_use]
    pub fn with_rotation_at(mut self, place: usize, rotation: usize) -> Self {
        self.rotation_at[place] = rotation;
        self
    }

    fn stiffness(&self) -> &SectionStiffness {
        &self.segments[0].stiffness
    }

    /// The length along the undeformed beam.
    fn length(&self) -> f64 {
        self.segments.iter().map(BeamSegment::length).sum()
    }

    fn deformed<'a>(&'a self, displacement: &'a [f64]) -> impl Iterator<Item = DeformedSegment> + 'a {
        self.segments.iter().enumerate().map(|(place, segment)| segment.deformed(&motion(displacement, place)))
    }

    /// The segments with forces that are variables of the iteration.
    fn deformed_with<'a>(
        &'a self,
        displacement: &'a [f64],
        forces: &'a [f64],
    ) -> impl Iterator<Item = DeformedSegment> + 'a {
        let forces = forces.chunks_exact(2).map(|force| [force[0], force[1]]);
        self.deformed(displacement).zip(forces).map(|(segment, force)| segment.with_force(force))
    }

    /// The force in the beam and the bending moment at an end, in the axes of the end's cross-section.
    fn end(&self, forces: &EndForces, segment: &BeamSegment, rotation: f64, which: usize) -> BeamEnd {
        let [cos, sin] = segment.direction();
        let turned = if which == 0 { -segment.half_turn() } else { segment.half_turn() };
        let (sine, cosine) = (rotation + turned).sin_cos();
        let normal = [cosine * cos - sine * sin, sine * cos + cosine * sin];
        let [x, y] = forces.force;
        let moment = forces.moments[which];
        BeamEnd {
            axial_force: normal[0] * x + normal[1] * y,
            shear_force: normal[0] * y - normal[1] * x,
            bending_moment: if which == 0 { -moment } else { moment },
        }
    }
}

/// The motion of the ends of the segment at a place.
#[inline(always)]
fn motion(displacement: &[f64], place: usize) -> EndMotion {
    let [first, second] = [place, place + 1].map(|node| &displacement[OF_NODE * node..][..OF_NODE]);
    EndMotion { relative: [second[0] - first[0], second[1] - first[1]], rotations: [first[2], second[2]] }
}

/// Writes the nodal forces of the segments; returns the largest force or moment.
#[inline(always)]
fn write_end_forces(segments: impl Iterator<Item = EndForces>, force: &mut [f64]) -> f64 {
    force.fill(0.0);
    let mut carried = 0.0_f64;
    for (place, EndForces { force: [x, y], moments }) in segments.enumerate() {
        let own = &mut force[OF_NODE * place..][..2 * OF_NODE];
        for (value, part) in own.iter_mut().zip([-x, -y, moments[0], x, y, moments[1]]) {
            *value += part;
        }
        carried = carried.max(x.hypot(y)).max(moments[0].abs()).max(moments[1].abs());
    }
    carried
}

/// Writes the tangent of the segments over `size` degrees of freedom.
#[inline(always)]
fn write_tangents(segments: impl Iterator<Item = DeformedSegment>, size: usize, stiffness: &mut [f64]) {
    // The degrees of freedom of a segment as motions of its ends, with their signs.
    const MOTIONS: [(usize, f64); 2 * OF_NODE] = [(0, -1.0), (1, -1.0), (2, 1.0), (0, 1.0), (1, 1.0), (3, 1.0)];
    stiffness.fill(0.0);
    for (place, segment) in segments.enumerate() {
        let tangent = segment.tangent();
        for (row, (of_row, sign)) in MOTIONS.iter().enumerate() {
            let row = &mut stiffness[(OF_NODE * place + row) * size + OF_NODE * place..][..2 * OF_NODE];
            for (value, (of_column, other)) in row.iter_mut().zip(&MOTIONS) {
                *value += sign * other * tangent[*of_row][*of_column];
            }
        }
    }
}

impl FiniteElement for Beam {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn is_of_relative_positions(&self) -> bool {
        true
    }

    fn rotations(&self) -> usize {
        1
    }

    fn first_rotation_at(&self, place: usize) -> usize {
        self.rotation_at[place]
    }

    fn energy(&self, displacement: &[f64]) -> f64 {
        self.deformed(displacement).map(|segment| segment.energy()).sum()
    }

    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        write_end_forces(self.deformed(displacement).map(|segment| segment.end_forces()), force)
    }

    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        write_tangents(self.deformed(displacement), displacement.len(), stiffness);
    }

    fn independent_forces(&self) -> usize {
        2 * self.segments.len()
    }

    fn write_independent_forces(&self, displacement: &[f64], forces: &mut [f64]) {
        let own = self.deformed(displacement).flat_map(|segment| segment.force());
        forces.iter_mut().zip(own).for_each(|(force, value)| *force = value);
    }

    fn write_mixed_excess(&self, displacement: &[f64], forces: &[f64], excess: &mut [f64]) {
        let forces = forces.chunks_exact(2).map(|force| [force[0], force[1]]);
        let ends = self.deformed(displacement).zip(forces).map(|(segment, force)| {
            let (of_motion, mixed) = (segment.end_forces(), segment.with_force(force).mixed_end_forces());
            EndForces {
                force: [0, 1].map(|k| mixed.force[k] - of_motion.force[k]),
                moments: [0, 1].map(|k| mixed.moments[k] - of_motion.moments[k]),
            }
        });
        write_end_forces(ends, excess);
    }

    fn write_mixed_stiffness(&self, displacement: &[f64], forces: &[f64], stiffness: &mut [f64]) {
        write_tangents(self.deformed_with(displacement, forces), displacement.len(), stiffness);
    }

    fn advance_independent_forces(&self, displacement: &[f64], change: &[f64], forces: &mut [f64]) {
        let moved = (0..self.segments.len()).map(|place| motion(change, place));
        let advanced: SmallVec<[[f64; 2]; 2]> = self
            .deformed_with(displacement, forces)
            .zip(moved)
            .map(|(segment, change)| segment.advanced_force(&change))
            .collect();
        forces.iter_mut().zip(advanced.iter().flatten()).for_each(|(force, value)| *force = *value);
    }

    /// `Σ |K_ij| |u_j|` and the force carried. A rotation moves the far end by up to the length of the segment.
    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        let size = displacement.len();
        let mut stiffness: SmallVec<[f64; 81]> = SmallVec::from_elem(0.0, size * size);
        let deformed: SmallVec<[DeformedSegment; 2]> = self.deformed(displacement).collect();
        write_tangents(deformed.iter().copied(), size, &mut stiffness);
        let carried = write_end_forces(deformed.iter().map(DeformedSegment::end_forces), sizes);
        let turned = displacement.iter().skip(2).step_by(OF_NODE).fold(0.0_f64, |most, turn| most.max(turn.abs()));
        let swept = turned.min(1.0) * self.length();
        for ((place, size_of), row) in sizes.iter_mut().enumerate().zip(stiffness.chunks(size)) {
            let moved = displacement.iter().enumerate().map(|(freedom, value)| {
                let by_turns = if freedom % OF_NODE == 2 { 0.0 } else { swept };
                value.abs().max(least).max(by_turns)
            });
            let by_motion: f64 = row.iter().zip(moved).map(|(stiffness, moved)| stiffness.abs() * moved).sum();
            // A moment is a force times a length of the element.
            let carried = if place % OF_NODE == 2 { size_of.abs() } else { carried };
            *size_of = carried + by_motion;
        }
    }

    /// `EA`; of motions that bend it, `EI` over the square of the length.
    fn axial_stiffness(&self, _motion: &[f64]) -> f64 {
        self.stiffness().axial.min(self.stiffness().bending / self.length().powi(2))
    }

    /// A slender beam resists bending far less than stretching: what resists a motion is compared with the stiffness
    /// against bending.
    fn least_stiffness(&self, freedom: usize) -> Option<f64> {
        let SectionStiffness { axial, bending, .. } = *self.stiffness();
        let length = self.length();
        Some(if freedom % OF_NODE == 2 {
            4.0 * bending / length
        } else {
            (12.0 * bending / length.powi(3)).min(axial / length)
        })
    }

    fn resultants(&self, displacement: &[f64]) -> Option<Resultants> {
        let deformed: SmallVec<[DeformedSegment; 2]> = self.deformed(displacement).collect();
        let (first, last) = (self.segments.first()?, self.segments.last()?);
        let (of_first, of_last) = (deformed.first()?.end_forces(), deformed.last()?.end_forces());
        let turn = displacement.last()?;
        Some(Resultants::Ends([self.end(&of_first, first, displacement[2], 0), self.end(&of_last, last, *turn, 1)]))
    }

    fn stretch(&self, displacement: &[f64]) -> Option<f64> {
        self.deformed(displacement).map(|segment| segment.stretch()).reduce(f64::min)
    }
}
