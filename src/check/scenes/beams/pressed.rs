//! Beams between rigid walls: a ring between two plates, a column between two walls.

use crate::check::scenes::beams::reissner::{BeamMember, BeamSection, SectionState};
use crate::check::scenes::beams::shooting::shoot;
use crate::check::scenes::beams::{BeamChain, floor, on_circle, on_line};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

/// Half a ring of radius 1 and `EI = 1`, between a floor and a ceiling that comes down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SqueezedRing {
    pub friction: f64,
    pub axial: f64,
}

impl SqueezedRing {
    /// The model of elements of three nodes, every node a contact with the nearer plate. The load factor is the distance
    /// that the ceiling has come down; `n0` is the top. The number of elements is even.
    pub fn model(&self, elements: usize) -> Value {
        let mut places = on_circle(0.0, PI, 2 * elements);
        (places[elements], places[2 * elements]) = ([1.0, 0.0], [0.0, -1.0]);
        let chain = BeamChain::new(&places, 3, &BeamSection::slender(self.axial));
        let plate = |node: usize| if node < elements { "ceiling" } else { "floor" };
        let contacts: Vec<Value> = (0..=2 * elements)
            .map(|node| json!({"node": format!("n{node}"), "obstacle": plate(node), "friction": self.friction}))
            .collect();
        json!({
            "name": format!("half a ring between rough plates, mu = {}", self.friction), "dimension": 2,
            "supports": {"n0": ["x", "rz"], chain.last(): ["x", "rz"]},
            "nodes": chain.nodes, "elements": chain.beams,
            "obstacles": {"floor": floor(-1.0), "ceiling": {"kind": "plane", "point": [0, 1], "normal": [0, -1]}},
            "contacts": contacts,
            "stages": [{"name": "squeeze", "obstacle_motion": {"ceiling": [0, -1]}}]
        })
    }

    /// A plate's force on the half ring that it touches at one point, by the distance that the plates have approached.
    pub fn force(&self, approach: f64) -> Option<f64> {
        let quarter = BeamMember { section: BeamSection::slender(self.axial), length: FRAC_PI_2, curvature: 1.0 };
        let solved = shoot(&[-0.3 * approach, 2.0 * approach], |unknowns| {
            let side =
                quarter.end(SectionState { x: 0.0, y: -1.0, angle: 0.0, moment: unknowns[0] }, [0.0, -unknowns[1]]);
            vec![side.angle - FRAC_PI_2, side.y + 0.5 * approach]
        })?;
        Some(solved[1])
    }
}

/// A pinned column of length 1 and `EI = 1` between two smooth walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColumnBetweenWalls {
    /// Distance of either wall from the column.
    pub gap: f64,
    pub axial: f64,
}

impl ColumnBetweenWalls {
    /// The load at which the stage "press" ends.
    const PRESSED: f64 = 20.0;

    /// The model of elements of two nodes, an even number. A force across the middle takes the column to one wall while it
    /// is pressed, and is taken away; the load of the last stage, which has no end, adds to a pressed load of 20.
    pub fn model(&self, elements: usize) -> Value {
        let chain = BeamChain::new(&on_line([0.0, 0.0], [0.0, 1.0], elements), 2, &BeamSection::slender(self.axial));
        let (top, middle) = (chain.last(), Self::middle(elements));
        let wall = |x: f64, normal: f64| json!({"kind": "plane", "point": [x, 0], "normal": [normal, 0]});
        let contacts: Vec<Value> = ["right", "left"]
            .iter()
            .flat_map(|wall| (1..elements).map(move |node| (node, wall)))
            .map(|(node, wall)| json!({"node": format!("n{node}"), "obstacle": wall, "friction": 0}))
            .collect();
        json!({
            "name": "column between walls", "dimension": 2,
            "nodes": chain.nodes, "elements": chain.beams,
            "supports": {"n0": ["x", "y"], &top: ["x"]},
            "obstacles": {"right": wall(self.gap, -1.0), "left": wall(-self.gap, 1.0)},
            "contacts": contacts,
            "stages": [
                {"name": "nudge", "forces": {&middle: [0.1, 0]}, "until": {"load_above": 1}},
                {"name": "press", "forces": {&top: [0, -1]}, "until": {"load_above": Self::PRESSED}},
                {"name": "release", "forces": {&middle: [-0.1, 0]}, "until": {"load_above": 1}},
                {"name": "load", "forces": {&top: [0, -1]}}
            ]
        })
    }

    pub fn middle(elements: usize) -> String {
        format!("n{}", elements / 2)
    }

    /// The whole load at a load factor of the last stage.
    pub fn load(load_factor: f64) -> f64 {
        Self::PRESSED + load_factor
    }

    /// The upper end from the moment at the middle, half the wall's force and the load.
    fn end(&self, moment: f64, half_force: f64, load: f64) -> SectionState {
        let half = BeamMember { section: BeamSection::slender(self.axial), length: 0.5, curvature: 0.0 };
        half.end(SectionState { x: self.gap, y: 0.0, angle: FRAC_PI_2, moment }, [half_force, -load])
    }

    /// The load at which the buckled column touches a wall.
    pub fn touch(&self) -> Option<f64> {
        let start = [PI * PI * self.gap, PI * PI];
        let solved = shoot(&start, |unknowns| {
            let end = self.end(unknowns[0], 0.0, unknowns[1]);
            vec![end.x, end.moment]
        })?;
        Some(solved[1])
    }

    /// The force of a wall that touches the middle alone.
    pub fn wall_force(&self, load: f64) -> Option<f64> {
        let root = load.sqrt();
        // Small rotations.
        let half = 0.5 * root;
        let force = -load * root * self.gap * half.cos() / (half.sin() - half * half.cos());
        let solved = shoot(&[self.gap, force], |unknowns| {
            let end = self.end(unknowns[0], unknowns[1], load);
            vec![end.x, end.moment]
        })?;
        Some(2.0 * solved[1])
    }

    /// The load at which the moment at the touched middle vanishes; beyond, a stretch lies on the wall.
    pub fn line_contact(&self) -> Option<f64> {
        let load = 4.0 * PI * PI;
        let solved = shoot(&[load * self.gap / 0.5, load], |unknowns| {
            let end = self.end(0.0, unknowns[0], unknowns[1]);
            vec![end.x, end.moment]
        })?;
        Some(solved[1])
    }
}
