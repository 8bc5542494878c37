//! Reads the model: nodes, supports, elements, obstacles, contacts, stages.

use indexmap::IndexMap;

use crate::mechanics::structure::elements::solid::shapes::kind::SolidKind;
use crate::model::decode::reader::{Choices, Fields, Input, count, number, numbers, text};
use crate::model::decode::{meshes, obstacles, solids};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::{
    BendingStiffness, Component, Contact, ContactDiscretisation, DisplacementBound, Element, Model, ObstacleRotation,
    Stage, StageControl, Strain, Units, Until,
};

const MODEL: Fields = Fields {
    what: "a model",
    known: &[
        "name",
        "units",
        "dimension",
        "mesh",
        "nodes",
        "supports",
        "materials",
        "elements",
        "surfaces",
        "sets",
        "obstacles",
        "contacts",
        "stages",
    ],
    later: &[],
};

const UNITS: Fields = Fields { what: "labels of units", known: &["length", "force"], later: &[] };

const BAR: Fields = Fields {
    what: "a bar",
    known: &["kind", "nodes", "axial_stiffness", "rest_length", "prestress", "strain", "name"],
    later: &[],
};

const BEAM: Fields = Fields {
    what: "a beam",
    known: &[
        "kind",
        "nodes",
        "axial_stiffness",
        "bending_stiffness",
        "torsional_stiffness",
        "orientation",
        "shear_stiffness",
        "releases",
        "name",
    ],
    later: &[],
};

const ROTATIONAL_SPRING: Fields =
    Fields { what: "a rotational spring", known: &["kind", "nodes", "stiffness", "name"], later: &[] };

const SPRING: Fields = Fields { what: "a spring", known: &["kind", "nodes", "stiffness", "name"], later: &[] };

const CONTACT: Fields = Fields {
    what: "a contact",
    known: &["node", "surface", "obstacle", "against", "discretisation", "friction"],
    later: &[],
};

const DISCRETISATION: Choices<ContactDiscretisation> = Choices {
    what: "a discretisation of contact",
    known: &[("mortar", ContactDiscretisation::Mortar), ("node_to_surface", ContactDiscretisation::NodeToSurface)],
    later: &[],
};

const STAGE: Fields = Fields {
    what: "a stage",
    known: &[
        "name",
        "forces",
        "moments",
        "displacements",
        "body_forces",
        "tractions",
        "pressures",
        "obstacle_motion",
        "obstacle_rotation",
        "until",
        "control",
        "history",
        "cycles",
    ],
    later: &[],
};

const OBSTACLE_ROTATION: Fields =
    Fields { what: "a rotation of an obstacle", known: &["angle", "about", "axis"], later: &[] };

const STAGE_CONTROL: Choices<StageControl> = Choices {
    what: "a control of a stage",
    known: &[("path", StageControl::Path), ("load", StageControl::Load)],
    later: &[],
};

const UNTIL: Fields = Fields {
    what: "an end of a stage",
    known: &["load_above", "load_below", "displacement", "limit_points", "contact_change", "increments"],
    later: &[],
};

const DISPLACEMENT_BOUND: Fields =
    Fields { what: "a displacement bound", known: &["node", "component", "above", "below"], later: &[] };

#[derive(Debug, Clone, Copy)]
enum ElementKind {
    Bar,
    Spring,
    Beam,
    RotationalSpring,
    Solid(SolidKind),
    Group,
}

const ELEMENT_KIND: Choices<ElementKind> = Choices {
    what: "a kind of element",
    known: &[
        ("bar", ElementKind::Bar),
        ("spring", ElementKind::Spring),
        ("beam", ElementKind::Beam),
        ("rotational_spring", ElementKind::RotationalSpring),
        ("triangle3", ElementKind::Solid(SolidKind::Triangle3)),
        ("triangle6", ElementKind::Solid(SolidKind::Triangle6)),
        ("quadrilateral4", ElementKind::Solid(SolidKind::Quadrilateral4)),
        ("quadrilateral8", ElementKind::Solid(SolidKind::Quadrilateral8)),
        ("tetrahedron4", ElementKind::Solid(SolidKind::Tetrahedron4)),
        ("tetrahedron10", ElementKind::Solid(SolidKind::Tetrahedron10)),
        ("hexahedron8", ElementKind::Solid(SolidKind::Hexahedron8)),
        ("hexahedron20", ElementKind::Solid(SolidKind::Hexahedron20)),
        ("solid", ElementKind::Group),
    ],
    later: &[],
};

