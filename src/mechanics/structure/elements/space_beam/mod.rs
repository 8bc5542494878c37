//! A geometrically exact beam in space, of two or three nodes: stretched, sheared, bent about two axes and twisted.
//!
//! The strains are those of J. C. Simo and L. Vu-Quoc (Comput. Methods Appl. Mech. Eng. 58 (1986) 79,
//! doi:10.1016/0045-7825(86)90079-4), interpolated between frames so that a common rotation changes nothing and no
//! strain depends on the way there (M. A. Crisfield, G. Jelenić, Proc. R. Soc. Lond. A 455 (1999) 1125,
//! doi:10.1098/rspa.1999.0352; constant along a helix: V. Sonneville, A. Cardona, O. Brüls, Comput. Methods Appl. Mech.
//! Eng. 268 (2014) 451, doi:10.1016/j.cma.2013.10.008); [`segment`] has the energy.
//!
//! The rotation of a node is `exp(θ - θ_n) exp(θ_n)`, `θ_n` a reference near by: the energy, the forces and the tangent
//! are those of an ordinary function of the degrees of freedom `θ`, and the tangent is symmetric everywhere. The
//! references move along with the path (`turning_nodes`), so that no rotation is too large.
//!
//! Axis 1 of the cross-section is the part across the beam of a given vector (of three nodes: across the tangent at the
//! second, and carried along the beam without twist); axis 2 is a quarter turn about the beam's direction from it.

pub mod segment;
#[cfg(test)]
mod tests;

use crate::mechanics::rotation::quaternion;
use crate::mechanics::structure::elements::{FiniteElement, Resultants, SpaceBeamEnd};
use nalgebra::{Quaternion, Rotation3, Vector3};
use segment::{OF_MOTION, SpaceEndMotion, SpaceSectionStiffness, SpaceSegment};
use smallvec::SmallVec;

/// Degrees of freedom of a node: three translations and a rotation vector.
const OF_NODE: usize = 6;

#[derive(Debug, Clone)]
pub struct SpaceBeam {
    nodes: SmallVec<[usize; 3]>,
    /// For each node, which of the node's rotations is the first that the element uses.
    rotation_at: SmallVec<[usize; 3]>,
    segments: SmallVec<[SpaceSegment; 2]>,
    /// `θ_n` of each node, and the quaternion of it.
    references: SmallVec<[([f64; 3], Quaternion<f64>); 3]>,
}

/// The part of a vector across another, of unit size.
fn across(vector: Vector3<f64>, along: &Vector3<f64>) -> Vector3<f64> {
    (vector - along * (vector.dot(along) / along.norm_squared())).normalize()
}

impl SpaceBeam {
    /// A straight beam; `chord` leads from the first node to the second, `orientation` is not parallel to it.
    pub fn straight(
        nodes: [usize; 2],
        chord: [f64; 3],
        orientation: [f64; 3],
        stiffness: SpaceSectionStiffness,
    ) -> Self {
        let axis = across(orientation.into(), &chord.into());
        Self::of(&nodes, &[SpaceSegment::new(chord, axis.into(), [0.0; 3], stiffness)])
    }

    /// A beam along the circle through three nodes (or a straight line); `chords` lead from each node to the next,
    /// `orientation` is not parallel to the tangent at the second node.
    pub fn curved(
        nodes: [usize; 3],
        chords: [[f64; 3]; 2],
        orientation: [f64; 3],
        stiffness: SpaceSectionStiffness,
    ) -> Self {
        // Each chord encloses half its arc's angle with the tangent at the second node.
        let [one, other] = chords.map(Vector3::from);
        let normal = one.cross(&other);
        let between = normal.norm().atan2(one.dot(&other));
        let (sin, cos) = between.sin_cos();
        let half_turn = (one.norm() * sin).atan2(other.norm() + one.norm() * cos);
        let normal = if normal.norm() > 0.0 { normal.normalize() } else { normal };
        let tangent = Rotation3::new(normal * half_turn) * one;
        let axis = across(orientation.into(), &tangent);
        let segment = |chord: Vector3<f64>, turned: f64, half_turn: f64| {
            let axis = Rotation3::new(normal * turned) * axis;
            let turn = normal * (2.0 * half_turn);
            SpaceSegment::new(chord.into(), axis.into(), turn.into(), stiffness)
        };
        let rest = between - half_turn;
        Self::of(&nodes, &[segment(one, -half_turn, half_turn), segment(other, rest, rest)])
    }

