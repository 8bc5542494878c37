//! Lee's frame and cantilevers.

use crate::check::scenes::beams::reissner::{BeamMember, BeamSection, SectionState};
use crate::check::scenes::beams::shooting::{fold, shoot};
use crate::check::scenes::beams::{BeamChain, on_line};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Lee's frame (S.-L. Lee, F. S. Manuel, E. C. Rossow, J. Eng. Mech. Div. 94 (1968) 521): legs of length 1, `EI = 1`, both
/// far ends pinned, the load a fifth of the leg from the corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeeFrame {
    pub section: BeamSection,
}

/// A load and the displacements of the loaded node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitPoint {
    pub load: f64,
    pub displacement: [f64; 2],
}

impl LeeFrame {
    /// E = 720, A = 6, I = 2, ν = 0.3, shear factor 1 and legs of 120, in units of EI and the legs.
    pub const PUBLISHED: Self =
        Self { section: BeamSection { axial: 43_200.0, bending: 1.0, shear_flexibility: 2.6 / 43_200.0 } };

    /// The model of elements of two nodes; the number a leg is a multiple of 5.
    pub fn model(&self, elements_a_leg: usize) -> Value {
        let mut chain = BeamChain::new(&on_line([0.0, 0.0], [0.0, 1.0], elements_a_leg), 2, &self.section);
        chain.extend(&on_line([0.0, 1.0], [1.0, 1.0], elements_a_leg)[1..], 2, &self.section);
        json!({
            "name": "Lee's frame", "dimension": 2,
            "supports": {"n0": ["x", "y"], chain.last(): ["x", "y"]},
            "nodes": chain.nodes, "elements": chain.beams,
            "stages": [{"name": "press", "forces": {Self::loaded(elements_a_leg): [0, -1]}}]
        })
    }

    pub fn loaded(elements_a_leg: usize) -> String {
        format!("n{}", elements_a_leg + elements_a_leg / 5)
    }

    /// The first load maximum and the minimum after it.
    pub fn limits(&self) -> Option<[LimitPoint; 2]> {
        let member = |length: f64| BeamMember { section: self.section, length, curvature: 0.0 };
        let loaded = |angle: f64, force: [f64; 2]| {
            let corner = member(1.0).end(SectionState { x: 0.0, y: 0.0, angle, moment: 0.0 }, force);
            member(0.2).end(SectionState { angle: corner.angle - FRAC_PI_2, ..corner }, force)
        };
        let limit = |start: &[f64; 4]| {
            let found = fold(start, |unknowns| {
                let [angle, fx, fy, load] = unknowns[..] else { return Vec::new() };
                let end = member(0.8).end(loaded(angle, [fx, fy]), [fx, fy + load]);
                vec![end.x - 1.0, end.y - 1.0, end.moment]
            })?;
            let at = loaded(found[0], [found[1], found[2]]);
            Some(LimitPoint { load: found[3], displacement: [at.x - 0.2, at.y - 1.0] })
        };
        Some([limit(&LEE_STARTS[0])?, limit(&LEE_STARTS[1])?])
    }
}

/// Angle at the column's foot, internal force of the column and load near both limit points.
const LEE_STARTS: [[f64; 4]; 2] = [[2.226, -3.51, -14.19, 18.55], [0.2115, -5.293, -4.837, -9.4]];

/// A cantilever of length 1 and `EI = 1` of elements of two nodes, turned by a moment at its tip: a circle of curvature
/// `2π s`, closed at `s = 1`.
pub fn roll_up(elements: usize) -> Value {
    let chain = BeamChain::new(&on_line([0.0, 0.0], [1.0, 0.0], elements), 2, &BeamSection::slender(1e4));
    let tip = chain.last();
    json!({
        "name": "roll-up of a cantilever", "dimension": 2, "nodes": chain.nodes,
        "supports": {"n0": ["x", "y", "rz"]}, "elements": chain.beams,
        "stages": [{"name": "roll", "moments": {tip: TAU}, "until": {"load_above": 1}}]
    })
}

/// A cantilever of length 1 and `EI = 1` under a dead force across its tip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeadForce {
    pub section: BeamSection,
    pub force: f64,
}

impl DeadForce {
    /// The model of elements of two nodes; the stage ends at the force.
    pub fn model(&self, elements: usize) -> Value {
        let chain = BeamChain::new(&on_line([0.0, 0.0], [1.0, 0.0], elements), 2, &self.section);
        let tip = chain.last();
        json!({
            "name": "cantilever under a dead end force", "dimension": 2, "nodes": chain.nodes,
            "supports": {"n0": ["x", "y", "rz"]}, "elements": chain.beams,
            "stages": [{"name": "bend", "forces": {tip: [0, self.force]}, "until": {"load_above": 1}}]
        })
    }

    /// Displacements and rotation of the tip.
    pub fn tip(&self) -> Option<[f64; 3]> {
        let member = BeamMember { section: self.section, length: 1.0, curvature: 0.0 };
        let tip =
            |moment: f64, force: f64| member.end(SectionState { x: 0.0, y: 0.0, angle: 0.0, moment }, [0.0, force]);
        // The load in parts, for each of which the last one is a start.
        let mut moment = 0.0;
        for part in 1..=16 {
            let force = self.force * f64::from(part) / 16.0;
            moment = shoot(&[moment], |unknowns| vec![tip(unknowns[0], force).moment])?[0];
        }
        let SectionState { x, y, angle, .. } = tip(moment, self.force);
        Some([x - 1.0, y, angle])
    }
}
