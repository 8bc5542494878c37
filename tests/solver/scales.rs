//! The scales of arc length go by what resists the load: one odd element, however soft beside the others or stiff in line
//! with them, changes neither the number of increments by much nor the path.

use crate::common::paths::{Traced, close, judged, request};
use crate::common::random::Numbers;
use crate::common::variants::about_axes;
use arcslip::continuation::scene::Scene;
use arcslip::result::increment::Increment;
use arcslip::result::stop_reason::StopReason;
use serde_json::{Value, json};

/// A path whose every increment keeps to its equations, and why it ends. What is stored against elements that are softer or
/// stiffer by more than ten orders is rounding beside the others, and so is the balance of energy.
fn traced(model: &Value, odd: f64) -> (Vec<Increment>, StopReason) {
    let request = request(&model.to_string());
    let Traced { increments, errors, report, .. } = judged(&request);
    for (increment, errors) in increments.iter().zip(errors) {
        assert!(errors.largest_of_state() <= 1e-10, "{odd:e}, increment {}: {errors:?}", increment.index);
        let is_told = (1e-10..=1e10).contains(&odd);
        assert!(!is_told || errors.energy <= 1e-6, "{odd:e}, increment {}: {errors:?}", increment.index);
    }
    (increments, report.stop_reason)
}

const SOFT: [f64; 9] = [0.5, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12];
const STIFF: [f64; 7] = [2.0, 10.0, 1e2, 1e4, 1e6, 1e9, 1e12];

/// No more than twice the increments of the model in which the odd element is like the others.
fn assert_alike(name: &str, odd: &[f64], model: impl Fn(f64) -> Value) {
    assert_alike_to(1.0, name, odd, model);
}

fn assert_alike_to(like: f64, name: &str, odd: &[f64], model: impl Fn(f64) -> Value) {
    let (like, end) = traced(&model(like), like);
    let counts: Vec<usize> = odd
        .iter()
        .map(|stiffness| {
            let (increments, reason) = traced(&model(*stiffness), *stiffness);
            assert_eq!(reason, end, "{name}: {stiffness:e}");
            increments.len()
        })
        .collect();
    println!("{name}: {} increments, {counts:?} with {odd:?}", like.len());
    for (count, stiffness) in counts.iter().zip(odd) {
        assert!(*count <= 2 * like.len(), "{name}: {count} increments at {stiffness:e}, {} alike", like.len());
    }
}

/// Bars from supports at `pins` to one node at `tip`, whose load is `force`.
fn star(tip: [f64; 2], pins: &[([f64; 2], f64)], force: [f64; 2], until: Value) -> Value {
    let (mut nodes, mut supports) = (json!({"t": tip}), json!({}));
    let mut elements = Vec::new();
    for (index, (place, stiffness)) in pins.iter().enumerate() {
        let name = format!("p{index}");
        nodes[&name] = json!(place);
        supports[&name] = json!(["x", "y"]);
        elements.push(json!({"kind": "bar", "nodes": [name, "t"], "axial_stiffness": stiffness}));
    }
    json!({"model": {"dimension": 2, "nodes": nodes, "supports": supports, "elements": elements,
        "stages": [{"name": "push", "forces": {"t": force}, "until": until}]}})
}

/// What the bars of a star leave of the balance of its node.
fn left_over(tip: [f64; 2], pins: &[([f64; 2], f64)], force: [f64; 2], increment: &Increment) -> f64 {
    let moved = &increment.displacements["t"];
    let mut sum = force.map(|value| value * increment.load_factor);
    for (place, stiffness) in pins {
        let along: [f64; 2] = std::array::from_fn(|k| tip[k] + moved[k] - place[k]);
        let (length, rest) = (along[0].hypot(along[1]), (tip[0] - place[0]).hypot(tip[1] - place[1]));
        let axial = stiffness * (length - rest) / rest;
        (0..2).for_each(|k| sum[k] -= axial * along[k] / length);
    }
    sum[0].hypot(sum[1])
}

