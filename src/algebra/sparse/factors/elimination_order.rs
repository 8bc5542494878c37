//! The elimination order, and the size and work of a factorisation in this order, before memory of that size is
//! allocated.
//!
//! The order is the approximate minimum degree order of P. R. Amestoy, T. A. Davis, I. S. Duff, SIAM J. Matrix Anal.
//! Appl. 17 (1996) 886, doi:10.1137/S0895479894278952, or one by [nested dissection](super::nested_dissection) where
//! that takes less work, as in large solids in space. The number of entries of each column of the factor follows from
//! the elimination tree, in memory proportional to the matrix and almost linear time (J. R. Gilbert, E. G. Ng, B. W.
//! Peyton, SIAM J. Matrix Anal. Appl. 15 (1994) 1075, doi:10.1137/S0895479892236921): a graph without small separators
//! may fill its factor almost completely.

use crate::algebra::sparse::factors::nested_dissection;
use crate::resources::budget::{self, Breach};
use faer::Side;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::{SupernodalThreshold, amd};

const NONE: usize = usize::MAX;

/// Largest number of multiplications of a factorisation in one piece: about a tenth of a second.
const MOST_AT_ONCE: u64 = 200_000_000;

/// From this number of multiplications per entry of the factor on, separators are sought: a block of 12 by 12 by 40
/// nodes has 391 and 1.7 times the work of nested dissection, a plane of 980,000 unknowns 228 and 0.8 times, a slab of
/// 60 by 60 by 3 nodes 180 and 0.8 times.
const DEEP: u64 = 250;

/// The unknown at each place of the elimination order, and the place of each unknown.
type Order<'a> = (&'a [usize], &'a [usize]);

/// A symbolic factorisation with its size and work.
#[derive(Debug)]
pub(crate) struct Symbolic {
    pub cholesky: SymbolicCholesky<usize>,
    pub fill: Fill,
}

impl Symbolic {
    /// The symbolic factorisation of a pattern by columns, one triangle or both; `whole` is the pattern of both
    /// triangles. The factorisation works by blocks from `by_blocks` multiplications per entry of the factor.
    ///
    /// The budget ends the current solve where the factors would be too large; `None` where memory runs out.
    pub fn new(given: (&[usize], &[usize]), whole: (&[usize], &[usize]), by_blocks: f64) -> Option<Self> {
        let size = given.0.len().checked_sub(1)?;
        let (mut order, mut place_of, foreseen) = ordered(given.0, given.1)?;
        let mut fill = Fill::new(&order, &place_of, whole.0, whole.1);
        if fill.is_deep()
            && let Some((dissected, places)) = nested_dissection::order(whole.0, whole.1)
        {
            let of_dissected = Fill::new(&dissected, &places, whole.0, whole.1);
            if of_dissected.multiplications < fill.multiplications {
                (order, place_of, fill) = (dissected, places, of_dissected);
            }
        }
        budget::allow_factor(fill.entries, fill.multiplications);
        // From the operation counts of the ordering, which are upper bounds.
        let is_dense = foreseen / fill.entries.max(1) as f64 > by_blocks;
        let threshold = if is_dense || fill.multiplications > MOST_AT_ONCE {
            SupernodalThreshold::FORCE_SUPERNODAL
        } else {
            SupernodalThreshold::FORCE_SIMPLICIAL
        };
        budget::spend(usize::try_from(fill.entries).unwrap_or(usize::MAX));
        let view = SymbolicSparseColMatRef::new_checked(size, size, given.0, None, given.1);
        let cholesky = factorize_symbolic_cholesky(
            view,
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&order, &place_of, size)),
            CholeskySymbolicParams { supernodal_flop_ratio_threshold: threshold, ..Default::default() },
        )
        .ok()?;
        Some(Self { cholesky, fill })
    }

    /// For a factorisation in pieces: the blocks, the unknown at each place of the order and the place of each unknown.
    pub fn in_pieces(&self) -> Option<(&SymbolicSupernodalCholesky<usize>, Order<'_>)> {
        match self.cholesky.raw() {
            SymbolicCholeskyRaw::Supernodal(blocks) if self.fill.multiplications > MOST_AT_ONCE => {
                Some((blocks, self.cholesky.perm()?.arrays()))
            }
            SymbolicCholeskyRaw::Supernodal(_) | SymbolicCholeskyRaw::Simplicial(_) => None,
        }
    }

    /// Number of stored indices.
    pub fn indices(&self) -> usize {
        let of_factor = match self.cholesky.raw() {
            SymbolicCholeskyRaw::Simplicial(simplicial) => simplicial.row_idx().len(),
            SymbolicCholeskyRaw::Supernodal(supernodal) => supernodal.row_idx().len(),
        };
        of_factor + 6 * self.cholesky.nrows()
    }
}

