//! Checks beams.

use crate::model::check::scope::Scope;
use crate::model::check::scope::numbers::{self, difference, largest, norm};
use crate::model::check::structure::distinct_nodes;
use crate::model::input::limits::COINCIDENCE_TOLERANCE;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::quoted;
use crate::model::request::{BendingStiffness, Component, Element};

/// Cosine of the angle between the chords of a beam of three nodes below which the beam turns back on itself: no circle
/// through its nodes passes them in this order.
const TURNS_BACK: f64 = -0.999;

/// Cosine of the angle between a beam and its orientation above which the two count as parallel.
const LARGEST_COSINE: f64 = 1.0 - 1e-8;

/// Notes an element that there is only in the plane.
pub(super) fn plane(what: &str, scope: &Scope, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if scope.model.dimension != 2 {
        let detail = || format!("{what} in {} dimensions is not taken; it lies in the plane", scope.model.dimension);
        mistakes.add(&at.member("kind"), detail);
    }
}

pub(super) fn beam(scope: &Scope, element: &Element, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let Element::Beam { nodes, axial_stiffness, shear_stiffness, releases, .. } = element else { return };
    numbers::positive(*axial_stiffness, &at.member("axial_stiffness"), mistakes);
    section(scope, element, at, mistakes);
    if let Some(shear) = *shear_stiffness {
        numbers::positive(shear, &at.member("shear_stiffness"), mistakes);
    }
    let found = distinct_nodes(scope, nodes, 3, at, mistakes);
    if !matches!(nodes.len(), 2 | 3) {
        mistakes
            .add(&at.member("nodes"), || format!("found {} nodes; a beam has 2, or 3 in order along it", nodes.len()));
    } else if let Some(found) = found {
        shape(scope, element, &found, at, mistakes);
    }
    if scope.model.dimension == 3 && !releases.is_empty() {
        let detail = || "releases of a beam in space are not taken; a bar would do where no moment is to pass";
        mistakes.add(&at.member("releases"), detail);
        return;
    }
    let ends = [nodes.first(), nodes.last()];
    for (node, components) in releases {
        let releases_at = at.member("releases");
        let at = releases_at.member(node);
        if !ends.contains(&Some(node)) {
            let ends: Vec<String> = ends.into_iter().flatten().map(|end| quoted(end).to_string()).collect();
            let detail = || format!("{} is no end of this beam; {} would do", quoted(node), ends.join(" or "));
            mistakes.add(&at, detail);
        }
        if components.is_empty() {
            mistakes.add(&at, || "nothing is released here; `rz` is expected, or leave the node out");
        }
        for (index, component) in components.iter().enumerate() {
            if *component != Component::Rz || index > 0 {
                mistakes
                    .add(&at.index(index), || "a beam can be released in its rotation alone; `rz` once is expected");
            }
        }
    }
}

/// As many stiffnesses as the dimension has, and no others.
fn section(scope: &Scope, element: &Element, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let Element::Beam { bending_stiffness, torsional_stiffness, orientation, .. } = element else { return };
    let bending_at = at.member("bending_stiffness");
    match (scope.model.dimension, bending_stiffness) {
        (3, BendingStiffness::Plane(_)) => {
            mistakes.add(&bending_at, || "found one number; in space two are expected, as `[EI_1, EI_2]`");
        }
        (2, BendingStiffness::Space(_)) => {
            mistakes.add(&bending_at, || "found two numbers; in the plane one is expected")
        }
        (_, BendingStiffness::Plane(bending)) => drop(numbers::positive(*bending, &bending_at, mistakes)),
        (_, BendingStiffness::Space(both)) => {
            for (index, bending) in both.iter().enumerate() {
                numbers::positive(*bending, &bending_at.index(index), mistakes);
            }
        }
    }
    let (torsion_at, orientation_at) = (at.member("torsional_stiffness"), at.member("orientation"));
    if scope.model.dimension == 2 {
        if torsional_stiffness.is_some() {
            mistakes.add(&torsion_at, || "a beam in the plane is not twisted; leave this out");
        }
        if orientation.is_some() {
            mistakes.add(&orientation_at, || "a beam in the plane has no orientation; leave this out");
        }
        return;
    }
    match torsional_stiffness {
        None => mistakes.add(at, || "`torsional_stiffness` is missing; a beam in space needs GJ, a number above 0"),
        Some(torsional) => drop(numbers::positive(*torsional, &torsion_at, mistakes)),
    }
    match orientation {
        None => mistakes.add(at, || {
            "`orientation` is missing; a beam in space needs a vector not parallel to it, whose part across it is axis 1"
        }),
        Some(vector) => {
            if numbers::vector(vector, 3, &orientation_at, mistakes) && largest(vector) == 0.0 {
                mistakes.add(&orientation_at, || "the vector is zero; one not parallel to the beam is expected");
            }
        }
    }
}

/// The nodes lie apart, and in an order that a beam can have; in space the orientation is not along it.
fn shape(scope: &Scope, element: &Element, nodes: &[usize], beam_at: &DocumentPlace, mistakes: &mut Mistakes) {
    let nodes_at = beam_at.member("nodes");
    let at = &nodes_at;
    let places: Option<Vec<&[f64]>> = nodes.iter().map(|node| scope.position(*node)).collect();
    let Some(places) = places else { return };
    let reach = places.iter().map(|place| largest(place)).fold(0.0, f64::max);
    let chords: Vec<_> = places.windows(2).map(|pair| difference(pair[1], pair[0])).collect();
    let lengths: Vec<f64> = chords.iter().map(|chord| norm(chord)).collect();
    if lengths.iter().any(|length| *length <= COINCIDENCE_TOLERANCE * reach) {
        mistakes.add(at, || "two of the beam's nodes are at the same place; a length above 0 is expected");
    } else if let ([first, second], [one, other]) = (&chords[..], &lengths[..]) {
        let cosine = numbers::dot(first, second) / (one * other);
        if cosine < TURNS_BACK {
            mistakes
                .add(at, || "the beam turns back at its second node; three nodes in order along the beam are expected");
            return;
        }
    }
    let Element::Beam { orientation: Some(vector), .. } = element else { return };
    if scope.model.dimension == 3 && numbers::well_formed(vector, 3) && largest(vector) > 0.0 {
        let tangent = tangent(&chords, &lengths);
        let cosine = numbers::dot(vector, &tangent).abs() / (norm(vector) * norm(&tangent));
        if cosine > LARGEST_COSINE {
            let detail =
                || format!("found {vector:?}, parallel to the beam; a vector across it, or partly so, is expected");
            mistakes.add(&beam_at.member("orientation"), detail);
        }
    }
}

/// The direction of a beam: along its chord, or of three nodes the tangent of their circle at the second.
fn tangent(chords: &[Vec<f64>], lengths: &[f64]) -> Vec<f64> {
    match (chords, lengths) {
        ([first, second], [one, other]) => {
            // The tangent encloses with each chord half the angle of its arc: the sines are as the chords.
            let parts = first.iter().zip(second);
            parts.map(|(a, b)| a / one * other + b / other * one).collect()
        }
        _ => chords.first().cloned().unwrap_or_default(),
    }
}
