//! Broken and hostile decks, each with its clear error.

use crate::samples::read;

/// A square of one element, with a set of each kind.
const SQUARE: &str = "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=CPS4, ELSET=all\n1, 1, 2, 3, 4\n\
                      *NSET, NSET=low\n1, 2\n*NSET, NSET=span, GENERATE\n1, 3, 2\n*ELSET, ELSET=again\nall\n\
                      *SURFACE, NAME=top, TYPE=ELEMENT\nall, S3\n*MATERIAL, NAME=steel\n*ELASTIC\n200, 0.3\n\
                      *SOLID SECTION, ELSET=all, MATERIAL=steel\n1.0\n";

#[test]
fn decks_with_mistakes() {
    let cases = [
        ("*NODE\n", "1, 2\n*NODE\n", "the file: expected `$MeshFormat` of gmsh or a keyword"),
        ("*NODE\n", "*\n", "line 1: expected a keyword such as *NODE"),
        ("*NODE\n", "*NODES\n", "the file: there is no *NODE"),
        ("*NODE\n", "*NODE, SYSTEM=C\n", "line 1: expected rectangular coordinates, found `C`"),
        ("*NODE\n", "*NODE, INPUT=nodes.txt\n", "line 1: other files are not opened"),
        ("*NODE\n", "*INCLUDE, INPUT=/etc/passwd\n*NODE\n", "line 1: other files are not opened"),
        ("*NODE\n", "*NGEN\n*NODE\n", "line 1: *NGEN is not read, and the mesh depends on it"),
        ("*NODE\n", "*SYSTEM\n1,0,0\n*NODE\n", "*SYSTEM is not read, and the mesh depends on it"),
        ("*NODE\n", "*PARAMETER\n*NODE\n", "*PARAMETER is not read, and the mesh depends on it"),
        ("2, 1, 0", "2, 1, nan", "line 3: expected a coordinate, a finite number, found `nan`"),
        ("2, 1, 0", "2, inf, 0", "line 3: expected a coordinate, a finite number, found `inf`"),
        ("2, 1, 0", "2, 1e999, 0", "found `1e999`"),
        ("2, 1, 0", "2, 1 0", "line 3: expected a coordinate, a finite number, found `1 0`"),
        ("2, 1, 0", "two, 1, 0", "line 3: expected the label of a node, found `two`"),
        ("2, 1, 0", "-2, 1, 0", "line 3: expected the label of a node, found `-2`"),
        ("2, 1, 0", "99999999999999999999, 1, 0", "expected the label of a node, found `99999999999999999999`"),
        ("2, 1, 0", ", 1, 0", "line 3: expected the label of a node, found nothing"),
        ("2, 1, 0", "1, 1, 0", "line 1: node 1 is given twice"),
        ("2, 1, 0", "2, <x>, 0", "found `<x>`"),
        ("TYPE=CPS4", "TYPE=CPS5", "line 6: expected elements C3D4, 8, 10, 20 or CPS, CPE, CAX"),
        ("TYPE=CPS4", "TYPE=C3D6", "found `C3D6`"),
        ("TYPE=CPS4", "TYPE=C3D27", "found `C3D27`"),
        ("TYPE=CPS4", "TYPE=CPEG4", "found `CPEG4`"),
        ("TYPE=CPS4", "TYPE=B21", "there is no *ELEMENT of a kind that is read"),
        (", TYPE=CPS4", "", "line 6: expected TYPE=... of *ELEMENT, found nothing"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3", "line 7: expected 4 nodes for element 1, found 3"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3, 4, 1", "line 7: expected 4 nodes for element 1, found also `1`"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3, x", "line 7: expected the label of a node, found `x`"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3, 9", "line 6: element 1 has node 9, which is not in the deck"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3, 3", "line 6: element 1 has node 3 twice"),
        ("1, 1, 2, 3, 4", "1, 1, 2, 3, 4\n1, 1, 2, 3, 4", "line 6: element 1 is given twice"),
        ("*NSET, NSET=low", "*NSET", "line 8: expected NSET=... of *NSET, found nothing"),
        ("*NSET, NSET=low", "*NSET, NSET=low, INSTANCE=i", "expected a set without INSTANCE"),
        ("low\n1, 2", "low\n1, 5", "line 8: node 5 is not in the deck"),
        ("low\n1, 2", "low\n1, other", "line 8: there is no set of nodes `other` before this line"),
        ("low\n1, 2", "low\nlow", "there is no set of nodes `low` before this line"),
        ("1, 3, 2", "1, 3, 0", "line 11: expected `first, last, step` upwards with a step above zero, found 1, 3, 0"),
        ("1, 3, 2", "3, 1, 1", "found 3, 1, 1"),
        ("1, 3, 2", "1, x", "line 11: expected a whole number of `first, last, step`, found `x`"),
        ("1, 3, 2", "10, 18446744073709551615, 1", "there is no node from 10 to 18446744073709551615 in steps of 1"),
        ("again\nall", "again\nnone", "line 12: there is no set of elements `none` before this line"),
        ("again\nall", "again\n7", "line 12: element 7 is not in the deck"),
        ("all, S3", "all, S5", "line 15: element 1 has no face S5"),
        ("all, S3", "all, S0", "line 15: expected a face S1 to S6 of a solid, found `S0`"),
        ("all, S3", "all, SPOS", "found `SPOS`"),
        ("all, S3", "all", "line 15: expected a face S1 to S6 of a solid, found nothing"),
        ("all, S3", "many, S3", "line 15: there is no set of elements `many` before this line"),
        ("*MATERIAL, NAME=steel\n", "", "line 16: *ELASTIC has to stand after *MATERIAL"),
        ("*MATERIAL, NAME=steel", "*MATERIAL", "expected NAME=... of *MATERIAL"),
        ("*MATERIAL, NAME=steel", "*MATERIAL, NAME=Steel\n*MATERIAL, NAME=STEEL", "is there a second time"),
        ("200, 0.3", "200, 0.5", "line 18: expected Poisson's ratio between -1 and 0.5, found 0.5"),
        ("200, 0.3", "-200, 0.3", "line 18: expected a modulus of elasticity above zero, found -200"),
        ("200, 0.3\n", "", "line 17: expected 2 numbers on the next line, found none"),
        ("*ELASTIC\n200, 0.3", "*HYPERELASTIC, NEO HOOKE\n1, 0", "expected D1 above zero"),
        ("*ELASTIC\n200, 0.3", "*HYPERELASTIC, MOONEY-RIVLIN\n-1, 0, 1", "expected C10 + C01 above zero"),
        ("*ELASTIC\n200, 0.3", "*DENSITY\n0", "expected a density above zero, found 0"),
        ("ELSET=all, MATERIAL", "ELSET=none, MATERIAL", "line 19: there is no set of elements `none`"),
        (", MATERIAL=steel", "", "line 19: expected MATERIAL=... of *SOLID SECTION"),
        ("steel\n1.0", "steel\n0.0", "line 20: expected a thickness above zero, found 0"),
        ("steel\n1.0", "steel\n*SOLID SECTION, ELSET=again, MATERIAL=steel", "element 1 has a section already"),
        ("steel\n1.0", "steel, COMPOSITE\n1.0", "a section of several layers is not read"),
        ("*NODE\n", "*PART, NAME=a\n*END PART\n*PART, NAME=b\n*NODE\n", "line 3: a second part after `a`"),
        ("*NODE\n", "*INSTANCE, NAME=a\n1, 0, 0\n*NODE\n", "line 2: the instance is moved"),
        ("*NODE\n", "*INSTANCE, NAME=a\n0,0,0\n0,0,0,0,0,1,90\n*NODE\n", "line 3: the instance is moved"),
        ("*NODE\n", "*INSTANCE, NAME=a\n*INSTANCE, NAME=b\n*NODE\n", "line 2: a second instance after `a`"),
    ];
    read(SQUARE.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    for (from, to, expected) in cases {
        assert!(SQUARE.contains(from), "{from}");
        let error = read(SQUARE.replacen(from, to, 1).as_bytes()).expect_err(to).to_string();
        assert!(error.contains(expected), "`{from}` as `{to}`: {error}\nexpected: {expected}");
    }
}

#[test]
fn what_is_no_mesh() {
    for (bytes, expected) in [
        (&b""[..], "the file: expected `$MeshFormat` of gmsh or a keyword such as `*NODE` of Abaqus, found nothing"),
        (b"   \n\n", "found nothing"),
        (b"{\"model\": {}}", "found `{\\\"model\\\": {}}`"),
        (b"\xff\xfe\x00*", "found `\\xff\\xfe\\x00*`"),
        (b"*\xff\n", "line 1: expected a keyword line in UTF-8"),
        (b"$", "line 1: expected a section such as `$Nodes`, found `$`"),
        (b"*", "line 1: expected a keyword such as *NODE"),
        (b"*NODE", "there is no *NODE"),
        (b"***\n**\n", "there is no *NODE"),
    ] {
        let error = read(bytes).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}\nexpected: {expected}");
    }
    let long = format!("*NODE\n{}, 0\n", "x".repeat(100_000));
    let error = read(long.as_bytes()).unwrap_err().to_string();
    assert!(error.len() < 120, "{error}");
    let many = format!("*NODE{}\n1, 0\n", ", GENERATE".repeat(101));
    let error = read(many.as_bytes()).unwrap_err().to_string();
    assert_eq!(error, "line 1: expected at most 100 parameters, found more");
}
