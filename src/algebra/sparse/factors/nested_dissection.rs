//! An elimination order by nested dissection: separators split the graph of a matrix again and again, and each is
//! eliminated after what it separates (A. George, SIAM J. Numer. Anal. 10 (1973) 345, doi:10.1137/0710032). In space it
//! takes far less work than an order by minimum degree.
//!
//! The separators are those of `feral-scotch`, found on coarser and coarser graphs (F. Pellegrini, J. Roman, HPCN 1996,
//! LNCS 1067, 493). Its random numbers begin with a fixed seed, so that the same pattern gives the same order.

use crate::resources::budget;
use feral_scotch::{CscPattern, scotch_order};

/// Bytes for each entry of the pattern: the graph, the graph without the unknowns that have the same neighbours, and the
/// coarser graphs. Cubes and random graphs take 24 to 32.
const BYTES_AN_ENTRY: usize = 32;
/// Largest number of entries, which take some six seconds: the library cannot be cancelled. A cube of 510,000 unknowns
/// has as many.
const MOST_ENTRIES: usize = 40_000_000;

/// The unknown at each place of the order and the place of each unknown, for a pattern of both triangles by columns.
/// `None` where the pattern has more than [`MOST_ENTRIES`].
pub(crate) fn order(starts: &[usize], rows: &[usize]) -> Option<(Vec<usize>, Vec<usize>)> {
    let size = starts.len().checked_sub(1).filter(|_| rows.len() <= MOST_ENTRIES)?;
    let narrow = |values: &[usize]| values.iter().map(|value| i32::try_from(*value).ok()).collect::<Option<Vec<i32>>>();
    let _held = budget::take::<u8>(rows.len().saturating_mul(BYTES_AN_ENTRY));
    budget::spend(rows.len());
    let (starts, rows) = (narrow(starts)?, narrow(rows)?);
    let found = scotch_order(&CscPattern::new(size, &starts, &rows)?).ok()?;
    budget::spend(rows.len());
    let order = found.into_iter().map(|unknown| usize::try_from(unknown).ok()).collect::<Option<Vec<usize>>>()?;
    let place_of = place_of(&order, size)?;
    Some((order, place_of))
}

/// The place of each unknown; `None` unless the order names each of them once.
fn place_of(order: &[usize], size: usize) -> Option<Vec<usize>> {
    let mut place_of = vec![usize::MAX; size];
    for (place, unknown) in order.iter().enumerate() {
        let own = place_of.get_mut(*unknown).filter(|own| **own == usize::MAX)?;
        *own = place;
    }
    (order.len() == size).then_some(place_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_order_names_each_unknown_once() {
        assert_eq!(place_of(&[2, 0, 1], 3), Some(vec![1, 2, 0]));
        for wrong in [&[0, 0, 1][..], &[0, 1], &[0, 1, 3]] {
            assert_eq!(place_of(wrong, 3), None, "{wrong:?}");
        }
    }
}
