//! How the force on a node is shared by several obstacles: the reactions of least norm.
//!
//! ```text
//! min ½ Σ |r_i|²   s.t.   Σ r_i = R,   r_i in the friction cone K_i
//! ```
//!
//! Where a node is held by several obstacles at once, equilibrium gives only the sum of their reactions, of a guided node
//! only what it is free to follow. The least ones
//! are `r_i = P_i(y)`, projections on the cones of one vector `y` with `Σ P_i(y) = R`: the minimiser of the convex
//! function `½ Σ |P_i(y)|² - R·y`, found by Newton's method (R. T. Rockafellar, *Convex Analysis*, Princeton 1970, §31;
//! projection on the circular cone: H. H. Bauschke, *Projection algorithms and monotone operators*, 1996, thm 3.3.6).

use super::vector::{Vector, add, dot, scaled, size};

/// A friction cone: axis (unit normal) and coefficient.
#[derive(Debug, Clone, Copy)]
pub struct Cone {
    pub normal: Vector,
    pub friction: f64,
    /// The only line along which there is friction; without one the cone is circular.
    pub line: Option<Vector>,
}

/// Newton iterations; a few are usual, since the function is piecewise quadratic in 2D.
const ITERATIONS: usize = 60;
/// The sum that is left over, relative to the force, may be this large.
const LEFT_OVER: f64 = 1e-12;

impl Cone {
    /// The nearest force of the cone, and the derivative of that applied to a vector.
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
        let place = if radius <= friction * along {
            Place::Inside
        } else if friction * radius <= -along {
            Place::Apex
        } else {
            Place::Surface
        };
        let ray = add(&normal, friction, &direction);
        let norm = 1.0 + friction * friction;
        let inside = move |vector: &Vector| match line {
            Some(_) => add(&tangential(vector), dot(vector, &normal), &normal),
            None => *vector,
        };
        let projected = match place {
            Place::Inside => inside(force),
            Place::Apex => [0.0; 3],
            Place::Surface => scaled(&ray, (along + friction * radius) / norm),
        };
        let derivative = move |change: &Vector| match place {
            Place::Inside => inside(change),
            Place::Apex => [0.0; 3],
            Place::Surface => {
                let stretched = scaled(&ray, dot(change, &ray) / norm);
                let tangential = tangential(change);
                let turning = add(&tangential, -dot(&tangential, &direction), &direction);
                let turn = friction * (along + friction * radius) / (norm * radius);
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

/// The reactions of least norm that make up a force as far as orthonormal directions `free` hold it; `None` where the
/// cones together do not hold it.
pub fn least_reactions(cones: &[Cone], free: &[Vector], force: &Vector) -> Option<Vec<Vector>> {
    let scale = size(force);
    if scale == 0.0 {
        return Some(vec![[0.0; 3]; cones.len()]);
    }
    let held = |vector: &Vector| free.iter().fold([0.0; 3], |sum, one| add(&sum, dot(one, vector), one));
    let sum_at = |y: &Vector| held(&cones.iter().fold([0.0; 3], |sum, cone| add(&sum, 1.0, &cone.project(y).0)));
    let value = |y: &Vector| {
        let squares: f64 = cones.iter().map(|cone| cone.project(y).0).map(|part| dot(&part, &part)).sum();
        0.5 * squares - dot(force, y)
    };
    let mut y = scaled(force, 1.0 / cones.len() as f64);
    for _ in 0..ITERATIONS {
        let rest = add(&sum_at(&y), -1.0, force);
        if size(&rest) <= LEFT_OVER * scale {
            return Some(cones.iter().map(|cone| cone.project(&y).0).collect());
        }
        // The derivative is symmetric and semidefinite; a small part of the identity makes it regular.
        let mut matrix = nalgebra::Matrix3::identity() * 1e-15;
        for cone in cones {
            let (_, derivative) = cone.project(&y);
            for column in 0..3 {
                let mut unit = [0.0; 3];
                unit[column] = 1.0;
                let change = held(&derivative(&held(&unit)));
                (0..3).for_each(|row| matrix[(row, column)] += change[row]);
            }
        }
        let step = matrix.lu().solve(&nalgebra::Vector3::from(rest))?;
        let step = [step[0], step[1], step[2]];
        let (before, slope) = (value(&y), dot(&rest, &step));
        let mut length = 1.0;
        while length > 1e-10 && value(&add(&y, -length, &step)) > before - 1e-4 * length * slope {
            length *= 0.5;
        }
        y = add(&y, -length, &step);
        if !size(&y).is_finite() {
            return None;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACE: [Vector; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn a_guided_node_shares_what_it_is_free_to_follow() {
        // Guided along y between y and (1, 1)/√2: parts in proportion to what of the normals is free.
        let floor = Cone { normal: [0.0, 1.0, 0.0], friction: 0.0, line: None };
        let half = 0.5_f64.sqrt();
        let flank = Cone { normal: [half, half, 0.0], friction: 0.0, line: None };
        let parts = least_reactions(&[floor, flank], &SPACE[1..2], &[0.0, 3.0, 0.0]).unwrap();
        assert!((parts[0][1] - 2.0).abs() < 1e-12 && (dot(&parts[1], &flank.normal) - 2.0 * half).abs() < 1e-12);
    }

    #[test]
    fn a_corner_shares_a_force() {
        // Floor and wall, frictionless: each takes its own part.
        let floor = Cone { normal: [0.0, 1.0, 0.0], friction: 0.0, line: None };
        let wall = Cone { normal: [1.0, 0.0, 0.0], friction: 0.0, line: None };
        let parts = least_reactions(&[floor, wall], &SPACE, &[2.0, 3.0, 0.0]).unwrap();
        assert!((parts[0][1] - 3.0).abs() < 1e-12 && (parts[1][0] - 2.0).abs() < 1e-12);
        assert!(least_reactions(&[floor, wall], &SPACE, &[-1.0, 3.0, 0.0]).is_none());
    }

    #[test]
    fn coincident_obstacles_share_equally() {
        let floor = Cone { normal: [0.0, 0.0, 1.0], friction: 0.5, line: None };
        let parts = least_reactions(&[floor, floor], &SPACE, &[0.3, 0.2, 1.0]).unwrap();
        for part in parts {
            assert!((part[0] - 0.15).abs() < 1e-12 && (part[2] - 0.5).abs() < 1e-12);
        }
    }

    #[test]
    fn the_least_reactions_satisfy_the_conditions_of_optimality() {
        let floor = Cone { normal: [0.0, 1.0, 0.0], friction: 0.3, line: None };
        let wall = Cone { normal: [0.8, 0.6, 0.0], friction: 0.2, line: None };
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
}
