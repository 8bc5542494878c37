//! The decoder against the types of the contract: what they write, it reads, and as serde's derived code reads it.

use indexmap::IndexMap;
use proptest::collection::vec;
use proptest::option::of;
use proptest::prelude::*;
use proptest::strategy::Union;

use crate::model::decode::decode;
use crate::model::request::*;
use crate::model::{InputErrors, JobRequest};

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("finite", |value| value.is_finite()),
        Just(0.0),
        (-9i32..9).prop_map(f64::from)
    ]
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof!["[a-z0-9]{0,3}", "[~/\"\\\\ä\n]{1,3}"]
}

fn numbers() -> impl Strategy<Value = Vec<f64>> {
    vec(number(), 0..4)
}

fn map<V: std::fmt::Debug>(value: impl Strategy<Value = V>) -> impl Strategy<Value = IndexMap<String, V>> {
    vec((name(), value), 0..4).prop_map(|members| members.into_iter().collect())
}

fn one_of<T: Clone + std::fmt::Debug + 'static>(values: impl IntoIterator<Item = T>) -> Union<Just<T>> {
    Union::new(values.into_iter().map(Just))
}

fn component() -> impl Strategy<Value = Component> {
    one_of([Component::X, Component::Y, Component::Z, Component::Rz])
}

fn element() -> impl Strategy<Value = Element> {
    let strain = one_of([Strain::Engineering, Strain::Green, Strain::Log]);
    let bar = (vec(name(), 0..3), number(), of(number()), number(), strain, of(name())).prop_map(
        |(nodes, axial_stiffness, rest_length, prestress, strain, name)| Element::Bar {
            nodes,
            axial_stiffness,
            rest_length,
            prestress,
            strain,
            name,
        },
    );
    let spring = (vec(name(), 0..3), vec(numbers(), 0..4), of(name()))
        .prop_map(|(nodes, stiffness, name)| Element::Spring { nodes, stiffness, name });
    let releases = map(vec(Just(Component::Rz), 0..3));
    let bending = prop_oneof![
        number().prop_map(BendingStiffness::Plane),
        (number(), number()).prop_map(|(first, second)| BendingStiffness::Space([first, second])),
    ];
    let in_space = (of(number()), of(numbers()));
    let beam = (vec(name(), 0..4), number(), bending, in_space, of(number()), releases, of(name())).prop_map(
        |(nodes, axial_stiffness, bending_stiffness, in_space, shear_stiffness, releases, name)| Element::Beam {
            nodes,
            axial_stiffness,
            bending_stiffness,
            torsional_stiffness: in_space.0,
            orientation: in_space.1,
            shear_stiffness,
            releases,
            name,
        },
    );
    let rotational_spring = (vec(name(), 0..3), number(), of(name()))
        .prop_map(|(nodes, stiffness, name)| Element::RotationalSpring { nodes, stiffness, name });
    let plane = one_of([PlaneCondition::Strain, PlaneCondition::Stress, PlaneCondition::Axisymmetric]);
    let locking = one_of([LockingMend::None, LockingMend::MeanGradient, LockingMend::MeanDilatation]);
    let kind = one_of(SolidKind::ALL);
    let solid = (kind, vec(name(), 0..4), name(), of(plane), of(number()), of(locking), of(name())).prop_map(
        |(kind, nodes, material, plane, thickness, locking, name)| {
            Element::of_solid(kind, Solid { nodes, material, plane, thickness, locking, name })
        },
    );
    prop_oneof![bar, spring, beam, rotational_spring, solid]
}

fn material() -> impl Strategy<Value = Material> {
    let constants = (number(), number(), of(number())).prop_map(|(young, poisson, density)| ElasticConstants {
        young,
        poisson,
        density,
    });
    let elastic = (0..3, constants).prop_map(|(kind, constants)| match kind {
        0 => Material::LinearElastic(constants),
        1 => Material::SaintVenantKirchhoff(constants),
        _ => Material::NeoHookean(constants),
    });
    let mooney_rivlin = (number(), number(), number(), of(number()))
        .prop_map(|(c10, c01, bulk_modulus, density)| Material::MooneyRivlin { c10, c01, bulk_modulus, density });
    prop_oneof![elastic, mooney_rivlin]
}

