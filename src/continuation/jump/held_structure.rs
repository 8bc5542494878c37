//! The structure with the springs that stand for damping and inertia in a time step.

use crate::mechanics::structure::Structure;
use crate::mechanics::structure::element_list::ElementList;
use crate::mechanics::structure::elements::anchor::Anchor;

/// Springs of one stiffness at places, one for each degree of freedom.
pub(super) struct Springs<'a> {
    pub stiffness: f64,
    pub places: &'a [f64],
}

/// Whether damping and inertia act on a degree of freedom: free translations, and in the plane free rotations.
pub(super) fn is_damped(structure: &Structure, freedom: usize) -> bool {
    let (_, which) = structure.numbering.node_of(freedom);
    structure.unknown_of[freedom].is_some() && (which < structure.dimension || structure.dimension == 2)
}

/// The length of a motion, over the degrees of freedom that are damped.
pub(super) fn length(structure: &Structure, motion: &[f64]) -> f64 {
    let damped = motion.iter().enumerate().filter(|(freedom, _)| is_damped(structure, *freedom));
    damped.map(|(_, value)| value * value).sum::<f64>().sqrt()
}

impl Springs<'_> {
    /// The structure held by the springs.
    pub fn holding(&self, structure: &Structure) -> Structure {
        let mut anchors = ElementList::default();
        for node in 0..structure.numbering.nodes() {
            let rotations = structure.numbering.rotations_of(node).len();
            let rotations = if structure.dimension == 2 { rotations } else { 0 };
            let first = structure.translations_of(node).start;
            let freedoms = first..first + structure.dimension + rotations;
            if !freedoms.clone().any(|freedom| is_damped(structure, freedom)) {
                continue;
            }
            let spring = |freedom: usize| {
                let stiffness = if is_damped(structure, freedom) { self.stiffness } else { 0.0 };
                (stiffness, self.places[freedom])
            };
            anchors.push(Anchor::new(node, rotations, freedoms.map(spring)));
        }
        structure.with_elements(&anchors)
    }

    /// The energy stored in the springs.
    pub fn energy(&self, structure: &Structure, displacement: &[f64]) -> f64 {
        let off: Vec<f64> = displacement.iter().zip(self.places).map(|(value, place)| value - place).collect();
        0.5 * self.stiffness * length(structure, &off).powi(2)
    }
}
