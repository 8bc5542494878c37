//! The reactions of least norm, by which several obstacles share the force on a node.
//!
//! ```text
//! min ½ Σ |r_i|²   s.t.   Σ r_i = R,   r_i in the friction cone K_i
//! ```
//!
//! Where several obstacles hold a node at once, equilibrium determines only the sum of their reactions; for a guided
//! node, only the components of the sum along which the node is free. The reactions of least norm are `r_i = P_i(y)`,
//! the projections on the cones of one vector `y` with `Σ P_i(y) = R`. This vector is the minimiser of the convex
//! function `½ Σ |P_i(y)|² - R·y`, found by Newton's method (R. T. Rockafellar, *Convex Analysis*, Princeton 1970, §31;
//! projection on the circular cone: H. H. Bauschke, *Projection algorithms and monotone operators*, 1996, thm 3.3.6).

use crate::mechanics::contact::coulomb::CoulombFriction;
use crate::mechanics::contact::tolerances::{REGULARISATION, SHORTEST_STEP, SUFFICIENT_DECREASE, SUM_RESIDUAL};
use crate::mechanics::contact::vector::{Vector, add, dot, scaled, size};

/// A friction cone: axis (unit normal) and coefficient.
#[derive(Debug, Clone, Copy)]
pub struct Cone {
    pub normal: Vector,
    pub friction: CoulombFriction,
    /// The line along which alone friction acts; without it the cone is circular.
    pub line: Option<Vector>,
}

/// Largest number of Newton iterations; a few are usual, since the function is piecewise quadratic in 2D.
const ITERATIONS: usize = 200;

impl Cone {
    /// The projection of a force on the cone, and the derivative of the projection applied to a vector.
    fn project(&self, force: &Vector) -> (Vector, impl Fn(&Vector) -> Vector + use<>) {
        let Self { normal, friction, line } = *self;
        let along = dot(force, &normal);
        let tangential = move |vector: &Vector| match line {
            Some(line) => scaled(&line, dot(vector, &line)),
            None => add(vector, -dot(vector, &normal), &normal),
        };
        let across = tangential(force);
        let radius = size(&across);
        let direction = if radius > 0.0 { scaled(&across, 1.0 / radius) } else { [0.0; 3] };
        let place = if radius <= friction.bound(along) {
            Place::Inside
        } else if friction.bound(radius) <= -along {
            Place::Apex
        } else {
            Place::Surface
        };
        let ray = add(&normal, friction.coefficient, &direction);
        let norm = friction.force_direction_squared();
        let inside = move |vector: &Vector| match line {
            Some(_) => add(&tangential(vector), dot(vector, &normal), &normal),
            None => *vector,
        };
        let projected = match place {
            Place::Inside => inside(force),
            Place::Apex => [0.0; 3],
            Place::Surface => scaled(&ray, (along + friction.bound(radius)) / norm),
        };
        let derivative = move |change: &Vector| match place {
            Place::Inside => inside(change),
            Place::Apex => [0.0; 3],
            Place::Surface => {
                let stretched = scaled(&ray, dot(change, &ray) / norm);
                let tangential = tangential(change);
                let turning = add(&tangential, -dot(&tangential, &direction), &direction);
                let turn = friction.bound(along + friction.bound(radius)) / (norm * radius);
                add(&stretched, turn, &turning)
            }
        };
        (projected, derivative)
    }
}

#[derive(Clone, Copy)]
enum Place {
    Inside,
    Surface,
    Apex,
}

