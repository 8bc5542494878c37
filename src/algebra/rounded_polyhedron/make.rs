//! The flat faces and edges of a closed triangle mesh, and what is wrong with triangles that make none.

use crate::algebra::rounded_polyhedron::closest::has_surface;
use crate::algebra::rounded_polyhedron::polyhedron::{BoundaryEdge, FlatFace, Polyhedron, PolyhedronEdge};
use crate::algebra::rounded_polyhedron::triangles::{PlacedTriangle, TriangleTree};
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Normals whose components differ by no more than this belong to one flat face: round-off of coordinates.
const COPLANAR: f64 = 1e-12;
/// Least area of a triangle, doubled and relative to the square of its longest side.
const LEAST_AREA: f64 = 1e-12;
/// Least volume, relative to the cube of the farthest corner's distance from the first one.
const LEAST_VOLUME: f64 = 1e-12;
/// Faces that the ball about a corner may meet: those of a mesh that has some five edges along the rounding.
pub(crate) const MOST_FACES_IN_BALL: usize = 200;

/// Why triangles make no such surface. Points and triangles are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PolyhedronMistake {
    /// Fewer than four triangles.
    TooFew,
    /// The corners of a triangle are on a line, or coincide.
    NoArea { triangle: usize },
    /// An edge that belongs to one triangle alone.
    Open { ends: [usize; 2] },
    /// An edge of three triangles or more.
    Shared { ends: [usize; 2] },
    /// Two triangles go along their common edge in the same sense.
    Turned { ends: [usize; 2] },
    /// There is no volume inside.
    NoVolume,
    /// A side of one triangle goes through another triangle.
    Crosses { triangles: [usize; 2] },
    /// The ball about a point meets too many faces.
    WideRounding { point: usize },
    /// Next to a point no ball is half filled.
    Thin { point: usize },
}

/// The numbers of a triangle's corners.
type Corners = [usize; 3];

/// For the numbers of the ends of each edge, the smaller one first, its triangles, and whether these go along it from the
/// smaller one.
type Sides = BTreeMap<[usize; 2], Vec<(usize, bool)>>;

/// The polyhedron of triangles, in multiples of the rounding.
pub(super) fn polyhedron(
    points: &[[f64; 3]],
    triangles: &[Corners],
    rounding: f64,
) -> Result<Polyhedron, PolyhedronMistake> {
    if triangles.len() < 4 {
        return Err(PolyhedronMistake::TooFew);
    }
    let points: Vec<Vector3<f64>> = points.iter().map(|point| Vector3::from(*point) / rounding).collect();
    let triangles = outwards(&points, triangles)?;
    let sides = sides(&triangles)?;
    let areas = triangles.iter().enumerate().map(|(number, corners)| area(&points, number, corners));
    let areas: Vec<Vector3<f64>> = areas.collect::<Result<_, _>>()?;
    let face_of = flat_faces(&areas, &sides);
    let mut faces = vec![FlatFace { normal: Vector3::zeros(), boundary: Vec::new() }; 1 + largest(&face_of)];
    areas.iter().zip(&face_of).for_each(|(area, face)| faces[*face].normal += area);
    faces.iter_mut().for_each(|face| face.normal = face.normal.normalize());
    let edges = edges(&points, &sides, &face_of, &mut faces);
    let placed = triangles.iter().zip(&face_of).enumerate().map(|(number, (corners, face))| PlacedTriangle {
        corners: corners.map(|corner| points[corner]),
        points: *corners,
        number,
        face: *face,
    });
    Ok(Polyhedron { triangles: TriangleTree::new(placed.collect()), faces, edges })
}

fn largest(numbers: &[usize]) -> usize {
    numbers.iter().copied().max().unwrap_or(0)
}

fn sides_of([a, b, c]: &Corners) -> [[usize; 2]; 3] {
    [[*a, *b], [*b, *c], [*c, *a]]
}

/// The triangles counter-clockwise as seen from outside, so that the volume is positive.
fn outwards(points: &[Vector3<f64>], triangles: &[Corners]) -> Result<Vec<Corners>, PolyhedronMistake> {
    let origin = points[triangles[0][0]];
    let volume_of = |corners: &Corners| {
        let [a, b, c] = corners.map(|corner| points[corner] - origin);
        a.dot(&b.cross(&c)) / 6.0
    };
    let volume: f64 = triangles.iter().map(volume_of).sum();
    let farthest = triangles.iter().flatten().map(|corner| (points[*corner] - origin).amax()).fold(0.0, f64::max);
    if volume.abs() <= LEAST_VOLUME * farthest.powi(3) {
        // An open surface may have none either: that is the clearer message.
        sides(triangles)?;
        return Err(PolyhedronMistake::NoVolume);
    }
    let turned = |[a, b, c]: &Corners| if volume > 0.0 { [*a, *b, *c] } else { [*a, *c, *b] };
    Ok(triangles.iter().map(turned).collect())
}