const STRAIN: Choices<Strain> = Choices {
    what: "a measure of strain",
    known: &[("engineering", Strain::Engineering), ("green", Strain::Green), ("log", Strain::Log)],
    later: &[],
};

/// What the end of a beam can be released in.
const RELEASE: Choices<Component> =
    Choices { what: "a release of a beam in the plane", known: &[("rz", Component::Rz)], later: &[] };

const COMPONENT: Choices<Component> = Choices {
    what: "a component",
    known: &[
        ("x", Component::X),
        ("y", Component::Y),
        ("z", Component::Z),
        ("rx", Component::Rx),
        ("ry", Component::Ry),
        ("rz", Component::Rz),
    ],
    later: &[],
};

pub(super) fn model(input: &Input, mistakes: &mut Mistakes) -> Option<Model> {
    let object = input.object(&MODEL, mistakes)?;
    let name = object.optional("name", mistakes, text);
    let units = object.optional("units", mistakes, units);
    let dimension = object.required("dimension", mistakes, count);
    let mesh = object.optional("mesh", mistakes, meshes::mesh);
    let nodes = if input.has("mesh") {
        object.with_default("nodes", IndexMap::new(), mistakes, vectors)
    } else {
        object.required("nodes", mistakes, vectors)
    };
    let supports = object
        .with_default("supports", Default::default(), mistakes, |input, mistakes| input.map(mistakes, components));
    let materials = object.with_default("materials", Default::default(), mistakes, |input, mistakes| {
        input.map(mistakes, solids::material)
    });
    let elements = object.required("elements", mistakes, |input, mistakes| input.list(mistakes, element));
    let surfaces = object
        .with_default("surfaces", Default::default(), mistakes, |input, mistakes| input.map(mistakes, solids::surface));
    let sets =
        object.with_default("sets", Default::default(), mistakes, |input, mistakes| input.map(mistakes, solids::set));
    let obstacles = object.with_default("obstacles", Default::default(), mistakes, |input, mistakes| {
        input.map(mistakes, obstacles::obstacle)
    });
    let contacts =
        object.with_default("contacts", Vec::new(), mistakes, |input, mistakes| input.list(mistakes, contact));
    let stages = object.required("stages", mistakes, |input, mistakes| input.list(mistakes, stage));
    Some(Model {
        name: name?,
        units: units?,
        // A dimension too large for the machine's words is refused with all others that are not 2 or 3.
        dimension: usize::try_from(dimension?).unwrap_or(usize::MAX),
        mesh: mesh?,
        nodes: nodes?,
        supports: supports?,
        materials: materials?,
        elements: elements?,
        surfaces: surfaces?,
        sets: sets?,
        obstacles: obstacles?,
        contacts: contacts?,
        posted_contacts: Vec::new(),
        stages: stages?,
    })
}

fn units(input: &Input, mistakes: &mut Mistakes) -> Option<Units> {
    let object = input.object(&UNITS, mistakes)?;
    let length = object.optional("length", mistakes, text);
    let force = object.optional("force", mistakes, text);
    Some(Units { length: length?, force: force? })
}

fn component(input: &Input, mistakes: &mut Mistakes) -> Option<Component> {
    input.choice(&COMPONENT, mistakes)
}

fn components(input: &Input, mistakes: &mut Mistakes) -> Option<Vec<Component>> {
    input.list(mistakes, component)
}

fn releases(input: &Input, mistakes: &mut Mistakes) -> Option<Vec<Component>> {
    input.list(mistakes, |input, mistakes| input.choice(&RELEASE, mistakes))
}

fn strings(input: &Input, mistakes: &mut Mistakes) -> Option<Vec<String>> {
    input.list(mistakes, text)
}

/// Vectors by name.
fn vectors(input: &Input, mistakes: &mut Mistakes) -> Option<IndexMap<String, Vec<f64>>> {
    input.map(mistakes, numbers)
}

