//! The surfaces of a model that touch each other, in the terms of mechanics.

use crate::mechanics::contact::bodies::PlaneVector;
use crate::mechanics::contact::bodies::mortar::MortarNode;
use crate::mechanics::contact::bodies::node_to_surface::NodeToSurface;
use crate::mechanics::contact::bodies::opposite_surface::{OppositeSurface, SurfaceError};
use crate::mechanics::contact::bodies::self_contact::crossed;
use crate::mechanics::contact::bodies::space::mortar::MortarNodeInSpace;
use crate::mechanics::contact::bodies::space::surface::{SurfaceInSpace, SurfaceInSpaceError};
use crate::mechanics::contact::kinematics::CoupledKinematics;
use crate::mechanics::contact::vector::{Vector, add, size};
use crate::model::input::limits::PENETRATION_TOLERANCE;
use crate::model::input::names::quoted;
use crate::model::request::{Contact, ContactDiscretisation, Model};
use crate::model::solids::closed_surfaces::begin_away_from_contact;
use crate::model::solids::data::is_revolved;
use crate::model::solids::faces::{FaceMatch, surface_faces};
use crate::model::solids::middle_nodes::following_middles;
use crate::resources::budget;
use smallvec::SmallVec;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// A penetration at the start of up to this part of a face's length is that of the mesh: round bodies whose meshes do not
/// match overlap by about an eighth of the square of an angle between faces.
const MESHED_PENETRATION: f64 = 0.05;

const SIDE_OF_REVOLUTION: &str = "sides of bars, springs and beams do not touch bodies of revolution; model the part by \
                                  axisymmetric solids";

const NO_FACES: &str = "the surface has faces that are none";

/// Which side of a surface in the plane is free.
const FREE_SIDE: &str = " (the free side of bars and beams is to the left of the order of a face's nodes)";

/// How often a surface is gone through for each of its contacts.
const GONE_THROUGH: usize = 10;

/// The surfaces that contacts of bodies name.
pub(crate) struct ContactSurfaces<'a> {
    model: &'a Model,
    unit: f64,
    origin: Vector,
    /// Whether the bodies are those of revolution.
    is_revolved: bool,
    surfaces: HashMap<&'a str, Result<TouchedSurface, String>>,
    /// The middles of edges that follow the ends of these.
    following: BTreeMap<usize, [usize; 2]>,
}

/// A surface that touches another.
#[derive(Debug, Clone)]
enum TouchedSurface {
    Plane(Arc<OppositeSurface>),
    Space(Arc<SurfaceInSpace>),
}

impl TouchedSurface {
    fn nodes(&self) -> &[usize] {
        match self {
            Self::Plane(surface) => &surface.nodes,
            Self::Space(surface) => &surface.nodes,
        }
    }

    fn faces(&self) -> usize {
        match self {
            Self::Plane(surface) => surface.faces.len(),
            Self::Space(surface) => surface.faces.len(),
        }
    }

    /// Whether a point is on the free side of the undeformed surface.
    fn is_free(&self, point: Vector) -> bool {
        match self {
            Self::Plane(surface) => surface.is_free([point[0], point[1]]),
            Self::Space(surface) => surface.is_free(point),
        }
    }
}