    fn of(nodes: &[usize], segments: &[SpaceSegment]) -> Self {
        Self {
            nodes: SmallVec::from_slice(nodes),
            rotation_at: SmallVec::from_elem(0, nodes.len()),
            segments: SmallVec::from_slice(segments),
            references: SmallVec::from_elem(([0.0; 3], Quaternion::identity()), nodes.len()),
        }
    }

    /// The beam with other ones of the node's rotations, from this one on, at the node of this place.
    #[must_use]
    pub fn with_rotation_at(mut self, place: usize, rotation: usize) -> Self {
        self.rotation_at[place] = rotation;
        self
    }

    fn stiffness(&self) -> &SpaceSectionStiffness {
        &self.segments[0].stiffness
    }

    /// The length along the undeformed beam.
    fn length(&self) -> f64 {
        self.segments.iter().map(SpaceSegment::length).sum()
    }

    fn least_bending(&self) -> f64 {
        self.stiffness().bending[0].min(self.stiffness().bending[1])
    }

    fn motion(&self, place: usize, displacement: &[f64]) -> SpaceEndMotion {
        let of = |first: usize| -> [f64; 3] { std::array::from_fn(|k| displacement[first + k]) };
        let nodes = [place, place + 1];
        let [from, to] = nodes.map(|node| of(OF_NODE * node));
        SpaceEndMotion {
            relative: std::array::from_fn(|k| to[k] - from[k]),
            rotations: nodes.map(|node| {
                let (total, reference) = (of(OF_NODE * node + 3), self.references[node].0);
                std::array::from_fn(|k| total[k] - reference[k])
            }),
            references: nodes.map(|node| self.references[node].1),
        }
    }

    /// The force and the moment in the beam at an end, in the axes of the end's cross-section.
    fn end(&self, displacement: &[f64], which: usize) -> SpaceBeamEnd {
        let place = if which == 0 { 0 } else { self.segments.len() - 1 };
        let (segment, mut motion) = (&self.segments[place], self.motion(place, displacement));
        // With the present rotation as reference, the derivative by the rotation vector is the moment.
        motion.references = [0, 1].map(|end| quaternion(&motion.rotations[end]) * motion.references[end]);
        motion.rotations = [[0.0; 3]; 2];
        let gradient = segment.gradient(&motion);
        let turned = nalgebra::UnitQuaternion::new_normalize(motion.references[which]);
        let frame = turned.to_rotation_matrix() * segment.frame(which);
        let vector = |first: usize| Vector3::new(gradient[first], gradient[first + 1], gradient[first + 2]);
        let sign = if which == 0 { -1.0 } else { 1.0 };
        let (force, moment) = (frame.tr_mul(&vector(0)), frame.tr_mul(&vector(3 + 3 * which)) * sign);
        SpaceBeamEnd {
            axial_force: force.x,
            shear_forces: [force.y, force.z],
            torsional_moment: moment.x,
            bending_moments: [moment.y, moment.z],
        }
    }
}

/// The degrees of freedom of a segment as components of its motion, with their signs.
const MOTIONS: [(usize, f64); 2 * OF_NODE] = [
    (0, -1.0),
    (1, -1.0),
    (2, -1.0),
    (3, 1.0),
    (4, 1.0),
    (5, 1.0),
    (0, 1.0),
    (1, 1.0),
    (2, 1.0),
    (6, 1.0),
    (7, 1.0),
    (8, 1.0),
];

impl FiniteElement for SpaceBeam {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn is_of_relative_positions(&self) -> bool {
        true
    }

    fn rotations(&self) -> usize {
        3
    }

    fn first_rotation_at(&self, place: usize) -> usize {
        self.rotation_at[place]
    }

