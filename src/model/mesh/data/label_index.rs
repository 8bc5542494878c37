//! The place of a node or element by its label in the file.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Where labels leave at most this many gaps for each of them, a table by label is as small as the list of labels.
const MOST_GAPS: u64 = 4;

/// Places by label. Labels are any numbers below 2^64; memory goes with how many there are, never with their size.
#[derive(Debug)]
pub enum LabelIndex {
    /// Place plus one by label less the first label; zero for a gap.
    Table(u64, Vec<u32>),
    /// Places of labels with wide gaps.
    Map(HashMap<u64, u32>),
}

impl LabelIndex {
    /// The index of a list of labels.
    ///
    /// # Errors
    /// The place in the list of a label that stands there for the second time, or of one beyond 2^32 - 2 labels.
    pub fn new(labels: &[u64]) -> Result<Self, usize> {
        let count = labels.len() as u64;
        if count >= u64::from(u32::MAX) {
            return Err(u32::MAX as usize);
        }
        let first = labels.iter().copied().min().unwrap_or(0);
        let span = labels.iter().copied().max().unwrap_or(0) - first;
        if span / (MOST_GAPS + 1) < count.max(1)
            && let Ok(size) = usize::try_from(span)
        {
            return Self::table(labels, first, size + 1);
        }
        let mut map = HashMap::with_capacity(labels.len());
        for (place, &label) in (0_u32..).zip(labels) {
            match map.entry(label) {
                Entry::Vacant(entry) => entry.insert(place),
                Entry::Occupied(_) => return Err(place as usize),
            };
        }
        Ok(Self::Map(map))
    }

    fn table(labels: &[u64], first: u64, size: usize) -> Result<Self, usize> {
        let mut table = vec![0_u32; size];
        for (place, &label) in (0_u32..).zip(labels) {
            match usize::try_from(label - first).ok().and_then(|offset| table.get_mut(offset)) {
                Some(entry) if *entry == 0 => *entry = place + 1,
                _ => return Err(place as usize),
            }
        }
        Ok(Self::Table(first, table))
    }

    /// The place of a label in the list.
    pub fn get(&self, label: u64) -> Option<u32> {
        match self {
            Self::Table(first, table) => {
                let offset = usize::try_from(label.checked_sub(*first)?).ok()?;
                table.get(offset)?.checked_sub(1)
            }
            Self::Map(map) => map.get(&label).copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dense_and_sparse_labels_are_found_and_others_are_not() {
        for labels in [vec![7, 5, 9], vec![0, u64::MAX, 1 << 63], vec![u64::MAX], vec![]] {
            let index = LabelIndex::new(&labels).unwrap();
            for (place, &label) in labels.iter().enumerate() {
                assert_eq!(index.get(label), u32::try_from(place).ok());
            }
            assert_eq!([index.get(6), index.get(4), index.get(1 << 40)], [None; 3]);
        }
    }

    #[test]
    fn a_repeated_label_is_told() {
        assert_eq!(LabelIndex::new(&[1, 2, 1]).unwrap_err(), 2);
        assert_eq!(LabelIndex::new(&[1, 1 << 60, 5, 1 << 60]).unwrap_err(), 3);
    }
}
