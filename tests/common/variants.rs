//! The same request said in another way: in other units, about other axes, in another order.

use arcslip::model::JobRequest;
use arcslip::model::request::{BendingStiffness, Element, Material, Obstacle};

/// Rows of an orthogonal matrix.
pub type Axes = [[f64; 3]; 3];

/// The same request in other units of length and force.
pub fn in_units(mut request: JobRequest, length: f64, force: f64) -> JobRequest {
    let scale = |values: &mut Vec<f64>, by: f64| values.iter_mut().for_each(|value| *value *= by);
    for coordinates in request.model.nodes.values_mut() {
        scale(coordinates, length);
    }
    for element in &mut request.model.elements {
        match element {
            Element::Bar { axial_stiffness, rest_length, prestress, .. } => {
                *axial_stiffness *= force;
                *prestress *= force;
                rest_length.iter_mut().for_each(|rest| *rest *= length);
            }
            Element::Spring { stiffness, .. } => stiffness.iter_mut().for_each(|row| scale(row, force / length)),
            Element::Beam { axial_stiffness, bending_stiffness, torsional_stiffness, shear_stiffness, .. } => {
                *axial_stiffness *= force;
                let by = force * length * length;
                *bending_stiffness = match *bending_stiffness {
                    BendingStiffness::Plane(bending) => BendingStiffness::Plane(bending * by),
                    BendingStiffness::Space(bending) => BendingStiffness::Space(bending.map(|bending| bending * by)),
                };
                torsional_stiffness.iter_mut().for_each(|torsional| *torsional *= by);
                shear_stiffness.iter_mut().for_each(|shear| *shear *= force);
            }
            Element::RotationalSpring { stiffness, .. } => *stiffness *= force * length,
            solid => {
                let thickness = solid.solid_mut().and_then(|solid| solid.thickness.as_mut());
                thickness.into_iter().for_each(|thickness| *thickness *= length);
            }
        }
    }
    let stress = force / length / length;
    for material in request.model.materials.values_mut() {
        match material {
            Material::LinearElastic(constants)
            | Material::SaintVenantKirchhoff(constants)
            | Material::NeoHookean(constants) => constants.young *= stress,
            Material::MooneyRivlin { c10, c01, bulk_modulus, .. } => {
                [c10, c01, bulk_modulus].into_iter().for_each(|constant| *constant *= stress);
            }
        }
    }
    for obstacle in request.model.obstacles.values_mut() {
        match obstacle {
            Obstacle::Plane { point, normal } => {
                scale(point, length);
                scale(normal, 1.0 / length);
            }
            Obstacle::Ball { center, radius, .. } => {
                scale(center, length);
                *radius *= length;
            }
            Obstacle::Cylinder { point, radius, .. } => {
                scale(point, length);
                *radius *= length;
            }
            Obstacle::Polyline(polyline) => {
                polyline.points.iter_mut().for_each(|point| scale(point, length));
                polyline.rounding.iter_mut().for_each(|rounding| *rounding *= length);
                polyline.section.iter_mut().for_each(|section| scale(&mut section.origin, length));
            }
            Obstacle::Box(own) => {
                scale(&mut own.center, length);
                scale(&mut own.size, length);
                own.rounding.iter_mut().for_each(|rounding| *rounding *= length);
            }
            Obstacle::TriangleMesh(mesh) => {
                mesh.points.iter_mut().for_each(|point| scale(point, length));
                mesh.rounding *= length;
            }
        }
    }
    for stage in &mut request.model.stages {
        stage.forces.values_mut().for_each(|values| scale(values, force));
        stage.moments.values_mut().for_each(|moment| *moment *= force * length);
        stage.body_forces.values_mut().for_each(|values| scale(values, stress / length));
        stage.tractions.values_mut().for_each(|values| scale(values, stress));
        // A third component in the plane is a rotation.
        for values in stage.displacements.values_mut() {
            let dimension = request.model.dimension;
            values.iter_mut().take(dimension).for_each(|value| *value *= length);
        }
        stage.obstacle_motion.values_mut().for_each(|values| scale(values, length));
        stage
            .obstacle_rotation
            .values_mut()
            .filter_map(|turn| turn.about.as_mut())
            .for_each(|place| scale(place, length));
        if let Some(until) = &mut stage.until
            && let Some(bound) = &mut until.displacement
        {
            bound.above.iter_mut().for_each(|value| *value *= length);
            bound.below.iter_mut().for_each(|value| *value *= length);
        }
    }
    request.analysis.arc_length.displacement_scale.iter_mut().for_each(|scale| *scale *= length);
    request
}

