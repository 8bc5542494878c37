//! Tips of cantilevers that slip: on a floor that moves, and over a round catch.

use crate::check::scenes::beams::reissner::{BeamMember, BeamSection, SectionState};
use crate::check::scenes::beams::shooting::shoot;
use crate::check::scenes::beams::{BeamChain, on_line};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// Number of parts in which a solution is continued from the touch.
const PARTS: u32 = 8;

/// A cantilever of length 1 and `EI = 1` that slants down to a rough floor. The floor rises, and then moves towards the
/// clamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DraggedTip {
    /// Of the cantilever below the horizontal, radians.
    pub slant: f64,
    pub friction: f64,
    pub rise: f64,
    pub axial: f64,
}

/// Displacements of a tip and its normal reaction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipPoint {
    pub displacement: [f64; 2],
    pub reaction: f64,
}

impl DraggedTip {
    fn tip(&self) -> [f64; 2] {
        [self.slant.cos(), -self.slant.sin()]
    }

    /// The model of elements of two nodes; the first stage raises the floor, the second moves it sideways.
    pub fn model(&self, elements: usize) -> Value {
        let chain = BeamChain::new(&on_line([0.0, 0.0], self.tip(), elements), 2, &BeamSection::slender(self.axial));
        let tip = chain.last();
        json!({
            "name": "cantilever whose tip is dragged along by a floor", "dimension": 2,
            "supports": {"n0": ["x", "y", "rz"]}, "nodes": chain.nodes, "elements": chain.beams,
            "obstacles": {"floor": {"kind": "plane", "point": self.tip(), "normal": [0, 1]}},
            "contacts": [{"node": tip, "obstacle": "floor", "friction": self.friction}],
            "stages": [
                {"name": "rise", "obstacle_motion": {"floor": [0, self.rise]}, "until": {"load_above": 1}},
                {"name": "drag", "obstacle_motion": {"floor": [1, 0]}, "until": {"load_above": 0.5}}
            ]
        })
    }

    /// The tip on the raised floor while it slips along x by a friction force of the given sign.
    pub fn slipping(&self, sign: f64) -> Option<TipPoint> {
        let member = BeamMember { section: BeamSection::slender(self.axial), length: 1.0, curvature: 0.0 };
        let [x, y] = self.tip();
        let end = |moment: f64, reaction: f64| {
            let start = SectionState { x: 0.0, y: 0.0, angle: -self.slant, moment };
            member.end(start, [sign * self.friction * reaction, reaction])
        };
        let mut unknowns = vec![0.0, 0.0];
        for part in 1..=PARTS {
            let height = y + self.rise * f64::from(part) / f64::from(PARTS);
            unknowns = shoot(&unknowns, |unknowns| {
                let end = end(unknowns[0], unknowns[1]);
                vec![end.y - height, end.moment]
            })?;
        }
        let at = end(unknowns[0], unknowns[1]);
        Some(TipPoint { displacement: [at.x - x, at.y - y], reaction: unknowns[1] })
    }
}

/// A snap-fit: a cantilever of length 1 and `EI = 1` with a hook of length 0.2 down from its tip. The clamp is pushed, so
/// that the hook's end, which touches a round catch of radius 0.2 at the start, slides over it and snaps in behind it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SnapFit {
    pub friction: f64,
    pub axial: f64,
}

impl SnapFit {
    const HOOK: f64 = 0.2;
    const RADIUS: f64 = 0.2;
    /// From the hook's end to the catch's centre.
    const CENTER: [f64; 2] = [0.16, -0.12];

    /// The model of elements of two nodes: as many as asked for, a multiple of 5, in the beam, a fifth as many in the hook.
    /// The load factor is the clamp's displacement.
    pub fn model(&self, elements: usize) -> Value {
        let section = BeamSection::slender(self.axial);
        let mut chain = BeamChain::new(&on_line([0.0, 0.0], [1.0, 0.0], elements), 2, &section);
        chain.extend(&on_line([1.0, 0.0], [1.0, -Self::HOOK], elements / 5)[1..], 2, &section);
        let tip = chain.last();
        json!({
            "name": format!("snap-fit hook, mu = {}", self.friction), "dimension": 2,
            "supports": {"n0": ["x", "y", "rz"]}, "nodes": chain.nodes, "elements": chain.beams,
            "obstacles": {"catch": {"kind": "ball", "center": Self::center(), "radius": Self::RADIUS}},
            "contacts": [{"node": tip, "obstacle": "catch", "friction": self.friction}],
            "stages": [{"name": "push", "displacements": {"n0": [1, 0, 0]}, "until": {"load_above": 0.4}}]
        })
    }

    pub fn tip(elements: usize) -> String {
        format!("n{}", elements + elements / 5)
    }

    /// The clamp's displacement and the normal reaction while the hook's end slides forwards, by its angle on the catch
    /// from the vertical, clockwise, in radians.
    pub fn sliding(&self, angle: f64) -> Option<(f64, f64)> {
        let section = BeamSection::slender(self.axial);
        let member = |length: f64| BeamMember { section, length, curvature: 0.0 };
        let center = Self::center();
        let end = |angle: f64, moment: f64, reaction: f64, travel: f64| {
            let (normal, along) = ([angle.sin(), angle.cos()], [angle.cos(), -angle.sin()]);
            let force = [0, 1].map(|k| reaction * (normal[k] - self.friction * along[k]));
            let corner = member(1.0).end(SectionState { x: travel, y: 0.0, angle: 0.0, moment }, force);
            let end = member(Self::HOOK).end(SectionState { angle: corner.angle - FRAC_PI_2, ..corner }, force);
            (end, [center[0] + Self::RADIUS * normal[0], center[1] + Self::RADIUS * normal[1]])
        };
        // From the touch on.
        let mut unknowns = vec![0.0, 0.0, Self::CENTER[0] + Self::RADIUS * Self::first_angle().sin()];
        for part in 1..=PARTS {
            let angle = Self::first_angle() + (angle - Self::first_angle()) * f64::from(part) / f64::from(PARTS);
            unknowns = shoot(&unknowns, |unknowns| {
                let [moment, reaction, travel] = unknowns[..] else { return Vec::new() };
                let (end, place) = end(angle, moment, reaction, travel);
                vec![end.x - place[0], end.y - place[1], end.moment]
            })?;
        }
        Some((unknowns[2], unknowns[1]))
    }

    /// The catch's centre.
    fn center() -> [f64; 2] {
        [1.0 + Self::CENTER[0], Self::CENTER[1] - Self::HOOK]
    }

    /// The angle at which the hook's end touches the catch.
    fn first_angle() -> f64 {
        -(-Self::CENTER[1] / Self::RADIUS).acos()
    }

    /// The angle of the hook's end on the catch at displacements.
    pub fn angle(displacement: [f64; 2]) -> f64 {
        let [x, y] = Self::center();
        (1.0 + displacement[0] - x).atan2(displacement[1] - Self::HOOK - y)
    }
}
