//! A block on springs, pressed on a floor that drags the block in one direction until the block slips, and then in
//! another direction.
//!
//! While the block slips, the friction force opposes the slip, balances the spring force and has the constant size
//! `μ P = k ρ`. The slip is therefore `u̇ - e = -λ u`, where `e` is the direction of the drag, and `u` turns towards
//! `e`. The angle `ψ` between `u` and `e` satisfies `ρ ψ̇ = -sin ψ`, so that after a drag of `d`,
//! `tan(ψ/2) = tan(ψ0/2) exp(-d/ρ)`.

use crate::check::scenes::exact::curve::{CurvePlace, CurveStage, Piece, Reach};
use crate::check::scenes::exact::pattern;
use crate::check::scenes::exact::solution::ExactSolution;
use crate::model::Model;
use crate::result::increment::PointKind;

/// Displacement of a block that slips at `(ρ, 0)` when the floor changes its direction to `(cos turn, sin turn)`, after
/// a further drag of `d`.
pub fn turning_drag(radius: f64, turn: f64, drag: f64) -> [f64; 2] {
    let between = 2.0 * ((0.5 * turn).tan() * (-drag / radius).exp()).atan();
    let (sine, cosine) = (turn - between).sin_cos();
    [radius * cosine, radius * sine]
}

/// A scene of this family, of any size.
#[derive(Debug, Clone)]
pub struct TurningDrag {
    /// `ρ`
    radius: f64,
    pressed_to: f64,
    /// Length at a load factor of 1 and angle from the x axis (radians) of both drags.
    drags: [(f64, f64); 2],
    /// Load factor at which the first drag ends.
    dragged_to: f64,
    stages: [String; 3],
}

impl TurningDrag {
    pub fn recognise(model: &Model) -> Option<Self> {
        let (node, stiffness) = pattern::one_spring(model).filter(|_| model.dimension == 3)?;
        let (contact, obstacle) = pattern::one_contact(model, node)?;
        let [press, along, across] = &model.stages[..] else { return None };
        let end = |stage: &crate::model::request::Stage| stage.until.as_ref()?.load_above.filter(|bound| *bound > 0.0);
        let (pressed_to, dragged_to) = (end(press)?, end(along)?);
        let [0.0, 0.0, down] = pattern::only_force(press, node)? else { return None };
        let drag = |stage: &crate::model::request::Stage| {
            let still = stage.forces.is_empty() && stage.displacements.is_empty();
            match stage.obstacle_motion.get(&contact.obstacle)?[..] {
                [x, y, 0.0] if still && (x, y) != (0.0, 0.0) => Some((x.hypot(y), y.atan2(x))),
                _ => None,
            }
        };
        let drags = [drag(along)?, drag(across)?];
        let spring = stiffness[0][0];
        let isotropic = (0..3).all(|i| (0..3).all(|j| stiffness[i][j] == if i == j { spring } else { 0.0 }));
        let radius = contact.friction * -down * pressed_to / spring;
        let slips = radius > 0.0 && dragged_to * drags[0].0 > radius && (drags[1].1 - drags[0].1).cos() > 0.0;
        (isotropic && pattern::is_floor_at(obstacle, &model.nodes[node]) && slips).then(|| Self {
            radius,
            pressed_to,
            drags,
            dragged_to,
            stages: [press.name.clone(), along.name.clone(), across.name.clone()],
        })
    }
}

impl ExactSolution for TurningDrag {
    fn name(&self) -> &'static str {
        "turning drag"
    }

    fn formula(&self) -> &'static str {
        "tan(psi/2) = tan(psi0/2) exp(-d/rho), rho = mu P/k, psi between spring and drag"
    }

    fn stages(&self, reach: Reach) -> Vec<CurveStage> {
        let Self { radius, drags: [(first, angle), (second, turned)], dragged_to, .. } = *self;
        let (sine, cosine) = angle.sin_cos();
        let turn = move |along: f64, across: f64, load: f64| CurvePlace {
            displacements: vec![along * cosine - across * sine, along * sine + across * cosine, 0.0],
            load,
        };
        let still = |load: f64| CurvePlace { displacements: vec![0.0; 3], load };
        let begins = radius / first;
        let far = 2.0 * reach.load.max(radius / second);
        let pieces = [
            vec![Piece::new(0.0, self.pressed_to, still).ending(PointKind::End)],
            vec![
                Piece::new(0.0, begins, move |load| turn(first * load, 0.0, load)).ending(PointKind::ContactChange),
                Piece::new(begins, dragged_to, move |load| turn(radius, 0.0, load)).ending(PointKind::End),
            ],
            vec![Piece::new(0.0, far, move |load| {
                let [along, across] = turning_drag(radius, turned - angle, second * load);
                turn(along, across, load)
            })],
        ];
        self.stages.iter().zip(pieces).map(|(name, pieces)| CurveStage { name: name.clone(), pieces }).collect()
    }
}