/// The same request in space about other axes, from another origin: `x` becomes `axes x + shift`. Every supported node has to
/// be supported in all components.
pub fn about_axes(mut request: JobRequest, axes: &Axes, shift: [f64; 3]) -> JobRequest {
    let place = |point: &[f64]| turned(axes, point).iter().zip(shift).map(|(x, by)| x + by).collect::<Vec<f64>>();
    request.model.nodes.values_mut().for_each(|point| *point = place(point));
    for element in &mut request.model.elements {
        if let Element::Spring { stiffness, .. } = element {
            // Q K Qᵀ
            let columns: Vec<Vec<f64>> = stiffness.iter().map(|row| turned(axes, row)).collect();
            let entry = |i: usize, j: usize| (0..3).map(|k| axes[i][k] * columns[k][j]).sum::<f64>();
            *stiffness = (0..3).map(|i| (0..3).map(|j| entry(i.min(j), i.max(j))).collect()).collect();
        }
    }
    for obstacle in request.model.obstacles.values_mut() {
        match obstacle {
            Obstacle::Plane { point, normal } => {
                *point = place(point);
                *normal = turned(axes, normal);
            }
            Obstacle::Ball { center, .. } => *center = place(center),
            Obstacle::Cylinder { point, axis, .. } => {
                *point = place(point);
                *axis = turned(axes, axis);
            }
            Obstacle::Polyline(polyline) => {
                if let Some(section) = &mut polyline.section {
                    section.origin = place(&section.origin);
                    section.x = turned(axes, &section.x);
                    section.y = turned(axes, &section.y);
                }
            }
            Obstacle::Box(own) => {
                own.center = place(&own.center);
                let [x, y] = [(&own.x, [1.0, 0.0, 0.0]), (&own.y, [0.0, 1.0, 0.0])]
                    .map(|(given, usual)| turned(axes, given.as_deref().unwrap_or(&usual)));
                (own.x, own.y) = (Some(x), Some(y));
            }
            Obstacle::TriangleMesh(mesh) => mesh.points.iter_mut().for_each(|point| *point = place(point)),
        }
    }
    for stage in &mut request.model.stages {
        for pattern in [&mut stage.forces, &mut stage.displacements, &mut stage.obstacle_motion] {
            pattern.values_mut().for_each(|vector| *vector = turned(axes, vector));
        }
        for turn in stage.obstacle_rotation.values_mut() {
            turn.about.iter_mut().for_each(|point| *point = place(point));
            turn.axis.iter_mut().for_each(|axis| *axis = turned(axes, axis));
        }
    }
    request
}

/// `axes v`
pub fn turned(axes: &Axes, vector: &[f64]) -> Vec<f64> {
    axes.iter().map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
}

/// The same request with its nodes, elements, obstacles and contacts the other way round.
pub fn in_reverse(mut request: JobRequest) -> JobRequest {
    let model = &mut request.model;
    model.nodes.reverse();
    model.supports.reverse();
    model.elements.reverse();
    model.obstacles.reverse();
    model.contacts.reverse();
    request
}

/// The same request in the plane, turned and moved, the way axes and origin are chosen; without supports of one component.
pub fn turned_in_plane(mut request: JobRequest, angle: f64, shift: f64) -> JobRequest {
    let (sine, cosine) = angle.sin_cos();
    let turn = |v: &[f64]| vec![cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]];
    let place = |v: &[f64]| turn(v).iter().map(|value| value + shift).collect::<Vec<f64>>();
    request.model.nodes.values_mut().for_each(|x| *x = place(x));
    for element in &mut request.model.elements {
        if let Element::Spring { stiffness, .. } = element {
            // R K Rᵀ, row by row.
            let columns: Vec<Vec<f64>> = stiffness.iter().map(|row| turn(row)).collect();
            let rows: Vec<Vec<f64>> = (0..2).map(|k| turn(&[columns[0][k], columns[1][k]])).collect();
            *stiffness = vec![vec![rows[0][0], rows[1][0]], vec![rows[0][1], rows[1][1]]];
            stiffness[1][0] = stiffness[0][1];
        }
    }
    for obstacle in request.model.obstacles.values_mut() {
        match obstacle {
            Obstacle::Plane { point, normal } => {
                *point = place(point);
                *normal = turn(normal);
            }
            Obstacle::Ball { center, .. } => *center = place(center),
            Obstacle::Cylinder { .. } => unreachable!("a cylinder is an obstacle in space"),
            Obstacle::Polyline(polyline) => polyline.points.iter_mut().for_each(|point| *point = place(point)),
            Obstacle::Box(own) => {
                own.center = place(&own.center);
                own.x = Some(turn(own.x.as_deref().unwrap_or(&[1.0, 0.0])));
            }
            Obstacle::TriangleMesh(_) => unreachable!("a triangle mesh is an obstacle in space"),
        }
    }
    for stage in &mut request.model.stages {
        let of_solids = [&mut stage.body_forces, &mut stage.tractions];
        let of_nodes = [&mut stage.forces, &mut stage.displacements, &mut stage.obstacle_motion];
        for pattern in of_nodes.into_iter().chain(of_solids) {
            for vector in pattern.values_mut() {
                // A third component is a rotation, which stays.
                let turned = turn(vector);
                vector[..2].copy_from_slice(&turned);
            }
        }
        for rotation in stage.obstacle_rotation.values_mut() {
            rotation.about.iter_mut().for_each(|point| *point = place(point));
        }
    }
    request
}