/// Returns the reactions of least norm whose sum, projected on the orthonormal directions `free`, is `force`; `None`
/// where no reactions within the cones have this sum.
pub fn least_reactions(cones: &[Cone], free: &[Vector], force: &Vector) -> Option<Vec<Vector>> {
    let scale = size(force);
    if scale == 0.0 {
        return Some(vec![[0.0; 3]; cones.len()]);
    }
    let dual = Dual { cones, free, force: scaled(force, 1.0 / scale) };
    let mut at = dual.at(scaled(&dual.force, 1.0 / cones.len() as f64));
    for _ in 0..ITERATIONS {
        if at.left_over <= f64::EPSILON {
            break;
        }
        let Some(next) = dual.step(&at) else { break };
        at = next;
    }
    let parts: Vec<Vector> = cones.iter().map(|cone| cone.project(&at.place).0).collect();
    let largest = parts.iter().map(size).fold(1.0, f64::max);
    (at.left_over <= SUM_RESIDUAL * largest).then(|| parts.iter().map(|part| scaled(part, scale)).collect())
}

/// The convex function whose minimiser gives the reactions, for a force of unit size.
struct Dual<'a> {
    cones: &'a [Cone],
    free: &'a [Vector],
    force: Vector,
}

/// A point `y` with the value and the gradient of the function.
struct At {
    place: Vector,
    value: f64,
    /// The gradient: the sum of the projections less the force.
    gradient: Vector,
    left_over: f64,
}

