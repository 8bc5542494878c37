//! Second derivatives of mortar contacts in space: of the integrals by the coordinates in the frames of the own triangles, and
//! of these by the places of the nodes.
//!
//! ```text
//! Σ_k r_k ∂B_k/∂u = r_n/A [∇²∫ χ (h - g) dA - ∇g ∇Aᵀ - ∇A ∇gᵀ] + 1/A [∂/∂u ∫ χ Σ_l c_l ∇β_l dA - b ∇Aᵀ + Σ_l b_l ∇c_lᵀ]
//! ```
//!
//! at a constant `g` under the first integral, with `c_l = Σ_α r_α t_α·y_l`, constant under the second, the tangential forces
//! `b` and their parts `b_l` by a unit value at one node. Where a face is covered in part, the share `s` of the dual function
//! in `χ` changes as well, which adds the products of its gradient with the derivatives by `s`.

use crate::mechanics::contact::bodies::covered_face::MetNodes;
use crate::mechanics::contact::bodies::space::covered_part::{CoveredPart, NodalMeans};
use crate::mechanics::contact::bodies::space::mortar::MortarNodeInSpace;
use crate::mechanics::contact::kinematics::LocalDisplacements;
use crate::mechanics::contact::vector::{Vector, add, dot, scaled};
use itertools::Itertools;
use smallvec::SmallVec;

/// Coordinates of the six corners of a covered part.
const OF_PART: usize = 18;
/// Coordinates of the three opposite corners in the frame of the own triangle.
const COORDINATES: usize = 9;

/// A square matrix over the degrees of freedom of the nodes that are met.
struct AssembledDerivatives {
    met: MetNodes,
    size: usize,
    values: Vec<f64>,
}

