//! One node constrained by border rows.

use nalgebra::Vector3;

/// A constrained node. Its small matrices are stored in a common array of all nodes, so that many nodes take little
/// memory.
pub(crate) struct HeldNode {
    pub(crate) unknowns: [u32; 3],
    pub(crate) rows: [u32; 3],
    pub(crate) columns: [u32; 3],
    pub(crate) count: u8,
    pub(crate) held: u8,
    /// Whether `Q` is not the identity.
    pub(crate) turns: bool,
    /// Whether friction is eliminated into the unconstrained equations.
    pub(crate) folds: bool,
    /// Whether the reactions remain borders.
    pub keeps: bool,
    /// Sign of the eliminated factor of the determinant, without the sign of the permutation.
    pub(crate) sign: i8,
    /// Index of the node's first number in the common array.
    pub(crate) numbers: u32,
    /// Number of constrained unknowns of the preceding nodes.
    pub(crate) before: u32,
}

/// An entry `d` of a constraint row, in the column of another border.
pub(crate) struct Coupling {
    /// Index of the node, and of the row among the node's rows.
    pub node: usize,
    pub row: usize,
    pub border: usize,
    pub value: f64,
}

/// The small matrices of a node, by columns.
#[derive(Clone, Copy)]
pub(crate) struct Matrices<'a> {
    /// `M⁻¹`
    pub constraint: &'a [f64],
    /// `R⁻¹`
    pub reaction: &'a [f64],
    /// `F R⁻¹`, where friction is eliminated.
    pub friction: &'a [f64],
    /// `Q`, where it is not the identity.
    pub rotation: &'a [f64],
}

/// `A x` with a matrix by columns.
pub(crate) fn times(matrix: &[f64], rows: usize, x: &Vector3<f64>) -> Vector3<f64> {
    let mut product = Vector3::zeros();
    for (column, factor) in matrix.chunks_exact(rows.max(1)).zip(x.iter()) {
        column.iter().zip(product.iter_mut()).for_each(|(value, sum)| *sum += value * factor);
    }
    product
}

/// `Aᵀ x` with a matrix by columns.
pub(crate) fn transposed_times(matrix: &[f64], rows: usize, x: &Vector3<f64>) -> Vector3<f64> {
    let mut product = Vector3::zeros();
    for (column, sum) in matrix.chunks_exact(rows.max(1)).zip(product.iter_mut()) {
        *sum = column.iter().zip(x.iter()).map(|(value, factor)| value * factor).sum();
    }
    product
}

impl HeldNode {
    pub(crate) fn count(&self) -> usize {
        usize::from(self.count)
    }

    /// Number of constrained unknowns among the rotated unknowns.
    pub(crate) fn held_count(&self) -> usize {
        usize::from(self.held)
    }

    pub fn sign(&self) -> f64 {
        f64::from(self.sign)
    }

    pub(crate) fn matrices<'a>(&self, numbers: &'a [f64]) -> Matrices<'a> {
        let (count, held) = (self.count(), self.held_count());
        let (constraint, rest) = numbers[self.numbers as usize..].split_at(held * held);
        let (reaction, rest) = rest.split_at(held * held);
        let (friction, rest) = rest.split_at(if self.folds { (count - held) * held } else { 0 });
        let rotation = &rest[..if self.turns { count * count } else { 0 }];
        Matrices { constraint, reaction, friction, rotation }
    }

    pub(crate) fn unknown(&self, local: usize) -> usize {
        self.unknowns[local] as usize
    }

    pub(crate) fn unknowns(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.unknowns[..self.count()].iter().map(|unknown| *unknown as usize)
    }

    /// The constrained unknowns among the rotated unknowns.
    pub fn held(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.unknowns[..self.held_count()].iter().map(|unknown| *unknown as usize)
    }

    pub fn rows(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.rows[..self.held_count()].iter().map(|row| *row as usize)
    }

    pub fn columns(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.columns[..self.held_count()].iter().map(|column| *column as usize)
    }

    /// Applies `Qᵀ`, or `Q` if `back`, to the node's part of a vector.
    pub(crate) fn turn(&self, numbers: &[f64], x: &mut [f64], back: bool) {
        let here = gathered(self.unknowns(), x);
        let (rotation, count) = (self.matrices(numbers).rotation, self.count());
        let turned = if back { times(rotation, count, &here) } else { transposed_times(rotation, count, &here) };
        self.unknowns().zip(turned.iter()).for_each(|(unknown, value)| x[unknown] = *value);
    }
}

/// The values at up to three places, padded with zeros.
pub(crate) fn gathered(places: impl Iterator<Item = usize>, values: &[f64]) -> Vector3<f64> {
    let mut gathered = Vector3::zeros();
    places.zip(gathered.iter_mut()).for_each(|(place, value)| *value = values[place]);
    gathered
}
