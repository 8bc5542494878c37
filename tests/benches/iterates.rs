//! The iterates of an increment's program, the last of each `ε`, and the point that Newton's method makes of them.
//!
//! `cargo bench --bench iterates -- SCENE INCREMENT [INCREMENT ...]`

use arcslip::continuation::path::iterator::Path;
use arcslip::continuation::scene::Scene;
use arcslip::model::request::{Certificate, Method, Mpec};
use arcslip::resources::cancel::CancelFlag;
use arcslip::result::program_iterate::ProgramIterate;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    let scene = words.iter().find(|word| word.parse::<u64>().is_err()).map_or("klarbring", String::as_str);
    let mut asked: Vec<u64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    if asked.is_empty() {
        asked.push(2);
    }
    let built_in = arcslip::check::scenes::find(scene).unwrap_or_else(|| panic!("there is no scene {scene}"));
    let mut request =
        arcslip::model::decode::decode(built_in.request.as_bytes()).unwrap_or_else(|errors| panic!("{errors}"));
    request.analysis.method = Method::Mpec;
    request.analysis.mpec = Some(Mpec { certificate: Certificate::Skip });
    let scene = Scene::new(&request).unwrap_or_else(|errors| panic!("{errors}"));
    let mut path = Path::new(&scene, CancelFlag::default());
    path.keep_iterates();
    while let Some(increment) = path.next() {
        if !asked.contains(&increment.index) {
            continue;
        }
        println!(
            "\n| program | ε | steps | arc length | load factor | contact | gap | r_n | within the cone | slip | violation |"
        );
        println!("|--:|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|");
        let same = |one: &ProgramIterate, other: &ProgramIterate| {
            (one.program, one.relaxation) == (other.program, other.relaxation)
        };
        for level in path.iterates().chunk_by(same) {
            let Some(iterate) = level.last() else { continue };
            let relaxation = iterate.relaxation.map_or("mode".to_owned(), |relaxation| format!("{relaxation:.0e}"));
            for at in &iterate.contacts {
                println!(
                    "| {} | {relaxation} | {} | {:.6} | {:.9} | {} on {} | {:.1e} | {:.9} | {:.1e} | {:.9} | {:.0e} |",
                    iterate.program,
                    level.len(),
                    iterate.size * increment.step,
                    iterate.load_factor,
                    at.node,
                    at.obstacle,
                    at.gap,
                    at.normal_reaction,
                    at.within_cone,
                    at.slip,
                    iterate.violation
                );
            }
        }
        for contact in &increment.contacts {
            let size = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>().sqrt();
            println!(
                "| polished | | | {:.6} | {:.9} | {} on {}: {:?} | {:.1e} | {:.9} | | {:.9} | {:.0e} |",
                increment.step,
                increment.load_factor,
                contact.node,
                contact.obstacle,
                contact.status,
                contact.gap,
                contact.normal_reaction,
                size(&contact.slip),
                increment.diagnostics.residual
            );
        }
        println!("\nincrement {}: {}", increment.index, increment.point.event.as_deref().unwrap_or("regular"));
    }
}
