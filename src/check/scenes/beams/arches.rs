//! Circular arches of radius 1 with `EI = 1`.

use crate::check::scenes::beams::reissner::{BeamMember, BeamSection, SectionState};
use crate::check::scenes::beams::shooting::{fold, shoot};
use crate::check::scenes::beams::{BeamChain, floor, on_circle};
use serde_json::{Value, json};
use std::f64::consts::FRAC_PI_2;

/// Half an arch: its crown guided, its foot on a rough floor. Load and drop are those of the whole arch's crown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughArch {
    /// Half the opening angle, radians.
    pub half_angle: f64,
    pub friction: f64,
    pub axial: f64,
}

/// A point of an arch's path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArchPoint {
    /// Load on the crown of the whole arch.
    pub load: f64,
    /// Displacement of the crown, downwards.
    pub drop: f64,
}

impl RoughArch {
    /// A right half angle.
    pub fn right(friction: f64, axial: f64) -> Self {
        Self { half_angle: FRAC_PI_2, friction, axial }
    }

    fn foot(&self) -> [f64; 2] {
        let foot = [self.half_angle.sin(), self.half_angle.cos()];
        // The cosine of a right angle as a number is not zero.
        if self.half_angle == FRAC_PI_2 { [1.0, 0.0] } else { foot }
    }

    /// The model of elements of three nodes, under half the load, without an end of the stage; `n0` is the crown.
    pub fn model(&self, elements: usize) -> Value {
        let mut places = on_circle(0.0, self.half_angle, 2 * elements);
        places[2 * elements] = self.foot();
        let chain = BeamChain::new(&places, 3, &BeamSection::slender(self.axial));
        let foot = chain.last();
        json!({
            "name": format!("half an arch on a rough floor, mu = {}", self.friction), "dimension": 2,
            "nodes": chain.nodes, "supports": {"n0": ["x", "rz"]}, "elements": chain.beams,
            "obstacles": {"floor": floor(self.foot()[1])},
            "contacts": [{"node": foot, "obstacle": "floor", "friction": self.friction}],
            "stages": [{"name": "press", "forces": {"n0": [0, -0.5]}}]
        })
    }

    /// The foot from the crown's moment, its height, the load and the foot's horizontal force.
    fn foot_of(&self, moment: f64, drop: f64, load: f64, horizontal: f64) -> SectionState {
        let member = BeamMember { section: BeamSection::slender(self.axial), length: self.half_angle, curvature: -1.0 };
        member.end(SectionState { x: 0.0, y: 1.0 - drop, angle: 0.0, moment }, [horizontal, 0.5 * load])
    }

    /// Where the stuck foot begins to slip outwards.
    pub fn onset(&self) -> Option<ArchPoint> {
        let [x, y] = self.foot();
        let found = shoot(&[2.8, 0.5, 9.36], |unknowns| {
            let [moment, drop, load] = unknowns[..] else { return Vec::new() };
            let foot = self.foot_of(moment, drop, load, -0.5 * self.friction * load);
            vec![foot.x - x, foot.y - y, foot.moment]
        })?;
        Some(ArchPoint { load: found[2], drop: found[1] })
    }

    /// The residuals of the slipping arch.
    fn slipping(&self, moment: f64, drop: f64, load: f64) -> Vec<f64> {
        let foot = self.foot_of(moment, drop, load, -0.5 * self.friction * load);
        vec![foot.y - self.foot()[1], foot.moment]
    }

    /// Where the drop of the slipping arch turns.
    pub fn turn_of_drop(&self) -> Option<ArchPoint> {
        let found = fold(&[1.5, 3.72, 0.236], |unknowns| self.slipping(unknowns[0], unknowns[2], unknowns[1]))?;
        Some(ArchPoint { load: found[1], drop: found[2] })
    }

    /// The load minimum of the slipping arch.
    pub fn minimum(&self) -> Option<ArchPoint> {
        let found = fold(&[1.376, 0.818, 1.99], |unknowns| self.slipping(unknowns[0], unknowns[1], unknowns[2]))?;
        Some(ArchPoint { load: found[2], drop: found[1] })
    }

    /// The load maximum of the stuck arch.
    pub fn stuck_maximum(&self) -> Option<ArchPoint> {
        let [x, y] = self.foot();
        let found = fold(&[3.66, 0.73, -5.26, 10.15], |unknowns| {
            let [moment, drop, horizontal, load] = unknowns[..] else { return Vec::new() };
            let foot = self.foot_of(moment, drop, load, horizontal);
            vec![foot.x - x, foot.y - y, foot.moment]
        })?;
        Some(ArchPoint { load: found[3], drop: found[1] })
    }

    /// The ratio of horizontal and vertical force of the stuck inextensible foot at the first load, in closed form.
    pub fn first_thrust(&self) -> f64 {
        let a = self.half_angle;
        let (sine, cosine) = a.sin_cos();
        // The integral of (cos φ - cos α)².
        let integral = 0.5 * a + 0.5 * sine * cosine - 2.0 * cosine * sine + a * cosine * cosine;
        (0.5 * sine * sine - a * sine * cosine + cosine - cosine * cosine) / integral
    }
}

/// The arch of 215° whose left foot is hinged and whose right foot is clamped, loaded at its crown (D. A. DaDeppo,
/// R. Schmidt, J. Appl. Mech. 42 (1975) 839).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeepArch {
    pub axial: f64,
}

impl DeepArch {
    const HALF_ANGLE: f64 = 107.5 * std::f64::consts::PI / 180.0;

    /// The model of twice as many elements of three nodes as asked for on each side of the crown.
    pub fn model(&self, elements_a_side: usize) -> Value {
        let places = on_circle(-Self::HALF_ANGLE, Self::HALF_ANGLE, 4 * elements_a_side);
        let chain = BeamChain::new(&places, 3, &BeamSection::slender(self.axial));
        json!({
            "name": "arch of 215 degrees, hinged and clamped", "dimension": 2,
            "supports": {"n0": ["x", "y"], chain.last(): ["x", "y", "rz"]},
            "nodes": chain.nodes, "elements": chain.beams,
            "stages": [{"name": "press", "forces": {Self::crown(elements_a_side): [0, -1]}}]
        })
    }

    pub fn crown(elements_a_side: usize) -> String {
        format!("n{}", 2 * elements_a_side)
    }

    /// The first load maximum.
    pub fn maximum(&self) -> Option<ArchPoint> {
        let a = Self::HALF_ANGLE;
        let member = BeamMember { section: BeamSection::slender(self.axial), length: a, curvature: -1.0 };
        let crown = |angle: f64, fx: f64, fy: f64| {
            member.end(SectionState { x: -a.sin(), y: a.cos(), angle, moment: 0.0 }, [fx, fy])
        };
        let found = fold(&DEEP_ARCH_START, |unknowns| {
            let [angle, fx, fy, load] = unknowns[..] else { return Vec::new() };
            let end = member.end(crown(angle, fx, fy), [fx, fy + load]);
            vec![end.x - a.sin(), end.y - a.cos(), end.angle + a]
        })?;
        let at = crown(found[0], found[1], found[2]);
        Some(ArchPoint { load: found[3], drop: 1.0 - at.y })
    }
}

/// Angle at the hinge, internal force of the left half and load near the maximum.
const DEEP_ARCH_START: [f64; 4] = [4.14, 2.67, -5.88, 8.97];