fn surface() -> impl Strategy<Value = Surface> {
    vec(vec(name(), 0..4), 0..3).prop_map(|faces| Surface { faces, group: None })
}

fn set() -> impl Strategy<Value = NamedSet> {
    (vec(name(), 0..3), vec(name(), 0..3)).prop_map(|(nodes, elements)| NamedSet { nodes, elements })
}

fn obstacle() -> impl Strategy<Value = Obstacle> {
    let plane = (numbers(), numbers()).prop_map(|(point, normal)| Obstacle::Plane { point, normal });
    let side = one_of([Side::Outside, Side::Inside]);
    let ball =
        (numbers(), number(), side.clone()).prop_map(|(center, radius, side)| Obstacle::Ball { center, radius, side });
    let cylinder = (numbers(), numbers(), number(), side.clone())
        .prop_map(|(point, axis, radius, side)| Obstacle::Cylinder { point, axis, radius, side });
    let section = (numbers(), numbers(), numbers()).prop_map(|(origin, x, y)| Section { origin, x, y });
    let corners = (of(numbers()), of(numbers()));
    let own = (numbers(), numbers(), of(number()), side.clone(), corners).prop_map(
        |(center, size, rounding, side, (x, y))| Obstacle::Box(RoundedBox { center, size, rounding, side, x, y }),
    );
    let triangles = vec(any::<[u32; 3]>(), 0..3);
    let mesh =
        (vec(numbers(), 0..4), triangles, number(), side.clone()).prop_map(|(points, triangles, rounding, side)| {
            Obstacle::TriangleMesh(TriangleMesh { points, triangles, rounding, side })
        });
    let polyline = (vec(numbers(), 0..4), any::<bool>(), of(number()), of(side), of(section)).prop_map(
        |(points, closed, rounding, side, section)| {
            Obstacle::Polyline(Polyline { points, closed, rounding, side, section })
        },
    );
    prop_oneof![plane, ball, cylinder, polyline, own, mesh]
}

fn contact() -> impl Strategy<Value = Contact> {
    let discretisation = one_of([ContactDiscretisation::Mortar, ContactDiscretisation::NodeToSurface]);
    let body = of((name(), of(discretisation)));
    (name(), name(), number(), body).prop_map(|(node, other, friction, body)| match body {
        // An obstacle without a name is none.
        None => Contact::new(node, format!("obstacle {other}"), friction),
        Some((surface, discretisation)) => {
            // Without a node it would stand for all nodes of the surface.
            Contact { node: format!("node {node}"), discretisation, ..Contact::between(surface, other, friction) }
        }
    })
}

fn until() -> impl Strategy<Value = Until> {
    let bound = (name(), component(), of(number()), of(number()))
        .prop_map(|(node, component, above, below)| DisplacementBound { node, component, above, below });
    (of(number()), of(number()), of(bound), of(any::<u64>()), of(any::<u64>()), of(any::<u64>())).prop_map(
        |(load_above, load_below, displacement, limit_points, contact_change, increments)| Until {
            load_above,
            load_below,
            displacement,
            limit_points,
            contact_change,
            increments,
        },
    )
}

fn stage() -> impl Strategy<Value = Stage> {
    let on_solids = (map(numbers()), map(numbers()), map(number()));
    let control =
        (of(until()), one_of([StageControl::Path, StageControl::Load]), vec(number(), 0..3), of(any::<u64>()));
    let rotation = (number(), of(numbers()), of(numbers())).prop_map(|(angle, about, axis)| ObstacleRotation {
        angle,
        about,
        axis,
    });
    let of_obstacles = (map(numbers()), map(rotation));
    (name(), map(numbers()), map(number()), map(numbers()), on_solids, of_obstacles, control).prop_map(
        |(name, forces, moments, displacements, on_solids, of_obstacles, (until, control, history, cycles))| {
            let (obstacle_motion, obstacle_rotation) = of_obstacles;
            let (body_forces, tractions, pressures) = on_solids;
            Stage {
                name,
                forces,
                moments,
                displacements,
                body_forces,
                tractions,
                pressures,
                obstacle_motion,
                obstacle_rotation,
                until,
                control,
                history,
                cycles,
            }
        },
    )
}

