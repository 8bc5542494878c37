//! Coulomb's law of dry friction.
//!
//! ```text
//! |r_t| <= μ r_n;      where a contact slips along d (a unit tangent):  r_t = -μ r_n d,  so that r = r_n (n - μ d)
//! ```
//!
//! The friction bound, the direction of the force of a slip and the distance of a force from the cone are evaluated
//! here alone. The law is homogeneous: the same functions give the rates of these quantities from the rates of the
//! reactions. Sums of cones, the cones of the increment's program, the projection on the cone and the proofs of
//! uniqueness have formulas of their own in the coefficient `μ`; another law has to replace these as well.

use crate::mechanics::contact::Reaction;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled};

/// The friction of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombFriction {
    /// The coefficient `μ >= 0`; 0 where friction has no effect.
    pub coefficient: f64,
}

impl CoulombFriction {
    /// No friction.
    pub const SMOOTH: Self = Self { coefficient: 0.0 };

    pub fn new(coefficient: f64) -> Self {
        Self { coefficient }
    }

    /// Whether there is friction at all.
    #[inline(always)]
    pub fn is_rough(self) -> bool {
        self.coefficient > 0.0
    }

    /// The bound `μ r_n` on the traction under a normal reaction; for the rate of a normal reaction, the rate of the
    /// bound.
    #[inline(always)]
    pub fn bound(self, normal: f64) -> f64 {
        self.coefficient * normal
    }

    /// The traction `-μ r_n d` of a slipping contact.
    #[inline(always)]
    pub fn traction(self, normal: f64, direction: &Vector) -> Vector {
        scaled(direction, -self.coefficient * normal)
    }

    /// The direction `n - μ d` of the force of a slipping contact on its node.
    #[inline(always)]
    pub fn force_direction(self, normal: &Vector, direction: &Vector) -> Vector {
        add(normal, -self.coefficient, direction)
    }

    /// The vector `d + μ n`, whose product with a force is `μ r_n + d·r_t`: the slack of the force against slip along
    /// `d`.
    #[inline(always)]
    pub fn slack_form(self, normal: &Vector, direction: &Vector) -> Vector {
        add(direction, self.coefficient, normal)
    }

    /// The slack `μ r_n + d·r_t` of a reaction (or its rate) against slip along `d`; not negative within the cone.
    #[inline(always)]
    pub fn slack(self, reaction: &Reaction, direction: &Vector) -> f64 {
        self.bound(reaction.normal) + dot(direction, &reaction.tangential)
    }

    /// The margin `μ r_n - |r_t|` of a reaction; not negative within the cone.
    #[inline(always)]
    pub fn margin(self, reaction: &Reaction) -> f64 {
        self.bound(reaction.normal) - reaction.tangential_size()
    }

    /// The squared norm `|n - μ d|² = 1 + μ²`.
    #[inline(always)]
    pub fn force_direction_squared(self) -> f64 {
        1.0 + self.coefficient * self.coefficient
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A force on the cone, one inside and one outside, and the slip that the first allows.
    #[test]
    fn a_force_is_within_its_cone_or_on_it_or_outside() {
        let friction = CoulombFriction::new(0.5);
        let (normal, direction) = ([0.0, 0.0, 1.0], [0.6, 0.8, 0.0]);
        let on_cone = Reaction { normal: 2.0, tangential: friction.traction(2.0, &direction) };
        assert_eq!(on_cone.tangential, [-0.6, -0.8, 0.0]);
        assert!(friction.margin(&on_cone).abs() < 1e-15 && friction.slack(&on_cone, &direction).abs() < 1e-15);
        let whole = add(&on_cone.tangential, 2.0, &normal);
        let along = scaled(&friction.force_direction(&normal, &direction), 2.0);
        assert!(dot(&add(&whole, -1.0, &along), &add(&whole, -1.0, &along)) < 1e-30);
        assert!(dot(&friction.slack_form(&normal, &direction), &whole).abs() < 1e-15);
        assert_eq!(friction.force_direction_squared(), dot(&along, &along) / 4.0);
        let [inside, outside] = [3.0, 1.0].map(|normal| Reaction { normal, ..on_cone });
        assert!((friction.margin(&inside) - 0.5).abs() < 1e-15 && (friction.margin(&outside) + 0.5).abs() < 1e-15);
        assert!(!CoulombFriction::SMOOTH.is_rough() && CoulombFriction::SMOOTH.bound(3.0) == 0.0);
    }
}
