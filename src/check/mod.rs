//! Verification of the solver.
//!
//! | module | contents |
//! |---|---|
//! | [`measure`] | the measure of error; it shares no code with the solver |
//! | [`judged`] | a path with the measure of each increment |
//! | [`scenes`] | the built-in scenes and their exact solutions |
//! | [`verify`], `extreme` | scenes with known answers, and families of stiff and extreme cases |
//! | [`cases`] | all of these cases |

pub mod cases;
pub(crate) mod extreme;
pub mod judged;
pub mod measure;
pub mod scenes;
pub mod verify;