fn model() -> impl Strategy<Value = Model> {
    let units = (of(name()), of(name())).prop_map(|(length, force)| Units { length, force });
    let geometry =
        (of(name()), of(units), 0usize..5, map(numbers()), map(vec(component(), 0..4)), vec(element(), 0..4));
    let solids = (map(material()), map(surface()), map(set()));
    let rest = (map(obstacle()), vec(contact(), 0..4), vec(stage(), 0..3));
    (geometry, solids, rest).prop_map(|(geometry, (materials, surfaces, sets), (obstacles, contacts, stages))| {
        let (name, units, dimension, nodes, supports, elements) = geometry;
        Model {
            name,
            units,
            dimension,
            mesh: None,
            nodes,
            supports,
            materials,
            elements,
            surfaces,
            sets,
            obstacles,
            contacts,
            posted_contacts: Vec::new(),
            stages,
        }
    })
}

fn analysis() -> impl Strategy<Value = Analysis> {
    let arc_length = (number(), number(), number(), of(number()), of(number()), any::<bool>()).prop_map(
        |(initial, min, max, displacement_scale, load_scale, jump)| ArcLength {
            initial,
            min,
            max,
            displacement_scale,
            load_scale,
            jump,
        },
    );
    let method = one_of([Method::Auto, Method::Mpec, Method::Regularised]);
    let load_sign = one_of([LoadSign::Determinant, LoadSign::PreviousIncrement]);
    let regularised = (number(), number(), any::<u64>(), number(), number(), load_sign).prop_map(
        |(normal_penalty, tangential_penalty, desired_iterations, tolerance, load_weight, load_sign)| Regularised {
            normal_penalty,
            tangential_penalty,
            desired_iterations,
            tolerance,
            load_weight,
            load_sign,
        },
    );
    let selection = one_of([Selection::MaxDissipation, Selection::MinPotentialEnergy, Selection::Straightest]);
    let events = one_of([Events::Auto, Events::All]);
    let explore = of((any::<u64>(), any::<u64>()).prop_map(|(depth, max_jobs)| Explore { depth, max_jobs }));
    let contact = (name(), name()).prop_map(|(node, obstacle)| RecordedContact { node, obstacle });
    let contacts = prop_oneof![
        one_of([ContactRange::All, ContactRange::InReach]).prop_map(RecordedContacts::Range),
        vec(contact, 0..3).prop_map(RecordedContacts::Named),
    ];
    let element = prop_oneof![any::<u64>().prop_map(ElementReference::Place), name().prop_map(ElementReference::Name)];
    let force_range = || one_of([ForceRange::All, ForceRange::None]);
    let elements = prop_oneof![
        force_range().prop_map(RecordedElements::Range),
        vec(element, 0..3).prop_map(RecordedElements::Listed),
    ];
    let supports = prop_oneof![
        force_range().prop_map(RecordedSupports::Range),
        vec(name(), 0..3).prop_map(RecordedSupports::Named),
    ];
    let flags = (any::<bool>(), any::<bool>());
    let record = (of(vec(name(), 0..3)), of(contacts), of(elements), of(supports), any::<u64>(), flags).prop_map(
        |(nodes, contacts, elements, supports, every, (directions, stability))| Record {
            nodes,
            contacts,
            elements,
            supports,
            every,
            directions,
            stability,
        },
    );
    let counts = (any::<u64>(), any::<u64>(), any::<bool>());
    let certificate = prop_oneof![Just(Certificate::Use), Just(Certificate::Skip)];
    let mpec = certificate.prop_map(|certificate| Mpec { certificate });
    let kind = one_of([JumpMotionKind::Overdamped, JumpMotionKind::Inertial]);
    let jump_motion = (kind, of(number()), number(), any::<u64>(), any::<[bool; 2]>()).prop_map(
        |(kind, damping_ratio, tolerance, max_steps, [keep_steps, compare])| JumpMotion {
            kind,
            damping_ratio,
            tolerance,
            max_steps,
            keep_steps,
            compare,
        },
    );
    let jumps = (one_of([OnPathEnd::Stop, OnPathEnd::Jump]), of(jump_motion));
    let of_methods = (of(mpec), of(regularised));
    (method, selection, events, arc_length, counts, explore, of(record), (of_methods, jumps)).prop_map(
        |(
            method,
            selection,
            events,
            arc_length,
            (max_increments, max_modes, keep_all),
            explore,
            record,
            ((mpec, regularised), (on_path_end, jump_motion)),
        )| Analysis {
            method,
            selection,
            events,
            arc_length,
            max_increments,
            max_modes,
            explore,
            record,
            on_path_end,
            jump_motion,
            keep_all,
            mpec,
            regularised,
        },
    )
}