impl Dual<'_> {
    fn held(&self, vector: &Vector) -> Vector {
        self.free.iter().fold([0.0; 3], |sum, one| add(&sum, dot(one, vector), one))
    }

    fn at(&self, place: Vector) -> At {
        let (mut sum, mut squares) = ([0.0; 3], 0.0);
        for cone in self.cones {
            let part = cone.project(&place).0;
            sum = add(&sum, 1.0, &part);
            squares += dot(&part, &part);
        }
        let gradient = add(&self.held(&sum), -1.0, &self.force);
        let value = 0.5 * squares - dot(&self.force, &place);
        At { place, value, gradient, left_over: size(&gradient) }
    }

    /// A regularised Newton step with line search. The multiple of the identity is proportional to the gradient: the
    /// step stays bounded where the second derivative is singular, and near the minimum it converges as fast as
    /// Newton's. It is shortened until the function decreases sufficiently (D. Li, M. Fukushima, L. Qi, N. Yamashita,
    /// Comput. Optim. Appl. 28 (2004) 131). `None` where rounding prevents a further decrease.
    fn step(&self, at: &At) -> Option<At> {
        let mut matrix = nalgebra::Matrix3::identity() * (REGULARISATION * at.left_over).max(f64::EPSILON);
        for cone in self.cones {
            let (_, derivative) = cone.project(&at.place);
            for column in 0..3 {
                let mut unit = [0.0; 3];
                unit[column] = 1.0;
                let change = self.held(&derivative(&self.held(&unit)));
                (0..3).for_each(|row| matrix[(row, column)] += change[row]);
            }
        }
        let step = matrix.lu().solve(&nalgebra::Vector3::from(at.gradient))?;
        let step = [step[0], step[1], step[2]];
        let slope = dot(&at.gradient, &step);
        let mut length = 1.0;
        while length > SHORTEST_STEP {
            let next = self.at(add(&at.place, -length, &step));
            let falls = next.value <= at.value - SUFFICIENT_DECREASE * length * slope;
            // Near the minimum the values differ by less than their rounding.
            if (falls && next.left_over < f64::INFINITY) || next.left_over <= 0.5 * at.left_over {
                return Some(next);
            }
            length *= 0.5;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACE: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn a_guided_node_shares_what_it_is_free_to_follow() {
        // Guided along y between the normals y and (1, 1)/√2: the parts are proportional to the free components of the
        // normals.
        let floor = Cone { normal: [0.0, 1.0, 0.0], friction: CoulombFriction::new(0.0), line: None };
        let half = 0.5_f64.sqrt();
        let flank = Cone { normal: [half, half, 0.0], friction: CoulombFriction::new(0.0), line: None };
        let parts = least_reactions(&[floor, flank], &SPACE[1..2], &[0.0, 3.0, 0.0]).unwrap();
        assert!((parts[0][1] - 2.0).abs() < 1e-12 && (dot(&parts[1], &flank.normal) - 2.0 * half).abs() < 1e-12);
    }

    #[test]
    fn a_corner_shares_a_force() {
        // Floor and wall, frictionless: each takes its own part.
        let floor = Cone { normal: [0.0, 1.0, 0.0], friction: CoulombFriction::new(0.0), line: None };
        let wall = Cone { normal: [1.0, 0.0, 0.0], friction: CoulombFriction::new(0.0), line: None };
        let parts = least_reactions(&[floor, wall], &SPACE, &[2.0, 3.0, 0.0]).unwrap();
        assert!((parts[0][1] - 3.0).abs() < 1e-12 && (parts[1][0] - 2.0).abs() < 1e-12);
        assert!(least_reactions(&[floor, wall], &SPACE, &[-1.0, 3.0, 0.0]).is_none());
    }

    #[test]
    fn coincident_obstacles_share_equally() {
        let floor = Cone { normal: [0.0, 0.0, 1.0], friction: CoulombFriction::new(0.5), line: None };
        let parts = least_reactions(&[floor, floor], &SPACE, &[0.3, 0.2, 1.0]).unwrap();
        for part in parts {
            assert!((part[0] - 0.15).abs() < 1e-12 && (part[2] - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn the_least_reactions_satisfy_the_conditions_of_optimality() {
        let floor = Cone { normal: [0.0, 1.0, 0.0], friction: CoulombFriction::new(0.3), line: None };
        let wall = Cone { normal: [0.8, 0.6, 0.0], friction: CoulombFriction::new(0.2), line: None };
        let force = [0.6, 1.9, 0.0];
        let parts = least_reactions(&[floor, wall], &SPACE, &force).unwrap();
        let sum = add(&parts[0], 1.0, &parts[1]);
        assert!(size(&add(&sum, -1.0, &force)) < 1e-11);
        // No exchange between the two within their cones makes the sum of squares smaller.
        let squares = |exchange: &Vector| {
            let (first, second) = (add(&parts[0], 1.0, exchange), add(&parts[1], -1.0, exchange));
            let inside = |cone: &Cone, part: &Vector| size(&add(part, -1.0, &cone.project(part).0)) < 1e-12;
            (inside(&floor, &first) && inside(&wall, &second)).then(|| dot(&first, &first) + dot(&second, &second))
        };
        let least = dot(&parts[0], &parts[0]) + dot(&parts[1], &parts[1]);
        for k in 0..720 {
            let angle = f64::from(k) * std::f64::consts::PI / 360.0;
            if let Some(other) = squares(&[1e-3 * angle.cos(), 1e-3 * angle.sin(), 0.0]) {
                assert!(other >= least - 1e-12);
            }
        }
    }

    /// Two cones whose sum is all of space, one of them narrow: plain Newton's method does not converge for every
    /// force.
    #[test]
    fn two_cones_that_are_all_of_space_share_any_force() {
        let unit = |vector: [f64; 3]| scaled(&vector, 1.0 / size(&vector));
        let first =
            Cone { normal: unit([-0.2297, 0.7365, -0.6362]), friction: CoulombFriction::new(1.265), line: None };
        let second =
            Cone { normal: unit([0.5639, -0.8116, -0.1529]), friction: CoulombFriction::new(0.201), line: None };
        for k in 0..2000 {
            let angle = f64::from(k) * 2.399_963_229_728_653;
            let height = 1.0 - (2.0 * f64::from(k) + 1.0) / 2000.0;
            let across = (1.0 - height * height).sqrt();
            let force = [across * angle.cos(), across * angle.sin(), height];
            let parts = least_reactions(&[first, second], &SPACE, &force).expect("every force is held");
            let sum = add(&parts[0], 1.0, &parts[1]);
            assert!(size(&add(&sum, -1.0, &force)) <= 1e-12 * (1.0 + size(&parts[0])), "{force:?}");
            for (part, cone) in parts.iter().zip([first, second]) {
                assert!(size(&add(part, -1.0, &cone.project(part).0)) <= 1e-12 * (1.0 + size(part)), "{force:?}");
            }
        }
    }
}
