//! Proofs that a point has no other directions than those that are known.
//!
//! | room | what it proves |
//! |---|---|
//! | `all_slipping` | within a mode: the way on and the stuck direction are all there is |
//! | `sparse_uniqueness` | for many contacts that can change: one direction for each sign of the load rate, without condensation |

pub(crate) mod all_slipping;
pub(crate) mod sparse_uniqueness;