proptest! {
    #[test]
    fn what_the_types_write_is_read_back(model in model(), analysis in analysis()) {
        let request = JobRequest { model, analysis };
        let text = serde_json::to_vec_pretty(&request).unwrap();
        prop_assert_eq!(&decode(&text).unwrap(), &request);
        prop_assert_eq!(&serde_json::from_slice::<JobRequest>(&text).unwrap(), &request);
    }
}

fn errors(text: &str) -> InputErrors {
    decode(text.as_bytes()).unwrap_err()
}

#[test]
fn defaults_are_those_of_the_types() {
    let text = br#"{"model": {"dimension": 2, "nodes": {}, "elements": [
        {"kind": "bar", "nodes": ["a", "b"], "axial_stiffness": 1}],
        "obstacles": {"o": {"kind": "ball", "center": [], "radius": 1}},
        "contacts": [{"node": "a", "obstacle": "o"}], "stages": [{"name": "s", "until": {}}]}}"#;
    assert_eq!(decode(text).unwrap(), serde_json::from_slice(text).unwrap());
}

#[test]
fn absent_arc_lengths_follow_the_given_ones() {
    let bounds = |initial, min, max| {
        let arc_length = ArcLength::with_defaults(initial, min, max);
        (arc_length.initial, arc_length.min, arc_length.max)
    };
    assert_eq!(bounds(None, None, None), (0.02, 1e-9, 0.5));
    assert_eq!(bounds(None, None, Some(0.01)), (0.01, 1e-9, 0.01));
    assert_eq!(bounds(None, Some(0.5), None), (0.5, 0.5, 0.5));
    assert_eq!(bounds(Some(3.0), None, None), (3.0, 1e-9, 3.0));
    assert_eq!(bounds(Some(1e-12), None, None), (1e-12, 1e-12, 0.5));
    assert_eq!(bounds(Some(1.0), Some(2.0), Some(0.5)), (1.0, 2.0, 0.5));
}

#[test]
fn every_mistake_is_listed_with_its_place() {
    let errors = errors(
        r#"{"modle": 1, "model": {"dimension": "2", "nodes": {"a": [0, null], "a": [0, 0]}, "elements": [
            {"kind": "bra"}, {"nodes": []}, 7, {"kind": "spring", "nodes": [1], "stifness": []}], "stages": {}}}"#,
    );
    let pointers: Vec<&str> = errors.0.iter().map(|error| error.pointer.as_str()).collect();
    assert_eq!(
        pointers,
        [
            "/model/nodes/a",
            "/modle",
            "/model/dimension",
            "/model/nodes/a/1",
            "/model/elements/0/kind",
            "/model/elements/1",
            "/model/elements/2",
            "/model/elements/3/stifness",
            "/model/elements/3/nodes/0",
            "/model/elements/3",
            "/model/stages",
        ]
    );
    assert_eq!(errors.0[2].detail, "found the string `2`; a whole number is expected");
    assert_eq!(
        errors.0[4].detail,
        "`bra` is not a kind of element; did you mean `bar`? Known: `bar`, `spring`, `beam`, `rotational_spring`, \
         `triangle3`, `triangle6`, `quadrilateral4`, `quadrilateral8`, `tetrahedron4`, `tetrahedron10`, `hexahedron8`, \
         `hexahedron20` and 1 more"
    );
}

#[test]
fn a_flood_of_mistakes_is_bounded() {
    let flood = |elements: String| errors(&format!("{{\"model\": {{\"elements\": [{elements}0]}}}}")).0;
    let same = flood("0,".repeat(100_000));
    let other_names = flood((0..100_000).map(|kind| format!("{{\"kind\": \"k{kind}\"}},")).collect());
    for errors in [same, other_names] {
        assert!(errors.len() < 10, "repeats are counted: {}", errors.len());
        assert!(errors.iter().any(|error| error.detail.contains("more places have such a mistake")), "{errors:?}");
    }
}
