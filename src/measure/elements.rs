//! Forces and strain energy of the posted elements, for the measure alone.

use crate::model::request::{Element, Model, Strain};

/// A bar as it is deformed.
struct Bar {
    /// `L/L0`
    stretch: f64,
    /// `L - L0` and `(L - L0)/L0`, without the cancellation of two lengths.
    elongation: f64,
    strain: f64,
    rest: f64,
    direction: Vec<f64>,
    ends: [usize; 2],
}

fn bar(model: &Model, nodes: &[String], rest: Option<f64>, u: &[Vec<f64>]) -> Bar {
    let index = |name: &String| model.nodes.get_index_of(name).unwrap_or(0);
    let ends = [index(&nodes[0]), index(&nodes[1])];
    let reference: Vec<f64> = (0..model.dimension).map(|k| model.nodes[ends[1]][k] - model.nodes[ends[0]][k]).collect();
    let change: Vec<f64> = (0..model.dimension).map(|k| u[ends[1]][k] - u[ends[0]][k]).collect();
    let deformed: Vec<f64> = reference.iter().zip(&change).map(|(a, b)| a + b).collect();
    let norm = |vector: &[f64]| vector.iter().map(|value| value * value).sum::<f64>().sqrt();
    let (before, length) = (norm(&reference), norm(&deformed));
    let rest = rest.unwrap_or(before);
    let grown: f64 = change.iter().zip(&reference).map(|(d, r)| d * (2.0 * r + d)).sum::<f64>() / (length + before);
    let elongation = grown + (before - rest);
    let direction = deformed.iter().map(|value| value / length).collect();
    Bar { stretch: length / rest, elongation, strain: elongation / rest, rest, direction, ends }
}

pub(super) fn element_forces(model: &Model, element: &Element, u: &[Vec<f64>]) -> Vec<(usize, Vec<f64>)> {
    match element {
        Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain } => {
            let Bar { stretch, strain: linear, direction, ends, .. } = bar(model, nodes, *rest_length, u);
            let elastic = match strain {
                Strain::Engineering => linear,
                Strain::Green => linear * (1.0 + 0.5 * linear) * stretch,
                Strain::Log => linear.ln_1p() / stretch,
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

/// Multiple of unit round-off that a difference of two rounded numbers, made from rounded ones, may be off by.
const ROUNDINGS: f64 = 16.0;

/// What the rounding of displacements (and of a bar's places, over its length) puts into the forces on an element's nodes.
pub(super) fn element_rounding(model: &Model, element: &Element, u: &[Vec<f64>]) -> Vec<(usize, f64)> {
    let largest = |vectors: &[&Vec<f64>]| vectors.iter().copied().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    let index = |name: &String| model.nodes.get_index_of(name).unwrap_or(0);
    match element {
        Element::Bar { nodes, axial_stiffness, rest_length, .. } => {
            let Bar { stretch, rest, ends, .. } = bar(model, nodes, *rest_length, u);
            let moved = largest(&[&u[ends[0]], &u[ends[1]]]);
            // The tangent of Green strain grows with the square of the stretch.
            let stiffness = axial_stiffness / rest * stretch.max(1.0).powi(2);
            ends.iter().map(|end| (*end, ROUNDINGS * f64::EPSILON * stiffness * moved)).collect()
        }
        Element::Spring { nodes, stiffness } => {
            let ends: Vec<usize> = nodes.iter().map(index).collect();
            let moved = ends.iter().map(|end| largest(&[&u[*end]])).fold(0.0, f64::max);
            let row = |row: &Vec<f64>| row.iter().map(|value| value.abs()).sum::<f64>();
            let stiffness = stiffness.iter().map(row).fold(0.0, f64::max);
            ends.iter().map(|end| (*end, ROUNDINGS * f64::EPSILON * stiffness * moved)).collect()
        }
    }
}

pub(super) fn strain_energy(model: &Model, u: &[Vec<f64>]) -> f64 {
    let energy = |element: &Element| match element {
        Element::Bar { nodes, axial_stiffness, rest_length, prestress, strain } => {
            let Bar { elongation, strain: linear, rest, .. } = bar(model, nodes, *rest_length, u);
            let measure = match strain {
                Strain::Engineering => linear,
                Strain::Green => linear * (1.0 + 0.5 * linear),
                Strain::Log => linear.ln_1p(),
            };
            0.5 * axial_stiffness * rest * measure * measure + prestress * elongation
        }
        Element::Spring { .. } => {
            let forces = element_forces(model, element, u);
            0.5 * forces.iter().flat_map(|(node, f)| f.iter().zip(&u[*node]).map(|(f, u)| f * u)).sum::<f64>()
        }
    };
    model.elements.iter().map(energy).sum()
}
