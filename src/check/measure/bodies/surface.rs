//! The surfaces that bodies touch, as posted: their faces in order, with the coordinates along them.

use crate::check::measure::numbers::{MeasuredVector, padded};
use crate::model::request::{Element, Model};
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
}

/// The surfaces that contacts of bodies name, each read once.
pub(in crate::check::measure) struct TouchedSurfaces<'a> {
    /// Faces with their free side on the left, by numbers of nodes.
    pub(super) lines: HashMap<&'a str, Vec<[usize; 2]>>,
    pub(super) faces: HashMap<&'a str, Arc<[OppositeFace]>>,
    /// Undeformed places of all nodes.
    pub(super) places: Arc<[MeasuredVector]>,
    pub(super) no_displacements: Vec<MeasuredVector>,
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
                places: Arc::new([]),
                no_displacements: Vec::new(),
            };
        }
        // A solid has its corners counter-clockwise: seen along its boundary, the free side is on the right.
        let solids = model.elements.iter().filter_map(Element::solid);
        let edges: HashSet<(&str, &str)> = solids
            .flat_map(|(_, solid)| {
                let next = solid.nodes.iter().cycle().skip(1);
                solid.nodes.iter().zip(next).map(|(one, other)| (one.as_str(), other.as_str()))
            })
            .collect();
        let number = |name: &String| model.nodes.get_index_of(name);
        let oriented = |face: &Vec<String>| {
            let [first, last] = face.as_slice() else { return None };
            let numbers = [number(first)?, number(last)?];
            let is_on_the_right = edges.contains(&(first.as_str(), last.as_str()));
            Some(if is_on_the_right { [numbers[1], numbers[0]] } else { numbers })
        };
        let surfaces = model.surfaces.iter().filter(|(name, _)| named.contains(name.as_str()));
        let lines: HashMap<&str, Vec<[usize; 2]>> = surfaces
            .map(|(name, surface)| (name.as_str(), surface.faces.iter().filter_map(oriented).collect()))
            .collect();
        let places: Arc<[MeasuredVector]> = model.nodes.values().map(|place| padded(place)).collect();
        let touched = lines.iter().filter(|(name, _)| against.contains(*name));
        let faces = touched.map(|(name, lines)| (*name, in_order(lines, &places).into())).collect();
        let no_displacements = vec![MeasuredVector::zeros(); places.len()];
        Self { lines, faces, places, no_displacements }
    }
}

/// The faces of a surface with what lies beside them and the coordinates along them.
fn in_order(lines: &[[usize; 2]], places: &[MeasuredVector]) -> Vec<OppositeFace> {
    let ending: HashMap<usize, usize> = lines.iter().enumerate().map(|(index, line)| (line[1], index)).collect();
    let beginning: HashMap<usize, usize> = lines.iter().enumerate().map(|(index, line)| (line[0], index)).collect();
    let mut along = vec![None; lines.len()];
    let mut periods = vec![None; lines.len()];
    let mut chains = vec![0; lines.len()];
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
    let all = lines.iter().zip(along).zip(periods).zip(chains);
    all.map(|(((nodes, along), period), chain)| OppositeFace {
        nodes: *nodes,
        along: along.unwrap_or_default(),
        beside: beside(nodes),
        period,
        chain,
    })
    .collect()
}
