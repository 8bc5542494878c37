//! Memory of large vectors that is used again: the pages of fresh memory cost a tenth of a factorisation.

use crate::resources::budget::{self, Taken};
use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, PoisonError};

/// Vectors of fewer numbers are taken afresh: 256 KiB.
const SMALLEST: usize = 1 << 15;

/// A vector, and what it takes of the budget of the solve that gave it back.
type Spare = (Vec<f64>, Taken);

/// Vectors of one length that were given back.
#[derive(Clone)]
pub struct SpareMemory {
    vectors: Arc<Mutex<Vec<Spare>>>,
    /// The most vectors that are kept.
    most: usize,
}

impl SpareMemory {
    pub fn new(most: usize) -> Self {
        Self { vectors: Arc::default(), most }
    }

    /// A vector of this length, of zeros where it is fresh and of any numbers where it was used before.
    pub fn any(&self, length: usize) -> Reused {
        if length < SMALLEST {
            return Reused { values: vec![0.0; length], held: budget::take::<f64>(length), memory: None };
        }
        let mut vectors = self.vectors.lock().unwrap_or_else(PoisonError::into_inner);
        let found =
            vectors.iter().position(|(vector, _)| vector.len() == length).map(|place| vectors.swap_remove(place));
        drop(vectors);
        // What it took of another solve's budget is given back before it is taken of the present one.
        let values = found.map(|(values, _)| values);
        let held = budget::take::<f64>(length);
        Reused { values: values.unwrap_or_else(|| vec![0.0; length]), held, memory: Some(self.clone()) }
    }

    /// A vector of zeros.
    pub fn zeros(&self, length: usize) -> Reused {
        let mut vector = self.any(length);
        vector.fill(0.0);
        vector
    }
}

impl fmt::Debug for SpareMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpareMemory").field("most", &self.most).finish_non_exhaustive()
    }
}

/// A vector that gives its memory back when it is dropped.
#[derive(Debug)]
pub struct Reused {
    values: Vec<f64>,
    held: Taken,
    /// None of a small vector.
    memory: Option<SpareMemory>,
}

impl Deref for Reused {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values
    }
}

impl DerefMut for Reused {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }
}

impl Clone for Reused {
    fn clone(&self) -> Self {
        match &self.memory {
            None => Self { values: self.values.clone(), held: self.held.clone(), memory: None },
            Some(memory) => {
                let mut copy = memory.any(self.values.len());
                copy.copy_from_slice(&self.values);
                copy
            }
        }
    }
}

impl Drop for Reused {
    fn drop(&mut self) {
        let Some(memory) = &self.memory else { return };
        let mut vectors = memory.vectors.lock().unwrap_or_else(PoisonError::into_inner);
        if vectors.len() < memory.most {
            vectors.push((std::mem::take(&mut self.values), std::mem::take(&mut self.held)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resources::budget::{Bounds, Breach, Budget};
    use crate::resources::cancel::CancelFlag;

    #[test]
    fn memory_is_used_again_and_counted_once() {
        let memory = SpareMemory::new(1);
        let bytes = 8 * SMALLEST as u64;
        let budget = Budget::new(CancelFlag::default(), Bounds { memory: 2 * bytes, ..Bounds::default() });
        let done = budget.during(|| {
            let mut first = memory.any(SMALLEST);
            first[7] = 3.0;
            let place = first.as_ptr();
            drop(first);
            let again = memory.any(SMALLEST);
            assert_eq!((again.as_ptr(), again[7]), (place, 3.0));
            assert_ne!(again.clone().as_ptr(), place);
            drop(again);
            assert_eq!(memory.zeros(SMALLEST)[7], 0.0);
        });
        assert_eq!(done, Ok(()));
        // One is kept, and two of another length are too many.
        let done = budget.during(|| (memory.any(SMALLEST + 1), memory.any(SMALLEST + 1)).0.len());
        assert!(matches!(done, Err(Breach::Memory { .. })), "{done:?}");
    }
}
