//! Reads solids, their materials, surfaces, and sets.

use crate::mechanics::structure::elements::solid::shapes::kind::{LockingMend, SolidKind};
use crate::model::decode::reader::{Choices, Fields, Input, Object, number, text};
use crate::model::input::mistakes::Mistakes;
use crate::model::request::{ElasticConstants, Element, Material, NamedSet, PlaneCondition, Solid, Surface};

const SOLID: Fields = Fields {
    what: "a solid",
    known: &["kind", "nodes", "material", "plane", "thickness", "locking", "name"],
    later: &[],
};

const ELASTIC: Fields =
    Fields { what: "a material of this kind", known: &["kind", "young", "poisson", "density"], later: &[] };

const MOONEY_RIVLIN: Fields = Fields {
    what: "a material of Mooney and Rivlin",
    known: &["kind", "c10", "c01", "bulk_modulus", "density"],
    later: &[],
};

const SURFACE: Fields = Fields { what: "a surface", known: &["faces", "group"], later: &[] };

const SET: Fields = Fields { what: "a set", known: &["nodes", "elements"], later: &[] };

const PLANE_CONDITION: Choices<PlaneCondition> = Choices {
    what: "a condition in the third direction",
    known: &[
        ("strain", PlaneCondition::Strain),
        ("stress", PlaneCondition::Stress),
        ("axisymmetric", PlaneCondition::Axisymmetric),
    ],
    later: &[],
};

const LOCKING: Choices<LockingMend> = Choices {
    what: "a mend against locking",
    known: &[
        ("none", LockingMend::None),
        ("mean_gradient", LockingMend::MeanGradient),
        ("mean_dilatation", LockingMend::MeanDilatation),
    ],
    later: &[],
};

#[derive(Debug, Clone, Copy)]
enum MaterialKind {
    LinearElastic,
    SaintVenantKirchhoff,
    NeoHookean,
    MooneyRivlin,
}

const MATERIAL_KIND: Choices<MaterialKind> = Choices {
    what: "a kind of material",
    known: &[
        ("linear_elastic", MaterialKind::LinearElastic),
        ("saint_venant_kirchhoff", MaterialKind::SaintVenantKirchhoff),
        ("neo_hookean", MaterialKind::NeoHookean),
        ("mooney_rivlin", MaterialKind::MooneyRivlin),
    ],
    later: &[],
};

pub(super) fn solid(kind: SolidKind, input: &Input, mistakes: &mut Mistakes) -> Option<Element> {
    let object = input.object(&SOLID, mistakes)?;
    let nodes = object.required("nodes", mistakes, strings);
    let material = object.required("material", mistakes, text);
    let solid_options = solid_options(&object, mistakes);
    let name = object.optional("name", mistakes, text);
    let SolidOptions { plane, thickness, locking } = solid_options?;
    let solid = Solid { nodes: nodes?, material: material?, plane, thickness, locking, name: name? };
    Some(Element::of_solid(kind, solid))
}

/// What a solid, or a group of them, may say beside its nodes and its material.
pub(super) struct SolidOptions {
    pub plane: Option<PlaneCondition>,
    pub thickness: Option<f64>,
    pub locking: Option<LockingMend>,
}

pub(super) fn solid_options(object: &Object, mistakes: &mut Mistakes) -> Option<SolidOptions> {
    let plane = object.optional("plane", mistakes, |input, mistakes| input.choice(&PLANE_CONDITION, mistakes));
    let thickness = object.optional("thickness", mistakes, number);
    let locking = object.optional("locking", mistakes, |input, mistakes| input.choice(&LOCKING, mistakes));
    Some(SolidOptions { plane: plane?, thickness: thickness?, locking: locking? })
}

pub(super) fn material(input: &Input, mistakes: &mut Mistakes) -> Option<Material> {
    match input.kind(&MATERIAL_KIND, mistakes)? {
        MaterialKind::LinearElastic => elastic(input, mistakes).map(Material::LinearElastic),
        MaterialKind::SaintVenantKirchhoff => elastic(input, mistakes).map(Material::SaintVenantKirchhoff),
        MaterialKind::NeoHookean => elastic(input, mistakes).map(Material::NeoHookean),
        MaterialKind::MooneyRivlin => {
            let object = input.object(&MOONEY_RIVLIN, mistakes)?;
            let c10 = object.required("c10", mistakes, number);
            let c01 = object.with_default("c01", 0.0, mistakes, number);
            let bulk_modulus = object.required("bulk_modulus", mistakes, number);
            let density = density(&object, mistakes);
            Some(Material::MooneyRivlin { c10: c10?, c01: c01?, bulk_modulus: bulk_modulus?, density: density? })
        }
    }
}

fn elastic(input: &Input, mistakes: &mut Mistakes) -> Option<ElasticConstants> {
    let object = input.object(&ELASTIC, mistakes)?;
    let young = object.required("young", mistakes, number);
    let poisson = object.required("poisson", mistakes, number);
    let density = density(&object, mistakes);
    Some(ElasticConstants { young: young?, poisson: poisson?, density: density? })
}

fn density(object: &Object, mistakes: &mut Mistakes) -> Option<Option<f64>> {
    object.optional("density", mistakes, number)
}

pub(super) fn surface(input: &Input, mistakes: &mut Mistakes) -> Option<Surface> {
    let object = input.object(&SURFACE, mistakes)?;
    let group = object.optional("group", mistakes, text)?;
    let lists = |input: &Input, mistakes: &mut Mistakes| input.list(mistakes, strings);
    let faces = match &group {
        Some(_) => object.with_default("faces", Vec::new(), mistakes, lists)?,
        None => object.required("faces", mistakes, lists)?,
    };
    if group.is_some() && !faces.is_empty() {
        return input.note("`faces` and `group` are given; one of the two is expected", mistakes);
    }
    Some(Surface { faces, group })
}

pub(super) fn set(input: &Input, mistakes: &mut Mistakes) -> Option<NamedSet> {
    let object = input.object(&SET, mistakes)?;
    let nodes = object.with_default("nodes", Vec::new(), mistakes, strings);
    let elements = object.with_default("elements", Vec::new(), mistakes, strings);
    Some(NamedSet { nodes: nodes?, elements: elements? })
}

fn strings(input: &Input, mistakes: &mut Mistakes) -> Option<Vec<String>> {
    input.list(mistakes, text)
}
