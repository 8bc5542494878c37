//! A node at the bottom of a bowl, pressed down and then pushed sideways. A spring with the same stiffness `k` in all
//! directions connects the node to the ground.
//!
//! The node slips upwards when the sum of load and spring force is inclined to the normal by the angle of friction. At
//! the angle `φ` from the bottom
//!
//! ```text
//! s q = k R sin φ + (P + k R (1 - cos φ)) tan(φ + arctan μ)
//! ```

use crate::check::scenes::exact::curve::{CurvePlace, CurveStage, Piece, Reach};
use crate::check::scenes::exact::pattern;
use crate::check::scenes::exact::solution::ExactSolution;
use crate::check::scenes::exact::zeros::zero;
use crate::model::Model;
use crate::model::request::{Obstacle, Side};
use crate::result::increment::PointKind;
use std::f64::consts::FRAC_PI_2;

/// The load at an angle from the bottom (radians), if radius, press and push are 1.
pub fn bowl_load(stiffness: f64, friction: f64, angle: f64) -> f64 {
    let (sine, cosine) = angle.sin_cos();
    stiffness * sine + (1.0 + stiffness * (1.0 - cosine)) * (angle + friction.atan()).tan()
}

/// A scene of this family, of any size.
#[derive(Debug, Clone)]
pub struct Bowl {
    /// `k R/P`
    stiffness: f64,
    friction: f64,
    radius: f64,
    pressed_to: f64,
    /// The force at the end of the press, over the force of the push at a load factor of 1.
    scale: f64,
    stages: [String; 2],
}

impl Bowl {
    pub fn recognise(model: &Model) -> Option<Self> {
        let (node, stiffness) = pattern::one_spring(model).filter(|_| model.dimension == 2)?;
        let (contact, obstacle) = pattern::one_contact(model, node)?;
        let Obstacle::Ball { center, radius, side: Side::Inside } = obstacle else { return None };
        let [press, push] = &model.stages[..] else { return None };
        let pressed_to = press.until.as_ref()?.load_above.filter(|bound| *bound > 0.0)?;
        let ([0.0, down], [along, 0.0]) = (pattern::only_force(press, node)?, pattern::only_force(push, node)?) else {
            return None;
        };
        let bottom = &model.nodes[node];
        let isotropic = stiffness[0][0] == stiffness[1][1] && stiffness[0][1] == 0.0 && stiffness[1][0] == 0.0;
        let at_bottom = bottom[0] == center[0] && bottom[1] == center[1] - radius;
        let pressed = -down * pressed_to;
        (isotropic && at_bottom && pressed > 0.0 && *along > 0.0).then(|| Self {
            stiffness: stiffness[0][0] * radius / pressed,
            friction: contact.friction,
            radius: *radius,
            pressed_to,
            scale: pressed / along,
            stages: [press.name.clone(), push.name.clone()],
        })
    }
}

impl ExactSolution for Bowl {
    fn name(&self) -> &'static str {
        "node in a bowl"
    }

    fn formula(&self) -> &'static str {
        "s q = k R sin + (P + k R (1 - cos)) tan(angle + arctan mu) of the angle from the bottom"
    }

    fn stages(&self, reach: Reach) -> Vec<CurveStage> {
        let Self { stiffness, friction, radius, scale, .. } = *self;
        let load = move |angle: f64| scale * bowl_load(stiffness, friction, angle);
        let still = |load: f64| CurvePlace { displacements: vec![0.0, 0.0], load };
        let slides = move |angle: f64| CurvePlace {
            displacements: vec![radius * angle.sin(), radius * 2.0 * (0.5 * angle).sin().powi(2)],
            load: load(angle),
        };
        let far = 2.0 * reach.load.max(load(0.0)).max(scale);
        let to = zero(|angle| load(angle) - far, 0.0, FRAC_PI_2 - friction.atan());
        let mut pieces = vec![Piece::new(0.0, to, slides)];
        if friction > 0.0 {
            pieces.insert(0, Piece::new(0.0, scale * friction, still).ending(PointKind::ContactChange));
        }
        let pressed = vec![Piece::new(0.0, self.pressed_to, still).ending(PointKind::End)];
        vec![
            CurveStage { name: self.stages[0].clone(), pieces: pressed },
            CurveStage { name: self.stages[1].clone(), pieces },
        ]
    }
}