/// The kinematics of a contact, its gap without displacements, and the size of a face.
type BuiltKinematics = (Arc<dyn CoupledKinematics>, f64, f64);

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
        let may_touch_itself = |name: &str| {
            bodies.clone().any(|contact| contact.touches_itself() && contact.surface.as_deref() == Some(name))
        };
        let named: HashSet<&str> = bodies
            .clone()
            .flat_map(|contact| [contact.surface.as_deref(), contact.against.as_deref()])
            .flatten()
            .collect();
        let first = model.nodes.values().next();
        let is_revolved = is_revolved(model);
        let is_radius = |axis: usize| is_revolved && axis == 0;
        let from = |place: &[f64], axis: usize| place.get(axis).copied().filter(|_| !is_radius(axis)).unwrap_or(0.0);
        let origin = first.map_or([0.0; 3], |place| [0, 1, 2].map(|axis| from(place, axis)));
        let (surfaces, following) = (HashMap::new(), following_middles(model));
        let mut built = Self { model, unit, origin, is_revolved, surfaces, following };
        if !named.is_empty() {
            let all = model.surfaces.keys().zip(surface_faces(model));
            for (name, faces) in all.filter(|(name, _)| named.contains(name.as_str())) {
                let surface = match model.dimension {
                    2 => built
                        .surface(&faces, may_touch_itself(name))
                        .map(|surface| TouchedSurface::Plane(Arc::new(surface))),
                    _ => built.surface_in_space(&faces).map(|surface| TouchedSurface::Space(Arc::new(surface))),
                };
                built.surfaces.insert(name.as_str(), surface);
            }
        }
        built
    }

    /// The position of a node from the origin, over the unit; in bodies of revolution the origin is on the axis.
    fn place(&self, node: usize) -> Vector {
        let place = self.model.nodes.get_index(node).map(|(_, place)| place.as_slice()).unwrap_or_default();
        [0, 1, 2].map(|k| place.get(k).map_or(0.0, |value| (value - self.origin[k]) / self.unit))
    }

    fn place_in_plane(&self, node: usize) -> PlaneVector {
        let [x, y, _] = self.place(node);
        [x, y]
    }

    /// Whether a component of a node is supported.
    fn is_held(&self, node: usize) -> bool {
        let supports = self.model.nodes.get_index(node).and_then(|(name, _)| self.model.supports.get(name));
        supports.is_some_and(|components| !components.is_empty())
    }

    fn name(&self, node: usize) -> String {
        quoted(self.model.nodes.get_index(node).map_or("", |(name, _)| name.as_str())).to_string()
    }

    fn surface_in_space(&self, faces: &[FaceMatch]) -> Result<SurfaceInSpace, String> {
        let mut corners: Vec<SmallVec<[usize; 4]>> = Vec::with_capacity(faces.len());
        for face in faces {
            let FaceMatch::Face(face) = face else { return Err(NO_FACES.to_owned()) };
            // The middles of quadratic faces follow the ends of their edges.
            corners.push(SmallVec::from_slice(&face.nodes[..face.kind.corners()]));
        }
        SurfaceInSpace::new(&corners, |node| self.place(node)).map_err(|error| match &error {
            SurfaceInSpaceError::Branches([one, other]) => format!(
                "{error}, from {} to {}: the surface branches there; one face, or two, are expected",
                self.name(*one),
                self.name(*other)
            ),
            SurfaceInSpaceError::NoArea(nodes) => {
                let names: Vec<String> = nodes.iter().map(|node| self.name(*node)).collect();
                format!("{error}: {}", names.join(", "))
            }
        })
    }

    fn surface(&self, faces: &[FaceMatch], may_touch_itself: bool) -> Result<OppositeSurface, String> {
        let mut lines = Vec::with_capacity(faces.len());
        for face in faces {
            match face {
                FaceMatch::Face(face) => {
                    // A middle follows the ends of its edge.
                    let [first, last, ..] = face.nodes[..] else { return Err(NO_FACES.to_owned()) };
                    // Solids have their faces with the outer side on the right.
                    lines.push([last, first]);
                }
                FaceMatch::Side(_) if self.is_revolved => return Err(SIDE_OF_REVOLUTION.to_owned()),
                FaceMatch::Side(nodes) => lines.push(*nodes),
                FaceMatch::None | FaceMatch::Inside => return Err(NO_FACES.to_owned()),
            }
        }
        if may_touch_itself {
            lines = begin_away_from_contact(&lines, |node| self.place_in_plane(node));
        }
        let name = |node: usize| self.name(node);
        let built = OppositeSurface::new(&lines, |node| self.place_in_plane(node));
        let surface = built.map(|surface| OppositeSurface { is_revolved: self.is_revolved, ..surface });
        surface.map_err(|error| match error {
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

    fn find(&self, name: &str, member: &'static str) -> Result<TouchedSurface, BodyContactMistake> {
        match self.surfaces.get(name) {
            Some(Ok(surface)) => Ok(surface.clone()),
            Some(Err(mistake)) => Err((member, format!("{}: {mistake}", quoted(name)))),
            None => Err((member, format!("there is no surface {}", quoted(name)))),
        }
    }

    /// Whether the `surface` of a mortar contact in the plane reaches beyond an end of the other, and the other beyond none of
    /// its own.
    pub fn reaches_beyond(&self, contact: &Contact) -> bool {
        let find = |name: &Option<String>| name.as_deref().and_then(|name| self.surfaces.get(name)?.as_ref().ok());
        match (find(&contact.surface), find(&contact.against)) {
            (Some(TouchedSurface::Plane(own)), Some(TouchedSurface::Plane(other))) if !contact.touches_itself() => {
                contact.discretisation.unwrap_or_default() == ContactDiscretisation::Mortar
                    && own.has_end_of(other).contains(&true)
                    && other.has_end_of(own) == [false; 2]
            }
            _ => false,
        }
    }

    /// Whether a node is on the free side of the surface that it touches, and its faces do not cross it: the mean of the gap
    /// may be negative there, where faces are much longer than those opposite.
    fn is_apart(&self, node: usize, kinematics: &Arc<dyn CoupledKinematics>, opposite: &TouchedSurface) -> bool {
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
        // The whole surface is gone through several times.
        budget::spend(GONE_THROUGH * opposite.faces());
        let name = || quoted(&contact.node).to_string();
        if let Some([a, b]) = self.following.get(&node) {
            let why = format!(
                "{} is the middle of an edge, which follows its ends {} and {} where bodies touch each other; leave its \
                 contact out",
                name(),
                self.name(*a),
                self.name(*b)
            );
            return Err(("node", why));
        }
        if contact.touches_itself() {
            return self.contact_with_itself(contact, node, &opposite);
        }
        if opposite.nodes().contains(&node) {
            return Err(("against", shared_node(&name(), against)));
        }
        let (kinematics, gap, face) = match contact.discretisation.unwrap_or_default() {
            ContactDiscretisation::Mortar => self.mortar(contact, node, &opposite)?,
            ContactDiscretisation::NodeToSurface => self.node_to_surface(node, &opposite)?,
        };
        let own = &kinematics.nodes()[..kinematics.own_nodes()];
        if let Some(shared) = own.iter().find(|node| opposite.nodes().contains(node)) {
            return Err(("against", shared_node(&self.name(*shared), against)));
        }
        if kinematics.beyond_end(&|_| 0.0).is_some() {
            // Past the end of the surface there is no contact yet.
            return Ok(BodyContact { kinematics, gap, overlap: 0.0 });
        }
        let is_behind = !opposite.is_free(self.place(node)) && gap.abs() > MESHED_PENETRATION * face;
        let is_deep = gap < -MESHED_PENETRATION * face && !self.is_apart(node, &kinematics, &opposite);
        if !gap.is_finite() || is_behind || is_deep {
            let found = if is_behind { -gap.abs() } else { gap } * self.unit;
            let side = match opposite {
                TouchedSurface::Plane(_) => FREE_SIDE,
                TouchedSurface::Space(_) => "",
            };
            let why = format!(
                "{} is behind the surface {} at the start, gap {found:?}; a gap of 0 or more is expected{side}",
                name(),
                quoted(against)
            );
            return Err(("node", why));
        }
        Ok(self.closed_or_open(kinematics, gap))
    }

    /// A contact whose gap at the start is not wrong: of 0 where it is one of round-off or of the meshes.
    fn closed_or_open(&self, kinematics: Arc<dyn CoupledKinematics>, gap: f64) -> BodyContact {
        let reach = kinematics.nodes().iter().filter_map(|node| self.model.nodes.get_index(*node));
        let reach = reach.flat_map(|(_, place)| place).fold(0.0_f64, |most, value| most.max(value.abs())) / self.unit;
        let closed = gap <= PENETRATION_TOLERANCE + 4.0 * f64::EPSILON * reach;
        let overlap = if gap < -PENETRATION_TOLERANCE - 4.0 * f64::EPSILON * reach { -gap } else { 0.0 };
        BodyContact { kinematics, gap: if closed { 0.0 } else { gap }, overlap }
    }

    /// A node with the surface that it belongs to.
    fn contact_with_itself(
        &self,
        contact: &Contact,
        node: usize,
        surface: &TouchedSurface,
    ) -> Result<BodyContact, BodyContactMistake> {
        let TouchedSurface::Plane(surface) = surface else {
            let why = "in space a surface does not touch itself in this version: name the parts that may meet as two \
                       surfaces without common nodes";
            return Err(("against", why.to_owned()));
        };
        if contact.discretisation == Some(ContactDiscretisation::NodeToSurface) {
            let why = "a surface touches itself by mortar contacts: leave `discretisation` out";
            return Err(("discretisation", why.to_owned()));
        }
        let Some(at) = surface.nodes.iter().position(|one| *one == node) else {
            let name = contact.against.as_deref().unwrap_or_default();
            return Err(("node", format!("{} is no node of {}", self.name(node), quoted(name))));
        };
        for own in surface.faces_at(at).into_iter().flatten() {
            if let Some(other) = crossed(surface, own) {
                let named = |face: usize| surface.faces[face].nodes.map(|node| self.name(surface.nodes[node]));
                let ([a, b], [c, d]) = (named(own), named(other));
                let why =
                    format!("the surface crosses itself at the start: its face from {a} to {b} that from {c} to {d}");
                return Err(("against", why));
            }
        }
        let kinematics = MortarNode::in_itself(at, Arc::clone(surface));
        let gap = kinematics.initial_gap();
        let face = self.shortest_face(&kinematics);
        if gap < -MESHED_PENETRATION * face && !kinematics.clearance(&|_| 0.0).is_some_and(|(way, _)| way > 0.0) {
            let why = format!(
                "{} is behind its own surface at the start, gap {:?}; a gap of 0 or more is expected{FREE_SIDE}",
                self.name(node),
                gap * self.unit
            );
            return Err(("node", why));
        }
        Ok(self.closed_or_open(Arc::new(kinematics), gap))
    }

    /// The shortest of the faces at the node of a contact.
    fn shortest_face(&self, kinematics: &dyn CoupledKinematics) -> f64 {
        let own = &kinematics.nodes()[..kinematics.own_nodes()];
        let place = self.place(own[0]);
        let away = own[1..].iter().map(|other| size(&add(&self.place(*other), -1.0, &place)));
        away.fold(f64::INFINITY, f64::min)
    }

    /// A node with the faces of its surface.
    fn mortar(
        &self,
        contact: &Contact,
        node: usize,
        opposite: &TouchedSurface,
    ) -> Result<BuiltKinematics, BodyContactMistake> {
        let own = contact.surface.as_deref().map(|surface| self.find(surface, "surface")).transpose()?;
        let own = own.ok_or_else(|| {
            let why = "a mortar contact is of a surface: name the `surface` of the node, or take \
                       `\"discretisation\": \"node_to_surface\"`";
            ("node", why.to_owned())
        })?;
        let Some(at) = own.nodes().iter().position(|one| *one == node) else {
            let surface = quoted(contact.surface.as_deref().unwrap_or_default()).to_string();
            return Err(("node", format!("{} is no node of {surface}", self.name(node))));
        };
        match (own, opposite) {
            (TouchedSurface::Plane(own), TouchedSurface::Plane(opposite)) => {
                let beside = own.faces_at(at);
                let neighbours = [0, 1].map(|end| beside[end].map(|face| own.nodes[own.faces[face].nodes[end]]));
                let place = |node: usize| self.place_in_plane(node);
                let kinematics = MortarNode::new(node, neighbours, Arc::clone(opposite), place);
                let gap = kinematics.initial_gap();
                let face = self.shortest_face(&kinematics);
                Ok((Arc::new(kinematics), gap, face))
            }
            (TouchedSurface::Space(own), TouchedSurface::Space(opposite)) => {
                let is_held = |node: usize| self.is_held(node);
                let kinematics = MortarNodeInSpace::new(at, &own, Arc::clone(opposite), is_held);
                let gap = kinematics.initial_gap();
                let face = self.shortest_face(&kinematics);
                Ok((Arc::new(kinematics), gap, face))
            }
            // All surfaces of a model are of its dimension.
            _ => Err(("surface", NO_FACES.to_owned())),
        }
    }

    /// A node by itself.
    fn node_to_surface(&self, node: usize, opposite: &TouchedSurface) -> Result<BuiltKinematics, BodyContactMistake> {
        let TouchedSurface::Plane(opposite) = opposite else {
            let why = "in space surfaces touch each other by mortar contacts alone, in this version: leave \
                       `discretisation` out and name the `surface` of the node";
            return Err(("discretisation", why.to_owned()));
        };
        let length = |nodes: [usize; 2]| {
            let [first, last] = nodes.map(|node| opposite.places[node]);
            (first[0] - last[0]).hypot(first[1] - last[1])
        };
        let face = opposite.faces.iter().map(|face| length(face.nodes)).fold(f64::INFINITY, f64::min);
        let kinematics = NodeToSurface::new(node, self.place_in_plane(node), Arc::clone(opposite));
        let gap = kinematics.initial_gap();
        Ok((Arc::new(kinematics), gap, face))
    }
}

fn shared_node(node: &str, against: &str) -> String {
    format!(
        "{node} is a node of {}, too; two surfaces have no common nodes, and one that may touch itself is both `surface` \
         and `against`",
        quoted(against)
    )
}
