//! `*MATERIAL` with its laws, and `*SOLID SECTION`.

use crate::model::mesh::abaqus::definitions::{Definitions, SectionDefinition};
use crate::model::mesh::abaqus::instances::Instances;
use crate::model::mesh::abaqus::lines::{DeckLines, Keyword};
use crate::model::mesh::data::error::{MeshError, MeshPlace};
use crate::model::mesh::data::mesh_data::{DeckLaw, DeckMaterial};

/// Begins a material.
pub fn material(keyword: &Keyword, found: &mut Definitions) -> Result<(), MeshError> {
    let name = keyword.required("NAME")?;
    if !found.material_names.insert(name.to_ascii_uppercase()) {
        return Err(MeshError::new(keyword.place, format!("the material `{name}` is there a second time")));
    }
    found.materials.insert(name.to_owned(), DeckMaterial::default());
    Ok(())
}

/// Reads `*ELASTIC`, `*HYPERELASTIC` or `*DENSITY` of the last material.
pub fn property(keyword: &Keyword, lines: &mut DeckLines, found: &mut Definitions) -> Result<(), MeshError> {
    let Some((name, material)) = found.materials.last_mut() else {
        return Err(MeshError::new(keyword.place, format!("*{} has to stand after *MATERIAL", keyword.name)));
    };
    let (law, wanted) = match keyword.name.as_str() {
        "DENSITY" => (Property::Density, 1),
        "ELASTIC" if keyword.value("TYPE").is_none_or(|kind| kind.to_ascii_uppercase().starts_with("ISO")) => {
            (Property::Elastic, 2)
        }
        "HYPERELASTIC" if keyword.has("TEST DATA INPUT") => (Property::Other, 0),
        "HYPERELASTIC" if keyword.has("NEO HOOKE") => (Property::NeoHooke, 2),
        "HYPERELASTIC" if keyword.has("MOONEY-RIVLIN") => (Property::MooneyRivlin, 3),
        _ => (Property::Other, 0),
    };
    if law == Property::Other {
        found.unread.add(keyword.place, format!("*{} of the material `{name}` in this form", keyword.name));
        return Ok(());
    }
    let mut numbers = [0.0; 3];
    let Some(line) = lines.next_data() else {
        return Err(MeshError::expected(keyword.place, format_args!("{wanted} numbers on the next line"), "none"));
    };
    let mut fields = line.fields();
    for number in numbers.iter_mut().take(wanted) {
        *number = line.real(fields.next().unwrap_or_default(), "a number of a material")?;
    }
    if lines.next_data().is_some() {
        found.unread.add(line.place, format!("lines of *{} after the first, for other temperatures", keyword.name));
    }
    match law_of(law, numbers, line.place)? {
        Some(law) => material.law = Some(law),
        None => material.density = numbers.first().copied(),
    }
    Ok(())
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Property {
    Elastic,
    NeoHooke,
    MooneyRivlin,
    Density,
    Other,
}

/// The law of a property's numbers; none for a density.
fn law_of(property: Property, numbers: [f64; 3], place: MeshPlace) -> Result<Option<DeckLaw>, MeshError> {
    let [first, second, third] = numbers;
    let law = match property {
        Property::Density | Property::Other => {
            check(first > 0.0, place, "a density above zero", first)?;
            return Ok(None);
        }
        Property::Elastic => {
            check(first > 0.0, place, "a modulus of elasticity above zero", first)?;
            check(second > -1.0 && second < 0.5, place, "Poisson's ratio between -1 and 0.5", second)?;
            DeckLaw::LinearElastic { young: first, poisson: second }
        }
        Property::NeoHooke => {
            check(first > 0.0, place, "C10 above zero", first)?;
            check(second > 0.0, place, "D1 above zero, as D1 = 0 stands for an incompressible material", second)?;
            // Shear modulus 2 C10 and bulk modulus 2/D1 at zero strain.
            let (shear, bulk) = (2.0 * first, 2.0 / second);
            let young = 9.0 * bulk * shear / (3.0 * bulk + shear);
            let poisson = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear);
            DeckLaw::NeoHookean { young, poisson }
        }
        Property::MooneyRivlin => {
            check(first + second > 0.0, place, "C10 + C01 above zero", first + second)?;
            check(third > 0.0, place, "D1 above zero, as D1 = 0 stands for an incompressible material", third)?;
            DeckLaw::MooneyRivlin { c10: first, c01: second, bulk_modulus: 2.0 / third }
        }
    };
    Ok(Some(law))
}

fn check(is_met: bool, place: MeshPlace, expected: &str, found: f64) -> Result<(), MeshError> {
    if is_met { Ok(()) } else { Err(MeshError::expected(place, expected, found)) }
}

/// Reads `*SOLID SECTION`: elements, material, and the thickness of plane elements.
pub fn solid_section(
    keyword: &Keyword,
    lines: &mut DeckLines,
    instances: &Instances,
    found: &mut Definitions,
) -> Result<(), MeshError> {
    if keyword.has("COMPOSITE") {
        return Err(MeshError::new(keyword.place, "a section of several layers is not read"));
    }
    let thickness = match lines.next_data() {
        Some(line) => match line.fields().next().filter(|field| !field.is_empty()) {
            Some(field) => {
                let thickness = line.real(field, "a thickness")?;
                check(thickness > 0.0, line.place, "a thickness above zero", thickness)?;
                Some(thickness)
            }
            None => None,
        },
        None => None,
    };
    found.sections.push(SectionDefinition {
        scope: instances.scope(),
        element_set: instances.local(keyword.required("ELSET")?).to_owned(),
        material: keyword.required("MATERIAL")?.to_owned(),
        thickness,
        place: keyword.place,
    });
    Ok(())
}