impl AssembledDerivatives {
    fn new(parts: &[CoveredPart<'_>], own: usize) -> Self {
        let mut met = MetNodes::default();
        (0..own).for_each(|node| {
            met.place(node);
        });
        for part in parts {
            let points = part.own.points.iter().chain(&part.opposite.points);
            points.flat_map(|point| point.shares()).for_each(|(node, _)| {
                met.place(node);
            });
        }
        let size = 3 * met.nodes.len();
        Self { met, size, values: vec![0.0; size * size] }
    }

    fn zeros(&self) -> Vec<f64> {
        vec![0.0; self.size]
    }

    /// Adds the product of a column and a row.
    fn add_product(&mut self, factor: f64, column: &[f64], row: &[f64]) {
        for (entries, left) in self.values.chunks_exact_mut(self.size).zip(column).filter(|(_, left)| **left != 0.0) {
            entries.iter_mut().zip(row).for_each(|(entry, right)| *entry += factor * left * right);
        }
    }

    /// Adds a matrix over the corners of a part.
    fn add_block(&mut self, part: &CoveredPart<'_>, factor: f64, matrix: &[[f64; OF_PART]; OF_PART]) {
        let points = part.own.points.iter().chain(&part.opposite.points).enumerate();
        let mut nodes: SmallVec<[(usize, usize, f64); 24]> = SmallVec::new();
        for (i, point) in points {
            nodes.extend(point.shares().map(|(node, share)| (3 * i, 3 * self.met.place(node), share)));
        }
        for (from, row, share) in &nodes {
            for k in 0..3 {
                let entries = &mut self.values[(row + k) * self.size..(row + k + 1) * self.size];
                let values = &matrix[from + k];
                for (at, column, other_share) in &nodes {
                    let weight = factor * share * other_share;
                    (0..3).for_each(|m| entries[column + m] += weight * values[at + m]);
                }
            }
        }
    }

    /// Adds a gradient by the corners of a part to one by the degrees of freedom.
    fn spread(&mut self, part: &CoveredPart<'_>, factor: f64, gradient: &[Vector; 6], row: &mut [f64]) {
        part.each_node(gradient, &mut |node, vector| {
            let at = 3 * self.met.place(node);
            (0..3).for_each(|k| row[at + k] += factor * vector[k]);
        });
    }
}

pub(super) fn each(
    node: &MortarNodeInSpace,
    displacement: LocalDisplacements<'_>,
    force: &Vector,
    add_entry: &mut dyn FnMut(usize, usize, f64),
) {
    let covered = node.covered(displacement);
    let parts = &covered.parts;
    let Some(means) = NodalMeans::new(parts) else { return };
    let mut local = AssembledDerivatives::new(parts, node.own());
    let tangents = node.tangents(displacement).tangents;
    let along = add(&scaled(&tangents[0], force[0]), force[1], &tangents[1]);
    let (inverse, of_slip) = (1.0 / means.area, 1.0 / means.slip_area);
    let from_mean =
        |part: &CoveredPart<'_>| part.opposite.points.map(|point| dot(&along, &add(&point.place, -1.0, &means.place)));
    let [mut by_gap, mut by_area] = [local.zeros(), local.zeros()];
    let [mut by_slip, mut by_slip_area] = [local.zeros(), local.zeros()];
    for part in parts {
        let (shifted, values) = (part.heights_from(means.gap), from_mean(part));
        if part.opposite.ends.contains(&true) {
            local.spread(part, 1.0, &part.gradient_of_area(), &mut by_area);
            local.spread(part, 1.0, &part.gradient_of_slip_area(), &mut by_slip_area);
        }
        local.spread(part, inverse * force[2], &part.gradient(&shifted), &mut by_gap);
        local.spread(part, of_slip, &part.at_points(&values), &mut by_slip);
        let heights = shifted.map(|height| force[2] * height);
        let values = values.map(|value| value * of_slip / inverse);
        of_part(part, (&heights, force[2]), &values, inverse, &mut local);
    }
    for (face, cover) in covered.faces.iter().enumerate().filter(|(_, cover)| cover.slopes != [0.0; 2]) {
        let [mut by_cover, mut gap_by_dual, mut slip_by_dual] = [local.zeros(), local.zeros(), local.zeros()];
        let changed = covered.by_dual(face, means.gap);
        let (mut area_by_dual, mut slip_area_by_dual) = (0.0, 0.0);
        for part in covered.of_face(face) {
            let (change, shifted) = (part.change_to_dual(), part.heights_from(means.gap));
            local.spread(part, 1.0, &part.plain().gradient_of_area(), &mut by_cover);
            local.spread(part, inverse * force[2], &change.gradient(&shifted), &mut gap_by_dual);
            local.spread(part, of_slip, &change.at_points(&from_mean(part)), &mut slip_by_dual);
            area_by_dual += change.integral(&[1.0; 3]);
            slip_area_by_dual += change.slip_area();
            let factor = inverse * force[2] * changed * cover.slopes[0];
            if part.opposite.ends.contains(&true) && factor != 0.0 {
                of_area(&part.plain(), factor, &mut local);
            }
        }
        let gap_factor = inverse * force[2] * changed;
        local.add_product(gap_factor * cover.slopes[1], &by_cover, &by_cover);
        local.add_product(cover.slopes[0], &gap_by_dual, &by_cover);
        local.add_product(cover.slopes[0], &by_cover, &gap_by_dual);
        local.add_product(cover.slopes[0], &slip_by_dual, &by_cover);
        for (at, value) in by_cover.iter().enumerate() {
            by_gap[at] += gap_factor * cover.slopes[0] * value;
            by_area[at] += area_by_dual * cover.slopes[0] * value;
            by_slip_area[at] += slip_area_by_dual * cover.slopes[0] * value;
        }
    }
    // Faces that are covered as a whole have areas that do not change.
    let changes = |area: &[f64]| area.iter().any(|value| *value != 0.0);
    if changes(&by_area) {
        local.add_product(-inverse, &by_gap, &by_area);
        local.add_product(-inverse, &by_area, &by_gap);
    }
    if changes(&by_slip_area) {
        local.add_product(-of_slip, &by_slip, &by_slip_area);
    }
    if force[0] != 0.0 || force[1] != 0.0 {
        by_places(parts, &means, &along, &mut local);
        by_tangents(node, displacement, (parts, &means), force, &mut local);
    }
    let freedom = |at: usize| 3 * local.met.nodes[at / 3] + at % 3;
    for (row, values) in local.values.chunks_exact(local.size.max(1)).enumerate() {
        for (column, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            add_entry(freedom(row), freedom(column), *value);
        }
    }
}

/// The derivatives of the forces of a part: of the gap with `heights` of which each coordinate has the share `by_height`,
/// and of the motion with `values` at the opposite corners.
fn of_part(
    part: &CoveredPart<'_>,
    (heights, by_height): (&[f64; 3], f64),
    values: &[f64; 3],
    factor: f64,
    local: &mut AssembledDerivatives,
) {
    let inner = by_coordinates(part, (heights, by_height), values);
    let along = part.weights_at_points(values);
    let across = part.weights_of_gap(heights);
    let weights = std::array::from_fn(|l| {
        // The share of the height in the gap carries the force, too.
        let by_height = part.scale * by_height * part.overlap.moments[l];
        [along[l][0] + across[l][0], along[l][1] + across[l][1], by_height]
    });
    by_corners(part, &inner, &weights, factor, local);
}

/// The second derivatives of `∫ φ dA` over a part.
fn of_area(part: &CoveredPart<'_>, factor: f64, local: &mut AssembledDerivatives) {
    let in_plane = part.overlap.second_derivatives(&[1.0; 3], &part.opposite.ends, false);
    let mut inner = [[0.0; COORDINATES]; COORDINATES];
    for (row, column) in (0..6).cartesian_product(0..6) {
        inner[3 * (row / 2) + row % 2][3 * (column / 2) + column % 2] = part.scale * in_plane[row][column];
    }
    let mut weights = part.weights_of_gap(&[1.0; 3]);
    weights.iter_mut().for_each(|weights| weights[2] = 0.0);
    by_corners(part, &inner, &weights, factor, local);
}

/// Adds second derivatives by the places of the corners, from those by the coordinates of the opposite ones, and the slopes by
/// these.
fn by_corners(
    part: &CoveredPart<'_>,
    inner: &[[f64; COORDINATES]; COORDINATES],
    slopes: &[[f64; 3]; 3],
    factor: f64,
    local: &mut AssembledDerivatives,
) {
    let mut matrix = [[0.0; OF_PART]; OF_PART];
    let rows = jacobian(part);
    let mut half = [[0.0; OF_PART]; COORDINATES];
    for (first, second) in (0..COORDINATES).cartesian_product(0..COORDINATES) {
        if inner[first][second] != 0.0 {
            (0..OF_PART).for_each(|column| half[first][column] += inner[first][second] * rows[second][column]);
        }
    }
    for (which, row) in rows.iter().enumerate() {
        for (at, left) in row.iter().enumerate().filter(|(_, left)| **left != 0.0) {
            (0..OF_PART).for_each(|column| matrix[at][column] += left * half[which][column]);
        }
    }
    for (l, weights) in slopes.iter().enumerate() {
        let hessian = part.frame.second_derivatives(&part.projected[l], weights);
        // The vectors from the first corner to the opposite one, and to the other own corners.
        let ends = [3 + l, 1, 2];
        for (row, column) in (0..9).cartesian_product(0..9) {
            let value = hessian[row][column];
            for (at, sign) in [(ends[row / 3], 1.0), (0, -1.0)] {
                for (other, other_sign) in [(ends[column / 3], 1.0), (0, -1.0)] {
                    matrix[3 * at + row % 3][3 * other + column % 3] += sign * other_sign * value;
                }
            }
        }
    }
    local.add_block(part, factor, &matrix);
}

/// The gradients of the coordinates of the opposite corners by the places of all corners.
fn jacobian(part: &CoveredPart<'_>) -> [[f64; OF_PART]; COORDINATES] {
    let mut rows = [[0.0; OF_PART]; COORDINATES];
    for (which, row) in rows.iter_mut().enumerate() {
        let (l, coordinate) = (which / 3, which % 3);
        let mut weights = [0.0; 3];
        weights[coordinate] = 1.0;
        let gradient = part.frame.gradient(&part.projected[l], &weights);
        for (at, vector) in [0, 1, 2, 3 + l].into_iter().zip(gradient) {
            (0..3).for_each(|k| row[3 * at + k] = vector[k]);
        }
    }
    rows
}

/// The derivatives by the coordinates of the opposite corners: two in the plane of the own triangle, the height.
fn by_coordinates(
    part: &CoveredPart<'_>,
    (heights, by_height): (&[f64; 3], f64),
    values: &[f64; 3],
) -> [[f64; COORDINATES]; COORDINATES] {
    let ends = &part.opposite.ends;
    let of_gap = part.overlap.second_derivatives(heights, ends, false);
    let of_slip = part.slip.second_derivatives(values, ends, true);
    let mut matrix = [[0.0; COORDINATES]; COORDINATES];
    for (row, column) in (0..6).cartesian_product(0..6) {
        let at = |which: usize| 3 * (which / 2) + which % 2;
        matrix[at(row)][at(column)] = part.scale * (of_gap[row][column] + of_slip[row][column]);
    }
    if by_height != 0.0 {
        let at_ends = part.overlap.changes_at_ends(ends);
        for (m, l, a) in itertools::iproduct!(0..3, 0..3, 0..2) {
            let inner = -part.overlap.moments[m] * part.overlap.slopes[l][a];
            let value = part.scale * by_height * (inner + at_ends[l][m][a]);
            matrix[3 * m + a][3 * l + 2] += value;
            matrix[3 * l + 2][3 * m + a] += value;
        }
    }
    matrix
}

/// The change of the places along the tangents with the opposite nodes: the rate of each node's share times a force along
/// the tangents.
fn by_places(parts: &[CoveredPart<'_>], means: &NodalMeans, along: &Vector, local: &mut AssembledDerivatives) {
    let count = local.met.nodes.len();
    let mut gradients = vec![Vec::new(); count];
    for part in parts {
        // A unit value at each corner, shared among its nodes.
        for (l, point) in part.opposite.points.iter().enumerate() {
            let mut values = [0.0; 3];
            values[l] = 1.0;
            let gradient = part.at_points(&values);
            for (node, share) in point.shares() {
                let at = local.met.place(node);
                gradients[at].resize(local.size, 0.0);
                local.spread(part, share / means.slip_area, &gradient, &mut gradients[at]);
            }
        }
    }
    for (at, gradient) in gradients.iter().enumerate().filter(|(_, gradient)| !gradient.is_empty()) {
        for (entries, part) in local.values.chunks_exact_mut(local.size).zip(gradient) {
            (0..3).for_each(|k| entries[3 * at + k] += part * along[k]);
        }
    }
}

/// The change of the places along the tangents with these: `Σ_l y_l ∇m_l` times the change of a force along them.
fn by_tangents(
    node: &MortarNodeInSpace,
    displacement: LocalDisplacements<'_>,
    (parts, means): (&[CoveredPart<'_>], &NodalMeans),
    force: &Vector,
    local: &mut AssembledDerivatives,
) {
    let mut changes = [local.zeros(), local.zeros(), local.zeros()];
    node.each_change_of_tangents(displacement, &mut |freedom, [first, second]| {
        let at = 3 * local.met.place(freedom / 3) + freedom % 3;
        (0..3).for_each(|k| changes[k][at] += force[0] * first[k] + force[1] * second[k]);
    });
    for (k, change) in changes.iter().enumerate() {
        let mut moved = local.zeros();
        for part in parts {
            let values = part.opposite.points.map(|point| point.place[k] - means.place[k]);
            local.spread(part, 1.0 / means.slip_area, &part.at_points(&values), &mut moved);
        }
        local.add_product(1.0, &moved, change);
    }
}
