//! Slip along a curve: the tip of a bar is pushed along a floor in space, while the bar pushes the tip sideways. The
//! tip moves along a tractrix.
//!
//! The pin is at `(0, b, h)`. The tip starts at `(x0, 0, 0)` and is pushed along +x by `s f`. With the horizontal force
//! `(F_x, F_y)` of the bar, slip satisfies `(s f + F_x)² + F_y² = (μ r_n)²`, and the direction of slip is
//! `(s f + F_x, F_y)`. The force cancels from the equation of the track: with `c = μ h` and `w = b - y` the direction
//! of slip is `(sqrt(c² - w²), -w)/c`, so that
//!
//! ```text
//! x - x0 = [sqrt(c² - w²) - c arcosh(c/w)] from b to w,     s f = EA (1/L - 1/L0) (sqrt(c² - w²) - x)
//! ```

use crate::check::scenes::exact::curve::{CurvePlace, CurveStage, Reach};
use crate::check::scenes::exact::pattern;
use crate::check::scenes::exact::solution::ExactSolution;
use crate::model::Model;
use crate::model::request::Strain;
use crate::result::increment::PointKind;

/// The track and the forces along the track, where EA and the push at a load factor of 1 are both 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tractrix {
    pub friction: f64,
    /// `b`
    pub offset: f64,
    /// `h`
    pub height: f64,
    /// `x0`
    pub start: f64,
}

impl Tractrix {
    /// The values of the scene `curving-slip`.
    pub const BUILT_IN: Self = Self { friction: 0.8, offset: 0.1, height: 1.0, start: -1.4 };

    fn cone(&self) -> f64 {
        self.friction * self.height
    }

    pub fn rest_length(&self) -> f64 {
        self.start.hypot(self.offset).hypot(self.height)
    }

    /// `x` of the track at `w`, computed from differences between both ends to avoid cancellation near the start.
    pub fn track(&self, w: f64) -> f64 {
        let (c, b) = (self.cone(), self.offset);
        let leg = |w: f64| ((c - w) * (c + w)).sqrt();
        let change = (b - w) * (b + w) / (leg(w) + leg(b));
        self.start + change + c * (((w - b) / b).ln_1p() + ((leg(b) - leg(w)) / (c + leg(w))).ln_1p())
    }

    /// Distance of a point from the track, to first order in the distance. The slope of the track at the point is
    /// `dw/dx = w/sqrt(c² - w²)`.
    pub fn distance(&self, x: f64, y: f64) -> f64 {
        let w = self.offset - y;
        (x - self.track(w)).abs() * w / self.cone()
    }

    /// Axial compression over the length, `P/L`.
    fn compression_by_length(&self, x: f64, y: f64) -> f64 {
        let length = x.hypot(self.offset - y).hypot(self.height);
        1.0 / length - 1.0 / self.rest_length()
    }

    /// Load of a tip that slips at this point: `s = -F_x + sqrt((μ r_n)² - F_y²)`.
    pub fn load(&self, x: f64, y: f64) -> f64 {
        let (c, w) = (self.cone(), self.offset - y);
        self.compression_by_length(x, y) * (((c - w) * (c + w)).sqrt() - x)
    }

    pub fn normal_reaction(&self, x: f64, y: f64) -> f64 {
        self.compression_by_length(x, y) * self.height
    }

    /// Traction along x and y: `μ r_n` against the slip.
    pub fn traction(&self, x: f64, y: f64) -> [f64; 2] {
        let (c, w) = (self.cone(), self.offset - y);
        let size = self.compression_by_length(x, y);
        [-size * ((c - w) * (c + w)).sqrt(), size * w]
    }

    /// The derivative of the load with respect to `w` along the track.
    fn slope(&self, w: f64) -> f64 {
        let (c, x) = (self.cone(), self.track(w));
        let leg = ((c - w) * (c + w)).sqrt();
        let length = x.hypot(w).hypot(self.height);
        let lengthening = (x * leg / w + w) / length;
        let compression = self.compression_by_length(x, self.offset - w);
        -lengthening / (length * length) * (leg - x) - compression * (w / leg + leg / w)
    }
}

/// A scene of this family, of any size, possibly mirrored.
#[derive(Debug, Clone)]
pub struct CurvingSlip {
    pub track: Tractrix,
    /// EA over the force at a load factor of 1.
    scale: f64,
    /// 1, or -1 if mirrored, for x and y.
    sides: [f64; 2],
    stage: String,
    tip: usize,
}

impl CurvingSlip {
    pub fn recognise(model: &Model) -> Option<Self> {
        let bar = pattern::one_bar(model).filter(|bar| model.dimension == 3 && bar.strain == Strain::Engineering)?;
        let (contact, obstacle) = pattern::one_contact(model, bar.free)?;
        let (pin, tip) = (&model.nodes[bar.held], &model.nodes[bar.free]);
        let [stage] = &model.stages[..] else { return None };
        let [push, 0.0, 0.0] = pattern::only_force(stage, bar.free)? else { return None };
        let sides = [push.signum(), (pin[1] - tip[1]).signum()];
        let track = Tractrix {
            friction: contact.friction,
            offset: (pin[1] - tip[1]).abs(),
            height: pin[2] - tip[2],
            start: sides[0] * (tip[0] - pin[0]),
        };
        let slips = track.height > 0.0 && track.offset > 0.0 && track.offset < track.cone() && track.start < 0.0;
        (pattern::is_floor_at(obstacle, tip) && *push != 0.0 && slips).then(|| Self {
            track,
            scale: bar.axial_stiffness / push.abs(),
            sides,
            stage: stage.name.clone(),
            tip: pattern::freedom(model, bar.free),
        })
    }
}

impl ExactSolution for CurvingSlip {
    fn name(&self) -> &'static str {
        "tractrix"
    }

    fn formula(&self) -> &'static str {
        "x - x0 = [sqrt(c^2 - w^2) - c arcosh(c/w)], c = mu h, w = b - y"
    }

    fn stages(&self, _reach: Reach) -> Vec<CurveStage> {
        let Self { track, scale, sides, tip, .. } = *self;
        let at = move |w: f64| {
            let (x, y) = (track.track(w), track.offset - w);
            let mut displacements = vec![0.0; 6];
            displacements[tip] = sides[0] * (x - track.start);
            displacements[tip + 1] = sides[1] * y;
            CurvePlace { displacements, load: scale * track.load(x, y) }
        };
        let compression = |w: f64| track.compression_by_length(track.track(w), track.offset - w);
        let unstressed =
            crate::check::scenes::exact::zeros::zeros(compression, track.offset, track.cone()).first().copied();
        let stage = |to| CurveStage::turning(&self.stage, (track.offset, to), |w| track.slope(w), at);
        vec![match unstressed {
            Some(to) => stage(to).ending(PointKind::End),
            None => stage(track.cone()),
        }]
    }
}
