//! Solutions with one triangular factor for the sparse borders of a matrix, and their products with other vectors.
//!
//! A border of few entries reaches only the unknowns that are eliminated after its own and depend on them: eight borders
//! together are stored at the places that any of them reaches.

use crate::algebra::sparse::factors::entries::SparseEntries;
use crate::algebra::sparse::factors::substitutions::TOGETHER;
use crate::resources::budget::{self, Taken};
use nalgebra::DMatrix;
use pulp::{Arch, NullaryFnOnce};

/// Number of sums of one product that are formed at once: more would not fit into the registers.
const AT_ONCE: usize = 4;

/// The vectors, eight by eight.
pub(super) struct HalfSolutions {
    groups: Vec<Group>,
    count: usize,
    _held: Taken,
}

/// Up to eight vectors, with zeros for those that are missing.
struct Group {
    /// Places in the elimination order, ascending.
    places: Vec<usize>,
    values: Vec<[f64; TOGETHER]>,
}

impl Group {
    /// Solves for up to eight borders; `work` is zero before and after.
    fn new(
        borders: &[SparseEntries],
        work: &mut [[f64; TOGETHER]],
        place: &impl Fn(usize, f64) -> (usize, f64),
        solve: &impl Fn(&[usize], &mut [[f64; TOGETHER]]) -> Vec<usize>,
    ) -> Self {
        let mut starts = Vec::new();
        for (lane, entries) in borders.iter().enumerate() {
            for (unknown, value) in entries {
                let (place, value) = place(*unknown, *value);
                work[place][lane] += value;
                starts.push(place);
            }
        }
        let mut places = solve(&starts, work);
        places.retain(|place| work[*place] != [0.0; TOGETHER]);
        let values = places.iter().map(|place| std::mem::replace(&mut work[*place], [0.0; TOGETHER])).collect();
        Self { places, values }
    }
}

impl HalfSolutions {
    /// Solves by `solve` for borders that `place` puts into the elimination order and scales; `solve` takes the places of
    /// entries, returns those that it reaches, and changes no others. `work` is zero before and after.
    pub fn new(
        borders: &[SparseEntries],
        work: &mut [[f64; TOGETHER]],
        place: impl Fn(usize, f64) -> (usize, f64),
        solve: impl Fn(&[usize], &mut [[f64; TOGETHER]]) -> Vec<usize>,
    ) -> Self {
        let mut held = Taken::default();
        let mut group = |borders: &[SparseEntries]| {
            let group = Group::new(borders, work, &place, &solve);
            held.add::<[f64; TOGETHER + 1]>(group.places.len());
            group
        };
        let groups = borders.chunks(TOGETHER).map(&mut group).collect();
        Self { groups, count: borders.len(), _held: held }
    }

    /// Solves again for the group of one of the borders, of which this one has changed.
    pub fn renew(
        &mut self,
        borders: &[SparseEntries],
        changed: usize,
        size: usize,
        place: impl Fn(usize, f64) -> (usize, f64),
        solve: impl Fn(&[usize], &mut [[f64; TOGETHER]]) -> Vec<usize>,
    ) {
        let which = changed / TOGETHER;
        if let Some((own, borders)) = self.groups.get_mut(which).zip(borders.chunks(TOGETHER).nth(which)) {
            *own = Group::new(borders, &mut vec![[0.0; TOGETHER]; size], &place, &solve);
        }
    }

    /// The square root of `Σ value² weight(place)` of each vector.
    pub fn norms(&self, weight: impl Fn(usize) -> f64) -> Vec<f64> {
        let mut norms = Vec::with_capacity(self.groups.len() * TOGETHER);
        for group in &self.groups {
            let mut sums = [0.0; TOGETHER];
            for (place, values) in group.places.iter().zip(&group.values) {
                let weight = weight(*place);
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value * value * weight);
            }
            norms.extend(sums.map(f64::sqrt));
        }
        norms.truncate(self.count);
        norms
    }

    /// The products of each vector with `N` others, given at all places.
    pub fn products<const N: usize>(&self, others: &[[f64; N]]) -> Vec<[f64; N]> {
        let mut products = vec![[0.0; N]; self.groups.len() * TOGETHER];
        self.groups.iter().for_each(|group| budget::spend(group.places.len() * TOGETHER * N));
        Arch::new().dispatch(Products { groups: &self.groups, others, products: &mut products });
        products.truncate(self.count);
        products
    }

    /// The products of each vector, one row each, with each of `columns`, one column each, over `size` places.
    pub fn products_with(&self, columns: &Self, size: usize) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.count, columns.count);
        let mut first = 0;
        columns.each_group(size, |group| {
            for (row, products) in self.products(group).iter().enumerate() {
                for (column, product) in (first..columns.count).zip(products) {
                    all[(row, column)] = *product;
                }
            }
            first += TOGETHER;
        });
        all
    }

    /// Subtracts from `N` vectors at all places their multiples of these vectors.
    pub fn take<const N: usize>(&self, weights: &[[f64; N]], from: &mut [[f64; N]]) {
        self.groups.iter().for_each(|group| budget::spend(group.places.len() * TOGETHER * N));
        Arch::new().dispatch(Multiples { groups: &self.groups, weights, from });
    }

    /// Calls `each` with eight vectors after the other, at all places.
    pub fn each_group(&self, size: usize, mut each: impl FnMut(&[[f64; TOGETHER]])) {
        let mut values = vec![[0.0; TOGETHER]; size];
        for group in &self.groups {
            group.places.iter().zip(&group.values).for_each(|(place, own)| values[*place] = *own);
            each(&values);
            group.places.iter().for_each(|place| values[*place] = [0.0; TOGETHER]);
        }
    }
}

/// Sums by the widest instructions of the machine, which compute the same bits as any others, as no operations are
/// fused.
struct Products<'a, const N: usize> {
    groups: &'a [Group],
    others: &'a [[f64; N]],
    products: &'a mut [[f64; N]],
}

impl<const N: usize> NullaryFnOnce for Products<'_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (group, products) in self.groups.iter().zip(self.products.chunks_exact_mut(TOGETHER)) {
            for (part, products) in products.chunks_exact_mut(AT_ONCE).enumerate() {
                let mut sums = [[0.0; N]; AT_ONCE];
                for (place, values) in group.places.iter().zip(&group.values) {
                    let other = &self.others[*place];
                    for (sums, value) in sums.iter_mut().zip(&values[part * AT_ONCE..]) {
                        (0..N).for_each(|lane| sums[lane] += value * other[lane]);
                    }
                }
                products.copy_from_slice(&sums);
            }
        }
    }
}

struct Multiples<'a, const N: usize> {
    groups: &'a [Group],
    weights: &'a [[f64; N]],
    from: &'a mut [[f64; N]],
}

impl<const N: usize> NullaryFnOnce for Multiples<'_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (group, weights) in self.groups.iter().zip(self.weights.chunks(TOGETHER)) {
            for (place, values) in group.places.iter().zip(&group.values) {
                let from = &mut self.from[*place];
                for (weights, value) in weights.iter().zip(values) {
                    (0..N).for_each(|lane| from[lane] -= value * weights[lane]);
                }
            }
        }
    }
}
