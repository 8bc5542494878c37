//! The shooting solutions against published values of inextensible beams and against closed forms.

use super::*;

/// Inextensible to rounding error.
const RIGID: f64 = 1e14;

fn close(found: f64, exact: f64, bar: f64) {
    assert!((found - exact).abs() <= bar, "found {found:.12}, exact {exact:.12}");
}

#[test]
fn a_rough_arch_has_its_published_points() {
    let arch = RoughArch::right(0.8, RIGID);
    let found = [arch.onset(), arch.turn_of_drop(), arch.minimum()];
    let exact = [[9.3605882420, 0.5003093224], [3.721305955, 0.236073760], [1.991708124, 0.818093982]];
    for (found, exact) in found.into_iter().zip(exact) {
        let found = found.unwrap();
        close(found.load, exact[0], 2e-9);
        close(found.drop, exact[1], 1e-8);
    }
    for (axial, onset) in [(1e3, 9.297066994), (1e4, 9.354333575), (1e5, 9.359963735)] {
        close(RoughArch::right(0.8, axial).onset().unwrap().load, onset, 2e-9);
    }
    let maximum = arch.stuck_maximum().unwrap();
    close(maximum.load, 10.15034386, 1e-8);
    close(maximum.drop, 0.7318513, 1e-7);
    close(arch.first_thrust(), std::f64::consts::FRAC_2_PI, 1e-14);
    let without = RoughArch { half_angle: 141.549225_f64.to_radians(), ..arch };
    close(without.first_thrust(), 0.0, 1e-8);
}

#[test]
fn frames_have_their_published_points() {
    close(DeepArch { axial: RIGID }.maximum().unwrap().load, 8.9731, 1e-4);
    let [first, second] = LeeFrame { section: BeamSection::slender(RIGID) }.limits().unwrap();
    close(first.load, 18.5587466, 1e-7);
    close(first.displacement[0], 0.224057, 1e-6);
    close(first.displacement[1], -0.406162, 1e-6);
    close(second.load, -9.4212875, 1e-7);
    close(second.displacement[0], 0.751766, 1e-6);
    close(second.displacement[1], -0.485004, 1e-6);
    let [first, _] = LeeFrame::PUBLISHED.limits().unwrap();
    close(first.load, 18.546_558_74, 1e-6);
    for (force, [w, u, slope]) in
        [(1.0, [0.3017207738, 0.05643323628, 0.4613519497]), (10.0, [0.8106090249, 0.5549955978, 1.430285539])]
    {
        let [x, y, angle] = DeadForce { section: BeamSection::slender(RIGID), force }.tip().unwrap();
        close(y, w, 1e-9);
        close(x, -u, 1e-9);
        close(angle, slope, 1e-9);
    }
}

#[test]
fn pressed_beams_have_their_published_points() {
    let column = ColumnBetweenWalls { gap: 0.01, axial: RIGID };
    close(column.touch().unwrap(), 9.87082237163, 1e-9);
    close(column.line_contact().unwrap(), 39.472493805, 1e-8);
    // A ring's flexibility under two opposite forces is π/4 - 2/π; half the ring has half the force.
    let ring = SqueezedRing { friction: 0.0, axial: RIGID };
    let flexibility = std::f64::consts::FRAC_PI_4 - std::f64::consts::FRAC_2_PI;
    close(ring.force(1e-6).unwrap() / 1e-6 * flexibility, 0.5, 1e-5);
}

/// Friction holds a tip back; a hook without friction is pressed by as much on the way down as on the way up.
#[test]
fn tips_slide() {
    let tip = DraggedTip { slant: 1.0, friction: 0.4, rise: 0.1, axial: 1e4 };
    let [out, back] = [-1.0, 1.0].map(|sign| tip.slipping(sign).unwrap());
    assert!(out.reaction > back.reaction && back.reaction > 0.0);
    let hook = SnapFit { friction: 0.2, axial: 1e4 };
    let (travel, reaction) = hook.sliding(0.0).unwrap();
    assert!(travel > 0.1 && reaction > 0.0);
    // Touched from the left and below the top.
    let first = SnapFit::angle([0.0, 0.0]);
    let (travel, reaction) = hook.sliding(first).unwrap();
    close(travel, 0.0, 1e-12);
    close(reaction, 0.0, 1e-12);
}
