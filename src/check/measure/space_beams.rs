//! Forces, moments and strain energy of the posted beams in space, for the measure only.
//!
//! A stretch of beam between two nodes has the curvature `φ/h`, `φ` the rotation vector from one end's cross-section to
//! the other's, and the force in it is the same everywhere. In the axes halfway, with the deformed chord `c`,
//!
//! ```text
//! W = ½ r·P⁻¹ r - h/24 y·B⁻¹ y + ½ (φ - φ_0)·B (φ - φ_0)/h,    B = diag(GJ, EI_1, EI_2)
//! r = c - h ∫ v dη - h/12 Xᵀ B⁻¹ y,    v = exp(ηφ) e,    -½ <= η <= ½
//! P = h ∫ (1/GA) I + (1/EA - 1/GA) v vᵀ dη + h/12 Xᵀ B⁻¹ X,    X f = c × f,    y = φ × B (φ - φ_0)/h
//! ```
//!
//! The integrals are taken numerically. The derivatives by the relative displacement and by the spins of both ends, which
//! are the force and the moments, are carried along.

use crate::check::measure::beams::{BeamResponse, NodeShare, ROUNDINGS, integral_of};
use crate::check::measure::numbers::DualNumber;
use crate::check::measure::numbers::{MeasuredVector, largest, padded};
use crate::model::request::{BendingStiffness, Element as Posted, Model};
use nalgebra::{Quaternion, Rotation3, UnitQuaternion};

/// A number with its derivatives by the relative displacement and the spins of both ends.
type MotionDual = DualNumber<9>;
type MotionDualVector = [MotionDual; 3];

/// A beam with its nodes numbered.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeasuredSpaceBeam {
    /// As many as there are segments, and one more.
    nodes: [usize; 3],
    segments: [Option<SpaceStretch>; 2],
}

#[derive(Debug, Clone, Copy)]
struct SpaceStretch {
    /// Along the chord, axis 1 and axis 2 halfway.
    axes: [MeasuredVector; 3],
    chord: f64,
    /// `h`
    length: f64,
    /// `φ_0`, in `axes`.
    turn: MeasuredVector,
    axial: f64,
    /// `1/GA`
    shear_flexibility: f64,
    /// The diagonal of `B`.
    rigidity: [f64; 3],
}

/// The angle of the rotation between two rotation vectors.
pub(super) fn angle_between(before: &MeasuredVector, after: &MeasuredVector) -> f64 {
    let between = half_turned(after) * half_turned(before).conjugate();
    2.0 * between.imag().norm().atan2(between.w.abs())
}

/// The moment along the components of the rotation vector `θ`: its work per change of each.
pub(super) fn along_components(rotation: &MeasuredVector, moment: &MeasuredVector) -> MeasuredVector {
    let angle = rotation.norm();
    let (first, second) = if angle < 1e-4 {
        (0.5 - angle * angle / 24.0, 1.0 / 6.0 - angle * angle / 120.0)
    } else {
        (2.0 * (0.5 * angle).sin().powi(2) / angle.powi(2), (angle - angle.sin()) / angle.powi(3))
    };
    let across = rotation.cross(moment);
    moment - across * first + rotation.cross(&across) * second
}

/// The quaternion of a rotation vector.
fn half_turned(rotation: &MeasuredVector) -> Quaternion<f64> {
    let angle = rotation.norm();
    let factor = if angle < 1e-8 { 0.5 } else { (0.5 * angle).sin() / angle };
    Quaternion::from_parts((0.5 * angle).cos(), rotation * factor)
}

fn constant(vector: &MeasuredVector) -> MotionDualVector {
    [vector.x, vector.y, vector.z].map(MotionDual::constant)
}

fn dot(a: &MotionDualVector, b: &MotionDualVector) -> MotionDual {
    a[0].by(b[0]).plus(a[1].by(b[1])).plus(a[2].by(b[2]))
}

fn cross(a: &MotionDualVector, b: &MotionDualVector) -> MotionDualVector {
    [(1, 2), (2, 0), (0, 1)].map(|(k, l)| a[k].by(b[l]).minus(a[l].by(b[k])))
}

fn sum(a: &MotionDualVector, b: &MotionDualVector) -> MotionDualVector {
    std::array::from_fn(|k| a[k].plus(b[k]))
}

fn scaled(factor: MotionDual, a: &MotionDualVector) -> MotionDualVector {
    a.map(|part| part.by(factor))
}

fn root(a: MotionDual) -> MotionDual {
    let value = a.0.sqrt();
    a.map(value, 0.5 / value)
}

