//! A bound on the members of all sets of a mesh.
//!
//! A short line such as `1, 1000000, 1` stands for a million members, and a set of sets for as many again. So the
//! members are bounded in proportion to the file before memory is asked for.

use crate::model::mesh::data::error::{MeshError, MeshPlace};

/// Members that the sets of any file may have.
const ANY_FILE: u64 = 1_000_000;
/// Members for each byte of the file beyond them.
const PER_BYTE: u64 = 4;

/// What is left of the members that a file's sets may have.
#[derive(Debug, Clone, Copy)]
pub struct MemberBudget {
    left: u64,
}

impl MemberBudget {
    /// The budget of a file of some bytes.
    pub fn new(bytes: usize) -> Self {
        Self { left: (bytes as u64).saturating_mul(PER_BYTE).saturating_add(ANY_FILE) }
    }

    /// Takes members from the budget.
    ///
    /// # Errors
    /// The budget is exceeded by the set at this place.
    pub fn take(&mut self, members: usize, place: MeshPlace) -> Result<(), MeshError> {
        match self.left.checked_sub(members as u64) {
            Some(left) => {
                self.left = left;
                Ok(())
            }
            None => Err(MeshError::new(
                place,
                format!(
                    "the sets have too many members: at most {ANY_FILE} and {PER_BYTE} for each byte of the file; \
                     leave out sets that repeat others"
                ),
            )),
        }
    }
}
