//! The one-bar truss over a hump: the tip slips over a circle, and the pin is above the centre of the circle.
//!
//! The pin is at `(0, H)`. The tip is on the circle of radius 1 about the origin, at the angle `φ` from the top,
//! positive to the right; EA = 1. With the normal `(sin φ, cos φ)` and the tangent `(cos φ, -sin φ)`, equilibrium of
//! the slipping tip requires
//!
//! ```text
//! P (1 - H cos φ)/L + s sin φ + r_n = 0,     P H sin φ/L + s cos φ = μ r_n
//! ```

use crate::check::scenes::exact::curve::{CurvePlace, CurveStage, Reach};
use crate::check::scenes::exact::pattern;
use crate::check::scenes::exact::solution::ExactSolution;
use crate::model::Model;
use crate::model::request::{Obstacle, Side, Strain};
use crate::result::increment::PointKind;

/// The truss, where the radius, EA and the push at a load factor of 1 are all 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hump {
    pub friction: f64,
    /// `H`
    pub pin: f64,
    /// Angle of the tip at the start (radians).
    pub start: f64,
}

impl Hump {
    /// The values of the scene `hump`.
    pub const BUILT_IN: Self = Self { friction: 0.3, pin: 2.5, start: -0.9 };

    fn length(&self, angle: f64) -> f64 {
        angle.sin().hypot(self.pin - angle.cos())
    }

    /// Axial compression over the length, `P/L`.
    fn compression_by_length(&self, angle: f64) -> f64 {
        1.0 / self.length(angle) - 1.0 / self.length(self.start)
    }

    pub fn load(&self, angle: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        -self.compression_by_length(angle) * (self.pin * sine + self.friction * (1.0 - self.pin * cosine))
            / (cosine + self.friction * sine)
    }

    pub fn normal_reaction(&self, angle: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        self.compression_by_length(angle) * (self.pin * cosine - 1.0) - self.load(angle) * sine
    }

    /// The derivative of the load with respect to the angle.
    fn slope(&self, angle: f64) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        let (pin, friction, length) = (self.pin, self.friction, self.length(angle));
        let compression = self.compression_by_length(angle);
        let shortening = -pin * sine / length.powi(3);
        let (above, below) = (pin * sine + friction * (1.0 - pin * cosine), cosine + friction * sine);
        let (above_slope, below_slope) = (pin * (cosine + friction * sine), friction * cosine - sine);
        -(shortening * above + compression * above_slope - compression * above * below_slope / below) / below
    }
}

/// Number of intervals of the arc. At each point between two intervals, the reaction must press on the tip.
const PARTS: u32 = 1000;
/// Tolerance for the distance of the tip from the circle, over the radius: the rounding error of the coordinates.
const ON_CIRCLE: f64 = 1e-12;

/// A scene of this family, of any size.
#[derive(Debug, Clone)]
pub struct OverHump {
    pub hump: Hump,
    radius: f64,
    /// EA over the force at a load factor of 1.
    scale: f64,
    stage: String,
    tip: usize,
}

impl OverHump {
    pub fn recognise(model: &Model) -> Option<Self> {
        let bar = pattern::one_bar(model).filter(|bar| model.dimension == 2 && bar.strain == Strain::Engineering)?;
        let (contact, obstacle) = pattern::one_contact(model, bar.free)?;
        let Obstacle::Ball { center, radius, side: Side::Outside } = obstacle else { return None };
        let (pin, tip) = (&model.nodes[bar.held], &model.nodes[bar.free]);
        let [stage] = &model.stages[..] else { return None };
        let [push, 0.0] = pattern::only_force(stage, bar.free)? else { return None };
        let (across, up) = (tip[0] - center[0], tip[1] - center[1]);
        let hump = Hump { friction: contact.friction, pin: (pin[1] - center[1]) / radius, start: across.atan2(up) };
        let on_circle = (across.hypot(up) - radius).abs() <= ON_CIRCLE * radius;
        let stands = pin[0] == center[0] && hump.pin > 1.0 && hump.start < 0.0 && *push > 0.0;
        let pressed = (1..PARTS).all(|part| {
            let angle = hump.start * (1.0 - 2.0 * f64::from(part) / f64::from(PARTS));
            hump.normal_reaction(angle) > 0.0 && angle.cos() + hump.friction * angle.sin() > 0.0
        });
        (on_circle && stands && pressed).then(|| Self {
            hump,
            radius: *radius,
            scale: bar.axial_stiffness / push,
            stage: stage.name.clone(),
            tip: pattern::freedom(model, bar.free),
        })
    }
}

impl ExactSolution for OverHump {
    fn name(&self) -> &'static str {
        "one-bar truss over a hump"
    }

    fn formula(&self) -> &'static str {
        "s f = -P/L (H sin + mu (R - H cos))/(cos + mu sin) of the angle from the top"
    }

    fn stages(&self, _reach: Reach) -> Vec<CurveStage> {
        let Self { hump, radius, scale, tip, .. } = *self;
        let at = move |angle: f64| {
            let mut displacements = vec![0.0; 4];
            displacements[tip] = radius * (angle.sin() - hump.start.sin());
            displacements[tip + 1] = radius * (angle.cos() - hump.start.cos());
            CurvePlace { displacements, load: scale * hump.load(angle) }
        };
        let range = (hump.start, -hump.start);
        vec![CurveStage::turning(&self.stage, range, |angle| hump.slope(angle), at).ending(PointKind::End)]
    }
}