/// `sin √x / √x`
fn sine_of_root(x: MotionDual) -> MotionDual {
    let value = x.0;
    if value < 1e-2 {
        let of = |a: f64, b: f64, c: f64, d: f64, e: f64| a + value * (b + value * (c + value * (d + value * e)));
        let slope = of(-1.0 / 6.0, 1.0 / 60.0, -1.0 / 1_680.0, 1.0 / 90_720.0, -1.0 / 7_983_360.0);
        return x.map(of(1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5_040.0, 1.0 / 362_880.0), slope);
    }
    let root = value.sqrt();
    let sine = root.sin() / root;
    x.map(sine, (root.cos() - sine) / (2.0 * value))
}

/// A product of quaternions, each a number and a vector.
fn product(
    (a, u): &(MotionDual, MotionDualVector),
    (b, v): &(MotionDual, MotionDualVector),
) -> (MotionDual, MotionDualVector) {
    (a.by(*b).minus(dot(u, v)), sum(&sum(&scaled(*a, v), &scaled(*b, u)), &cross(u, v)))
}

fn constant_turn(quaternion: &Quaternion<f64>) -> (MotionDual, MotionDualVector) {
    (MotionDual::constant(quaternion.w), constant(&quaternion.imag()))
}

impl SpaceStretch {
    /// The excess of the deformed chord over the undeformed one, and `φ`, in the axes halfway.
    fn strains(&self, relative: &MeasuredVector, ends: [Quaternion<f64>; 2]) -> (MotionDualVector, MotionDualVector) {
        // A spin `w` changes the quaternion by `½ w q`.
        let carried = [0, 1].map(|end| {
            let mut own = constant_turn(&ends[end]);
            for k in 0..3 {
                let mut spin = MeasuredVector::zeros();
                spin[k] = 0.5;
                let change = Quaternion::from_parts(0.0, spin) * ends[end];
                own.0.1[3 + 3 * end + k] = change.w;
                (0..3).for_each(|l| own.1[l].1[3 + 3 * end + k] = change.imag()[l]);
            }
            own
        });
        let relative: MotionDualVector = std::array::from_fn(|k| MotionDual::variable(relative[k], k));
        let half = half_turned(&(self.turn * 0.5));
        let in_axes = |vector: &MotionDualVector| self.axes.map(|axis| dot(&constant(&axis), vector));
        let back = (carried[0].0, carried[0].1.map(|part| part.times(-1.0)));
        let (real, vector) = product(&back, &carried[1]);
        let half_turn = constant_turn(&half);
        let (real, vector) = product(&product(&half_turn, &(real, in_axes(&vector))), &half_turn);
        let global = self.axes[0] * half.i + self.axes[1] * half.j + self.axes[2] * half.k;
        let forward = product(&carried[0], &constant_turn(&Quaternion::from_parts(half.w, -global)));
        let backward = product(&carried[1], &constant_turn(&Quaternion::from_parts(half.w, global)));
        let (w, v) = (forward.0.plus(backward.0), sum(&forward.1, &backward.1));
        // The rotation halfway turned back, less the identity, of the deformed chord.
        let undeformed = constant(&(self.axes[0] * self.chord));
        let chord = sum(&relative, &undeformed);
        let across = cross(&v, &chord);
        let twice = MotionDual::constant(2.0).over(w.by(w).plus(dot(&v, &v)));
        let turned = scaled(twice, &sum(&scaled(w.times(-1.0), &across), &cross(&v, &across)));
        (in_axes(&sum(&relative, &turned)), Self::vector_of(real, &vector))
    }

    fn vector_of(real: MotionDual, vector: &MotionDualVector) -> MotionDualVector {
        let squared = dot(vector, vector);
        if squared.0 < 1e-4 && real.0 > 0.0 {
            let s = squared.0;
            let value = 2.0 + s * (1.0 / 3.0 + s * (3.0 / 20.0 + s * (5.0 / 56.0 + s * 35.0 / 576.0)));
            let slope = 1.0 / 3.0 + s * (3.0 / 10.0 + s * (15.0 / 56.0 + s * 35.0 / 144.0));
            return scaled(squared.map(value, slope), vector);
        }
        let size = root(squared);
        scaled(real.angle(size).times(2.0).over(size), vector)
    }

