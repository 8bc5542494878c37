//! Kinds of elements: their nodes, edges and faces, in VTK's order of nodes.

/// The kind of an element, by its shape and number of nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ElementShape {
    /// A node.
    Point,
    /// A straight line; the face of a plane element.
    Segment2,
    /// A line with a node between its ends.
    Segment3,
    /// A triangle of 3 nodes.
    Triangle3,
    /// A triangle of 6 nodes.
    Triangle6,
    /// A quadrilateral of 4 nodes.
    Quadrilateral4,
    /// A quadrilateral of 8 nodes.
    Quadrilateral8,
    /// A tetrahedron of 4 nodes.
    Tetrahedron4,
    /// A tetrahedron of 10 nodes.
    Tetrahedron10,
    /// A hexahedron of 8 nodes.
    Hexahedron8,
    /// A hexahedron of 20 nodes.
    Hexahedron20,
}

/// What is known of a kind of element.
struct Topology {
    name: &'static str,
    dimension: usize,
    corners: usize,
    /// Ends of the edges with nodes between them, in the order of these nodes; all edges where the kind has none.
    edges: &'static [[usize; 2]],
    /// Whether edges have nodes between their ends.
    quadratic: bool,
    /// Nodes of the faces: corners, counterclockwise as seen from outside, then the nodes between them. In the plane
    /// the element lies to the left of its faces. They stand in the order of the faces S1, S2, ... of Abaqus.
    faces: &'static [&'static [usize]],
}

const TRIANGLE_EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];
const QUADRILATERAL_EDGES: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
const TETRAHEDRON_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
const HEXAHEDRON_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

const fn topology(shape: ElementShape) -> Topology {
    let plain = Topology { name: "point", dimension: 0, corners: 1, edges: &[], quadratic: false, faces: &[] };
    match shape {
        ElementShape::Point => plain,
        ElementShape::Segment2 => Topology { name: "segment2", dimension: 1, corners: 2, edges: &[[0, 1]], ..plain },
        ElementShape::Segment3 => Topology { name: "segment3", quadratic: true, ..topology(ElementShape::Segment2) },
        ElementShape::Triangle3 => Topology {
            name: "triangle3",
            dimension: 2,
            corners: 3,
            edges: &TRIANGLE_EDGES,
            quadratic: false,
            faces: &[&[0, 1], &[1, 2], &[2, 0]],
        },
        ElementShape::Triangle6 => Topology {
            name: "triangle6",
            quadratic: true,
            faces: &[&[0, 1, 3], &[1, 2, 4], &[2, 0, 5]],
            ..topology(ElementShape::Triangle3)
        },
        ElementShape::Quadrilateral4 => Topology {
            name: "quadrilateral4",
            dimension: 2,
            corners: 4,
            edges: &QUADRILATERAL_EDGES,
            quadratic: false,
            faces: &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
        },
        ElementShape::Quadrilateral8 => Topology {
            name: "quadrilateral8",
            quadratic: true,
            faces: &[&[0, 1, 4], &[1, 2, 5], &[2, 3, 6], &[3, 0, 7]],
            ..topology(ElementShape::Quadrilateral4)
        },
        ElementShape::Tetrahedron4 => Topology {
            name: "tetrahedron4",
            dimension: 3,
            corners: 4,
            edges: &TETRAHEDRON_EDGES,
            quadratic: false,
            faces: &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
        },
        ElementShape::Tetrahedron10 => Topology {
            name: "tetrahedron10",
            quadratic: true,
            faces: &[&[0, 2, 1, 6, 5, 4], &[0, 1, 3, 4, 8, 7], &[1, 2, 3, 5, 9, 8], &[2, 0, 3, 6, 7, 9]],
            ..topology(ElementShape::Tetrahedron4)
        },
        ElementShape::Hexahedron8 => Topology {
            name: "hexahedron8",
            dimension: 3,
            corners: 8,
            edges: &HEXAHEDRON_EDGES,
            quadratic: false,
            faces: &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
        },
        ElementShape::Hexahedron20 => Topology {
            name: "hexahedron20",
            quadratic: true,
            faces: &[
                &[0, 3, 2, 1, 11, 10, 9, 8],
                &[4, 5, 6, 7, 12, 13, 14, 15],
                &[0, 1, 5, 4, 8, 17, 12, 16],
                &[1, 2, 6, 5, 9, 18, 13, 17],
                &[2, 3, 7, 6, 10, 19, 14, 18],
                &[3, 0, 4, 7, 11, 16, 15, 19],
            ],
            ..topology(ElementShape::Hexahedron8)
        },
    }
}

impl ElementShape {
    /// Nodes of the largest element.
    pub const MOST_NODES: usize = 20;

