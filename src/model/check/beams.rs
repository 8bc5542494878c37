//! Checks beams.

use crate::model::check::numbers::{self, difference, largest, norm};
use crate::model::check::scope::Scope;
use crate::model::check::structure::distinct_nodes;
use crate::model::input::limits::COINCIDENCE_TOLERANCE;
use crate::model::input::mistakes::{DocumentPlace, Mistakes};
use crate::model::input::names::quoted;
use crate::model::request::{Component, Element};

/// Cosine of the angle between the chords of a beam of three nodes below which the beam turns back on itself: no circle
/// through its nodes passes them in this order.
const TURNS_BACK: f64 = -0.999;

/// Notes an element that there is only in the plane.
pub(super) fn plane(what: &str, scope: &Scope, at: &DocumentPlace, mistakes: &mut Mistakes) {
    if scope.model.dimension != 2 {
        let detail = || format!("{what} in {} dimensions is not taken; it lies in the plane", scope.model.dimension);
        mistakes.add(&at.member("kind"), detail);
    }
}

pub(super) fn beam(scope: &Scope, element: &Element, at: &DocumentPlace, mistakes: &mut Mistakes) {
    let Element::Beam { nodes, axial_stiffness, bending_stiffness, shear_stiffness, releases, name: _ } = element
    else {
        return;
    };
    plane("a beam", scope, at, mistakes);
    numbers::positive(*axial_stiffness, &at.member("axial_stiffness"), mistakes);
    numbers::positive(*bending_stiffness, &at.member("bending_stiffness"), mistakes);
    if let Some(shear) = *shear_stiffness {
        numbers::positive(shear, &at.member("shear_stiffness"), mistakes);
    }
    let found = distinct_nodes(scope, nodes, 3, at, mistakes);
    if !matches!(nodes.len(), 2 | 3) {
        mistakes
            .add(&at.member("nodes"), || format!("found {} nodes; a beam has 2, or 3 in order along it", nodes.len()));
    } else if let Some(found) = found {
        shape(scope, &found, &at.member("nodes"), mistakes);
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

/// The nodes lie apart, and in an order that a beam can have.
fn shape(scope: &Scope, nodes: &[usize], at: &DocumentPlace, mistakes: &mut Mistakes) {
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
        }
    }
}
