//! The flat faces and edges of a closed triangle mesh, and what is wrong with triangles that make none.

use crate::algebra::rounded_polyhedron::closest::has_surface;
use crate::algebra::rounded_polyhedron::polyhedron::{BoundaryEdge, FlatFace, Polyhedron, PolyhedronEdge};
use crate::algebra::rounded_polyhedron::triangles::{PlacedTriangle, TriangleTree};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Normals whose components differ by no more than this belong to one flat face: round-off of coordinates.
const COPLANAR: f64 = 1e-12;
/// Least area of a triangle, doubled and relative to the square of its longest side.
const LEAST_AREA: f64 = 1e-12;
/// Least volume, relative to the cube of the farthest corner's distance from the first one.
const LEAST_VOLUME: f64 = 1e-12;
/// Distance from the plane of a triangle, relative to the coordinates, up to which a point may be in it.
const CROSSES: f64 = 1e-9;
/// Faces that the ball about a corner may meet: those of a mesh that has some five edges along the rounding.
pub(crate) const MOST_FACES_IN_BALL: usize = 200;

/// Parts that do not hang together: each is placed among all triangles.
pub(crate) const MOST_PARTS: usize = 100;
/// Pairs of triangles with overlapping boxes that are looked at for crossings: some seconds.
const MOST_PAIRS: usize = 20_000_000;

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
    /// A part of the surface that hangs together is turned against its place: what it encloses would count twice, or less
    /// than nothing.
    Nested { triangle: usize },
    /// Too many parts that do not hang together.
    ManyParts { found: usize },
    /// The boxes of too many triangles overlap.
    Crowded,
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
    check_shells(&points, &triangles, &sides)?;
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
    groups(normals.len(), sides, |one, other| (normals[one] - normals[other]).amax() <= COPLANAR)
}

/// The number of the group of each triangle: neighbours for which `joins` hold belong together.
fn groups(triangles: usize, sides: &Sides, joins: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut neighbours = vec![Vec::new(); triangles];
    for beside in sides.values() {
        let [one, other] = [beside[0].0, beside[1].0];
        if joins(one, other) {
            neighbours[one].push(other);
            neighbours[other].push(one);
        }
    }
    let mut group_of = vec![usize::MAX; triangles];
    let mut groups = 0;
    for first in 0..triangles {
        if group_of[first] != usize::MAX {
            continue;
        }
        let mut reached = vec![first];
        while let Some(triangle) = reached.pop() {
            if group_of[triangle] == usize::MAX {
                group_of[triangle] = groups;
                reached.extend(&neighbours[triangle]);
            }
        }
        groups += 1;
    }
    group_of
}

/// The parts of the surface that hang together are bodies side by side, or cavities in bodies and bodies in cavities: next to
/// each the others count 0 on its outer side, or 1 where it is a cavity.
fn check_shells(points: &[Vector3<f64>], triangles: &[Corners], sides: &Sides) -> Result<(), PolyhedronMistake> {
    let shell_of = groups(triangles.len(), sides, |_, _| true);
    let shells = 1 + largest(&shell_of);
    if shells == 1 {
        return Ok(());
    }
    if shells > MOST_PARTS {
        return Err(PolyhedronMistake::ManyParts { found: shells });
    }
    let mut volumes = vec![0.0; shells];
    let origin = points[triangles[0][0]];
    for (corners, shell) in triangles.iter().zip(&shell_of) {
        let [a, b, c] = corners.map(|corner| points[corner] - origin);
        volumes[*shell] += a.dot(&b.cross(&c));
    }
    for (shell, volume) in volumes.iter().enumerate() {
        let Some(first) = shell_of.iter().position(|other| *other == shell) else { continue };
        let middle = triangles[first].iter().map(|corner| points[*corner]).sum::<Vector3<f64>>() / 3.0;
        let others = triangles.iter().zip(&shell_of).filter(|(_, other)| **other != shell);
        let around: f64 = others.map(|(corners, _)| solid_angle(corners.map(|corner| points[corner] - middle))).sum();
        let depth = (around / (4.0 * PI)).round();
        if depth != if *volume > 0.0 { 0.0 } else { 1.0 } {
            return Err(PolyhedronMistake::Nested { triangle: first });
        }
    }
    Ok(())
}

/// The solid angle of a triangle, positive where it is counter-clockwise as seen from the side that is not the origin's (A. van
/// Oosterom and J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125, doi:10.1109/TBME.1983.325207).
fn solid_angle([a, b, c]: [Vector3<f64>; 3]) -> f64 {
    let [p, q, r] = [a.norm(), b.norm(), c.norm()];
    2.0 * a.dot(&b.cross(&c)).atan2(p * q * r + a.dot(&b) * r + b.dot(&c) * p + c.dot(&a) * q)
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
    let mut pairs = 0;
    for triangle in tree.iter() {
        for other in tree.beside(triangle) {
            pairs += 1;
            if pairs > MOST_PAIRS {
                return Err(PolyhedronMistake::Crowded);
            }
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

/// Whether a line between two places goes through the inside of a triangle, from one side of it to the other by more than the
/// round-off of coordinates: the sides of faces in one plane do not.
fn pierces([from, to]: &[Vector3<f64>; 2], [a, b, c]: &[Vector3<f64>; 3]) -> bool {
    let reach = [from, to, a, b, c].iter().map(|place| place.amax()).fold(0.0, f64::max);
    let volume = |places: [&Vector3<f64>; 4]| {
        let [p, q, r, s] = places;
        (q - p).cross(&(r - p)).dot(&(s - p))
    };
    let area = (b - a).cross(&(c - a)).norm();
    let sides = [[a, b], [b, c], [c, a]].map(|[first, second]| volume([from, to, first, second]));
    let is_inside = sides.iter().all(|value| *value > 0.0) || sides.iter().all(|value| *value < 0.0);
    let ends = [from, to].map(|end| volume([a, b, c, end]));
    is_inside && ends[0] * ends[1] < 0.0 && ends.iter().all(|end| end.abs() > CROSSES * reach * area)
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
