//! Limit point and contact change at one point; several events at the same load, or at nearly the same load.

use crate::check::verify::case::Case;
use crate::check::verify::compare::{moved, of_stage, relative, worse, worst};
use crate::check::verify::known::{KlarbringSolution, VonMisesSolution};
use crate::check::verify::make::{load_above, plane_model};
use crate::result::increment::Status;

const SEPARATIONS: [f64; 7] = [0.0, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9, 1e-6];

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    cases.extend([0.0, 1e-13, -1e-13, 1e-11, -1e-11, 1e-9, -1e-9, 1e-6, -1e-6].map(landing_at_the_limit));
    for number in [2, 6] {
        cases.extend(SEPARATIONS.map(|apart| slips(number, apart)));
        cases.extend(SEPARATIONS.map(|apart| landings(number, apart)));
    }
    cases.extend([0.0, 1e-6].map(falling_slips));
    cases
}

/// The von Mises truss (h = 1/2) over a floor that the apex reaches at the limit point, or at a small distance from the
/// limit point. Down to the floor the load is that of the truss. From there on the load rises, with `r_n = s - P`.
fn landing_at_the_limit(off: f64) -> Case {
    let truss = VonMisesSolution { height: 0.5 };
    let floor = truss.height_at_limit() + off;
    let request = truss
        .make()
        .plane("floor", &[0.0, floor], &[0.0, 1.0])
        .contact("apex", "floor", 0.5)
        .stage("load", &[("apex", [0.0, -1.0])], load_above(0.1))
        .request();
    Case::new("limit-and-contact", format!("floor off by {off:e}"), request).exact(1e-10, move |path| {
        let drop = truss.height - floor;
        let states = path.iter().skip(1).map(|increment| {
            let (s, y) = (increment.load_factor, moved(increment, "apex", 1));
            match increment.contacts[0].status {
                Status::Free => relative(s, truss.load(-y), 0.0),
                Status::Stick => {
                    worse((y + drop).abs(), (increment.contacts[0].normal_reaction - (s - truss.load(drop))).abs())
                }
                Status::Slip => f64::INFINITY,
            }
        });
        let landed = path.iter().filter(|increment| increment.contacts[0].status == Status::Stick).count() >= 2;
        if landed { worst(states) } else { f64::INFINITY }
    })
}

fn name(index: usize) -> String {
    format!("node{index}")
}

/// Klarbring's nodes with `μ = 1/2 + i δ` (the loads rise) and `K = [[1, -1/4], [-1/4, 1]]`, pulled by one load. Each
/// node moves as if the node were alone.
fn slips(number: usize, apart: f64) -> Case {
    let alone = move |index: usize| KlarbringSolution {
        along: 1.0,
        coupling: 0.25,
        across: 1.0,
        friction: 0.5 + index as f64 * apart,
        press: 1.0,
        pull: 1.0,
    };
    let request = row(number, alone, 6.0);
    Case::new("events-at-once", format!("{number} slips {apart:e} apart"), request).exact(1e-10, move |path| {
        worst(of_stage(path, "pull").flat_map(|increment| {
            (0..number).map(move |index| alone(index).error_at(increment, &name(index), index..index + 1))
        }))
    })
}

fn row(number: usize, alone: impl Fn(usize) -> KlarbringSolution, last: f64) -> crate::model::JobRequest {
    let names: Vec<String> = (0..number).map(name).collect();
    let mut make = plane_model().floor();
    for (index, name) in names.iter().enumerate() {
        make = make.node(name, &[index as f64, 0.0]).spring(&[name], alone(index).stiffness()).contact(
            name,
            "floor",
            alone(index).friction,
        );
    }
    let forces = |force: [f64; 2]| names.iter().map(|name| (name.as_str(), force)).collect::<Vec<_>>();
    make.stage("press", &forces([0.0, -1.0]), load_above(1.0))
        .stage("pull", &forces([1.0, 0.0]), load_above(last))
        .request()
}

/// Two of Klarbring's nodes (μ = 1.5), whose loads fall during slip. If the nodes are identical, both slip at the same
/// time, which dissipates more per arc length. Otherwise the first node slips alone, and the second node slips after
/// the first has left the floor.
fn falling_slips(apart: f64) -> Case {
    let alone =
        move |index: usize| KlarbringSolution { friction: 1.5 + index as f64 * apart, ..KlarbringSolution::PUBLISHED };
    Case::new("events-at-once", format!("two falling slips {apart:e} apart"), row(2, alone, 3.0)).exact(
        1e-10,
        move |path| {
            let together = of_stage(path, "pull")
                .any(|increment| increment.contacts.iter().all(|contact| contact.status == Status::Slip));
            let error = worst(of_stage(path, "pull").flat_map(|increment| {
                (0..2).map(move |index| alone(index).error_at(increment, &name(index), index..index + 1))
            }));
            if together == (apart == 0.0) { error } else { f64::INFINITY }
        },
    )
}

/// Nodes on unit springs at gaps `1/2 + i δ` above the floor, pressed by s. Each node lands at `s = g`; then
/// `r_n = s - g`.
fn landings(number: usize, apart: f64) -> Case {
    let gap = move |index: usize| 0.5 + index as f64 * apart;
    let names: Vec<String> = (0..number).map(name).collect();
    let mut make = plane_model().floor();
    for (index, name) in names.iter().enumerate() {
        make = make
            .node(name, &[index as f64, gap(index)])
            .spring(&[name], [[1.0, 0.0], [0.0, 1.0]])
            .contact(name, "floor", 0.5);
    }
    let forces: Vec<(&str, [f64; 2])> = names.iter().map(|name| (name.as_str(), [0.0, -1.0])).collect();
    let request = make.stage("press", &forces, load_above(1.0)).request();
    Case::new("events-at-once", format!("{number} landings {apart:e} apart"), request).exact(1e-10, move |path| {
        worst(path.iter().flat_map(|increment| {
            let s = increment.load_factor;
            (0..number).map(move |index| {
                let place = (moved(increment, &name(index), 1) + s.min(gap(index))).abs();
                worse(place, (increment.contacts[index].normal_reaction - (s - gap(index)).max(0.0)).abs())
            })
        }))
    })
}
