//! The surfaces that bodies touch, as posted: their faces in order, with the coordinates along them.

use crate::check::measure::numbers::{MeasuredVector, padded};
use crate::model::request::{Element, Model, SolidKind, Surface};
use crate::model::solids::closed_surfaces::begin_away_from_contact;
use crate::model::solids::data::is_revolved;
use crate::model::solids::faces::{FaceMatch, SolidFace, surface_faces};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

#[derive(Debug, Clone, Copy)]
pub(super) struct OppositeFace {
    pub nodes: [usize; 2],
    pub along: [f64; 2],
    /// Faces before and after, as indices.
    pub beside: [Option<usize>; 2],
    pub period: Option<f64>,
    /// Number of its chain: the index of the chain's first face.
    pub chain: usize,
    /// Its place in the order of all faces, chain by chain.
    pub rank: usize,
}

/// The surfaces that contacts of bodies name, each read once.
pub(in crate::check::measure) struct TouchedSurfaces<'a> {
    /// Faces with their free side on the left, by numbers of nodes.
    pub(super) lines: HashMap<&'a str, Vec<[usize; 2]>>,
    pub(super) faces: HashMap<&'a str, Arc<[OppositeFace]>>,
    /// Faces in space, their nodes counter-clockwise as seen from the free side, and the triangles of those that are touched.
    faces_in_space: HashMap<&'a str, Vec<Vec<usize>>>,
    pub(super) triangles: HashMap<&'a str, Arc<[MeasuredTriangle]>>,
    /// Undeformed places of all nodes.
    pub(super) places: Arc<[MeasuredVector]>,
    /// Whether they are those of bodies of revolution.
    pub(super) is_revolved: bool,
    pub(super) no_displacements: Vec<MeasuredVector>,
    /// Whether a component of a node is supported.
    held: Vec<bool>,
}