/// Lets the budget of the current solve refuse a factorisation, by other crates and without row exchanges, of a
/// symmetric matrix with entries at the given places and their mirror images. Such a factorisation runs in one piece of
/// at most `most` multiplications.
pub fn allow_factor(size: usize, entries: impl IntoIterator<Item = (usize, usize)>, most: u64) {
    let mut places: Vec<(usize, usize)> = (0..size).map(|index| (index, index)).collect();
    places.extend(entries.into_iter().flat_map(|(row, column)| [(row, column), (column, row)]));
    let _held = budget::take::<(usize, usize)>(3 * places.len());
    budget::spend(places.len());
    places.sort_unstable();
    places.dedup();
    let starts: Vec<usize> = (0..=size).map(|column| places.partition_point(|(own, _)| *own < column)).collect();
    let rows: Vec<usize> = places.into_iter().map(|(_, row)| row).collect();
    let Some((order, place_of, _)) = ordered(&starts, &rows) else { return };
    let fill = Fill::new(&order, &place_of, &starts, &rows);
    budget::allow_factor(fill.entries, fill.multiplications);
    if fill.multiplications > most {
        budget::end(Breach::FactorWork { asked: fill.multiplications, allowed: most });
    }
    // Taken and released at once: only the total is checked.
    drop(budget::take::<f64>(usize::try_from(2 * fill.entries).unwrap_or(usize::MAX)));
    budget::spend(usize::try_from(fill.multiplications).unwrap_or(usize::MAX));
}

/// The elimination order of a pattern by columns, the place of each unknown in the order, and the estimated number of
/// multiplications and divisions. `None` where memory runs out.
fn ordered(starts: &[usize], rows: &[usize]) -> Option<(Vec<usize>, Vec<usize>, f64)> {
    let size = starts.len().checked_sub(1)?;
    let view = SymbolicSparseColMatRef::new_checked(size, size, starts, None, rows);
    let (mut order, mut place_of) = (vec![0; size], vec![0; size]);
    let request = amd::order_maybe_unsorted_scratch::<usize>(size, rows.len());
    let _scratch = budget::take::<u8>(request.unaligned_bytes_required());
    let mut memory = MemBuffer::try_new(request).ok()?;
    budget::spend(rows.len());
    let stack = MemStack::new(&mut memory);
    let flops = amd::order_maybe_unsorted(&mut order, &mut place_of, view, amd::Control::default(), stack).ok()?;
    budget::spend(rows.len());
    Some((order, place_of, flops.n_div + flops.n_mult_subs_ldl))
}

/// The size and work of a factorisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Fill {
    /// Entries of the triangular factor, diagonal included.
    pub entries: u64,
    pub multiplications: u64,
}

impl Fill {
    fn new(order: &[usize], place_of: &[usize], starts: &[usize], rows: &[usize]) -> Self {
        let size = order.len();
        let column = |place: usize| {
            let unknown = order[place];
            rows[starts[unknown]..starts[unknown + 1]].iter().map(|row| place_of[*row])
        };
        let parent = elimination_tree(size, column);
        let postorder = postorder(&parent);
        let counts = column_counts(&parent, &postorder, column);
        let sum =
            |each: fn(u64) -> u64| counts.iter().fold(0_u64, |sum, count| sum.saturating_add(each(*count as u64)));
        Self { entries: sum(|count| count), multiplications: sum(|count| count * (count + 1) / 2) }
    }

