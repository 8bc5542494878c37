//! Proofs that a point has no other directions than those that are known.
//!
//! | room | what it proves |
//! |---|---|
//! | `two_directions` | within a mode: the way on and the stuck direction are all there is |
//! | `one_direction` | for many contacts that can change: one direction for each sign of the load rate, without condensation |

pub(crate) mod one_direction;
pub(crate) mod two_directions;
