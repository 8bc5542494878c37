//! Pieces that several test files share.
// Each test binary uses its own part of this.
#![allow(dead_code)]

pub mod bad_documents;
#[cfg(feature = "server")]
pub mod browser;
#[cfg(feature = "server")]
pub mod cut;
#[cfg(feature = "server")]
pub mod engines;
#[cfg(feature = "server")]
pub mod faulty_store;
pub mod generators;
#[cfg(feature = "server")]
pub mod kills;
#[cfg(feature = "server")]
pub mod load;
pub mod long_paths;
pub mod paths;
#[cfg(feature = "server")]
pub mod postgres;
#[cfg(feature = "server")]
pub mod process;
pub mod random;
pub mod random_corners;
pub mod random_curves;
pub mod random_solids;
#[cfg(feature = "server")]
pub mod reader;
pub mod round_arch;
#[cfg(feature = "server")]
pub mod server;
#[cfg(feature = "server")]
pub mod service;
#[cfg(feature = "server")]
pub mod solver;
pub mod sum_of_cones;
pub mod variants;
#[cfg(feature = "server")]
pub mod watched;
