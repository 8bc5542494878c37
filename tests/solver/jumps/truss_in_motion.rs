//! A plane truss that moves against damping, by a program of its own.

use arcslip::model::JobRequest;
use arcslip::model::request::Element;
use arcslip::result::increment::Increment;

/// A plane truss of bars and springs to the ground on planes: motion against damping alone, by explicit steps.
pub(super) struct Motion<'a> {
    pub request: &'a JobRequest,
    pub load: f64,
    /// Places of the nodes, in the order of the model.
    pub places: Vec<[f64; 2]>,
}

impl<'a> Motion<'a> {
    pub fn from(request: &'a JobRequest, increment: &Increment) -> Self {
        let nodes = request.model.nodes.iter();
        let places = nodes.map(|(name, place)| {
            let moved = &increment.displacements[name.as_str()];
            [place[0] + moved[0], place[1] + moved[1]]
        });
        Self { request, load: increment.load_factor, places: places.collect() }
    }

    pub fn node(&self, name: &str) -> usize {
        self.request.model.nodes.get_index_of(name).expect("a node")
    }

    /// The forces of elements and loads on the nodes.
    pub fn forces(&self) -> Vec<[f64; 2]> {
        let model = &self.request.model;
        let mut forces = vec![[0.0; 2]; self.places.len()];
        for (name, force) in &model.stages[0].forces {
            let node = self.node(name);
            (0..2).for_each(|k| forces[node][k] += self.load * force[k]);
        }
        for element in &model.elements {
            match element {
                Element::Bar { nodes, axial_stiffness, .. } => {
                    let [first, second] = [self.node(&nodes[0]), self.node(&nodes[1])];
                    let rest =
                        (0..2).map(|k| (model.nodes[second][k] - model.nodes[first][k]).powi(2)).sum::<f64>().sqrt();
                    let along = [0, 1].map(|k| self.places[second][k] - self.places[first][k]);
                    let length = along[0].hypot(along[1]);
                    let force = axial_stiffness * (length - rest) / rest;
                    for k in 0..2 {
                        forces[first][k] += force * along[k] / length;
                        forces[second][k] -= force * along[k] / length;
                    }
                }
                Element::Spring { nodes, stiffness, .. } => {
                    let node = self.node(&nodes[0]);
                    let moved = [0, 1].map(|k| self.places[node][k] - model.nodes[node][k]);
                    (0..2).for_each(|k| forces[node][k] -= stiffness[k][0] * moved[0] + stiffness[k][1] * moved[1]);
                }
                other => panic!("{other:?}"),
            }
        }
        forces
    }
}
