//! gmsh's kinds of elements.

use crate::model::mesh::data::element_shape::ElementShape;

/// A kind of element by gmsh's number, with the place in gmsh's order of each node in VTK's order; no order where both
/// are the same.
///
/// # Errors
/// What is wrong with a kind that is not read.
pub fn element_type(number: i64) -> Result<(ElementShape, Option<&'static [usize]>), String> {
    let shape = match number {
        15 => ElementShape::Point,
        1 => ElementShape::Segment2,
        8 => ElementShape::Segment3,
        2 => ElementShape::Triangle3,
        9 => ElementShape::Triangle6,
        3 => ElementShape::Quadrilateral4,
        16 => ElementShape::Quadrilateral8,
        4 => ElementShape::Tetrahedron4,
        11 => ElementShape::Tetrahedron10,
        5 => ElementShape::Hexahedron8,
        17 => ElementShape::Hexahedron20,
        _ => return Err(refusal(number)),
    };
    Ok((shape, order(shape)))
}

/// gmsh numbers the edges of tetrahedra and hexahedra in another order than VTK.
fn order(shape: ElementShape) -> Option<&'static [usize]> {
    match shape {
        ElementShape::Tetrahedron10 => Some(&[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        ElementShape::Hexahedron20 => Some(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15]),
        ElementShape::Point
        | ElementShape::Segment2
        | ElementShape::Segment3
        | ElementShape::Triangle3
        | ElementShape::Triangle6
        | ElementShape::Quadrilateral4
        | ElementShape::Quadrilateral8
        | ElementShape::Tetrahedron4
        | ElementShape::Hexahedron8 => None,
    }
}

fn refusal(number: i64) -> String {
    let incomplete = "mesh with Mesh.SecondOrderIncomplete = 1";
    let (kind, remedy) = match number {
        10 => ("quadrilaterals of 9 nodes", incomplete),
        12 => ("hexahedra of 27 nodes", incomplete),
        6 | 13 | 18 => ("prisms", "mesh with tetrahedra or hexahedra alone"),
        7 | 14 | 19 => ("pyramids", "mesh with tetrahedra or hexahedra alone"),
        20..=140 => ("elements of higher order or special kinds", "mesh with Mesh.ElementOrder = 1 or 2"),
        _ => ("elements of an unknown kind", "kinds are numbered from 1 to 140"),
    };
    format!("{kind} (gmsh's type {number}) are not read: {remedy}")
}