    /// Whether the factorisation is long enough, and its columns are, for an order by nested dissection to pay.
    fn is_deep(self) -> bool {
        self.multiplications > MOST_AT_ONCE && self.multiplications > self.entries.saturating_mul(DEEP)
    }
}

/// The parent of each column in the elimination tree; [`NONE`] for a root (J. W. H. Liu, SIAM J. Matrix Anal. Appl. 11
/// (1990) 134, doi:10.1137/0611010).
fn elimination_tree<I: Iterator<Item = usize>>(size: usize, column: impl Fn(usize) -> I) -> Vec<usize> {
    let (mut parent, mut ancestor) = (vec![NONE; size], vec![NONE; size]);
    for place in 0..size {
        for row in column(place).filter(|row| *row < place) {
            let mut node = row;
            while node != NONE && node < place {
                let next = std::mem::replace(&mut ancestor[node], place);
                if next == NONE {
                    parent[node] = place;
                }
                node = next;
            }
        }
    }
    parent
}

/// A postorder of the tree: children before their parents, each subtree contiguous.
fn postorder(parent: &[usize]) -> Vec<usize> {
    let size = parent.len();
    let (mut first_child, mut next_child) = (vec![NONE; size], vec![NONE; size]);
    for node in (0..size).rev().filter(|node| parent[*node] != NONE) {
        next_child[node] = std::mem::replace(&mut first_child[parent[node]], node);
    }
    let mut order = Vec::with_capacity(size);
    let mut open = Vec::new();
    for root in (0..size).filter(|node| parent[*node] == NONE) {
        open.push(root);
        while let Some(node) = open.last().copied() {
            match std::mem::replace(&mut first_child[node], NONE) {
                NONE => {
                    order.push(node);
                    open.pop();
                }
                child => {
                    first_child[node] = next_child[child];
                    open.push(child);
                }
            }
        }
    }
    order
}

/// Number of entries of each column of the factor, diagonal included.
fn column_counts<I: Iterator<Item = usize>>(
    parent: &[usize],
    postorder: &[usize],
    column: impl Fn(usize) -> I,
) -> Vec<usize> {
    let size = parent.len();
    // Postorder number of the first descendant of each node.
    let mut first = vec![NONE; size];
    // Entries of a column minus those of its children; partial sums may be negative.
    let mut counts = vec![0_isize; size];
    for (place, node) in postorder.iter().enumerate() {
        counts[*node] = isize::from(first[*node] == NONE);
        let mut node = *node;
        while node != NONE && first[node] == NONE {
            first[node] = place;
            node = parent[node];
        }
    }
    let mut ancestor: Vec<usize> = (0..size).collect();
    let (mut latest_first, mut latest_leaf) = (vec![NONE; size], vec![NONE; size]);
    for node in postorder.iter().copied() {
        if parent[node] != NONE {
            counts[parent[node]] -= 1;
        }
        for row in column(node).filter(|row| *row > node) {
            // Only a leaf of the row's subtree counts.
            if latest_first[row] != NONE && first[node] <= latest_first[row] {
                continue;
            }
            latest_first[row] = first[node];
            counts[node] += 1;
            let before = std::mem::replace(&mut latest_leaf[row], node);
            if before != NONE {
                counts[common_ancestor(&mut ancestor, before)] -= 1;
            }
        }
        if parent[node] != NONE {
            ancestor[node] = parent[node];
        }
    }
    for node in 0..size {
        if parent[node] != NONE {
            counts[parent[node]] += counts[node];
        }
    }
    counts.into_iter().map(|count| usize::try_from(count).unwrap_or(0)).collect()
}

