//! The shapes of solid elements and of their faces: kinds, shape functions, quadrature, undeformed geometry.

pub mod faces;
pub mod geometry;
pub mod kind;
pub mod quadrature;
pub mod shape_functions;