#[test]
fn a_soft_bar_that_carries_nothing_does_not_set_the_scale() {
    let pins = |odd: f64| [([0.0, 0.0], 1.0), ([2.0, 0.0], 1.0), ([3.0, 1.0], odd)];
    let (tip, force) = ([1.0, 0.5], [0.0, -1.0]);
    let model = |odd: f64| star(tip, &pins(odd), force, json!({"load_above": 0.01}));
    assert_alike("three bars", &SOFT, model);
    for odd in SOFT {
        let (increments, reason) = traced(&model(odd), odd);
        assert_eq!(reason, StopReason::StagesCompleted);
        let last = increments.last().expect("an end");
        assert_eq!(last.load_factor, 0.01);
        assert!(left_over(tip, &pins(odd), force, last) < 1e-14, "{odd:e}");
    }
}

/// The one-bar truss with a tether along the floor: while the tip slips, `s = P (μ h - x)/L + T (x - a)/(8 - a')`.
fn tethered(odd: f64) -> Value {
    let mut model = star([-1.5, 0.0], &[([0.0, 1.0], 1.0), ([-8.0, 0.0], odd)], [1.0, 0.0], json!({}));
    model["model"]["obstacles"] = json!({"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}});
    model["model"]["contacts"] = json!([{"node": "t", "obstacle": "floor", "friction": 0.3}]);
    model["model"]["stages"][0]["until"] = json!({"displacement": {"node": "t", "component": "x", "above": 2.9}});
    model["analysis"] = json!({"arc_length": {"initial": 0.02, "max": 0.1}});
    model
}

#[test]
fn a_soft_tether_does_not_set_the_scale() {
    assert_alike("one bar and a tether", &SOFT, tethered);
    for odd in SOFT {
        let (increments, _) = traced(&tethered(odd), odd);
        let mut slipped = 0;
        for increment in increments.iter().filter(|one| one.contacts[0].tangential_reaction[0].abs() > 1e-9) {
            let contact = &increment.contacts[0];
            if (contact.tangential_reaction[0].abs() - 0.3 * contact.normal_reaction).abs() > 1e-12 {
                continue;
            }
            let x = -1.5 + increment.displacements["t"][0];
            let (length, rest) = (x.hypot(1.0), 1.5_f64.hypot(1.0));
            let side = -contact.tangential_reaction[0].signum();
            let exact = (1.0 - length / rest) * (0.3 * side - x) / length + odd * (x + 1.5) / 6.5;
            close(increment.load_factor, exact, 1e-10, "load");
            slipped += 1;
        }
        assert!(slipped > 10, "{odd:e}: {slipped}");
    }
}

/// A tip pushed down between two bars, through a link, a node that a soft tether holds as well.
fn linked(link: f64, tether: f64) -> Value {
    json!({"model": {"dimension": 2,
        "nodes": {"l": [-1, 0], "r": [1, 0], "t": [0, 0.5], "q": [0, 1.5], "far": [4, 2]},
        "supports": {"l": ["x", "y"], "r": ["x", "y"], "q": ["x"], "far": ["x", "y"]},
        "elements": [
            {"kind": "bar", "nodes": ["l", "t"], "axial_stiffness": 1},
            {"kind": "bar", "nodes": ["r", "t"], "axial_stiffness": 1},
            {"kind": "bar", "nodes": ["q", "t"], "axial_stiffness": link},
            {"kind": "bar", "nodes": ["q", "far"], "axial_stiffness": tether}],
        "stages": [{"name": "push", "forces": {"q": [0, -1]},
            "until": {"displacement": {"node": "q", "component": "y", "below": -1.2}}}]}})
}

#[test]
fn a_stiff_link_does_not_set_the_scale() {
    assert_alike("von Mises, linked", &STIFF, |odd| linked(odd, 1e-3));
    assert_alike("von Mises, tethered", &SOFT, |odd| linked(1.0, odd));
    assert_alike("von Mises, linked and tethered", &STIFF, |odd| linked(odd, 1e-3 / odd));
}

/// A load across two bars in line, which hold it only as they bend: at first order nothing but a tether does. One that is
/// as stiff as they are makes another path; soft ones are compared.
#[test]
fn what_holds_at_second_order_counts() {
    let pins = |odd: f64| [([-1.0, 0.0], 1.0), ([1.0, 0.0], 1.0), ([0.0, 2.0], odd)];
    assert_alike_to(0.1, "bars in line", &SOFT[2..], |odd| {
        star([0.0, 0.0], &pins(odd), [0.0, -1.0], json!({"load_above": 0.1}))
    });
}

/// A stiff bar that only guides its node around its pin, and a soft one that holds it against the load.
#[test]
fn a_guide_does_not_set_the_scale() {
    let pins = |odd: f64| [([0.0, 1.0], odd), ([1.0, 0.0], 1.0)];
    assert_alike("guided", &STIFF[..6], |odd| star([0.0, 0.0], &pins(odd), [0.3, 0.0], json!({"load_above": 0.5})));
}

/// The one-bar truss pulled through a bar on the floor: friction holds the tip at first, the truss ever after.
#[test]
fn a_bar_that_pulls_does_not_set_the_scale() {
    let model = |odd: f64| {
        let mut model = tethered(1e-12);
        model["model"]["nodes"]["hook"] = json!([-0.5, 0]);
        model["model"]["supports"]["hook"] = json!(["y"]);
        model["model"]["elements"][1] = json!({"kind": "bar", "nodes": ["t", "hook"], "axial_stiffness": odd});
        model["model"]["stages"][0]["forces"] = json!({"hook": [1, 0]});
        model
    };
    assert_alike("pulled by a bar", &STIFF[..6], model);
}

/// The tip falls a little before it lands: until then only the tether holds it.
#[test]
fn a_contact_that_closes_soon_counts() {
    let model = |odd: f64| {
        let mut model = tethered(odd);
        model["model"]["obstacles"]["floor"]["point"] = json!([0, -0.01]);
        model["model"]["stages"][0]["until"] = json!({"load_above": 0.2});
        model
    };
    assert_alike("one bar above its floor", &SOFT[..7], model);
}

/// Blocks on a floor, joined by springs and pulled at the first, with one odd spring among them.
fn chain(springs: &[f64], to_ground: f64) -> Value {
    let (mut nodes, mut elements, mut contacts, mut press) = (json!({}), Vec::new(), Vec::new(), json!({}));
    for block in 0..=springs.len() {
        let name = format!("b{block}");
        nodes[&name] = json!([block, 0]);
        contacts.push(json!({"node": name, "obstacle": "floor", "friction": 0.5}));
        press[&name] = json!([0, -1]);
        let ground = json!([[to_ground, 0], [0, 1]]);
        elements.push(json!({"kind": "spring", "nodes": [name], "stiffness": ground}));
    }
    for (index, stiffness) in springs.iter().enumerate() {
        let ends = [format!("b{index}"), format!("b{}", index + 1)];
        elements.push(json!({"kind": "spring", "nodes": ends, "stiffness": [[stiffness, 0], [0, 0]]}));
    }
    json!({"model": {"dimension": 2, "nodes": nodes, "elements": elements, "contacts": contacts,
        "obstacles": {"floor": {"kind": "plane", "point": [0, 0], "normal": [0, 1]}},
        "stages": [{"name": "press", "forces": press, "until": {"load_above": 1}},
            {"name": "pull", "forces": {"b0": [-1, 0]}, "until": {"load_above": 1.75}}]},
        "analysis": {"arc_length": {"max": 0.2}}})
}

#[test]
fn an_odd_spring_does_not_set_the_scale() {
    assert_alike("chain, a stiff spring", &STIFF[..5], |odd| chain(&[1.0, odd, 1.0], 0.1));
    assert_alike("chain, springs to the ground", &SOFT, |odd| chain(&[1.0, 1.0, 1.0], 0.1 * odd));
}

/// The arch with a bar of its own or a tether that is odd, over the whole of its path.
#[test]
fn the_arch_keeps_its_scale() {
    let arch = |bar: usize, odd: f64, tether: f64| {
        let mut model: Value =
            serde_json::from_str(arcslip::check::scenes::find("arch-type-truss").expect("a scene").request)
                .expect("JSON");
        model["model"]["elements"][bar]["axial_stiffness"] = json!(odd);
        model["model"]["nodes"]["far"] = json!([-0.1, 3]);
        model["model"]["supports"]["far"] = json!(["x", "y"]);
        let ends = ["b2", "far"];
        let bars = model["model"]["elements"].as_array_mut().expect("elements");
        bars.push(json!({"kind": "bar", "nodes": ends, "axial_stiffness": 1e-3 * tether}));
        model
    };
    assert_alike("arch with a stiff bar", &STIFF[..6], |odd| arch(1, odd, 1e-3));
    assert_alike("arch with a tether", &SOFT, |odd| arch(1, 1.0, odd));
}

/// Two nodes in space, each on a spring and a bar of its own and both on a third, touching a plane with friction each.
fn pair_in_space(seed: u64) -> Value {
    let mut numbers = Numbers(seed);
    let mut model =
        json!({"dimension": 3, "nodes": {}, "supports": {}, "elements": [], "obstacles": {}, "contacts": []});
    let mut forces = json!({});
    for index in 0..2 {
        let [free, pin, plane] = ["f", "p", "o"].map(|name| format!("{name}{index}"));
        let mut place = numbers.vector(3, 0.3);
        place[0] += 2.5 * f64::from(index);
        let mut normal = numbers.vector(3, 1.0);
        normal[2] += 2.0;
        model["nodes"][&pin] = json!([place[0] - 0.8, place[1] + 0.5, place[2] + numbers.between(0.5, 1.0)]);
        model["supports"][&pin] = json!(["x", "y", "z"]);
        model["obstacles"][&plane] = json!({"kind": "plane", "point": place, "normal": normal});
        let stiffness = numbers.positive_definite(0.1, 2.0);
        let elements = model["elements"].as_array_mut().expect("elements");
        elements.push(json!({"kind": "spring", "nodes": [free], "stiffness": stiffness}));
        elements.push(json!({"kind": "bar", "nodes": [pin, free], "axial_stiffness": numbers.between(0.2, 9.0)}));
        let contacts = model["contacts"].as_array_mut().expect("contacts");
        contacts.push(json!({"node": free, "obstacle": plane, "friction": numbers.friction()}));
        forces[&free] = json!(numbers.vector(3, 0.5));
        model["nodes"][&free] = json!(place);
    }
    let both = json!({"kind": "bar", "nodes": ["f0", "f1"], "axial_stiffness": numbers.between(0.2, 9.0)});
    model["elements"].as_array_mut().expect("elements").push(both);
    model["stages"] = json!([{"name": "push", "forces": forces, "until": {"load_above": 1}}]);
    json!({"model": model})
}

#[test]
fn axes_do_not_decide() {
    let axes = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]];
    for seed in 0..200 {
        let posted = request(&pair_in_space(seed).to_string());
        let turned = about_axes(posted.clone(), &axes, [3.0, -1.7, 0.9]);
        let [one, other] = [&posted, &turned].map(|request| Scene::new(request).expect("a scene").plan().clone());
        let what = format!("seed {seed}");
        close(one.displacement_scale, other.displacement_scale, 1e-9, &what);
        close(one.force_scale, other.force_scale, 1e-9, &what);
        close(one.load_scales[0], other.load_scales[0], 1e-6 * one.load_scales[0], &what);
    }
}
