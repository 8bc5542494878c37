//! Broken and hostile files of gmsh, each with its clear error.

use crate::samples::{read, sample};

/// A triangle in version 2.2.
const TWO: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"body\"\n$EndPhysicalNames\n\
                   $Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n7 2 2 1 1 1 2 3\n$EndElements\n";
/// The same in version 4.1.
const FOUR: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 0 1 1 0\n$EndEntities\n\
                    $Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n$EndNodes\n\
                    $Elements\n1 1 7 7\n2 1 2 1\n7 1 2 3\n$EndElements\n";

/// What is replaced in a file, by what, and what the error has to say.
type Case = (&'static str, &'static str, &'static str);

fn refused(text: &str, cases: &[Case]) {
    read(text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    for (from, to, expected) in cases {
        assert!(text.contains(from), "{from}");
        let error = read(text.replacen(from, to, 1).as_bytes()).expect_err(to).to_string();
        assert!(error.contains(expected), "`{from}` as `{to}`: {error}\nexpected: {expected}");
    }
}

#[test]
fn files_of_version_two() {
    refused(
        TWO,
        &[
            ("$MeshFormat", "MeshFormat", "the file: expected `$MeshFormat` of gmsh"),
            ("$MeshFormat", "$Nodes", "line 1: expected `$MeshFormat` first, found `$Nodes`"),
            ("2.2 0 8", "1.0 0 8", "line 2: expected version 2.2 or 4.1"),
            ("2.2 0 8", "4.0 0 8", "found `4.0`"),
            ("2.2 0 8", "2.2 2 8", "line 2: expected 0 for text or 1 for binary, found 2"),
            ("2.2 0 8", "2.2 0", "line 3: expected the bytes of a number, found `$EndMeshFormat`"),
            ("2.2 0 8", "2.2 1 8", "expected the number 1 in four bytes"),
            ("$EndMeshFormat", "", "expected `$EndMeshFormat`"),
            ("\"body\"", "body", "line 6: expected a name in quotes, in UTF-8, found `body`"),
            ("2 1 \"body\"", "4 1 \"body\"", "line 6: the dimension of the group `body` is not 0 to 3"),
            ("$PhysicalNames\n1", "$PhysicalNames\n2", "line 7: expected the dimension of a physical group"),
            ("$PhysicalNames\n1", "$PhysicalNames\n-1", "line 5: expected the number of physical names, found `-1`"),
            ("$Nodes\n3", "$Nodes\n4", "line 13: expected the tag of a node, or as many nodes as announced"),
            ("$Nodes\n3", "$Nodes\n2", "line 12: expected `$EndNodes`, found `3`"),
            ("$Nodes\n3", "$Nodes\n1000000000000", "1000000000000 nodes are announced, which the rest of the file"),
            ("$Nodes\n3", "$Nodes\n99999999999999999999", "expected the number of nodes"),
            ("2 1 0 0", "2 1 0", "line 13: expected a coordinate, a finite number, found `$EndNodes`"),
            ("2 1 0 0", "2 NaN 0 0", "line 11: expected a coordinate, a finite number, found `NaN`"),
            ("2 1 0 0", "2 1 inf 0", "line 11: expected a coordinate, a finite number, found `inf`"),
            ("2 1 0 0", "2 1 0 1e400", "found `1e400`"),
            ("2 1 0 0", "2 1,5 0 0", "found `1,5`"),
            ("2 1 0 0", "-2 1 0 0", "expected the tag of a node"),
            ("2 1 0 0", "1 1 0 0", "node 1 is given twice"),
            ("$EndNodes", "$Elements", "expected `$EndNodes`, found `$Elements`"),
            ("$Elements\n1", "$Elements\n1000000000000", "elements are announced"),
            ("$Elements\n1", "$Elements\n2", "expected the tag of an element, or as many elements as announced"),
            ("7 2 2 1 1 1 2 3", "7 10 2 1 1 1 2 3", "line 16: quadrilaterals of 9 nodes (gmsh's type 10) are not read"),
            ("7 2 2 1 1 1 2 3", "7 12 2 1 1 1 2 3", "hexahedra of 27 nodes (gmsh's type 12) are not read: mesh with"),
            ("7 2 2 1 1 1 2 3", "7 6 2 1 1 1 2 3", "prisms (gmsh's type 6) are not read"),
            ("7 2 2 1 1 1 2 3", "7 7 2 1 1 1 2 3", "pyramids (gmsh's type 7) are not read"),
            ("7 2 2 1 1 1 2 3", "7 21 2 1 1 1 2 3", "elements of higher order"),
            ("7 2 2 1 1 1 2 3", "7 999 2 1 1 1 2 3", "elements of an unknown kind"),
            ("7 2 2 1 1 1 2 3", "7 2 2 1 1 1 2 4", "line 16: element 7 has node 4, which is not in `$Nodes`"),
            ("7 2 2 1 1 1 2 3", "7 2 2 1 1 1 2 2", "element 7 has node 2 twice; collapsed elements are not read"),
            ("7 2 2 1 1 1 2 3", "7 2 99999999 1 1 1 2 3", "at most 1000000 tags for a triangle3, found 99999999"),
            ("7 2 2 1 1 1 2 3", "7 2 2 1 1 1 2", "line 17: expected the tag of a node, found `$EndElements`"),
            ("7 2 2 1 1 1 2 3", "7 2 2 1 1 1 2 3 4", "line 16: expected `$EndElements`, found `4`"),
            ("$Elements\n1\n7 2 2 1 1 1 2 3", "$Elements\n0", "there is no element"),
            ("$EndElements", "", "expected `$EndElements`, found nothing"),
            ("$Elements\n1\n7 2 2 1 1 1 2 3\n$EndElements\n", "", "there is no section `$Elements`"),
            ("$Elements\n", "$NodeData\n1\n", "the section `$NodeData` has no end: expected `$EndNodeData`"),
            ("$EndElements\n", "$EndElements\nend\n", "line 18: expected a section such as `$Nodes`, found `end`"),
        ],
    );
    let name = format!("\"{}\"", "n".repeat(201));
    let error = read(TWO.replace("\"body\"", &name).as_bytes()).unwrap_err().to_string();
    assert_eq!(error, "line 6: a name of 201 bytes, at most 200");
    let nodes_last = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Elements\n1\n7 15 0 1\n$EndElements\n";
    let error = read(nodes_last.as_bytes()).unwrap_err().to_string();
    assert_eq!(error, "line 4: `$Nodes` has to stand before `$Elements`");
    let twice = TWO.replace("$Elements", "$Nodes\n0\n$EndNodes\n$Elements");
    assert!(read(twice.as_bytes()).unwrap_err().to_string().contains("`$Nodes` is there a second time"));
}

#[test]
fn files_of_version_four() {
    refused(
        FOUR,
        &[
            ("0 0 1 0", "0 0 1000000000000 0", "1000000000000 entities are announced"),
            ("0 0 1 0", "0 0 2 0", "expected the tag of an entity, found `$EndEntities`"),
            ("0 0 1 0", "0 0 0 0", "expected `$EndEntities`, found `1`"),
            ("1 0 0 0 1 1 0 1 1 0", "1 0 0 0 1 1 0 999999 1 0", "999999 physical groups are announced"),
            ("1 0 0 0 1 1 0 1 1 0", "1 0 0 0 1 1 inf 1 1 0", "expected a bound of an entity, a finite number"),
            ("1 3 1 3\n2 1 0 3", "1 4 1 4\n2 1 0 3", "4 nodes are announced, and the blocks have 3"),
            ("1 3 1 3", "1 1000000000000 1 3", "1000000000000 nodes are announced, which the rest of the file"),
            ("1 3 1 3", "1000000000000 3 1 3", "1000000000000 blocks are announced"),
            ("1 3 1 3", "2 3 1 3", "expected the dimension of an entity, found `$EndNodes`"),
            ("2 1 0 3\n1", "2 1 0 1000000000000\n1", "1000000000000 nodes are announced"),
            ("2 1 0 3\n1", "4 1 0 3\n1", "expected a dimension of an entity from 0 to 3, found 4"),
            (
                "2 1 0 3\n1",
                "2 1 1 3\n1",
                "line 17: expected a parametric coordinate, a finite number, found `$EndNodes`",
            ),
            ("\n1\n2\n3\n", "\n1\n2\n2\n", "node 2 is given twice"),
            ("\n1\n2\n3\n", "\n1\n-2\n3\n", "line 12: expected the tag of a node, found `-2`"),
            ("1 1 7 7", "1 2 7 7", "2 elements are announced, and the blocks have 1"),
            ("1 1 7 7", "1 1000000000000 7 7", "1000000000000 elements are announced"),
            ("2 1 2 1\n7", "2 1 2 1000000000000\n7", "1000000000000 elements are announced"),
            ("2 1 2 1\n7", "2 5 2 1\n7", "dimension 2, tag 5: `$Entities` does not have the elements' entity"),
            ("2 1 2 1\n7", "2 1 10 1\n7", "quadrilaterals of 9 nodes"),
            (
                "7 1 2 3",
                "7 1 2 9223372036854775808",
                "element 7 has node 9223372036854775808, which is not in `$Nodes`",
            ),
            ("7 1 2 3", "7 1 2 x", "expected the tag of a node, found `x`"),
        ],
    );
    let late = format!("{FOUR}$Entities\n0 0 0 0\n$EndEntities\n");
    assert!(read(late.as_bytes()).unwrap_err().to_string().contains("entities have to stand before `$Elements`"));
}

/// A file, a text in it, which byte after that is changed, to what, and what the error has to say.
type BinaryCase<'a> = (&'a [u8], &'a [u8], usize, &'a [u8], &'a str);

#[test]
fn binary_files() {
    let [two, four] = ["cube_22_little.msh", "cube_41_little.msh"].map(sample);
    let after = |bytes: &[u8], text: &[u8]| {
        bytes.windows(text.len()).position(|window| window == text).expect("the text") + text.len()
    };
    let cases: [BinaryCase; 12] = [
        (&two, b"$MeshFormat\n2.2 1 8\n", 0, &[2, 0, 0, 0], "expected the number 1 in four bytes on the next line"),
        (&two, b"$MeshFormat\n2.2 1 ", 0, b"4", "expected 8 bytes for a number, found 4"),
        (&two, b"$Nodes\n", 0, b"9", "byte "),
        (&two, b"$Nodes\n8\n", 4, &f64::NAN.to_le_bytes(), "a coordinate, a finite number, found NaN"),
        (&two, b"$Nodes\n8\n", 0, &(-1_i32).to_le_bytes(), "the tag of a node, or as many nodes as announced"),
        (&two, b"$Elements\n2\n", 0, &12_i32.to_le_bytes(), "hexahedra of 27 nodes"),
        (&two, b"$Elements\n2\n", 4, &3_i32.to_le_bytes(), "expected a block of 1 to 2 elements, found 3"),
        (&two, b"$Elements\n2\n", 4, &0_i32.to_le_bytes(), "expected a block of 1 to 2 elements, found 0"),
        (&four, b"$Entities\n", 16, &(1_u64 << 40).to_le_bytes(), "1099511627776 entities are announced"),
        (&four, b"$Nodes\n", 8, &1_000_000_000_000_u64.to_le_bytes(), "1000000000000 nodes are announced"),
        (&four, b"$Nodes\n", 44, &u64::MAX.to_le_bytes(), "18446744073709551615 nodes are announced"),
        (&four, b"$Elements\n", 60, &u64::MAX.to_le_bytes(), "has node 18446744073709551615, which is not in `$Nodes`"),
    ];
    for (file, text, offset, bytes, expected) in cases {
        let mut changed = file.to_vec();
        let at = after(file, text) + offset;
        changed[at..at + bytes.len()].copy_from_slice(bytes);
        let error = read(&changed).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}\nexpected: {expected}");
    }
}

#[test]
fn a_promise_of_a_terabyte_takes_no_memory() {
    let two = TWO.replace("$Nodes\n3", "$Nodes\n1000000000000");
    let four = FOUR.replace("1 3 1 3", "1 1000000000000 1 3");
    for text in [two, four] {
        let used = allocation_counter::measure(|| assert!(read(text.as_bytes()).is_err()));
        assert!(used.bytes_max < 10_000, "{}", used.bytes_max);
    }
}

#[test]
fn groups_that_multiply_are_bounded() {
    // Each of 2000 blocks is in each of 2000 groups.
    let groups: String = (1..=2000).map(|tag| format!("{tag} ")).collect();
    let blocks: String = (1..=2000).map(|label| format!("2 1 2 1\n{label} 1 2 3\n0 9 15 0\n")).collect();
    let text = FOUR
        .replace("0 0 1 0\n1 0 0 0 1 1 0 1 1 0", &format!("1 0 1 0\n9 0 0 0 0\n1 0 0 0 1 1 0 2000 {groups} 0"))
        .replace("1 1 7 7\n2 1 2 1\n7 1 2 3\n", &format!("4000 2000 1 2000\n{blocks}"));
    let error = read(text.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("the sets have too many members"), "{error}");
}
