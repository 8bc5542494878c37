//! The kinds of elements, one file each, and the interface of all.

pub mod anchor;
pub mod bar;
pub mod beam;
pub mod materials;
pub mod rotational_spring;
pub mod solid;
pub mod space_beam;
pub mod spring;

use std::fmt::Debug;

/// One element. All quantities are dimensionless.
///
/// `displacement` and `force` hold the element's own degrees of freedom, node by node: the translations of a node, then
/// as many of its rotations as [`rotations`](Self::rotations) says. `stiffness` is a square matrix over these degrees
/// of freedom, row by row.
pub trait FiniteElement: Debug + Send + Sync {
    /// The nodes that the element joins, at least one, each once.
    fn nodes(&self) -> &[usize];

    /// The number of rotations that the element has at each of its nodes.
    fn rotations(&self) -> usize {
        0
    }

    /// Which of a node's rotations is the first that the element has there; `place` is the node's place in
    /// [`nodes`](Self::nodes). Rotation 0 is shared by all elements that are joined rigidly at the node; a released end
    /// has another.
    fn first_rotation_at(&self, _place: usize) -> usize {
        0
    }

    /// Takes other rotation vectors, among values for all of the element's degrees of freedom, as those from which the
    /// rotations of its nodes are measured; for elements with rotations in space.
    fn refer(&mut self, _references: &[f64]) {}

    /// Strain energy `W`.
    fn energy(&self, displacement: &[f64]) -> f64;

    /// Writes the nodal forces `∂W/∂u`; returns the size of the force that the element carries.
    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64;

    /// Writes the tangent `∂²W/∂u²`.
    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]);

    /// Number of forces that are variables of the iteration, next to the displacements: see
    /// [`mixed_iteration`](crate::mechanics::structure::mixed_iteration).
    fn independent_forces(&self) -> usize {
        0
    }

    /// Writes the independent forces that belong to the displacements.
    fn write_independent_forces(&self, _displacement: &[f64], _forces: &mut [f64]) {}

    /// Writes the nodal forces of the mixed form less those that the displacements give.
    fn write_mixed_excess(&self, _displacement: &[f64], _forces: &[f64], excess: &mut [f64]) {
        excess.fill(0.0);
    }

    /// Writes the tangent of the mixed form.
    fn write_mixed_stiffness(&self, displacement: &[f64], _forces: &[f64], stiffness: &mut [f64]) {
        self.write_stiffness(displacement, stiffness);
    }

    /// Changes the independent forces of an iterate at a displacement by the linear equations, when the displacement
    /// changes by `change`.
    fn advance_independent_forces(&self, _displacement: &[f64], _change: &[f64], _forces: &mut [f64]) {}

    /// Writes the size of the terms that make up the nodal forces: stiffness times the displacements themselves (at
    /// least `least`), not their differences, and the force carried.
    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]);

    /// The stiffness against a motion (of the element's degrees of freedom) per strain, expressed as an axial
    /// stiffness.
    fn axial_stiffness(&self, motion: &[f64]) -> f64;

    /// The stiffness to which a change of the nodal force of one of the element's degrees of freedom is compared, where
    /// the element resists some motions far less than others; `None`: its stiffness at large.
    fn least_stiffness(&self, _freedom: usize) -> Option<f64> {
        None
    }

    /// Whether the element stands for a load: it stores no energy and resists no motion. Its forces are no derivative of an
    /// energy, and its tangent need not be symmetric.
    fn is_load(&self) -> bool {
        false
    }

    /// Whether the forces depend on the positions of the nodes relative to each other and on rotations alone.
    fn is_of_relative_positions(&self) -> bool {
        false
    }

    /// Whether the nodal forces are linear in the displacements.
    fn is_linear(&self) -> bool {
        false
    }

    /// The summands `k c cᵀ` of the tangent by which the element resists stretching, kept apart from the rest where
    /// stiff and soft elements meet; `along` counts the element's own degrees of freedom.
    fn stretching(&self, _displacement: &[f64]) -> Vec<Stretching> {
        Vec::new()
    }

    /// Writes the tangent without the summands that [`stretching`](Self::stretching) lists.
    fn write_stiffness_across(&self, displacement: &[f64], stiffness: &mut [f64]) {
        self.write_stiffness(displacement, stiffness);
    }

    /// The force that the element carries, as results report it; `None` where nothing is reported of its kind.
    fn resultants(&self, _displacement: &[f64]) -> Option<Resultants> {
        None
    }

    /// The stretch `L/L0` of an element that may shrink to a point, where its forces lose their direction.
    fn stretch(&self, _displacement: &[f64]) -> Option<f64> {
        None
    }
}

/// The force that an element carries.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Resultants {
    /// Along the deformed axis of a bar, tension positive.
    Axial(f64),
    /// Of a spring on its first node's displacement relative to the second, or to the ground, in global axes; in 2D the
    /// third component is 0.
    Force([f64; 3]),
    /// At both ends of a plane beam.
    Ends([BeamEnd; 2]),
    /// At both ends of a beam in space.
    SpaceEnds([SpaceBeamEnd; 2]),
    /// Of a rotational spring on the rotation of its first node relative to the second, or to the ground.
    Moment(f64),
    /// The mean Cauchy stress in a solid over its deformed volume, per undeformed area where strains count as small.
    Stress {
        /// Components `xx`, `yy`, `zz`, `xy`, `yz`, `xz`; in a body of revolution `zz` is around the axis.
        stress: [f64; 6],
        /// Equivalent stress of von Mises.
        von_mises: f64,
    },
}

/// The force in a beam at one of its ends, in the axes of the cross-section there: `t` its normal, along the beam, and
/// `n`, a quarter turn counter-clockwise from `t`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamEnd {
    /// Along `t`, tension positive.
    pub axial_force: f64,
    /// Along `n`, on the side of the cross-section that `t` leaves.
    pub shear_force: f64,
    /// Positive where the rotation grows along the beam.
    pub bending_moment: f64,
}

/// The force and the moment in a beam in space at one of its ends, in the axes of the cross-section there: `t` along the
/// beam, axis 1 and axis 2; both act on the side that `t` leaves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceBeamEnd {
    /// Along `t`, tension positive.
    pub axial_force: f64,
    /// Along axes 1 and 2.
    pub shear_forces: [f64; 2],
    /// About `t`.
    pub torsional_moment: f64,
    /// About axes 1 and 2.
    pub bending_moments: [f64; 2],
}

/// A summand `k c cᵀ` of the tangent: the stiffness `k` against motions along `c`.
#[derive(Debug, Clone)]
pub struct Stretching {
    /// The stiffness `k`, not zero.
    pub stiffness: f64,
    /// Entries of `c`, one per degree of freedom.
    pub along: Vec<(usize, f64)>,
}

/// Stretch of an element below which a failure to converge counts as its collapse.
pub(crate) const COLLAPSED: f64 = 1e-4;
