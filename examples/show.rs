use arcslip::*;
fn main() {
    let name = std::env::args().nth(1).unwrap();
    let all = std::env::args().nth(2).is_some();
    let text = match scenes::find(&name) {
        Some(s) => s.request.as_bytes().to_vec(),
        None => std::fs::read(&name).unwrap(),
    };
    let request = model::decode::decode(&text).unwrap();
    let scene = path::Scene::new(&request).unwrap();
    println!("{:?}", scene.plan());
    let mut path = path::Path::new(&scene, Default::default());
    for i in path.by_ref() {
        if all || i.point.event.is_some() || i.point.kind != path::increment::PointKind::Regular {
            println!(
                "{} {:?} bif {} s {:.12} S {:.4} {:?} ev {:?}",
                i.index,
                i.point.kind,
                i.point.bifurcation,
                i.load_factor,
                i.step,
                i.contacts
                    .iter()
                    .map(|c| (c.status, c.gap, c.normal_reaction, c.tangential_reaction[0]))
                    .collect::<Vec<_>>(),
                i.point.event
            );
            println!("    u {:?}", i.displacements.iter().filter(|d| d.1[0] != 0. || d.1[1] != 0.).collect::<Vec<_>>());
            println!("    deg {} {:?}", i.point.degenerate, i.directions);
            println!("    {:?}", i.diagnostics);
        }
    }
    println!("{:?}", path.report());
}
