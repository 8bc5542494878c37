//! Homogeneous states of all materials on distorted meshes of all elements, against closed forms.

use crate::common::paths::{request, trace};
use crate::solids::meshes::{IN_PLANE, IN_SPACE, Mesh, hold};
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// The stretch by which a body is pulled.
const STRETCH: f64 = 1.3;
const YOUNG: f64 = 2.0;
const POISSON: f64 = 0.3;

fn materials() -> [(&'static str, Value); 4] {
    let elastic = |kind: &str| json!({"kind": kind, "young": YOUNG, "poisson": POISSON});
    [
        ("linear_elastic", elastic("linear_elastic")),
        ("saint_venant_kirchhoff", elastic("saint_venant_kirchhoff")),
        ("neo_hookean", elastic("neo_hookean")),
        ("mooney_rivlin", json!({"kind": "mooney_rivlin", "c10": 0.3, "c01": 0.2, "bulk_modulus": 4.0})),
    ]
}

/// The first Piola-Kirchhoff stresses of principal stretches: `∂W/∂λ_i`.
fn principal_stresses(material: &str, stretches: [f64; 3]) -> [f64; 3] {
    let (shear, lame) = (YOUNG / (2.0 * (1.0 + POISSON)), YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)));
    let volume: f64 = stretches.iter().product();
    match material {
        "linear_elastic" => {
            let trace: f64 = stretches.iter().map(|stretch| stretch - 1.0).sum();
            stretches.map(|stretch| lame * trace + 2.0 * shear * (stretch - 1.0))
        }
        "saint_venant_kirchhoff" => {
            let strain = |stretch: f64| 0.5 * (stretch * stretch - 1.0);
            let trace: f64 = stretches.iter().map(|stretch| strain(*stretch)).sum();
            stretches.map(|stretch| stretch * (lame * trace + 2.0 * shear * strain(stretch)))
        }
        "neo_hookean" => {
            stretches.map(|stretch| shear * (stretch - 1.0 / stretch) + lame * (volume - 1.0) * volume / stretch)
        }
        _ => {
            let (first, second, bulk) = (0.3, 0.2, 4.0);
            let squares = stretches.map(|stretch| stretch * stretch);
            let one: f64 = squares.iter().sum();
            let two = squares[0] * squares[1] + squares[1] * squares[2] + squares[2] * squares[0];
            stretches.map(|stretch| {
                let by_first = 2.0 * volume.powf(-2.0 / 3.0) * (stretch - one / 3.0 / stretch);
                let by_second =
                    2.0 * volume.powf(-4.0 / 3.0) * (stretch * (one - stretch * stretch) - 2.0 * two / 3.0 / stretch);
                first * by_first + second * by_second + 0.5 * bulk * (volume * volume - 1.0) / stretch
            })
        }
    }
}

/// The stretch across that leaves the sides free of stress, by Newton's method with differences of the closed form.
fn free_stretch(stress: impl Fn(f64) -> f64) -> f64 {
    let mut stretch = 0.9;
    for _ in 0..100 {
        let step = 1e-7;
        let slope = (stress(stretch + step) - stress(stretch - step)) / (2.0 * step);
        stretch -= stress(stretch) / slope;
    }
    stretch
}

/// Stretches and stresses of a bar pulled along x whose sides are free: of both sides, or of one where the third direction
/// is held.
fn pulled(material: &str, third_is_held: bool) -> ([f64; 3], [f64; 3]) {
    let stretches = |across: f64| [STRETCH, across, if third_is_held { 1.0 } else { across }];
    let across = free_stretch(|across| principal_stresses(material, stretches(across))[1]);
    (stretches(across), principal_stresses(material, stretches(across)))
}

/// A body of unit size pulled along x by prescribed displacements, its nodes inside moved; symmetric planes hold it.
fn pulled_body(mesh: &Mesh, material: Value, data: &Value) -> Value {
    let mut model = mesh.model(material, data);
    for (axis, component) in ["x", "y", "z"].iter().enumerate().take(mesh.dimension()) {
        hold(&mut model, &mesh.side(axis, false), &[component]);
    }
    hold(&mut model, &mesh.side(0, true), &["x"]);
    let mut moved = vec![0.0; mesh.dimension()];
    moved[0] = STRETCH - 1.0;
    for node in mesh.side(0, true) {
        model["stages"][0]["displacements"][node] = json!(moved);
    }
    model["stages"][0]["name"] = json!("pull");
    model["stages"][0]["until"] = json!({"load_above": 1});
    model
}

#[test]
fn pulled_bodies_have_the_stretches_and_forces_of_the_closed_form() {
    let in_plane = IN_PLANE.iter().flat_map(|kind| {
        ["strain", "stress"].map(|plane| (*kind, json!({"plane": plane, "thickness": 0.5}), plane == "strain", 0.5))
    });
    let in_space = IN_SPACE.iter().map(|kind| (*kind, json!({}), false, 1.0));
    let mut worst = 0.0_f64;
    for (kind, data, third_is_held, area) in in_plane.chain(in_space) {
        for (name, material) in materials() {
            let dimension = if area < 1.0 { 2 } else { 3 };
            let mesh = Mesh::new(kind, &vec![3; dimension], |point| point).distorted(0.12);
            let model =
                json!({"model": pulled_body(&mesh, material, &data), "analysis": {"record": {"elements": "all"}}});
            let (increments, report) = trace(&request(&model.to_string()));
            let what = format!("{kind}, {name}, {data}");
            assert_eq!(report.stop_reason, StopReason::StagesCompleted, "{what}: {report:?}");
            let last = increments.last().expect("an end");
            let (stretches, stresses) = pulled(name, third_is_held);
            for (node, position) in mesh.positions() {
                for ((moved, place), stretch) in last.displacements[&*node].iter().zip(position).zip(stretches) {
                    worst = worst.max((moved - (stretch - 1.0) * place).abs());
                }
            }
            let of_side: f64 = mesh.side(0, true).iter().map(|node| last.supports[&**node][0]).sum();
            worst = worst.max((of_side / (area * stresses[0]) - 1.0).abs());
            // Cauchy's stress of each element: along x alone, and out of a held plane.
            let of_area = stretches[1] * stretches[2];
            let cauchy = |along: usize| match name {
                "linear_elastic" => stresses[along],
                _ => stresses[along] * stretches[along] / (stretches[0] * of_area),
            };
            for element in &last.elements {
                let stress = element.stress.as_ref().expect("a stress");
                assert_eq!(stress.len(), if dimension == 2 { 4 } else { 6 });
                worst = worst.max((stress[0] - cauchy(0)).abs()).max((stress[2] - cauchy(2)).abs());
                worst = worst.max(stress[1].abs()).max(stress[3].abs());
            }
            assert!(worst < 1e-12, "{what}: {worst:e}");
        }
    }
    println!("homogeneous states: largest error {worst:.1e}");
}
