//! Klarbring's node (A. Klarbring, *Examples of non-uniqueness and non-existence of solutions to quasistatic contact
//! problems with friction*, Ing.-Arch. 60 (1990) 529): a node on a floor with the stiffness `K = [[a, -b], [-b, c]]`,
//! pressed by `p` and pulled by `s q`.
//!
//! The contact sticks up to `s q = μ p`. Then the contact slips at `u_x = x` with `r_n = p - b x` and
//! `s q = a x + μ (p - b x)`; the load falls if `μ > a/b`. From `x = p/b` on, the contact is free and
//! `u = K⁻¹ (s q e_x - p e_y)`.

use crate::check::scenes::exact::curve::{CurvePlace, CurveStage, Piece, Reach};
use crate::check::scenes::exact::pattern;
use crate::check::scenes::exact::solution::ExactSolution;
use crate::model::Model;
use crate::result::increment::PointKind;

/// The node and its two stages.
#[derive(Debug, Clone)]
pub struct KlarbringScene {
    /// `a`, `b`, `c`.
    pub stiffness: [f64; 3],
    pub friction: f64,
    /// Force of the first stage at a load factor of 1, positive downwards.
    press: f64,
    /// Load factor at which the first stage ends.
    pressed_to: f64,
    pull: f64,
    stages: [String; 2],
}

impl KlarbringScene {
    pub fn recognise(model: &Model) -> Option<Self> {
        let (node, stiffness) = pattern::one_spring(model).filter(|_| model.dimension == 2)?;
        let (contact, obstacle) = pattern::one_contact(model, node)?;
        let [press, pull] = &model.stages[..] else { return None };
        let pressed_to = press.until.as_ref()?.load_above.filter(|bound| *bound > 0.0)?;
        let ([side, down], [along, up]) = (pattern::only_force(press, node)?, pattern::only_force(pull, node)?) else {
            return None;
        };
        let (a, b, c) = (stiffness[0][0], -stiffness[0][1], stiffness[1][1]);
        let forces = *side == 0.0 && *down < 0.0 && *along > 0.0 && *up == 0.0;
        // During slip the coupling b lifts the node off the floor. With a = μ b the load would be constant during slip.
        let leaves = b > 0.0 && a > 0.0 && a * c > b * b && a != contact.friction * b && stiffness[1][0] == -b;
        let fits = pattern::is_floor_at(obstacle, &model.nodes[node]) && forces && leaves && contact.friction > 0.0;
        fits.then(|| Self {
            stiffness: [a, b, c],
            friction: contact.friction,
            press: -down,
            pressed_to,
            pull: *along,
            stages: [press.name.clone(), pull.name.clone()],
        })
    }
}

impl ExactSolution for KlarbringScene {
    fn name(&self) -> &'static str {
        "Klarbring's node"
    }

    fn formula(&self) -> &'static str {
        "stuck to s q = mu p; s q = a x + mu (p - b x) to x = p/b; then K u = (s q, -p)"
    }

    fn stages(&self, reach: Reach) -> Vec<CurveStage> {
        let ([a, b, c], friction, pull) = (self.stiffness, self.friction, self.pull);
        let held = self.press * self.pressed_to;
        let still = |load: f64| CurvePlace { displacements: vec![0.0, 0.0], load };
        let slips = friction * held / pull;
        let leaves = held / b;
        let corner = if a < friction * b { PointKind::NonsmoothLimit } else { PointKind::ContactChange };
        let left_at = a * leaves / pull;
        // Large enough for both extents: x = (c s q - b p)/(a c - b²).
        let far = reach.load.max((reach.displacement * (a * c - b * b) + b * held) / (c * pull)).max(left_at);
        let free = move |load: f64| {
            let determinant = a * c - b * b;
            let x = (c * load * pull - b * held) / determinant;
            let y = (b * load * pull - a * held) / determinant;
            CurvePlace { displacements: vec![x, y], load }
        };
        vec![
            CurveStage {
                name: self.stages[0].clone(),
                pieces: vec![Piece::new(0.0, self.pressed_to, still).ending(PointKind::End)],
            },
            CurveStage {
                name: self.stages[1].clone(),
                pieces: vec![
                    Piece::new(0.0, slips, still).ending(corner),
                    Piece::new(0.0, leaves, move |x| CurvePlace {
                        displacements: vec![x, 0.0],
                        load: (a * x + friction * (held - b * x)) / pull,
                    })
                    .ending(corner),
                    Piece::new(left_at, 2.0 * far, free),
                ],
            },
        ]
    }
}
