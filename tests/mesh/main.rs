//! MeshData files: what other programs read in them, their geometry, decks, broken and hostile files, conversion.
//!
//! `generate.py` makes the files in `samples` and what other programs read in them, `summaries.json`.

mod broken_decks;
mod broken_gmsh;
mod conversion;
mod decks;
mod geometry;
mod mutations;
mod requests;
mod samples;
mod summaries;
