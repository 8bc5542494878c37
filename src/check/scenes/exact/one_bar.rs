//! The one-bar truss: a bar from a pin down to a tip. The tip is pushed along a floor towards the foot of the pin and
//! past the foot.
//!
//! The pin is at the height `h` above the floor. The tip is at `x` from the foot of the pin, initially at `-a`;
//! `L² = x² + h²`, compression `P = EA (1 - L/L0)`. Equilibrium of the slipping tip gives `r_n = P h/L` and
//!
//! ```text
//! s f = P (μ h - x)/L
//! ```
//!
//! between `x = -a` and `x = a`. At `x = a` the bar is unstressed, the reaction is zero, and the path ends in a
//! mechanism.

use crate::check::scenes::exact::curve::{CurvePlace, CurveStage, Reach};
use crate::check::scenes::exact::pattern;
use crate::check::scenes::exact::solution::ExactSolution;
use crate::model::Model;
use crate::model::request::Strain;
use crate::result::increment::PointKind;

/// The truss, mirrored if necessary so that the tip moves to +x.
#[derive(Debug, Clone)]
pub struct OneBarScene {
    pub axial_stiffness: f64,
    pub height: f64,
    /// Distance from the tip to the foot of the pin at the start.
    pub offset: f64,
    pub friction: f64,
    /// Absolute value of the force at a load factor of 1.
    pub force: f64,
    /// 1, or -1 for a truss whose tip moves to -x.
    side: f64,
    stage: String,
    freedoms: usize,
    tip: usize,
}

impl OneBarScene {
    pub fn recognise(model: &Model) -> Option<Self> {
        let bar = pattern::one_bar(model).filter(|bar| model.dimension == 2 && bar.strain == Strain::Engineering)?;
        let (contact, obstacle) = pattern::one_contact(model, bar.free)?;
        let (pin, tip) = (&model.nodes[bar.held], &model.nodes[bar.free]);
        let [stage] = &model.stages[..] else { return None };
        let force = pattern::only_force(stage, bar.free)?;
        let (offset, height) = (pin[0] - tip[0], pin[1] - tip[1]);
        let side = offset.signum();
        let towards = force[0] * side > 0.0 && force[1] == 0.0;
        let fits = pattern::is_floor_at(obstacle, tip) && offset != 0.0 && height > 0.0 && towards;
        fits.then(|| Self {
            axial_stiffness: bar.axial_stiffness,
            height,
            offset: offset.abs(),
            friction: contact.friction,
            force: force[0].abs(),
            side,
            stage: stage.name.clone(),
            freedoms: 4,
            tip: pattern::freedom(model, bar.free),
        })
    }

    /// The load factor of a tip that slips at `x`.
    pub fn load(&self, x: f64) -> f64 {
        self.compression_by_length(x) * (self.friction * self.height - x) / self.force
    }

    /// `P/L`, without cancellation for small strains.
    fn compression_by_length(&self, x: f64) -> f64 {
        let (length, rest) = (x.hypot(self.height), self.offset.hypot(self.height));
        self.axial_stiffness * (self.offset - x) * (self.offset + x) / ((length + rest) * length * rest)
    }

    /// The derivative of the load with respect to `x`, times `L³ f/EA`: `L³/L0 - h² - μ h x`.
    fn slope(&self, x: f64) -> f64 {
        let (length, rest) = (x.hypot(self.height), self.offset.hypot(self.height));
        length.powi(3) / rest - self.height * self.height - self.friction * self.height * x
    }

    /// The limit points in order: place `x` and load factor.
    pub fn limits(&self) -> Vec<(f64, f64)> {
        let places = crate::check::scenes::exact::zeros::zeros(|x| self.slope(x), -self.offset, self.offset);
        places.into_iter().map(|x| (x, self.load(x))).collect()
    }
}

impl ExactSolution for OneBarScene {
    fn name(&self) -> &'static str {
        "one-bar truss"
    }

    fn formula(&self) -> &'static str {
        "s f = P (mu h - x)/L, P = EA (1 - L/L0)"
    }

    fn stages(&self, _reach: Reach) -> Vec<CurveStage> {
        let truss = self.clone();
        let at = move |x: f64| {
            let mut displacements = vec![0.0; truss.freedoms];
            displacements[truss.tip] = truss.side * (x + truss.offset);
            CurvePlace { displacements, load: truss.load(x) }
        };
        let range = (-self.offset, self.offset);
        vec![CurveStage::turning(&self.stage, range, |x| self.slope(x), at).ending(PointKind::End)]
    }
}