impl<'a> TouchedSurfaces<'a> {
    pub fn new(model: &'a Model) -> Self {
        let bodies = || model.contacts.iter().filter(|contact| contact.against.is_some());
        let against: HashSet<&str> = bodies().filter_map(|contact| contact.against.as_deref()).collect();
        let own = bodies().filter_map(|contact| contact.surface.as_deref());
        let named: HashSet<&str> = own.chain(against.iter().copied()).collect();
        if named.is_empty() {
            return Self {
                lines: HashMap::new(),
                faces: HashMap::new(),
                faces_in_space: HashMap::new(),
                triangles: HashMap::new(),
                places: Arc::new([]),
                is_revolved: false,
                no_displacements: Vec::new(),
                held: Vec::new(),
            };
        }
        // A solid has its corners counter-clockwise: seen along its boundary, the free side is on the right.
        let solids = model.elements.iter().filter_map(Element::solid);
        let edges: HashSet<(&str, &str)> = solids
            .flat_map(|(kind, solid)| {
                let corners = if matches!(kind, SolidKind::Triangle3 | SolidKind::Triangle6) { 3 } else { 4 };
                let corners = &solid.nodes[..corners.min(solid.nodes.len())];
                let next = corners.iter().cycle().skip(1);
                corners.iter().zip(next).map(|(one, other)| (one.as_str(), other.as_str()))
            })
            .collect();
        let number = |name: &String| model.nodes.get_index_of(name);
        // The middle of an edge follows its ends.
        let corners_of = |face: &'a Vec<String>| match face.as_slice() {
            [first, last] => Some([first, last]),
            [a, b, c] => {
                let is_edge = |[one, other]: &[&String; 2]| {
                    let names = (one.as_str(), other.as_str());
                    edges.contains(&names) || edges.contains(&(names.1, names.0))
                };
                [[a, b], [b, c], [a, c]].into_iter().find(is_edge)
            }
            _ => None,
        };
        let oriented = |face: &'a Vec<String>| {
            let [first, last] = corners_of(face)?;
            let numbers = [number(first)?, number(last)?];
            let is_on_the_right = edges.contains(&(first.as_str(), last.as_str()));
            Some(if is_on_the_right { [numbers[1], numbers[0]] } else { numbers })
        };
        let surfaces = model.surfaces.iter().filter(|(name, _)| named.contains(name.as_str()));
        let places: Arc<[MeasuredVector]> = model.nodes.values().map(|place| padded(place)).collect();
        let of_itself: HashSet<&str> =
            bodies().filter(|one| one.touches_itself()).filter_map(|one| one.surface.as_deref()).collect();
        let in_order_of_parts = |(name, surface): (&'a String, &'a Surface)| {
            let lines: Vec<[usize; 2]> = surface.faces.iter().filter_map(oriented).collect();
            if !of_itself.contains(name.as_str()) {
                return (name.as_str(), lines);
            }
            let place = |node: usize| [places[node].x, places[node].y];
            (name.as_str(), begin_away_from_contact(&lines, place))
        };
        let lines: HashMap<&str, Vec<[usize; 2]>> = surfaces.map(in_order_of_parts).collect();
        let touched = lines.iter().filter(|(name, _)| against.contains(*name));
        let faces = touched.map(|(name, lines)| (*name, in_order(lines, &places).into())).collect();
        let no_displacements = vec![MeasuredVector::zeros(); places.len()];
        let faces_in_space = faces_in_space(model, &named);
        let touched = faces_in_space.iter().filter(|(name, _)| against.contains(*name));
        let triangles = touched.map(|(name, faces)| (*name, triangles(faces).into())).collect();
        let is_held = |name: &String| model.supports.get(name).is_some_and(|components| !components.is_empty());
        let held = model.nodes.keys().map(is_held).collect();
        let is_revolved = is_revolved(model);
        Self { lines, faces, faces_in_space, triangles, places, is_revolved, no_displacements, held }
    }

    /// Whether a node of a face is supported.
    pub(super) fn is_held(&self, face: &[usize]) -> bool {
        face.iter().any(|node| self.held[*node])
    }

    /// The faces of a surface at a node, each from this node on.
    pub(super) fn around(&self, surface: &str, node: usize) -> Vec<Vec<usize>> {
        let all = self.faces_in_space.get(surface).into_iter().flatten();
        let from_node = |face: &Vec<usize>| {
            let first = face.iter().position(|other| *other == node)?;
            Some(face.iter().cycle().skip(first).take(face.len()).copied().collect())
        };
        all.filter_map(from_node).collect()
    }
}

/// The faces in space of the surfaces with these names, by their corners: the middles of quadratic faces follow these.
fn faces_in_space<'a>(model: &'a Model, named: &HashSet<&str>) -> HashMap<&'a str, Vec<Vec<usize>>> {
    if model.dimension != 3 {
        return HashMap::new();
    }
    let corners = |face| match face {
        FaceMatch::Face(SolidFace { nodes, .. }) => {
            let corners = if nodes.len() % 3 == 0 { 3 } else { 4 };
            Some(nodes[..corners].to_vec())
        }
        _ => None,
    };
    let all = model.surfaces.keys().zip(surface_faces(model)).filter(|(name, _)| named.contains(name.as_str()));
    all.map(|(name, faces)| (name.as_str(), faces.into_iter().filter_map(corners).collect())).collect()
}

/// The faces of a surface with what lies beside them and the coordinates along them.
fn in_order(lines: &[[usize; 2]], places: &[MeasuredVector]) -> Vec<OppositeFace> {
    let ending: HashMap<usize, usize> = lines.iter().enumerate().map(|(index, line)| (line[1], index)).collect();
    let beginning: HashMap<usize, usize> = lines.iter().enumerate().map(|(index, line)| (line[0], index)).collect();
    let mut along = vec![None; lines.len()];
    let mut periods = vec![None; lines.len()];
    let mut chains = vec![0; lines.len()];
    let mut ranks = vec![0; lines.len()];
    let mut met = 0;
    for start in 0..lines.len() {
        if along[start].is_some() {
            continue;
        }
        let mut first = start;
        while let Some(before) = ending.get(&lines[first][0]).filter(|before| **before != start) {
            first = *before;
        }
        let (mut face, mut from, mut chain) = (first, 0.0, Vec::new());
        let closed = loop {
            let [start, end] = lines[face].map(|node| places[node]);
            let to = from + (end - start).norm();
            along[face] = Some([from, to]);
            chains[face] = first;
            ranks[face] = met;
            met += 1;
            chain.push(face);
            from = to;
            match beginning.get(&lines[face][1]) {
                Some(next) if *next == first => break true,
                Some(next) => face = *next,
                None => break false,
            }
        };
        chain.into_iter().filter(|_| closed).for_each(|face| periods[face] = Some(from));
    }
    let beside = |line: &[usize; 2]| [ending.get(&line[0]).copied(), beginning.get(&line[1]).copied()];
    let all = lines.iter().zip(along).zip(periods).zip(chains).zip(ranks);
    all.map(|((((nodes, along), period), chain), rank)| OppositeFace {
        nodes: *nodes,
        along: along.unwrap_or_default(),
        beside: beside(nodes),
        period,
        chain,
        rank,
    })
    .collect()
}

