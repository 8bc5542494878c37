//! Forces and strain energy of the posted elements, for the measure alone.

use crate::model::request::{Element, Model, Strain};

/// `L`, `L0` and the unit direction of a bar.
fn bar_geometry(
    model: &Model,
    nodes: &[String],
    rest: Option<f64>,
    u: &[Vec<f64>],
) -> (f64, f64, Vec<f64>, [usize; 2]) {
    let index = |name: &String| model.nodes.get_index_of(name).unwrap_or(0);
    let ends = [index(&nodes[0]), index(&nodes[1])];
    let reference: Vec<f64> = (0..model.dimension).map(|k| model.nodes[ends[1]][k] - model.nodes[ends[0]][k]).collect();
    let deformed: Vec<f64> = (0..model.dimension).map(|k| reference[k] + u[ends[1]][k] - u[ends[0]][k]).collect();
    let norm = |vector: &[f64]| vector.iter().map(|value| value * value).sum::<f64>().sqrt();
    let length = norm(&deformed);
    let direction = deformed.iter().map(|value| value / length).collect();
    (length, rest.unwrap_or_else(|| norm(&reference)), direction, ends)
}

pub(super) fn element_forces(model: &Model, element: &Element, u: &[Vec<f64>]) -> Vec<(usize, Vec<f64>)> {
    match element {
        Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain } => {
            let (length, rest, direction, ends) = bar_geometry(model, nodes, *rest_length, u);
            let stretch = length / rest;
            let elastic = match strain {
                Strain::Engineering => stretch - 1.0,
                Strain::Green => 0.5 * (stretch * stretch - 1.0) * stretch,
                Strain::Log => stretch.ln() / stretch,
            };
            let axial = axial_stiffness * elastic + prestress;
            let force: Vec<f64> = direction.iter().map(|value| axial * value).collect();
            vec![(ends[0], force.iter().map(|value| -value).collect()), (ends[1], force)]
        }
        Element::Spring { nodes, stiffness } => {
            let ends: Vec<usize> = nodes.iter().map(|name| model.nodes.get_index_of(name).unwrap_or(0)).collect();
            let force: Vec<f64> = stiffness
                .iter()
                .map(|row| {
                    let relative = |k: usize| u[ends[0]][k] - ends.get(1).map_or(0.0, |other| u[*other][k]);
                    row.iter().enumerate().map(|(k, value)| value * relative(k)).sum()
                })
                .collect();
            let mut forces = vec![(ends[0], force.clone())];
            forces.extend(ends.get(1).map(|other| (*other, force.iter().map(|value| -value).collect())));
            forces
        }
    }
}

pub(super) fn strain_energy(model: &Model, u: &[Vec<f64>]) -> f64 {
    let energy = |element: &Element| match element {
        Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain } => {
            let (length, rest, _, _) = bar_geometry(model, nodes, *rest_length, u);
            let stretch = length / rest;
            let measure = match strain {
                Strain::Engineering => stretch - 1.0,
                Strain::Green => 0.5 * (stretch * stretch - 1.0),
                Strain::Log => stretch.ln(),
            };
            0.5 * axial_stiffness * rest * measure * measure + prestress * (length - rest)
        }
        Element::Spring { .. } => {
            let forces = element_forces(model, element, u);
            0.5 * forces.iter().flat_map(|(node, f)| f.iter().zip(&u[*node]).map(|(f, u)| f * u)).sum::<f64>()
        }
    };
    model.elements.iter().map(energy).sum()
}
