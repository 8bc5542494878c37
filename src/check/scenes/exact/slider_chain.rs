//! A chain of blocks on a floor, joined by springs along a line. The weights press the blocks, and a force pulls the
//! first block.
//!
//! With springs `k_j` from block `j` to block `j + 1` and `q_j = Σ_{i <= j} μ_i W_i`, block `m` begins to slip at
//! `s p = q_m`. Until the last block slips, `u_j - u_{j+1} = max(0, s p - q_j)/k_j`.

use crate::check::scenes::exact::curve::{CurvePlace, CurveStage, Piece, Reach};
use crate::check::scenes::exact::pattern;
use crate::check::scenes::exact::solution::ExactSolution;
use crate::model::Model;
use crate::model::request::Element;
use crate::result::increment::PointKind;

/// The chain and its two stages.
#[derive(Debug, Clone)]
pub struct SliderChain {
    /// `k_j`, one fewer than the blocks.
    stiffness: Vec<f64>,
    /// `q_j`: the force at which block `j` begins to slip.
    holds: Vec<f64>,
    pull: f64,
    pressed_to: f64,
    stages: [String; 2],
    /// The index of the x displacement of each block.
    along: Vec<usize>,
    freedoms: usize,
}

impl SliderChain {
    pub fn recognise(model: &Model) -> Option<Self> {
        let blocks: Vec<&String> = model.nodes.keys().collect();
        let [weigh, pull] = &model.stages[..] else { return None };
        let pressed_to = weigh.until.as_ref()?.load_above.filter(|bound| *bound > 0.0)?;
        let [force, 0.0] = pattern::only_force(pull, blocks.first()?)? else { return None };
        let shape = model.dimension == 2 && blocks.len() >= 2 && *force > 0.0 && model.supports.is_empty();
        let still = weigh.displacements.is_empty() && weigh.obstacle_motion.is_empty();
        let sizes = model.contacts.len() == blocks.len() && model.elements.len() + 1 == blocks.len();
        if !(shape && still && sizes && model.obstacles.len() == 1 && weigh.forces.len() == blocks.len()) {
            return None;
        }
        let (_, floor) = model.obstacles.first()?;
        let mut holds = Vec::with_capacity(blocks.len());
        let mut hold = 0.0;
        for (block, contact) in blocks.iter().zip(&model.contacts) {
            let [0.0, weight] = weigh.forces.get(*block)?[..] else { return None };
            let fits = contact.node == **block && contact.friction > 0.0 && weight < 0.0;
            if !fits || !pattern::is_floor_at(floor, &model.nodes[*block]) {
                return None;
            }
            hold += contact.friction * -weight * pressed_to;
            holds.push(hold);
        }
        let mut stiffness = Vec::with_capacity(model.elements.len());
        for (element, ends) in model.elements.iter().zip(blocks.windows(2)) {
            let Element::Spring { nodes, stiffness: matrix, .. } = element else { return None };
            let [first, second] = &nodes[..] else { return None };
            let along = matrix[0][0] > 0.0 && [matrix[0][1], matrix[1][0], matrix[1][1]] == [0.0; 3];
            if !along || first != ends[0] || second != ends[1] {
                return None;
            }
            stiffness.push(matrix[0][0]);
        }
        Some(Self {
            stiffness,
            holds,
            pull: *force,
            pressed_to,
            stages: [weigh.name.clone(), pull.name.clone()],
            along: (0..blocks.len()).map(|block| 2 * block).collect(),
            freedoms: 2 * blocks.len(),
        })
    }

    fn place(&self, load: f64) -> CurvePlace {
        let mut displacements = vec![0.0; self.freedoms];
        let mut moved = 0.0;
        for block in (0..self.stiffness.len()).rev() {
            moved += (load * self.pull - self.holds[block]).max(0.0) / self.stiffness[block];
            displacements[self.along[block]] = moved;
        }
        CurvePlace { displacements, load }
    }
}

impl ExactSolution for SliderChain {
    fn name(&self) -> &'static str {
        "slider chain"
    }

    fn formula(&self) -> &'static str {
        "u_j - u_j+1 = max(0, s p - q_j)/k_j, q_j = sum of mu W up to block j"
    }

    fn stages(&self, _reach: Reach) -> Vec<CurveStage> {
        let freedoms = self.freedoms;
        let still = move |load: f64| CurvePlace { displacements: vec![0.0; freedoms], load };
        let mut pieces = Vec::with_capacity(self.holds.len());
        let mut begins = 0.0;
        for (block, hold) in self.holds.iter().enumerate() {
            let ends = hold / self.pull;
            let kind = if block + 1 == self.holds.len() { PointKind::End } else { PointKind::ContactChange };
            let chain = self.clone();
            pieces.push(Piece::new(begins, ends, move |load| chain.place(load)).ending(kind));
            begins = ends;
        }
        let weighed = vec![Piece::new(0.0, self.pressed_to, still).ending(PointKind::End)];
        vec![
            CurveStage { name: self.stages[0].clone(), pieces: weighed },
            CurveStage { name: self.stages[1].clone(), pieces },
        ]
    }
}
