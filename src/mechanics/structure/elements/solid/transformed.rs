//! A solid, or a pressure on one, over the unknowns of a
//! [transformed basis](crate::mechanics::structure::basis_transformation).

use crate::mechanics::structure::basis_transformation::EdgePlaces;
use crate::mechanics::structure::element_list::ElementList;
use crate::mechanics::structure::elements::{FiniteElement, Resultants};
use smallvec::SmallVec;

/// An element some of whose nodes are middles with transformed unknowns.
#[derive(Debug, Clone)]
struct TransformedElement<E> {
    element: E,
    /// By the element's degrees of freedom.
    edges: Vec<EdgePlaces>,
}

/// The numbers of an element of 20 nodes fit.
type LocalValues = SmallVec<[f64; 60]>;

impl<E> TransformedElement<E> {
    fn displacements(&self, unknowns: &[f64]) -> LocalValues {
        let mut values = LocalValues::from_slice(unknowns);
        self.edges.iter().for_each(|edge| edge.displace(&mut values));
        values
    }
}

impl<E: FiniteElement> FiniteElement for TransformedElement<E> {
    fn nodes(&self) -> &[usize] {
        self.element.nodes()
    }

    fn energy(&self, displacement: &[f64]) -> f64 {
        self.element.energy(&self.displacements(displacement))
    }

    fn write_force(&self, displacement: &[f64], force: &mut [f64]) -> f64 {
        let size = self.element.write_force(&self.displacements(displacement), force);
        self.edges.iter().for_each(|edge| edge.distribute(force));
        size
    }

    fn write_stiffness(&self, displacement: &[f64], stiffness: &mut [f64]) {
        self.element.write_stiffness(&self.displacements(displacement), stiffness);
        self.edges.iter().for_each(|edge| edge.transform(displacement.len(), stiffness));
    }

    fn write_force_sizes(&self, displacement: &[f64], least: f64, sizes: &mut [f64]) {
        self.element.write_force_sizes(&self.displacements(displacement), least, sizes);
        self.edges.iter().for_each(|edge| edge.distribute(sizes));
    }

    fn axial_stiffness(&self, motion: &[f64]) -> f64 {
        self.element.axial_stiffness(&self.displacements(motion))
    }

    fn is_load(&self) -> bool {
        self.element.is_load()
    }

    fn is_linear(&self) -> bool {
        self.element.is_linear()
    }

    fn resultants(&self, displacement: &[f64]) -> Option<Resultants> {
        self.element.resultants(&self.displacements(displacement))
    }

    fn stretch(&self, displacement: &[f64]) -> Option<f64> {
        self.element.stretch(&self.displacements(displacement))
    }
}

/// Adds an element in so many dimensions at the end of a list, over transformed unknowns where `edges`, by the places of its
/// nodes, has any.
pub fn push_transformed<E>(list: &mut ElementList, element: E, edges: &[EdgePlaces], dimension: usize)
where
    E: FiniteElement + Clone + 'static,
{
    if edges.is_empty() {
        list.push(element);
        return;
    }
    let along = |axis: usize| {
        let freedom = move |place: usize| dimension * place + axis;
        edges.iter().map(move |edge| EdgePlaces { middle: freedom(edge.middle), ends: edge.ends.map(freedom), ..*edge })
    };
    let edges = (0..dimension).flat_map(along).collect();
    list.push(TransformedElement { element, edges });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::structure::basis_transformation::{BasisTransformation, MiddleUnknown, TransformedEdge};
    use crate::mechanics::structure::elements::materials::ElasticModuli;
    use crate::mechanics::structure::elements::materials::neo_hookean::NeoHookean;
    use crate::mechanics::structure::elements::solid::any::{AnySolid, SolidData};
    use crate::mechanics::structure::elements::solid::shapes::kind::{Idealisation, SolidKind};
    use std::collections::BTreeMap;
    use std::sync::Arc;

    /// Forces are the derivatives of the energy by the unknowns, and the tangent that of the forces.
    #[test]
    fn forces_and_tangent_are_derivatives() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.1, 1.2, 0.1], [0.0, 0.2, 0.9]];
        let middles = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
        let mut places = corners.to_vec();
        places.extend(
            middles
                .map(|[a, b]: [usize; 2]| std::array::from_fn::<f64, 3, _>(|k| 0.5 * (corners[a][k] + corners[b][k]))),
        );
        let moduli = ElasticModuli::from_young(2.0, 0.3).expect("moduli");
        let data = SolidData {
            kind: SolidKind::Tetrahedron10,
            idealisation: Idealisation::Space,
            material: Arc::new(NeoHookean { moduli }),
            mend: None,
        };
        let nodes: Vec<usize> = (0..10).collect();
        let edge = |ends, unknown| TransformedEdge { ends, unknown };
        let basis = BasisTransformation::new(BTreeMap::from([
            (4, edge([0, 1], MiddleUnknown::Extrapolated)),
            (5, edge([1, 2], MiddleUnknown::Extrapolated)),
            (6, edge([2, 0], MiddleUnknown::OffTheChord)),
        ]));
        let mut list = ElementList::default();
        AnySolid::new(&data, &nodes, &places).expect("a solid").add_to(&mut list, &basis);
        let element = list.iter().next().expect("an element");
        let at: Vec<f64> = (0..30).map(|place| 0.02 * (1.3 * f64::from(place)).sin()).collect();
        let (mut force, mut tangent) = (vec![0.0; 30], vec![0.0; 900]);
        element.write_force(&at, &mut force);
        element.write_stiffness(&at, &mut tangent);
        let step = 1e-5;
        for moved in 0..30 {
            let [high, low] = [step, -step].map(|step| {
                let mut at = at.clone();
                at[moved] += step;
                let mut force = vec![0.0; 30];
                element.write_force(&at, &mut force);
                (element.energy(&at), force)
            });
            assert!(((high.0 - low.0) / (2.0 * step) - force[moved]).abs() < 1e-9, "{moved}");
            for row in 0..30 {
                let slope = (high.1[row] - low.1[row]) / (2.0 * step);
                assert!((slope - tangent[row * 30 + moved]).abs() < 1e-8, "{row} {moved}");
            }
        }
    }
}
