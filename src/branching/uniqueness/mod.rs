//! Proofs that a point has no other directions than those already known.
//!
//! | module | proof |
//! |---|---|
//! | `all_slipping` | within a mode: the continuation and the stuck direction are the only ones |
//! | `sparse_uniqueness` | many contacts that can change: one direction for each sign of the load rate, uncondensed |

pub(crate) mod all_slipping;
pub(crate) mod sparse_uniqueness;