    /// The kind's name in a model.
    pub fn name(self) -> &'static str {
        topology(self).name
    }

    /// Dimension of the element itself: 0 for a point to 3 for a solid in space.
    pub fn dimension(self) -> usize {
        topology(self).dimension
    }

    /// Number of corners; they come first among the nodes.
    pub fn corners(self) -> usize {
        topology(self).corners
    }

    /// Number of nodes.
    pub fn nodes(self) -> usize {
        let topology = topology(self);
        topology.corners + if topology.quadratic { topology.edges.len() } else { 0 }
    }

    /// Whether edges have nodes between their ends.
    pub fn is_quadratic(self) -> bool {
        topology(self).quadratic
    }

    /// Ends of the edges, in the order of the nodes between them.
    pub fn edges(self) -> &'static [[usize; 2]] {
        topology(self).edges
    }

    /// Nodes of the faces: corners, counterclockwise as seen from outside, then the nodes between them; in the plane
    /// the element lies to the left.
    pub fn faces(self) -> &'static [&'static [usize]] {
        topology(self).faces
    }

    /// The order of nodes of a plane element that is turned over, which begins at the same corner; empty for others.
    pub fn turned_over(self) -> &'static [usize] {
        match self {
            Self::Triangle3 => &[0, 2, 1],
            Self::Triangle6 => &[0, 2, 1, 5, 4, 3],
            Self::Quadrilateral4 => &[0, 3, 2, 1],
            Self::Quadrilateral8 => &[0, 3, 2, 1, 7, 6, 5, 4],
            Self::Point
            | Self::Segment2
            | Self::Segment3
            | Self::Tetrahedron4
            | Self::Tetrahedron10
            | Self::Hexahedron8
            | Self::Hexahedron20 => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [ElementShape; 8] = [
        ElementShape::Triangle3,
        ElementShape::Triangle6,
        ElementShape::Quadrilateral4,
        ElementShape::Quadrilateral8,
        ElementShape::Tetrahedron4,
        ElementShape::Tetrahedron10,
        ElementShape::Hexahedron8,
        ElementShape::Hexahedron20,
    ];

    fn corners(shape: ElementShape) -> Vec<[f64; 3]> {
        let plane = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        match (shape.dimension(), shape.corners()) {
            (2, 3) => vec![plane[0], plane[1], plane[3]],
            (2, _) => plane.to_vec(),
            (_, 4) => vec![plane[0], plane[1], plane[3], [0.0, 0.0, 1.0]],
            _ => plane.iter().copied().chain(plane.map(|[x, y, _]| [x, y, 1.0])).collect(),
        }
    }

    fn points(shape: ElementShape) -> Vec<[f64; 3]> {
        let mut points = corners(shape);
        if shape.is_quadratic() {
            for [one, other] in shape.edges() {
                points.push([0, 1, 2].map(|axis| (points[*one][axis] + points[*other][axis]) / 2.0));
            }
        }
        assert_eq!(points.len(), shape.nodes());
        points
    }

    fn mean(points: &[[f64; 3]]) -> [f64; 3] {
        [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64)
    }

    fn less(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| one[axis] - other[axis])
    }

    /// Area times normal of a face, from its corners.
    fn normal(face: &[[f64; 3]]) -> [f64; 3] {
        if face.len() == 2 {
            let [x, y, _] = less(face[1], face[0]);
            return [y, -x, 0.0];
        }
        let (a, b) = (less(face[1], face[0]), less(face[face.len() - 1], face[0]));
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    #[test]
    fn faces_look_outwards_and_close_the_element() {
        for shape in SHAPES {
            let points = points(shape);
            let middle = mean(&corners(shape));
            for face in shape.faces() {
                let corner_count = if shape.is_quadratic() { face.len() / 2 + face.len() % 2 } else { face.len() };
                let at: Vec<[f64; 3]> = face[..corner_count].iter().map(|node| points[*node]).collect();
                let (out, normal) = (less(mean(&at), middle), normal(&at));
                assert!((0..3).map(|axis| out[axis] * normal[axis]).sum::<f64>() > 0.0, "{shape:?} {face:?}");
                for (place, node) in face.iter().enumerate().skip(corner_count) {
                    let one = place - corner_count;
                    let ends = mean(&[at[one], at[(one + 1) % corner_count]]);
                    assert_eq!(points[*node], ends, "{shape:?} {face:?}");
                }
            }
            let corners_of_faces: usize = shape.faces().iter().map(|face| face.len()).sum();
            let shared = if shape.dimension() == 3 { 2 * shape.edges().len() } else { 2 * shape.corners() };
            let between = if shape.is_quadratic() { (shape.dimension() - 1) * shape.edges().len() } else { 0 };
            assert_eq!(corners_of_faces, shared + between, "{shape:?}");
        }
    }

    #[test]
    fn an_element_turned_over_has_the_same_edges() {
        for shape in SHAPES.into_iter().filter(|shape| shape.dimension() == 2) {
            let points = points(shape);
            let turned: Vec<[f64; 3]> = shape.turned_over().iter().map(|node| points[*node]).collect();
            assert_eq!(turned.len(), shape.nodes());
            if shape.is_quadratic() {
                for (edge, [one, other]) in shape.edges().iter().enumerate() {
                    let ends = mean(&[turned[*one], turned[*other]]);
                    assert_eq!(turned[shape.corners() + edge], ends);
                }
            }
        }
    }
}