fn sides(triangles: &[Corners]) -> Result<Sides, PolyhedronMistake> {
    let mut found = Sides::new();
    for (number, corners) in triangles.iter().enumerate() {
        for [from, to] in sides_of(corners) {
            if from == to {
                return Err(PolyhedronMistake::NoArea { triangle: number });
            }
            found.entry([from.min(to), from.max(to)]).or_default().push((number, from < to));
        }
    }
    for (ends, triangles) in &found {
        let ends = *ends;
        match triangles[..] {
            [(_, first), (_, second)] if first != second => {}
            [_, _] => return Err(PolyhedronMistake::Turned { ends }),
            [_] => return Err(PolyhedronMistake::Open { ends }),
            _ => return Err(PolyhedronMistake::Shared { ends }),
        }
    }
    Ok(found)
}

/// The normal of a triangle, as long as twice its area.
fn area(points: &[Vector3<f64>], number: usize, corners: &Corners) -> Result<Vector3<f64>, PolyhedronMistake> {
    let [a, b, c] = corners.map(|corner| points[corner]);
    let area = (b - a).cross(&(c - a));
    let longest = [b - a, c - b, a - c].iter().map(Vector3::norm_squared).fold(0.0, f64::max);
    if area.norm() > LEAST_AREA * longest { Ok(area) } else { Err(PolyhedronMistake::NoArea { triangle: number }) }
}

/// The number of the flat face of each triangle: neighbours in one plane belong together.
fn flat_faces(areas: &[Vector3<f64>], sides: &Sides) -> Vec<usize> {
    let normals: Vec<Vector3<f64>> = areas.iter().map(Vector3::normalize).collect();
    let mut neighbours = vec![Vec::new(); normals.len()];
    for triangles in sides.values() {
        let [one, other] = [triangles[0].0, triangles[1].0];
        if (normals[one] - normals[other]).amax() <= COPLANAR {
            neighbours[one].push(other);
            neighbours[other].push(one);
        }
    }
    let mut face_of = vec![usize::MAX; normals.len()];
    let mut faces = 0;
    for first in 0..normals.len() {
        if face_of[first] != usize::MAX {
            continue;
        }
        let mut reached = vec![first];
        while let Some(triangle) = reached.pop() {
            if face_of[triangle] == usize::MAX {
                face_of[triangle] = faces;
                reached.extend(&neighbours[triangle]);
            }
        }
        faces += 1;
    }
    face_of
}

/// The edges between different faces; adds them to the boundaries of these.
fn edges(points: &[Vector3<f64>], sides: &Sides, face_of: &[usize], faces: &mut [FlatFace]) -> Vec<PolyhedronEdge> {
    let mut edges = Vec::new();
    for (ends, beside) in sides {
        if face_of[beside[0].0] == face_of[beside[1].0] {
            continue;
        }
        let ends = ends.map(|end| points[end]);
        let direction = (ends[1] - ends[0]).normalize();
        for (triangle, is_forward) in beside {
            let face = &mut faces[face_of[*triangle]];
            let sense = if *is_forward { 1.0 } else { -1.0 };
            let outwards = (direction * sense).cross(&face.normal).normalize();
            face.boundary.push(BoundaryEdge { edge: edges.len(), sense, outwards });
        }
        edges.push(PolyhedronEdge { ends, direction });
    }
    edges
}

/// No triangle is crossed by a side of another one with which it shares no point of this side.
pub(super) fn check_crossings(tree: &TriangleTree) -> Result<(), PolyhedronMistake> {
    let mut found: Option<[usize; 2]> = None;
    for triangle in tree.iter() {
        for other in tree.beside(triangle) {
            let crosses = (0..3).any(|k| {
                let ends = [k, (k + 1) % 3];
                ends.iter().all(|end| !triangle.points.contains(&other.points[*end]))
                    && pierces(&ends.map(|end| other.corners[end]), &triangle.corners)
            });
            if crosses {
                let pair = [triangle.number.min(other.number), triangle.number.max(other.number)];
                found = Some(found.map_or(pair, |before| before.min(pair)));
            }
        }
    }
    found.map_or(Ok(()), |triangles| Err(PolyhedronMistake::Crosses { triangles }))
}

/// Whether a line between two places goes through a triangle.
fn pierces([from, to]: &[Vector3<f64>; 2], [a, b, c]: &[Vector3<f64>; 3]) -> bool {
    let volume = |places: [&Vector3<f64>; 4]| {
        let [p, q, r, s] = places;
        (q - p).cross(&(r - p)).dot(&(s - p))
    };
    let around = [volume([from, to, a, b]), volume([from, to, b, c]), volume([from, to, c, a])];
    let is_inside = around.iter().all(|value| *value > 0.0) || around.iter().all(|value| *value < 0.0);
    is_inside && volume([a, b, c, from]) * volume([a, b, c, to]) < 0.0
}

/// Next to each corner there is a surface, and the ball about it meets no more faces than are taken.
pub(super) fn check_corners(polyhedron: &Polyhedron) -> Result<(), PolyhedronMistake> {
    let mut corners = BTreeMap::new();
    for triangle in polyhedron.triangles.iter() {
        corners.extend(triangle.points.into_iter().zip(triangle.corners));
    }
    for (point, corner) in corners {
        if polyhedron.triangles.faces_within(1.0, &corner).len() > MOST_FACES_IN_BALL {
            return Err(PolyhedronMistake::WideRounding { point });
        }
        if !has_surface(polyhedron, &corner) {
            return Err(PolyhedronMistake::Thin { point });
        }
    }
    Ok(())
}
