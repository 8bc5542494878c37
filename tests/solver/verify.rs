//! Every case with a known answer passes.

use arcslip::check::cases::cases;

#[test]
fn every_case_passes() {
    let mut failed = Vec::new();
    for case in cases().iter().filter(|case| !case.long) {
        for &method in case.methods {
            let row = case.solve(method);
            if !row.pass {
                failed.push(format!("{row:?}"));
            }
        }
    }
    assert!(failed.is_empty(), "{} cases fail:\n{}", failed.len(), failed.join("\n"));
}