/// The root of a set, with path compression.
fn common_ancestor(ancestor: &mut [usize], node: usize) -> usize {
    let mut root = node;
    while ancestor[root] != root {
        root = ancestor[root];
    }
    let mut node = node;
    while node != root {
        node = std::mem::replace(&mut ancestor[node], root);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both triangles of a pattern, by columns.
    fn columns(size: usize, entries: &[(usize, usize)]) -> (Vec<usize>, Vec<usize>) {
        let mut all: Vec<(usize, usize)> = (0..size).map(|index| (index, index)).collect();
        all.extend(entries.iter().flat_map(|(row, column)| [(*row, *column), (*column, *row)]));
        all.sort_unstable();
        all.dedup();
        let starts = (0..=size).map(|column| all.partition_point(|(own, _)| *own < column)).collect();
        (starts, all.into_iter().map(|(_, row)| row).collect())
    }

    /// Elimination of the pattern itself, entry by entry.
    fn by_elimination(size: usize, order: &[usize], starts: &[usize], rows: &[usize]) -> Fill {
        let mut filled = vec![vec![false; size]; size];
        for (place, unknown) in order.iter().enumerate() {
            for row in &rows[starts[*unknown]..starts[*unknown + 1]] {
                let other = order.iter().position(|own| own == row).expect("an order of all");
                filled[place][other] = true;
            }
        }
        let mut fill = Fill { entries: 0, multiplications: 0 };
        for pivot in 0..size {
            let below: Vec<usize> = (pivot + 1..size).filter(|row| filled[*row][pivot]).collect();
            below.iter().for_each(|row| below.iter().for_each(|column| filled[*row][*column] = true));
            let count = below.len() as u64 + 1;
            fill.entries += count;
            fill.multiplications += count * (count + 1) / 2;
        }
        fill
    }

    #[test]
    fn the_fill_is_that_of_elimination() {
        let mut seed = 7_u64;
        let mut random = move |below: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 33) as usize % below
        };
        for (size, count) in [(1, 0), (2, 1), (9, 4), (30, 25), (30, 60), (60, 61), (60, 240)] {
            let entries: Vec<(usize, usize)> = (0..count).map(|_| (random(size), random(size))).collect();
            let (starts, rows) = columns(size, &entries);
            let mut order: Vec<usize> = (0..size).collect();
            (1..size).for_each(|place| order.swap(place, random(place + 1)));
            let mut place_of = vec![0; size];
            order.iter().enumerate().for_each(|(place, unknown)| place_of[*unknown] = place);
            let found = Fill::new(&order, &place_of, &starts, &rows);
            assert_eq!(found, by_elimination(size, &order, &starts, &rows), "{size} {entries:?}");
        }
    }

    /// A cube of nodes, each joined to its 26 neighbours: less than two thirds of the entries and half of the work of
    /// the order by minimum degree, and the same order again.
    #[test]
    fn a_cube_is_dissected() {
        let side = 24_usize;
        let place = |x: usize, y: usize, z: usize| (z * side + y) * side + x;
        let about = |centre: usize| centre.saturating_sub(1)..(centre + 2).min(side);
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for (z, y, x) in itertools::iproduct!(0..side, 0..side, 0..side) {
            rows.extend(itertools::iproduct!(about(z), about(y), about(x)).map(|(z, y, x)| place(x, y, z)));
            starts.push(rows.len());
        }
        let (order, place_of, _) = ordered(&starts, &rows).expect("an order");
        let by_degree = Fill::new(&order, &place_of, &starts, &rows);
        let symbolic = Symbolic::new((&starts, &rows), (&starts, &rows), 0.0).expect("a factor");
        let (dissected, again) = (symbolic.fill, Symbolic::new((&starts, &rows), (&starts, &rows), 0.0));
        let order = |symbolic: &Symbolic| symbolic.cholesky.perm().expect("an order").arrays().0.to_vec();
        assert_eq!(order(&symbolic), order(&again.expect("a factor")));
        assert!(by_degree.is_deep());
        assert!(3 * dissected.entries < 2 * by_degree.entries, "{dissected:?} {by_degree:?}");
        assert!(2 * dissected.multiplications < by_degree.multiplications, "{dissected:?} {by_degree:?}");
    }
}