fn element(input: &Input, mistakes: &mut Mistakes) -> Option<Element> {
    match input.kind(&ELEMENT_KIND, mistakes)? {
        ElementKind::Bar => bar(input, mistakes),
        ElementKind::Spring => spring(input, mistakes),
        ElementKind::Beam => beam(input, mistakes),
        ElementKind::RotationalSpring => rotational_spring(input, mistakes),
        ElementKind::Solid(kind) => solids::solid(kind, input, mistakes),
        ElementKind::Group => meshes::group(input, mistakes),
    }
}

fn bar(input: &Input, mistakes: &mut Mistakes) -> Option<Element> {
    let object = input.object(&BAR, mistakes)?;
    let nodes = object.required("nodes", mistakes, strings);
    let axial_stiffness = object.required("axial_stiffness", mistakes, number);
    let rest_length = object.optional("rest_length", mistakes, number);
    let prestress = object.with_default("prestress", 0.0, mistakes, number);
    let strain =
        object.with_default("strain", Strain::default(), mistakes, |input, mistakes| input.choice(&STRAIN, mistakes));
    let name = object.optional("name", mistakes, text);
    Some(Element::Bar {
        nodes: nodes?,
        axial_stiffness: axial_stiffness?,
        rest_length: rest_length?,
        prestress: prestress?,
        strain: strain?,
        name: name?,
    })
}

fn spring(input: &Input, mistakes: &mut Mistakes) -> Option<Element> {
    let object = input.object(&SPRING, mistakes)?;
    let nodes = object.required("nodes", mistakes, strings);
    let stiffness = object.required("stiffness", mistakes, |input, mistakes| input.list(mistakes, numbers));
    let name = object.optional("name", mistakes, text);
    Some(Element::Spring { nodes: nodes?, stiffness: stiffness?, name: name? })
}

fn beam(input: &Input, mistakes: &mut Mistakes) -> Option<Element> {
    let object = input.object(&BEAM, mistakes)?;
    let nodes = object.required("nodes", mistakes, strings);
    let axial_stiffness = object.required("axial_stiffness", mistakes, number);
    let bending_stiffness = object.required("bending_stiffness", mistakes, bending_stiffness);
    let torsional_stiffness = object.optional("torsional_stiffness", mistakes, number);
    let orientation = object.optional("orientation", mistakes, numbers);
    let shear_stiffness = object.optional("shear_stiffness", mistakes, number);
    let releases =
        object.with_default("releases", Default::default(), mistakes, |input, mistakes| input.map(mistakes, releases));
    let name = object.optional("name", mistakes, text);
    Some(Element::Beam {
        nodes: nodes?,
        axial_stiffness: axial_stiffness?,
        bending_stiffness: bending_stiffness?,
        torsional_stiffness: torsional_stiffness?,
        orientation: orientation?,
        shear_stiffness: shear_stiffness?,
        releases: releases?,
        name: name?,
    })
}

/// A number, or two in space.
fn bending_stiffness(input: &Input, mistakes: &mut Mistakes) -> Option<BendingStiffness> {
    if !input.is_list() {
        return number(input, mistakes).map(BendingStiffness::Plane);
    }
    match numbers(input, mistakes)?[..] {
        [first, second] => Some(BendingStiffness::Space([first, second])),
        _ => input.refuse("one number in the plane, or two in space, as `[EI_1, EI_2]`,", mistakes),
    }
}

fn rotational_spring(input: &Input, mistakes: &mut Mistakes) -> Option<Element> {
    let object = input.object(&ROTATIONAL_SPRING, mistakes)?;
    let nodes = object.required("nodes", mistakes, strings);
    let stiffness = object.required("stiffness", mistakes, number);
    let name = object.optional("name", mistakes, text);
    Some(Element::RotationalSpring { nodes: nodes?, stiffness: stiffness?, name: name? })
}

fn contact(input: &Input, mistakes: &mut Mistakes) -> Option<Contact> {
    let object = input.object(&CONTACT, mistakes)?;
    let surface = object.optional("surface", mistakes, text)?;
    let node = match &surface {
        Some(_) => object.with_default("node", String::new(), mistakes, text),
        None => object.required("node", mistakes, text),
    };
    let against = object.optional("against", mistakes, text)?;
    let discretisation =
        object.optional("discretisation", mistakes, |input, mistakes| input.choice(&DISCRETISATION, mistakes));
    let friction = object.with_default("friction", 0.0, mistakes, number);
    let obstacle = match &against {
        Some(_) => object.with_default("obstacle", String::new(), mistakes, text),
        None => object.required("obstacle", mistakes, text),
    };
    let (node, obstacle, discretisation) = (node?, obstacle?, discretisation?);
    let mistake = match &against {
        None if surface.is_some() && !node.is_empty() => "`node` and `surface` are given; one of the two is expected",
        None if discretisation.is_some() => "`discretisation` is of contacts `against` a surface; leave it out",
        Some(_) if !obstacle.is_empty() => "`obstacle` and `against` are given; one of the two is expected",
        _ => return Some(Contact { node, surface, obstacle, against, discretisation, friction: friction? }),
    };
    input.note(mistake, mistakes)
}

