//! A node in front of a rigid obstacle that turns about an axis.
//!
//! ```text
//! x = Rᵀ(X + u - c - d) - (X - c),     R = exp(θ a×)
//! ```
//!
//! with the undeformed position `X` of the node, a point `c` on the axis, the unit vector `a` along it, the translation `d`
//! of the obstacle and its angle `θ`. `x` is the position of the node in the axes of the obstacle, which turn with it;
//! there the obstacle is at rest, and the motion of the node along it is its slip.
//!
//! Translation and angle are degrees of freedom that the load factor prescribes, as it prescribes the motion of supports:
//! the translations of one auxiliary node, and the first of another; all of these are held. What follows from the motion of
//! supports thus follows from the turning, too: rates, second derivatives, works.

use crate::mechanics::AUXILIARY_UNIT;
use crate::mechanics::contact::kinematics::{CoupledKinematics, LocalDisplacements};
use crate::mechanics::contact::vector::{Vector, add, cross, dot, scaled};

/// A node and the auxiliary nodes of the obstacle in front of it.
#[derive(Debug, Clone)]
pub struct NodeAtTurningObstacle {
    /// The node, the auxiliary node of the translation, and that of the angle.
    nodes: [usize; 3],
    dimension: usize,
    /// `X - c`
    arm: Vector,
    /// `a`; the third axis in the plane.
    axis: Vector,
}

/// The motion of the obstacle, and the node in its axes.
struct RelativePlacement {
    sine: f64,
    /// `1 - cos θ`, without cancellation.
    versine: f64,
    /// `u - d`
    relative: Vector,
}

impl NodeAtTurningObstacle {
    /// `auxiliary`: the nodes that stand for the translation and for the angle of the obstacle; `arm`: the undeformed
    /// position of the node from a point on the axis; `axis`: a unit vector.
    pub fn new(node: usize, auxiliary: [usize; 2], dimension: usize, arm: Vector, axis: Vector) -> Self {
        Self { nodes: [node, auxiliary[0], auxiliary[1]], dimension, arm, axis }
    }

    fn placed(&self, displacement: LocalDisplacements<'_>) -> RelativePlacement {
        let mut relative = [0.0; 3];
        for (k, part) in relative.iter_mut().enumerate().take(self.dimension) {
            *part = displacement(k) - displacement(self.dimension + k) * AUXILIARY_UNIT;
        }
        let angle = displacement(2 * self.dimension) * AUXILIARY_UNIT;
        let half = (0.5 * angle).sin();
        RelativePlacement { sine: angle.sin(), versine: 2.0 * half * half, relative }
    }

    /// By Rodrigues' formula: `(Rᵀ - I) v`, or `(R - I) v` for the opposite sine.
    fn turned_by(&self, versine: f64, sine: f64, vector: &Vector) -> Vector {
        let across = cross(&self.axis, vector);
        add(&scaled(&across, -sine), versine, &cross(&self.axis, &across))
    }

    /// `Rᵀ v`
    fn in_axes(&self, placed: &RelativePlacement, vector: &Vector) -> Vector {
        add(vector, 1.0, &self.turned_by(placed.versine, placed.sine, vector))
    }

    /// `R v`
    fn in_space(&self, placed: &RelativePlacement, vector: &Vector) -> Vector {
        add(vector, 1.0, &self.turned_by(placed.versine, -placed.sine, vector))
    }

    /// `Rᵀ(X + u - c - d)`
    fn position(&self, placed: &RelativePlacement) -> Vector {
        self.in_axes(placed, &add(&self.arm, 1.0, &placed.relative))
    }
}

impl CoupledKinematics for NodeAtTurningObstacle {
    fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    fn place(&self, displacement: LocalDisplacements<'_>) -> Vector {
        let placed = self.placed(displacement);
        // The difference of two long vectors, without cancellation.
        let turned = self.turned_by(placed.versine, placed.sine, &self.arm);
        add(&self.in_axes(&placed, &placed.relative), 1.0, &turned)
    }

    fn each_column(&self, displacement: LocalDisplacements<'_>, each: &mut dyn FnMut(usize, &Vector)) {
        let placed = self.placed(displacement);
        for k in 0..self.dimension {
            let mut along = [0.0; 3];
            along[k] = 1.0;
            let column = self.in_axes(&placed, &along);
            each(k, &column);
            each(self.dimension + k, &scaled(&column, -AUXILIARY_UNIT));
        }
        let by_angle = cross(&self.axis, &self.position(&placed));
        each(2 * self.dimension, &scaled(&by_angle, -AUXILIARY_UNIT));
    }