    fn refer(&mut self, references: &[f64]) {
        for (own, values) in self.references.iter_mut().zip(references.chunks_exact(OF_NODE)) {
            let total = [values[3], values[4], values[5]];
            *own = (total, quaternion(&total));
        }
    }

    fn energy(&self, displacement: &[f64]) -> f64 {
        let energies = self.segments.iter().enumerate();
        energies.map(|(place, segment)| segment.energy(&self.motion(place, displacement))).sum()
    }

    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        force.fill(0.0);
        let mut carried = 0.0_f64;
        for (place, segment) in self.segments.iter().enumerate() {
            let gradient: [f64; OF_MOTION] = segment.gradient(&self.motion(place, displacement));
            let own = &mut force[OF_NODE * place..][..2 * OF_NODE];
            for (value, (motion, sign)) in own.iter_mut().zip(MOTIONS) {
                *value += sign * gradient[motion];
            }
            let size = |first: usize| gradient[first].hypot(gradient[first + 1]).hypot(gradient[first + 2]);
            carried = carried.max(size(0)).max(size(3)).max(size(6));
        }
        carried
    }

    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        stiffness.fill(0.0);
        let size = displacement.len();
        for (place, segment) in self.segments.iter().enumerate() {
            let hessian = segment.hessian(&self.motion(place, displacement));
            for (row, (of_row, sign)) in MOTIONS.iter().enumerate() {
                let row = &mut stiffness[(OF_NODE * place + row) * size + OF_NODE * place..][..2 * OF_NODE];
                for (value, (of_column, other)) in row.iter_mut().zip(&MOTIONS) {
                    *value += sign * other * hessian[*of_row][*of_column];
                }
            }
        }
    }

    /// `Σ |K_ij| |u_j|` and the force carried. A rotation moves the far end by up to the length of the segment.
    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        let size = displacement.len();
        let mut stiffness: SmallVec<[f64; 324]> = SmallVec::from_elem(0.0, size * size);
        self.write_stiffness(displacement, &mut stiffness);
        let carried = self.write_force(displacement, sizes);
        let is_turn = |freedom: usize| freedom % OF_NODE >= 3;
        let turns = displacement.iter().enumerate().filter(|(freedom, _)| is_turn(*freedom));
        let turned = turns.fold(0.0_f64, |most, (_, turn)| most.max(turn.abs()));
        let swept = turned.min(1.0) * self.length();
        for ((place, size_of), row) in sizes.iter_mut().enumerate().zip(stiffness.chunks(size)) {
            let moved = displacement
                .iter()
                .enumerate()
                .map(|(freedom, value)| value.abs().max(least).max(if is_turn(freedom) { 0.0 } else { swept }));
            let by_motion: f64 = row.iter().zip(moved).map(|(stiffness, moved)| stiffness.abs() * moved).sum();
            *size_of = by_motion + if is_turn(place) { size_of.abs() } else { carried };
        }
    }

    /// `EA`; of motions that bend it, `EI` over the square of the length.
    fn axial_stiffness(&self, _motion: &[f64]) -> f64 {
        let soft = self.least_bending().min(self.stiffness().torsional);
        self.stiffness().axial.min(soft / self.length().powi(2))
    }

    /// A slender beam resists bending and torsion far less than stretching.
    fn least_stiffness(&self, freedom: usize) -> Option<f64> {
        let (bending, length) = (self.least_bending(), self.length());
        Some(if freedom % OF_NODE >= 3 {
            (4.0 * bending).min(self.stiffness().torsional) / length
        } else {
            (12.0 * bending / length.powi(3)).min(self.stiffness().axial / length)
        })
    }

    fn resultants(&self, displacement: &[f64]) -> Option<Resultants> {
        Some(Resultants::SpaceEnds([0, 1].map(|end| self.end(displacement, end))))
    }

    fn stretch(&self, displacement: &[f64]) -> Option<f64> {
        let segments = self.segments.iter().enumerate();
        segments.map(|(place, segment)| segment.stretch(&self.motion(place, displacement))).reduce(f64::min)
    }
}
