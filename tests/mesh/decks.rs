//! Decks: sets, surfaces, materials, sections, parts, and what is not read.

use crate::samples::{mesh, near, read, sample};
use arcslip::model::mesh::data::mesh_data::{DeckLaw, MeshData, PlaneState};

/// Two squares side by side, with most of what is read.
const SQUARES: &str = "\
*Heading
 two squares, in any bytes \u{e9}
** a comment
*NODE, NSET=Nall
1, 0., 0.
2, 1.0D0, 0
3, 2e0, 0, 0.
 4, 0, 1
5, 1, 1,
6, 2, 1

*Element , type = cps4r,
 elset=Left
10, 1, 2,
 5, 4
*ELEMENT,TYPE=CPS4,ELSET=right
20,2,3,6,5
*ELEMENT, TYPE=T2D2, ELSET=bars
30, 1, 4
*NSET, NSET=bottom, GENERATE
1, 3
*NSET, NSET=ends, GENERATE
1, 3, 2
*nset, nset=most
BOTTOM, 4
*ELSET, ELSET=both
left, RIGHT
*ELSET, ELSET=withbars
10, 30,
*SURFACE, NAME=underside, TYPE=ELEMENT
both, S1
20, s2
*SURFACE, NAME=tips, TYPE=NODE
ends
4,
*MATERIAL, NAME=Steel
*ELASTIC
210e3, 0.3
200e3, 0.3, 100.
*DENSITY
7.8e-9,
*MATERIAL, NAME=\"soft rubber\"
*HYPERELASTIC, NEO HOOKE
0.5, 0.1
*SOLID SECTION, ELSET=LEFT, MATERIAL=steel
2.5,
*SOLID SECTION, ELSET=right, MATERIAL=soft rubber
*BOUNDARY
bottom, 1, 2
*STEP
*STATIC
*CLOAD
4, 1, 5.
*END STEP
";