    /// `W`
    fn energy(&self, excess: &MotionDualVector, turn: &MotionDualVector) -> MotionDual {
        let (h, zero) = (self.length, MotionDual::constant(0.0));
        let along = constant(&MeasuredVector::x());
        let (b, squared) = (cross(turn, &along), dot(turn, turn));
        let q = cross(turn, &b);
        let chord = [excess[0].plus(MotionDual::constant(self.chord)), excess[1], excess[2]];
        let size = root(dot(&chord, &chord));
        let first = scaled(MotionDual::constant(1.0).over(size), &chord);
        let beside = if chord[1].0.abs() < chord[2].0.abs() { MeasuredVector::y() } else { MeasuredVector::z() };
        let second = cross(&first, &constant(&beside));
        let second = scaled(MotionDual::constant(1.0).over(root(dot(&second, &second))), &second);
        let basis = [first, second, cross(&first, &second)];
        // `∫ v - e dη` and `∫ v vᵀ dη`, in the basis.
        let (mut bent, mut squares) = ([zero; 3], [[zero; 3]; 3]);
        integral_of(|t, weight| {
            let along_beam = t - 0.5;
            let s1 = sine_of_root(squared.times(along_beam * along_beam)).times(along_beam);
            let half = sine_of_root(squared.times(0.25 * along_beam * along_beam)).times(along_beam);
            let beyond = sum(&scaled(s1, &b), &scaled(half.by(half).times(0.5), &q));
            let v = sum(&along, &beyond);
            let parts = basis.map(|axis| dot(&axis, &v));
            for row in 0..3 {
                bent[row] = bent[row].plus(beyond[row].times(weight));
                for column in 0..3 {
                    squares[row][column] = squares[row][column].plus(parts[row].by(parts[column]).times(weight));
                }
            }
        });
        let own_change: MotionDualVector = std::array::from_fn(|k| turn[k].minus(MotionDual::constant(self.turn[k])));
        let moment: MotionDualVector = std::array::from_fn(|k| own_change[k].times(self.rigidity[k] / h));
        let soft = |vector: &MotionDualVector| -> MotionDualVector {
            std::array::from_fn(|k| vector[k].times(self.rigidity[k].recip()))
        };
        let y = cross(turn, &moment);
        let levers = basis.map(|axis| cross(&chord, &axis));
        let error: MotionDualVector = std::array::from_fn(|k| {
            let whole = excess[k].minus(bent[k].times(h));
            if k == 0 { whole.plus(MotionDual::constant(self.chord - h)) } else { whole }
        });
        let (axial, shear) = (self.axial.recip(), self.shear_flexibility);
        let mut rows = [[zero; 4]; 3];
        for row in 0..3 {
            for column in 0..3 {
                let identity = if row == column { shear * h } else { 0.0 };
                // The lever of a force along the chord is zero.
                let of_lever = if row == 0 || column == 0 {
                    zero
                } else {
                    dot(&levers[row], &soft(&levers[column])).times(h / 12.0)
                };
                rows[row][column] =
                    squares[row][column].times((axial - shear) * h).plus(of_lever).plus(MotionDual::constant(identity));
            }
            let of_twist = if row == 0 { zero } else { dot(&levers[row], &soft(&y)).times(h / 12.0) };
            rows[row][3] = dot(&basis[row], &error).minus(of_twist);
        }
        let mut energy = dot(&own_change, &moment).times(0.5).minus(dot(&y, &soft(&y)).times(h / 24.0));
        // Elimination from the last row, so that what is small along the chord is left for the end.
        for pivot in (0..3).rev() {
            let of_pivot = rows[pivot];
            energy = energy.plus(of_pivot[3].by(of_pivot[3]).over(of_pivot[pivot]).times(0.5));
            for row in rows.iter_mut().take(pivot) {
                let factor = row[pivot].over(of_pivot[pivot]);
                (0..4).for_each(|column| row[column] = row[column].minus(factor.by(of_pivot[column])));
            }
        }
        energy
    }

    /// Axes of the undeformed cross-section at an end.
    fn frame(&self, end: usize) -> [MeasuredVector; 3] {
        let [t, first, second] = self.axes;
        let global = t * self.turn.x + first * self.turn.y + second * self.turn.z;
        let turned = Rotation3::new(global * if end == 0 { -0.5 } else { 0.5 });
        self.axes.map(|axis| turned * axis)
    }
}

