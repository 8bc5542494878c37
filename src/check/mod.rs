//! What holds the solver to account.
//!
//! | room | what it holds |
//! |---|---|
//! | [`measure`] | the measure of error; it shares no code with the solver |
//! | [`judged`] | a path with the measure of each increment |
//! | [`scenes`] | the built-in scenes and their exact solutions |
//! | [`verify`], `extreme` | scenes with known answers, and families of stiff and extreme cases |
//! | [`cases`] | all of them |

pub mod cases;
pub(crate) mod extreme;
pub mod judged;
pub mod measure;
pub mod scenes;
pub mod verify;