fn stage(input: &Input, mistakes: &mut Mistakes) -> Option<Stage> {
    let object = input.object(&STAGE, mistakes)?;
    let name = object.required("name", mistakes, text);
    let forces = object.with_default("forces", Default::default(), mistakes, vectors);
    let moments =
        object.with_default("moments", Default::default(), mistakes, |input, mistakes| input.map(mistakes, number));
    let displacements = object.with_default("displacements", Default::default(), mistakes, vectors);
    let body_forces = object.with_default("body_forces", Default::default(), mistakes, vectors);
    let tractions = object.with_default("tractions", Default::default(), mistakes, vectors);
    let pressures =
        object.with_default("pressures", Default::default(), mistakes, |input, mistakes| input.map(mistakes, number));
    let obstacle_motion = object.with_default("obstacle_motion", Default::default(), mistakes, vectors);
    let obstacle_rotation =
        object.with_default("obstacle_rotation", Default::default(), mistakes, |input, mistakes| {
            input.map(mistakes, obstacle_rotation)
        });
    let until = object.optional("until", mistakes, until);
    let control = object.with_default("control", Default::default(), mistakes, |input, mistakes| {
        input.choice(&STAGE_CONTROL, mistakes)
    });
    let history = object.with_default("history", Default::default(), mistakes, load_history);
    let cycles = object.optional("cycles", mistakes, count);
    Some(Stage {
        name: name?,
        forces: forces?,
        moments: moments?,
        displacements: displacements?,
        body_forces: body_forces?,
        tractions: tractions?,
        pressures: pressures?,
        obstacle_motion: obstacle_motion?,
        obstacle_rotation: obstacle_rotation?,
        until: until?,
        control: control?,
        history: history?,
        cycles: cycles?,
    })
}

fn obstacle_rotation(input: &Input, mistakes: &mut Mistakes) -> Option<ObstacleRotation> {
    let object = input.object(&OBSTACLE_ROTATION, mistakes)?;
    let angle = object.required("angle", mistakes, number);
    let about = object.optional("about", mistakes, numbers);
    let axis = object.optional("axis", mistakes, numbers);
    Some(ObstacleRotation { angle: angle?, about: about?, axis: axis? })
}

fn load_history(input: &Input, mistakes: &mut Mistakes) -> Option<Vec<f64>> {
    let history = numbers(input, mistakes)?;
    if history.is_empty() {
        return input.note("the list is empty; one load factor or more is expected, or leave it out", mistakes);
    }
    Some(history)
}

fn until(input: &Input, mistakes: &mut Mistakes) -> Option<Until> {
    let object = input.object(&UNTIL, mistakes)?;
    let load_above = object.optional("load_above", mistakes, number);
    let load_below = object.optional("load_below", mistakes, number);
    let displacement = object.optional("displacement", mistakes, displacement_bound);
    let limit_points = object.optional("limit_points", mistakes, count);
    let contact_change = object.optional("contact_change", mistakes, count);
    let increments = object.optional("increments", mistakes, count);
    Some(Until {
        load_above: load_above?,
        load_below: load_below?,
        displacement: displacement?,
        limit_points: limit_points?,
        contact_change: contact_change?,
        increments: increments?,
    })
}

fn displacement_bound(input: &Input, mistakes: &mut Mistakes) -> Option<DisplacementBound> {
    let object = input.object(&DISPLACEMENT_BOUND, mistakes)?;
    let node = object.required("node", mistakes, text);
    let component = object.required("component", mistakes, component);
    let above = object.optional("above", mistakes, number);
    let below = object.optional("below", mistakes, number);
    Some(DisplacementBound { node: node?, component: component?, above: above?, below: below? })
}