impl MeasuredSpaceBeam {
    /// `None` if a node is unknown, or what a beam in space has is missing.
    pub fn new(model: &Model, posted: &Posted) -> Option<Self> {
        let Posted::Beam { nodes, axial_stiffness, bending_stiffness, torsional_stiffness, orientation, .. } = posted
        else {
            return None;
        };
        let Posted::Beam { shear_stiffness, .. } = posted else { return None };
        let BendingStiffness::Space([one, two]) = *bending_stiffness else { return None };
        let rigidity = [(*torsional_stiffness)?, one, two];
        let mut numbers = [0; 3];
        for (number, name) in numbers.iter_mut().zip(nodes) {
            *number = model.nodes.get_index_of(name)?;
        }
        let places = nodes.iter().map(|node| model.nodes.get(node)).collect::<Option<Vec<_>>>()?;
        let chords: Vec<MeasuredVector> = places.windows(2).map(|pair| padded(pair[1]) - padded(pair[0])).collect();
        let orientation = padded(orientation.as_ref()?);
        let first = *chords.first()?;
        let stretch = |chord: MeasuredVector, axis: MeasuredVector, turn: MeasuredVector| {
            let size = chord.norm();
            let t = chord / size;
            let axes = [t, axis, t.cross(&axis)];
            let half = 0.5 * turn.norm();
            let length = if half > 0.0 { size * half / half.sin() } else { size };
            let turn = MeasuredVector::from(axes.map(|axis| axis.dot(&turn)));
            SpaceStretch {
                axes,
                chord: size,
                length,
                turn,
                axial: *axial_stiffness,
                shear_flexibility: shear_stiffness.map_or(0.0, f64::recip),
                rigidity,
            }
        };
        let axis = |tangent: MeasuredVector| {
            let tangent = tangent.normalize();
            (orientation - tangent * orientation.dot(&tangent)).normalize()
        };
        let segments = match chords.get(1).copied() {
            None => [Some(stretch(first, axis(first), MeasuredVector::zeros())), None],
            Some(second) => {
                // The angles at the circumference over both chords: half the arcs' own.
                let across = first + second;
                let angle = |from: &MeasuredVector, to: &MeasuredVector| from.cross(to).norm().atan2(from.dot(to));
                let halves = [angle(&across, &second), angle(&first, &across)];
                let normal = first.cross(&second).try_normalize(0.0).unwrap_or_default();
                let axis = axis(Rotation3::new(normal * halves[0]) * first);
                let arc = |chord: MeasuredVector, half: f64, turned: f64| {
                    stretch(chord, Rotation3::new(normal * turned) * axis, normal * (2.0 * half))
                };
                [Some(arc(first, halves[0], -halves[0])), Some(arc(second, halves[1], halves[1]))]
            }
        };
        Some(Self { nodes: numbers, segments })
    }

    /// Approximately the largest stiffness in any direction.
    pub fn stiffness(&self) -> f64 {
        self.segments.iter().flatten().map(|segment| segment.axial / segment.length).fold(0.0, f64::max)
    }

    /// The response to the given displacements and rotation vectors of the nodes.
    pub fn response(&self, u: &[MeasuredVector], rotations: &[MeasuredVector]) -> BeamResponse {
        let last = self.segments.iter().flatten().count();
        let mut response = BeamResponse { of_end: 6, ..BeamResponse::default() };
        for (share, node) in response.nodes.iter_mut().zip(self.nodes).take(last + 1) {
            *share = Some(NodeShare { node, ..NodeShare::default() });
        }
        for (place, segment) in self.segments.iter().flatten().enumerate() {
            let nodes = [self.nodes[place], self.nodes[place + 1]];
            let turned = nodes.map(|node| half_turned(&rotations[node]));
            let (excess, turn) = segment.strains(&(u[nodes[1]] - u[nodes[0]]), turned);
            let energy = segment.energy(&excess, &turn);
            response.energy += energy.0;
            let vector = |first: usize| MeasuredVector::new(energy.1[first], energy.1[first + 1], energy.1[first + 2]);
            let force = vector(0);
            let (by_force, by_moment) = segment.rounding(nodes.map(|node| (u[node], rotations[node])));
            for (end, sign) in [(0, -1.0), (1, 1.0)] {
                let moment = vector(3 + 3 * end);
                if let Some(share) = &mut response.nodes[place + end] {
                    share.force += force * sign;
                    share.moment += moment;
                    share.force_rounding += by_force;
                    share.moment_rounding += by_moment;
                }
                if place + end == if end == 0 { 0 } else { last } {
                    let rotation = UnitQuaternion::new_normalize(turned[end]);
                    let axes = segment.frame(end).map(|axis| rotation * axis);
                    let along = |vector: &MeasuredVector, sign: f64| axes.map(|axis| sign * axis.dot(vector));
                    response.ends[end][..3].copy_from_slice(&along(&force, 1.0));
                    response.ends[end][3..].copy_from_slice(&along(&moment, sign));
                }
            }
        }
        response
    }
}

impl SpaceStretch {
    /// Rounding errors of the force and of the moments: those of the strains times the stiffness against each.
    fn rounding(&self, ends: [(MeasuredVector, MeasuredVector); 2]) -> (f64, f64) {
        let most = self.rigidity.iter().fold(0.0_f64, |most, value| most.max(*value));
        let (h, lateral) = (self.length, 12.0 * most / self.length.powi(3));
        let moved = ends.iter().fold(0.0_f64, |moved, (u, _)| moved.max(largest(u)));
        let turned = ends.iter().fold(0.0_f64, |turned, (_, rotation)| turned.max(rotation.norm()));
        let of_length = ROUNDINGS * f64::EPSILON * moved.max(h * turned.max(self.turn.norm()));
        let of_turn = ROUNDINGS * f64::EPSILON * turned;
        let by_force = of_length * (self.axial / h + lateral) + of_turn * lateral * h;
        (by_force, by_force * h + of_turn * most / h)
    }
}