    fn each_curvature(
        &self,
        displacement: LocalDisplacements<'_>,
        force: &Vector,
        add: &mut dyn FnMut(usize, usize, f64),
    ) {
        let placed = self.placed(displacement);
        let angle = 2 * self.dimension;
        // The force turns with the obstacle.
        let turning = cross(&self.axis, &self.in_space(&placed, force));
        for (k, part) in turning.iter().enumerate().take(self.dimension) {
            for (row, value) in [(k, *part), (self.dimension + k, -AUXILIARY_UNIT * part)] {
                add(row, angle, AUXILIARY_UNIT * value);
                add(angle, row, AUXILIARY_UNIT * value);
            }
        }
        let twice = cross(&self.axis, &cross(&self.axis, &self.position(&placed)));
        add(angle, angle, AUXILIARY_UNIT * AUXILIARY_UNIT * dot(&twice, force));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The columns are the derivatives of the place, and the curvature that of the forces, by central differences, in the
    /// plane and in space.
    #[test]
    fn derivatives_are_those_of_the_place() {
        let (axis, force) = ([0.6, 0.0, 0.8], [0.3, -0.7, 0.5]);
        for (dimension, axis) in [(2, [0.0, 0.0, 1.0]), (3, axis)] {
            let arm = if dimension == 2 { [1.5, -0.4, 0.0] } else { [1.5, -0.4, 0.9] };
            let contact = NodeAtTurningObstacle::new(0, [1, 2], dimension, arm, axis);
            let angle = 2 * dimension;
            // In units of the node's own degrees of freedom.
            let unit = |at: usize| if at < dimension { 1.0 } else { AUXILIARY_UNIT };
            let mut values = [0.2, -0.1, 0.3, 0.05, 0.15, -0.25, 0.0, 0.0, 0.0];
            values[angle] = 0.8;
            let at = |values: &[f64; 9]| {
                let local: Vec<f64> = values.iter().enumerate().map(|(at, value)| value / unit(at)).collect();
                let mut columns = [[0.0; 3]; 9];
                contact.each_column(&|at| local[at], &mut |at, column| columns[at] = scaled(column, 1.0 / unit(at)));
                (contact.place(&|at| local[at]), columns)
            };
            let (_, columns) = at(&values);
            let mut curvature = [[0.0; 9]; 9];
            let local: Vec<f64> = values.iter().enumerate().map(|(at, value)| value / unit(at)).collect();
            contact.each_curvature(&|at| local[at], &force, &mut |row, column, value| {
                curvature[row][column] += value / unit(row) / unit(column);
            });
            let step = 1e-5;
            for moved in 0..=angle {
                let [high, low] = [step, -step].map(|step| {
                    let mut values = values;
                    values[moved] += step;
                    at(&values)
                });
                for ((high, low), column) in high.0.iter().zip(low.0).zip(columns[moved]) {
                    let slope = (high - low) / (2.0 * step);
                    assert!((slope - column).abs() < 1e-9, "{dimension} {moved}: {slope} {column}");
                }
                for ((high, low), row) in high.1.iter().zip(&low.1).zip(&curvature).take(angle + 1) {
                    let (slope, found) = ((dot(high, &force) - dot(low, &force)) / (2.0 * step), row[moved]);
                    assert!((slope - found).abs() < 1e-9, "{dimension} {moved}: {slope} {found}");
                }
            }
        }
    }

    /// A node that moves with the obstacle stays where it is in the axes of the obstacle, however far both turn.
    #[test]
    fn a_node_that_turns_with_the_obstacle_does_not_move_in_its_axes() {
        let contact = NodeAtTurningObstacle::new(0, [1, 2], 2, [3.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        for angle in [1e-9, 0.5, 3.0, 40.0_f64] {
            let moved = [3.0 * (angle.cos() - 1.0) + 0.1, 3.0 * angle.sin() - 0.2];
            let values = [moved[0], moved[1], 0.1 / AUXILIARY_UNIT, -0.2 / AUXILIARY_UNIT, angle / AUXILIARY_UNIT, 0.0];
            let place = contact.place(&|at| values[at]);
            assert!(place.iter().all(|part| part.abs() < 2e-15), "{angle}: {place:?}");
        }
    }
}