fn deck(text: &str) -> MeshData {
    read(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn sets_of_labels_ranges_and_sets() {
    let mesh = deck(SQUARES);
    assert_eq!(mesh.node_labels, [1, 2, 3, 4, 5, 6]);
    assert_eq!(mesh.coordinates[2], [2.0, 0.0, 0.0]);
    assert_eq!(mesh.elements.labels, [10, 20]);
    assert_eq!(mesh.elements.nodes.iter().collect::<Vec<_>>(), [[0, 1, 4, 3], [1, 2, 5, 4]]);
    assert_eq!(mesh.elements.plane_states, [Some(PlaneState::Stress); 2]);
    let sets: Vec<(&str, &[u32])> = mesh.node_sets.iter().map(|(name, set)| (name.as_str(), set.as_slice())).collect();
    assert_eq!(
        sets,
        [
            ("Nall", &[0, 1, 2, 3, 4, 5][..]),
            ("bottom", &[0, 1, 2]),
            ("ends", &[0, 2]),
            ("most", &[0, 1, 2, 3]),
            ("tips", &[0, 2, 3]),
        ]
    );
    let sets: Vec<(&str, &[u32])> =
        mesh.element_sets.iter().map(|(name, set)| (name.as_str(), set.as_slice())).collect();
    assert_eq!(sets, [("Left", &[0][..]), ("right", &[1]), ("both", &[0, 1]), ("withbars", &[0])]);
    let faces: Vec<&[u32]> = mesh.surfaces["underside"].iter().collect();
    assert_eq!(faces, [[0, 1], [1, 2], [2, 5]]);
}

#[test]
fn ends_of_lines_and_marks_of_editors_change_nothing() {
    let plain = deck(SQUARES);
    let windows = read(&[b"\xef\xbb\xbf", SQUARES.replace('\n', "\r\n").as_bytes()].concat()).expect("a mesh");
    assert_eq!((&plain.coordinates, &plain.node_sets), (&windows.coordinates, &windows.node_sets));
    assert_eq!((&plain.elements.nodes, &plain.element_sets), (&windows.elements.nodes, &windows.element_sets));
    for name in ["triangle6_41_text.msh", "hexahedron20_22_text.msh"] {
        let text = String::from_utf8(sample(name)).expect("text").replace('\n', "\r\n");
        assert_eq!(read(text.as_bytes()).expect("a mesh").node_sets, mesh(name).node_sets);
    }
}

#[test]
fn materials_and_sections() {
    let mesh = deck(SQUARES);
    let steel = mesh.materials["Steel"];
    assert_eq!(steel.law, Some(DeckLaw::LinearElastic { young: 210e3, poisson: 0.3 }));
    assert_eq!(steel.density, Some(7.8e-9));
    // Shear modulus 1, bulk modulus 20: E = 9 K G / (3 K + G), ν = (3 K - 2 G) / (6 K + 2 G).
    let Some(DeckLaw::NeoHookean { young, poisson }) = mesh.materials["soft rubber"].law else { panic!("another law") };
    assert!(near(&[young, poisson], &[180.0 / 61.0, 58.0 / 122.0], 1e-14));
    assert_eq!(mesh.elements.sections, [Some(0), Some(1)]);
    assert_eq!((mesh.sections[0].material.as_str(), mesh.sections[0].thickness), ("steel", Some(2.5)));
    assert_eq!((mesh.sections[1].material.as_str(), mesh.sections[1].thickness), ("soft rubber", None));
    let mooney = "*MATERIAL,NAME=m\n*HYPERELASTIC,MOONEY-RIVLIN\n1,0.5,0.25\n";
    let law = deck(&format!("{SQUARES}{mooney}")).materials["m"].law;
    assert_eq!(law, Some(DeckLaw::MooneyRivlin { c10: 1.0, c01: 0.5, bulk_modulus: 8.0 }));
}

#[test]
fn what_is_not_read_is_listed_with_its_line() {
    let lines = deck(SQUARES).unread.lines();
    assert_eq!(
        lines,
        [
            "line 12: not read: the ending R of cps4r, which is read as cps4",
            "line 18: not read: *ELEMENT, TYPE=T2D2",
            "line 38: not read: lines of *ELASTIC after the first, for other temperatures",
            "line 48: not read: *BOUNDARY",
            "line 50: not read: *STEP with all that it holds",
        ]
    );
    let many: String = (0..300).map(|number| format!("*KEYWORD {number}\n*SAME\n")).collect();
    let lines = deck(&format!("{SQUARES}{many}")).unread.lines();
    assert_eq!(lines.len(), 101);
    assert_eq!(lines[6], "line 56: not read: *SAME (300 times)");
    assert_eq!(lines[100], "206 more parts are not read and not listed");
}

/// A unit cube at the origin, of one element, with sets as the graphical program writes them.
fn assembly(instance: &str) -> String {
    format!(
        "*PART, NAME=Block\n*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
         *ELEMENT, TYPE=C3D8\n1, 1,2,3,4,5,6,7,8\n*NSET, NSET=Set-1\n1,2\n*ELSET, ELSET=all\n1,\n\
         *SOLID SECTION, ELSET=all, MATERIAL=m\n,\n*END PART\n\
         *ASSEMBLY, NAME=A\n*INSTANCE, NAME=Block-1, PART=Block\n{instance}*END INSTANCE\n\
         *NODE\n1, 5, 5, 5\n*NSET, NSET=reference\n1,\n*NSET, NSET=Set-1, INSTANCE=Block-1\n7,8\n\
         *ELSET, ELSET=_top_S2, INTERNAL, INSTANCE=Block-1\n1,\n\
         *SURFACE, TYPE=ELEMENT, NAME=top\n_top_S2, S2\n*SURFACE, TYPE=ELEMENT, NAME=side\nBlock-1.all, S4\n\
         *END ASSEMBLY\n"
    )
}

#[test]
fn one_part_in_its_own_place() {
    for instance in ["", "0., 0., 0.\n", "0,0,0\n1,2,3,4,5,6,0.\n"] {
        let mesh = deck(&assembly(instance));
        assert_eq!((mesh.node_labels.len(), mesh.elements.len()), (8, 1));
        assert_eq!(mesh.node_sets.keys().collect::<Vec<_>>(), ["Set-1", "assembly.Set-1"]);
        assert_eq!(mesh.node_sets["assembly.Set-1"], [6, 7]);
        assert_eq!(mesh.element_sets.keys().collect::<Vec<_>>(), ["all"]);
        assert_eq!(mesh.surfaces["top"].get(0), [4, 5, 6, 7]);
        assert_eq!(mesh.surfaces["side"].get(0), [1, 2, 6, 5]);
        let lines = mesh.unread.lines().join("\n");
        assert!(lines.contains("*NODE of the assembly") && lines.contains("`reference`"), "{lines}");
    }
}

#[test]
fn faces_have_the_numbers_of_abaqus() {
    // Corners of the faces S1, S2, ... by the node numbers of the manual, sections "Two-dimensional" and
    // "Three-dimensional solid element library".
    let faces: [(&str, usize, &[&[u32]]); 4] = [
        ("CPE3", 3, &[&[1, 2], &[2, 3], &[1, 3]]),
        ("CAX4", 4, &[&[1, 2], &[2, 3], &[3, 4], &[1, 4]]),
        ("C3D4", 4, &[&[1, 2, 3], &[1, 2, 4], &[2, 3, 4], &[1, 3, 4]]),
        ("C3D8", 8, &[&[1, 2, 3, 4], &[5, 6, 7, 8], &[1, 2, 5, 6], &[2, 3, 6, 7], &[3, 4, 7, 8], &[1, 4, 5, 8]]),
    ];
    let tetrahedron = "1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n";
    let cube = "1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n";
    for (kind, nodes, faces) in faces {
        let points = if kind == "C3D4" { tetrahedron } else { cube };
        let list: Vec<String> = (1..=nodes).map(|node| node.to_string()).collect();
        for (number, corners) in (1..).zip(faces) {
            let text =
                format!("*NODE\n{points}*ELEMENT,TYPE={kind}\n1,{}\n*SURFACE,NAME=s\n1,S{number}\n", list.join(","));
            let mut found: Vec<u32> = deck(&text).surfaces["s"].get(0).iter().map(|node| node + 1).collect();
            found.sort_unstable();
            assert_eq!(found, *corners, "{kind} S{number}");
        }
    }
}

#[test]
fn plane_elements_in_space_are_faces() {
    let mesh = mesh("hexahedron8.inp");
    assert_eq!(mesh.dimension(), 3);
    assert_eq!(mesh.surfaces.keys().collect::<Vec<_>>(), ["Surface1", "Surface26", "bottom", "top"]);
    assert_eq!(mesh.surfaces["bottom"].len(), 2);
    assert!(mesh.remarks[0].starts_with("4 plane elements beside solids"));
}

#[test]
fn clockwise_elements_keep_their_faces() {
    let text = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n*ELEMENT,TYPE=CPE4\n1, 1,4,3,2\n*SURFACE,NAME=left\n1,S1\n";
    let mesh = deck(text);
    assert_eq!(mesh.elements.nodes.get(0), [0, 1, 2, 3]);
    // S1 has the nodes 1 and 4; with the element to its left it leads from 4 to 1.
    assert_eq!(mesh.surfaces["left"].get(0), [3, 0]);
}

#[test]
fn sets_that_multiply_are_bounded() {
    let labels: String = (1..=2000).map(|label| format!("{label},0,0\n")).collect();
    let start = format!("*NODE,NSET=n\n{labels}*NODE\n2001,1,0\n2002,0,1\n");
    let start = format!("{start}*ELEMENT,TYPE=CPS3\n1,1,2001,2002\n");
    let doubled: String = (0..600).map(|number| format!("*NSET,NSET=s{number}\nn,n\n")).collect();
    let error = read(format!("{start}{doubled}").as_bytes()).unwrap_err().to_string();
    assert!(error.contains("the sets have too many members"), "{error}");
    let wide = format!("{start}*NSET,NSET=w,GENERATE\n1,18446744073709551615,1\n");
    assert_eq!(deck(&wide).node_sets["w"].len(), 2002);
}
