//! Whether friction cones together hold a force, by alternating projections: a check that shares nothing with the solver.

type Vector = [f64; 3];

fn add(a: &Vector, factor: f64, b: &Vector) -> Vector {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The nearest force of a friction cone of a unit normal.
fn projected(force: &Vector, (normal, friction): &(Vector, f64)) -> Vector {
    let along = dot(force, normal);
    let across = add(force, -along, normal);
    let radius = dot(&across, &across).sqrt();
    if radius <= friction * along {
        return *force;
    }
    if friction * radius <= -along {
        return [0.0; 3];
    }
    let ray = add(normal, friction / radius, &across);
    let factor = (along + friction * radius) / (1.0 + friction * friction);
    add(&[0.0; 3], factor, &ray)
}

/// How far a force is from the sum of friction cones, each a unit normal and a coefficient: the least `|R - Σ r_i|` with
/// `r_i` in the cones, by minimising over one after another (it falls in every round).
pub fn distance(cones: &[(Vector, f64)], force: &Vector) -> f64 {
    let size = dot(force, force).sqrt();
    let mut parts = vec![[0.0; 3]; cones.len()];
    let mut rest = *force;
    for _ in 0..200_000 {
        for (part, cone) in parts.iter_mut().zip(cones) {
            let next = projected(&add(&rest, 1.0, part), cone);
            rest = add(&add(&rest, 1.0, part), -1.0, &next);
            *part = next;
        }
        if dot(&rest, &rest).sqrt() <= 1e-12 * size {
            break;
        }
    }
    dot(&rest, &rest).sqrt()
}
