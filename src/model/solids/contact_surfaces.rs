//! The surfaces of a model that touch each other, in the terms of mechanics.

use crate::mechanics::contact::bodies::PlaneVector;
use crate::mechanics::contact::bodies::mortar::MortarNode;
use crate::mechanics::contact::bodies::node_to_surface::NodeToSurface;
use crate::mechanics::contact::bodies::opposite_surface::{OppositeSurface, SurfaceError};
use crate::mechanics::contact::kinematics::CoupledKinematics;
use crate::model::input::limits::PENETRATION_TOLERANCE;
use crate::model::input::names::quoted;
use crate::model::request::{Contact, ContactDiscretisation, Element, Model, PlaneCondition};
use crate::model::solids::faces::{FaceMatch, surface_faces};
use crate::resources::budget;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A penetration at the start of up to this part of a face's length is that of the mesh: round bodies whose meshes do not
/// match overlap by about an eighth of the square of an angle between faces.
const MESHED_PENETRATION: f64 = 0.05;

/// How often a surface is gone through for each of its contacts.
const GONE_THROUGH: usize = 10;

/// The surfaces that contacts of bodies name.
pub(crate) struct ContactSurfaces<'a> {
    model: &'a Model,
    unit: f64,
    origin: PlaneVector,
    surfaces: HashMap<&'a str, Result<Arc<OppositeSurface>, String>>,
}

/// A contact of bodies.
#[derive(Debug)]
pub(crate) struct BodyContact {
    pub kinematics: Arc<dyn CoupledKinematics>,
    /// Gap without displacements, over the unit of length.
    pub gap: f64,
    /// How far the meshes overlap at the start, over the unit of length; such a contact is closed.
    pub overlap: f64,
}

