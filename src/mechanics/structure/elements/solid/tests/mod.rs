//! Solid elements against difference quotients, closed forms and exact solutions.

mod bending;
//mod bodies_of_revolution;
mod consistency;
mod cook;
mod loads;
mod meshes;
mod patches;
mod stability;
mod structures;