/// A triangle of a face in space: a face of three nodes, or a quarter of one of four around its centre.
#[derive(Debug, Clone)]
pub(super) struct MeasuredTriangle {
    /// The nodes of each corner, with their shares.
    pub corners: [Vec<(usize, f64)>; 3],
    /// Whether the surface ends at the edge from each corner to the next.
    pub ends: [bool; 3],
    /// The nodes of its face.
    pub face: Vec<usize>,
    /// Number of the connected part of the surface.
    pub part: usize,
}

impl MeasuredTriangle {
    /// The triangles of a face whose nodes run counter-clockwise as seen from the free side.
    pub fn of_face(face: &[usize], ends: &[bool], part: usize) -> Vec<Self> {
        let count = face.len();
        let node = |at: usize| vec![(face[at % count], 1.0)];
        let face_nodes = face.to_vec();
        if count == 3 {
            let ends = [ends[0], ends[1], ends[2]];
            return vec![Self { corners: [node(0), node(1), node(2)], ends, face: face_nodes, part }];
        }
        let centre: Vec<(usize, f64)> = face.iter().map(|node| (*node, 1.0 / count as f64)).collect();
        let quarter = |at: usize| Self {
            corners: [node(at), node(at + 1), centre.clone()],
            ends: [ends[at], false, false],
            face: face_nodes.clone(),
            part,
        };
        (0..count).map(quarter).collect()
    }

    /// The places of the corners.
    pub fn places(&self, position: &dyn Fn(usize) -> MeasuredVector) -> [MeasuredVector; 3] {
        let place = |corner: &Vec<(usize, f64)>| corner.iter().map(|(node, share)| position(*node) * *share).sum();
        [place(&self.corners[0]), place(&self.corners[1]), place(&self.corners[2])]
    }
}

/// The triangles of the faces of a surface in space.
fn triangles(faces: &[Vec<usize>]) -> Vec<MeasuredTriangle> {
    let edges = |face: &Vec<usize>| -> Vec<[usize; 2]> {
        (0..face.len()).map(|k| [face[k], face[(k + 1) % face.len()]]).collect()
    };
    let by_edge: HashMap<[usize; 2], usize> = faces
        .iter()
        .enumerate()
        .flat_map(|(index, face)| edges(face).into_iter().map(move |edge| (edge, index)))
        .collect();
    // Each face takes the smallest number among those it is connected with, until none changes.
    let mut parts: Vec<usize> = (0..faces.len()).collect();
    loop {
        let before = parts.clone();
        for (index, face) in faces.iter().enumerate() {
            for beside in edges(face).into_iter().filter_map(|[one, other]| by_edge.get(&[other, one])) {
                let least = parts[index].min(parts[*beside]);
                (parts[index], parts[*beside]) = (least, least);
            }
        }
        if before == parts {
            break;
        }
    }
    let all = faces.iter().zip(parts).flat_map(|(face, part)| {
        let ends: Vec<bool> = edges(face).iter().map(|[one, other]| !by_edge.contains_key(&[*other, *one])).collect();
        MeasuredTriangle::of_face(face, &ends, part)
    });
    all.collect()
}