/// What is wrong with a contact of bodies: the member it is about, and what would do.
pub(crate) type BodyContactMistake = (&'static str, String);

impl<'a> ContactSurfaces<'a> {
    /// The surfaces of all contacts of bodies, with lengths over `unit`. Surfaces that cannot touch others say why when a
    /// contact asks for them.
    pub fn new(model: &'a Model, unit: f64) -> Self {
        let bodies = model.contacts.iter().filter(|contact| contact.against.is_some());
        let named: HashSet<&str> =
            bodies.flat_map(|contact| [contact.surface.as_deref(), contact.against.as_deref()]).flatten().collect();
        let first = model.nodes.values().next();
        let origin = first.map_or([0.0; 2], |place| [0, 1].map(|k| place.get(k).copied().unwrap_or(0.0)));
        let mut built = Self { model, unit, origin, surfaces: HashMap::new() };
        if !named.is_empty() {
            let all = model.surfaces.keys().zip(surface_faces(model));
            for (name, faces) in all.filter(|(name, _)| named.contains(name.as_str())) {
                let surface = built.surface(&faces);
                built.surfaces.insert(name.as_str(), surface.map(Arc::new));
            }
        }
        built
    }

    /// The position of a node from the origin, over the unit.
    fn place(&self, node: usize) -> PlaneVector {
        let place = self.model.nodes.get_index(node).map(|(_, place)| place.as_slice()).unwrap_or_default();
        [0, 1].map(|k| (place.get(k).copied().unwrap_or(0.0) - self.origin[k]) / self.unit)
    }

    fn surface(&self, faces: &[FaceMatch]) -> Result<OppositeSurface, String> {
        if self.model.dimension != 2 {
            return Err("surfaces touch each other in the plane; in space not in this version".to_owned());
        }
        let mut lines = Vec::with_capacity(faces.len());
        for face in faces {
            match face {
                FaceMatch::Face(face) => {
                    let solid = self.model.elements.get(face.element).and_then(Element::solid);
                    if solid.is_some_and(|(_, solid)| solid.plane == Some(PlaneCondition::Axisymmetric)) {
                        return Err(
                            "surfaces of bodies of revolution do not touch each other in this version".to_owned()
                        );
                    }
                    let [first, last] = face.nodes[..] else {
                        return Err(
                            "the surface has faces of three nodes; surfaces that touch each other have faces of two: \
                                    mesh the body with triangle3 or quadrilateral4"
                                .to_owned(),
                        );
                    };
                    // Solids have their faces with the outer side on the right.
                    lines.push([last, first]);
                }
                FaceMatch::Side(nodes) => lines.push(*nodes),
                FaceMatch::None | FaceMatch::Inside => return Err("the surface has faces that are none".to_owned()),
            }
        }
        let name =
            |node: usize| quoted(self.model.nodes.get_index(node).map_or("", |(name, _)| name.as_str())).to_string();
        OppositeSurface::new(&lines, |node| self.place(node)).map_err(|error| match error {
            SurfaceError::Branches(node) => {
                format!(
                    "{error} {}: the surface branches there; one face before and one after it are expected",
                    name(node)
                )
            }
            SurfaceError::NoLength([first, last]) => {
                format!("{error}: {} and {} are at one place", name(first), name(last))
            }
        })
    }

    fn find(&self, name: &str, member: &'static str) -> Result<Arc<OppositeSurface>, BodyContactMistake> {
        match self.surfaces.get(name) {
            Some(Ok(surface)) => Ok(Arc::clone(surface)),
            Some(Err(mistake)) => Err((member, format!("{}: {mistake}", quoted(name)))),
            None => Err((member, format!("there is no surface {}", quoted(name)))),
        }
    }

    /// Whether a node is on the free side of the surface that it touches, and its faces do not cross it: the mean of the gap
    /// may be negative there, where faces are much longer than those opposite.
    fn is_apart(&self, node: usize, kinematics: &Arc<dyn CoupledKinematics>, opposite: &OppositeSurface) -> bool {
        let is_clear = kinematics.clearance(&|_| 0.0).is_some_and(|(distance, _)| distance > 0.0);
        is_clear && opposite.is_free(self.place(node))
    }

    /// A contact of a node with a surface.
    ///
    /// # Errors
    /// Where the contact makes none.
    pub fn contact(&self, contact: &Contact, node: usize) -> Result<BodyContact, BodyContactMistake> {
        let against = contact.against.as_deref().unwrap_or_default();
        let opposite = self.find(against, "against")?;
        let touched = Arc::clone(&opposite);
        // The whole surface is gone through several times.
        budget::spend(GONE_THROUGH * opposite.faces.len());
        let name = || quoted(&contact.node).to_string();
        if opposite.nodes.contains(&node) {
            let why = format!(
                "{} is a node of {}, too; a surface does not touch itself in this version",
                name(),
                quoted(against)
            );
            return Err(("against", why));
        }
        let own = contact.surface.as_deref().map(|surface| self.find(surface, "surface")).transpose()?;
        let size = |nodes: [PlaneVector; 2]| (nodes[0][0] - nodes[1][0]).hypot(nodes[0][1] - nodes[1][1]);
        let (kinematics, gap, face): (Arc<dyn CoupledKinematics>, f64, f64) =
            match contact.discretisation.unwrap_or_default() {
                ContactDiscretisation::Mortar => {
                    let own = own.ok_or_else(|| {
                        let why = "a mortar contact is of a surface: name the `surface` of the node, or take \
                               `\"discretisation\": \"node_to_surface\"`";
                        ("node", why.to_owned())
                    })?;
                    let Some(at) = own.nodes.iter().position(|one| *one == node) else {
                        let surface = quoted(contact.surface.as_deref().unwrap_or_default()).to_string();
                        return Err(("node", format!("{} is no node of {surface}", name())));
                    };
                    let beside = own.faces_at(at);
                    let neighbours = [0, 1].map(|end| beside[end].map(|face| own.nodes[own.faces[face].nodes[end]]));
                    if let Some(shared) = neighbours.into_iter().flatten().find(|node| opposite.nodes.contains(node)) {
                        let shared = self.model.nodes.get_index(shared).map_or("", |(name, _)| name.as_str());
                        let why = format!(
                            "{} is a node of both surfaces; a surface does not touch itself in this version",
                            quoted(shared)
                        );
                        return Err(("against", why));
                    }
                    let kinematics = MortarNode::new(node, neighbours, opposite, |node| self.place(node));
                    let gap = kinematics.initial_gap();
                    let sizes =
                        neighbours.into_iter().flatten().map(|other| size([self.place(node), self.place(other)]));
                    let face = sizes.fold(f64::INFINITY, f64::min);
                    (Arc::new(kinematics), gap, face)
                }
                ContactDiscretisation::NodeToSurface => {
                    let sizes = opposite.faces.iter().map(|face| size(face.nodes.map(|node| opposite.places[node])));
                    let face = sizes.fold(f64::INFINITY, f64::min);
                    let kinematics = NodeToSurface::new(node, self.place(node), opposite);
                    let gap = kinematics.initial_gap();
                    (Arc::new(kinematics), gap, face)
                }
            };
        if kinematics.beyond_end(&|_| 0.0).is_some() {
            // Past the end of the surface there is no contact yet.
            return Ok(BodyContact { kinematics, gap, overlap: 0.0 });
        }
        let is_behind = !touched.is_free(self.place(node)) && gap.abs() > MESHED_PENETRATION * face;
        let is_deep = gap < -MESHED_PENETRATION * face && !self.is_apart(node, &kinematics, &touched);
        if !gap.is_finite() || is_behind || is_deep {
            let found = if is_behind { -gap.abs() } else { gap } * self.unit;
            let why = format!(
                "{} is behind the surface {} at the start, gap {found:?}; a gap of 0 or more is expected (the free side of bars \
                 and beams is to the left of the order of a face's nodes)",
                name(),
                quoted(against)
            );
            return Err(("node", why));
        }
        let reach = kinematics.nodes().iter().filter_map(|node| self.model.nodes.get_index(*node));
        let reach = reach.flat_map(|(_, place)| place).fold(0.0_f64, |most, value| most.max(value.abs())) / self.unit;
        let closed = gap <= PENETRATION_TOLERANCE + 4.0 * f64::EPSILON * reach;
        let overlap = if gap < -PENETRATION_TOLERANCE - 4.0 * f64::EPSILON * reach { -gap } else { 0.0 };
        Ok(BodyContact { kinematics, gap: if closed { 0.0 } else { gap }, overlap })
    }
}
