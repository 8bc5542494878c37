//! A builder of requests.

use crate::model::JobRequest;
use crate::model::request::{
    Analysis, Component, Contact, DisplacementBound, Element, Model, Obstacle, Side, Stage, Strain, Until,
};

/// A request under construction.
#[derive(Debug, Clone)]
pub struct Make(pub JobRequest);

/// The forces of a stage without forces.
pub const NO_FORCES: [(&str, [f64; 2]); 0] = [];

/// An empty request in the plane.
pub fn plane_model() -> Make {
    model(2)
}

/// An empty request in space.
pub fn space_model() -> Make {
    model(3)
}

fn model(dimension: usize) -> Make {
    let model = Model::new(dimension);
    Make(JobRequest { model, analysis: Analysis { max_increments: 20_000, ..Analysis::default() } })
}

/// The load above which a stage ends.
pub fn load_above(bound: f64) -> Option<Until> {
    Some(Until { load_above: Some(bound), ..Until::default() })
}

/// A displacement at which a stage ends; `sign` is the sign of the motion towards the bound.
pub fn displacement(node: &str, component: Component, bound: f64, sign: f64) -> Option<Until> {
    let (above, below) = if sign > 0.0 { (Some(bound), None) } else { (None, Some(bound)) };
    let bound = DisplacementBound { node: node.to_owned(), component, above, below };
    Some(Until { displacement: Some(bound), ..Until::default() })
}

impl Make {
    pub fn node(mut self, name: &str, place: &[f64]) -> Self {
        self.0.model.nodes.insert(name.to_owned(), place.to_vec());
        self
    }

    pub fn support(mut self, node: &str, components: &[Component]) -> Self {
        self.0.model.supports.insert(node.to_owned(), components.to_vec());
        self
    }

    pub fn bar(mut self, first: &str, second: &str, axial_stiffness: f64) -> Self {
        self.0.model.elements.push(Element::Bar {
            nodes: vec![first.to_owned(), second.to_owned()],
            axial_stiffness,
            rest_length: None,
            prestress: 0.0,
            strain: Strain::Engineering,
            name: None,
        });
        self
    }

    /// Sets the strain measure of all bars added so far.
    pub fn strain(mut self, measure: Strain) -> Self {
        for element in &mut self.0.model.elements {
            if let Element::Bar { strain, .. } = element {
                *strain = measure;
            }
        }
        self
    }

    /// A spring between two nodes, or between one node and the ground.
    pub fn spring(mut self, nodes: &[&str], stiffness: [[f64; 2]; 2]) -> Self {
        self.0.model.elements.push(Element::Spring {
            nodes: nodes.iter().map(|node| (*node).to_owned()).collect(),
            stiffness: stiffness.iter().map(|row| row.to_vec()).collect(),
            name: None,
        });
        self
    }

    pub fn plane(mut self, name: &str, point: &[f64], normal: &[f64]) -> Self {
        let plane = Obstacle::Plane { point: point.to_vec(), normal: normal.to_vec() };
        self.0.model.obstacles.insert(name.to_owned(), plane);
        self
    }

    /// A plane with the free side `y >= 0`.
    pub fn floor(self) -> Self {
        self.plane("floor", &[0.0, 0.0], &[0.0, 1.0])
    }

    pub fn ball(mut self, name: &str, center: &[f64], radius: f64) -> Self {
        let ball = Obstacle::Ball { center: center.to_vec(), radius, side: Side::Outside };
        self.0.model.obstacles.insert(name.to_owned(), ball);
        self
    }

    pub fn contact(mut self, node: &str, obstacle: &str, friction: f64) -> Self {
        self.0.model.contacts.push(Contact::new(node, obstacle, friction));
        self
    }

    pub fn stage<const D: usize>(mut self, name: &str, forces: &[(&str, [f64; D])], until: Option<Until>) -> Self {
        let forces = forces.iter().map(|(node, force)| ((*node).to_owned(), force.to_vec())).collect();
        self.0.model.stages.push(Stage { forces, until, ..Stage::new(name) });
        self
    }

    /// Prescribes the displacement of a supported node in the last stage.
    pub fn driven(mut self, node: &str, displacement: [f64; 2]) -> Self {
        if let Some(stage) = self.0.model.stages.last_mut() {
            stage.displacements.insert(node.to_owned(), displacement.to_vec());
        }
        self
    }

    pub fn longest_step(mut self, step: f64) -> Self {
        let arc_length = &mut self.0.analysis.arc_length;
        (arc_length.initial, arc_length.max, arc_length.jump) = (arc_length.initial.min(step), step, false);
        self
    }

    pub fn shortest_step(mut self, step: f64) -> Self {
        self.0.analysis.arc_length.min = step;
        self
    }

    pub fn most_increments(mut self, count: u64) -> Self {
        self.0.analysis.max_increments = count;
        self
    }

    pub fn load_scale(mut self, scale: f64) -> Self {
        self.0.analysis.arc_length.load_scale = Some(scale);
        self
    }

    pub fn request(self) -> JobRequest {
        self.0
    }
}
