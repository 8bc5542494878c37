//! Combinations of one option from each of several lists, in one fixed order for all callers.

use itertools::Itertools;

/// The number of combinations, saturating.
pub(crate) fn count<T>(options: &[Vec<T>]) -> u64 {
    options.iter().fold(1, |total: u64, options| total.saturating_mul(options.len() as u64))
}

/// The first `most` combinations, with the first list varying fastest; none where a list is empty.
pub(crate) fn combinations<T: Clone>(options: &[Vec<T>], most: u64) -> impl Iterator<Item = Vec<T>> {
    // In a cartesian product the last list varies fastest.
    let product = options.iter().rev().map(|options| options.iter().cloned()).multi_cartesian_product();
    let most = usize::try_from(most).unwrap_or(usize::MAX);
    product.take(most).map(|mut combination| {
        combination.reverse();
        combination
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_list_counts_fastest() {
        let options = [vec![0, 1], vec![5], vec![7, 8, 9]];
        assert_eq!(count(&options), 6);
        let all: Vec<Vec<i32>> = combinations(&options, 4).collect();
        assert_eq!(all, [[0, 5, 7], [1, 5, 7], [0, 5, 8], [1, 5, 8]]);
        assert_eq!(combinations(&[vec![1], vec![]], 9).count(), 0);
        assert_eq!(combinations::<i32>(&[], 9).count(), 1);
    }
}
