//! A lattice arch of any size over a floor: chords of bars, posts and diagonals, fixed at both ends, with a load
//! slightly off the crown. The arch snaps through, and the nodes below the crown land on the floor. The cells are
//! approximately square: the number of chords grows with the refinement, so that the slenderness does not depend on the
//! number of unknowns.

use crate::model::JobRequest;
use serde_json::{Value, json};

/// A lattice arch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeArch {
    /// Number of fields between posts, at least 2.
    pub panels: usize,
    /// Number of fields between chords, at least 1.
    pub layers: usize,
    /// Number of nodes of the lower chord that may land on the floor: those nearest to the crown.
    pub contacts: usize,
    pub friction: f64,
    /// Height of the crown; half the span is 1.
    pub rise: f64,
    /// Distance between the outer chords.
    pub depth: f64,
    /// Height of the lower chord at the crown above the floor.
    pub clearance: f64,
    /// Nodes of the upper chord within this distance of the load, along the span, carry a part of the load.
    pub spread: f64,
    /// The requested number of increments.
    pub increments: usize,
}

impl LatticeArch {
    /// The lattice with approximately the given number of unknowns.
    pub fn of_unknowns(unknowns: usize) -> Self {
        let depth = 0.08;
        let layers_of = |panels: usize| ((0.5 * depth * panels as f64).round() as usize).max(1);
        let mut panels = 4;
        while 2 * (layers_of(panels) + 1) * (panels - 1) < unknowns {
            panels += 1;
        }
        let layers = layers_of(panels);
        Self {
            panels,
            layers,
            contacts: 0,
            friction: 0.3,
            rise: 0.25,
            depth,
            clearance: 0.15,
            spread: 0.0,
            increments: 100,
        }
    }

    /// The same lattice with a load over 0.3 of the span, so that the arch lands flat, and with the given number of
    /// contacts, all open at the start.
    pub fn landing(self, contacts: usize) -> Self {
        let contacts = contacts.min(self.panels - 1);
        let outermost = (contacts + 1) as f64 / self.panels as f64;
        let clearance = self.clearance.max(1.05 * self.rise * outermost.powi(2));
        Self { contacts, clearance, spread: 0.3, ..self }
    }

    /// Number of free displacement components.
    pub fn unknowns(&self) -> usize {
        2 * (self.layers + 1) * (self.panels - 1)
    }

    /// The job request. With `n` unknowns the first and longest step is `sqrt(0.2 n)/50` of the rise: the order of
    /// magnitude of the norm of the displacements when the crown falls by `1/50` of the rise.
    pub fn request(&self) -> Result<JobRequest, serde_json::Error> {
        let x = |post: usize| 2.0 * post as f64 / self.panels as f64 - 1.0;
        let y = |post: usize| self.rise * (1.0 - x(post).powi(2));
        let mut nodes = serde_json::Map::new();
        let mut elements = Vec::new();
        let mut bar = |first: String, second: String| {
            elements.push(json!({"kind": "bar", "nodes": [first, second], "axial_stiffness": 1.0}));
        };
        let node = |layer: usize, post: usize| format!("c{layer}_{post}");
        for post in 0..=self.panels {
            for layer in 0..=self.layers {
                let height = y(post) + self.depth * layer as f64 / self.layers as f64;
                nodes.insert(node(layer, post), json!([x(post), height]));
                if layer > 0 && post > 0 && post < self.panels {
                    bar(node(layer - 1, post), node(layer, post));
                }
                if post > 0 {
                    bar(node(layer, post - 1), node(layer, post));
                }
                if post > 0 && layer > 0 {
                    bar(node(layer - 1, post - 1), node(layer, post));
                    bar(node(layer, post - 1), node(layer - 1, post));
                }
            }
        }
        let mut supports = serde_json::Map::new();
        for layer in 0..=self.layers {
            supports.insert(node(layer, 0), json!(["x", "y"]));
            supports.insert(node(layer, self.panels), json!(["x", "y"]));
        }
        let crown = self.panels / 2;
        let first = (crown + 1).saturating_sub(self.contacts.div_ceil(2)).max(1);
        let last = (first + self.contacts).min(self.panels);
        let contacts: Vec<Value> = (first..last)
            .map(|post| json!({"node": node(0, post), "obstacle": "floor", "friction": self.friction}))
            .collect();
        let loaded = (self.panels * 11).div_ceil(24);
        let bears = |post: &usize| *post == loaded || (x(*post) - x(loaded)).abs() <= self.spread;
        let loaded: Vec<usize> = (1..self.panels).filter(bears).collect();
        let force = -0.001 / loaded.len() as f64;
        let forces: serde_json::Map<String, Value> =
            loaded.into_iter().map(|post| (node(self.layers, post), json!([0, force]))).collect();
        let step = self.rise / 50.0 * (0.2 * self.unknowns() as f64).sqrt();
        serde_json::from_value(json!({
            "model": {
                "dimension": 2, "nodes": nodes, "elements": elements, "supports": supports,
                "obstacles": {"floor": {"kind": "plane", "point": [0, self.rise - self.clearance], "normal": [0, 1]}},
                "contacts": contacts,
                "stages": [{
                    "name": "press", "forces": forces, "until": {"increments": self.increments},
                }],
            },
            "analysis": {
                "arc_length": {"initial": step, "max": step, "displacement_scale": 1.0},
                "record": {"nodes": [node(self.layers, crown)], "contacts": "in_reach"},
            },
        }))
    }
}
