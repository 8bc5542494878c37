//! One node that border rows hold.

use nalgebra::Vector3;

/// One node. Its small matrices are among the numbers of all nodes, so that many nodes take little memory.
pub(crate) struct HeldNode {
    pub(crate) unknowns: [u32; 3],
    pub(crate) rows: [u32; 3],
    pub(crate) columns: [u32; 3],
    pub(crate) count: u8,
    pub(crate) held: u8,
    /// Whether `Q` is not the identity.
    pub(crate) turns: bool,
    /// Whether friction is folded.
    pub(crate) folds: bool,
    /// Its reactions stay borders.
    pub keeps: bool,
    /// Sign of the part of the determinant that is eliminated, its place apart.
    pub(crate) sign: i8,
    /// Where its numbers begin.
    pub(crate) numbers: u32,
    /// Held unknowns of the nodes before it.
    pub(crate) before: u32,
}

/// An entry `d` of a held row: another border's.
pub(crate) struct Coupling {
    /// Which of the nodes, and which of its rows.
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
    /// `F R⁻¹`; where it is folded.
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

    /// So many of the rotated unknowns are held.
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

    /// Its rotated unknowns that are held.
    pub fn held(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.unknowns[..self.held_count()].iter().map(|unknown| *unknown as usize)
    }

    pub fn rows(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.rows[..self.held_count()].iter().map(|row| *row as usize)
    }

    pub fn columns(&self) -> impl ExactSizeIterator<Item = usize> + '_ {
        self.columns[..self.held_count()].iter().map(|column| *column as usize)
    }

    /// `Qᵀ x` or `Q x` of its part of a vector.
    pub(crate) fn turn(&self, numbers: &[f64], x: &mut [f64], back: bool) {
        let here = gathered(self.unknowns(), x);
        let (rotation, count) = (self.matrices(numbers).rotation, self.count());
        let turned = if back { times(rotation, count, &here) } else { transposed_times(rotation, count, &here) };
        self.unknowns().zip(turned.iter()).for_each(|(unknown, value)| x[unknown] = *value);
    }
}

/// Values at up to three places, zero after them.
pub(crate) fn gathered(places: impl Iterator<Item = usize>, values: &[f64]) -> Vector3<f64> {
    let mut gathered = Vector3::zeros();
    places.zip(gathered.iter_mut()).for_each(|(place, value)| *value = values[place]);
    gathered
}
