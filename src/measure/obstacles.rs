//! Obstacles as posted: where they are under a load factor, and their frame at a node, for the measure alone.
//!
//! A frame is the gap, the unit normal into the free side, and the tangents: in 2D `(n_y, -n_x)`; in 3D
//! `t1 = (e_k - n_k n)/|.|` with `k` the first of the smallest `|n_k|`, and `t2 = n x t1`.

use crate::model::request::{Obstacle, Side};

/// How the obstacle lies to a node.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub gap: f64,
    /// What rounding of the coordinates may put into the gap.
    pub rounding: f64,
    pub normal: Vec<f64>,
    pub tangents: Vec<Vec<f64>>,
}

impl Frame {
    /// Of an obstacle moved by `shift`, at a node at `place` moved by `displacement`.
    pub fn new(obstacle: &Obstacle, shift: &[f64], place: &[f64], displacement: &[f64]) -> Self {
        let centre = match obstacle {
            Obstacle::Plane { point, .. } => point,
            Obstacle::Ball { center, .. } => center,
        };
        let moved: Vec<f64> = displacement.iter().zip(shift).map(|(u, d)| u - d).collect();
        let from: Vec<f64> = place.iter().zip(centre).zip(&moved).map(|((x, c), m)| x - c + m).collect();
        let (gap, normal, size) = match obstacle {
            Obstacle::Plane { normal, .. } => {
                let size = norm(normal);
                let normal: Vec<f64> = normal.iter().map(|value| value / size).collect();
                (dot(&from, &normal), normal, 0.0)
            }
            Obstacle::Ball { radius, side, .. } => {
                let sign = if *side == Side::Outside { 1.0 } else { -1.0 };
                let distance = norm(&from);
                let unit = |k: usize| if distance > 0.0 { sign * from[k] / distance } else { f64::from(k == 0) };
                (sign * (distance - radius), (0..from.len()).map(unit).collect(), *radius)
            }
        };
        let reach = [place, centre, displacement, shift].into_iter().flatten();
        let reach = reach.fold(size, |reach, value| reach.max(value.abs()));
        let tangents = tangents(&normal);
        Self { gap, rounding: 16.0 * f64::EPSILON * reach, normal, tangents }
    }

    /// The vector with these components along the tangents.
    pub fn in_space(&self, components: &[f64]) -> Vec<f64> {
        let sum = |k: usize| components.iter().zip(&self.tangents).map(|(value, tangent)| value * tangent[k]).sum();
        (0..self.normal.len()).map(sum).collect()
    }

    /// Components of a vector along the tangents.
    pub fn along(&self, vector: &[f64]) -> Vec<f64> {
        self.tangents.iter().map(|tangent| dot(tangent, vector)).collect()
    }
}

fn tangents(normal: &[f64]) -> Vec<Vec<f64>> {
    if let [x, y] = *normal {
        return vec![vec![y, -x]];
    }
    let mut axis = 0;
    for k in 1..3 {
        if normal[k].abs() < normal[axis].abs() {
            axis = k;
        }
    }
    let across: Vec<f64> =
        (0..3).map(|k| if k == axis { 1.0 - normal[axis] * normal[k] } else { -normal[axis] * normal[k] }).collect();
    let size = norm(&across);
    let first: Vec<f64> = across.iter().map(|value| value / size).collect();
    let turned = |i: usize, j: usize| normal[i] * first[j] - normal[j] * first[i];
    let second = vec![turned(1, 2), turned(2, 0), turned(0, 1)];
    vec![first, second]
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub(super) fn norm(vector: &[f64]) -> f64 {
    dot(vector, vector).sqrt()
}
