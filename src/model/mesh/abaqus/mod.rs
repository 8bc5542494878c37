//! Decks of Abaqus, and of programs that write the same form, such as `CalculiX` and gmsh.
//!
//! The form: Dassault Systèmes, *Abaqus Keywords Reference Guide*; G. Dhondt, *User's Manual* of `CalculiX`. `deck`
//! reads keyword after keyword into lists; `assembled` resolves names and labels when the whole deck is known, since
//! sets may stand before what they name.

mod assembled;
mod deck;
mod definitions;
mod element_types;
mod elements;
mod instances;
mod lines;
mod materials;
mod set_members;
mod sets;

pub use assembled::read;
