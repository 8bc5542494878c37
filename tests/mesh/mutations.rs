//! Files that are cut, changed and shuffled: whatever the bytes, reading ends without a panic and within memory.

use crate::samples::{all, read};
use arcslip::model::mesh::convert::ConvertedModel;
use arcslip::model::mesh::data::mesh_data::MeshData;

/// Bytes of memory for each byte of a file, and for any file.
const MEMORY: (u64, u64) = (400, 8_000_000);

/// Numbers without a pattern, the same in every run (Marsaglia 2003, xorshift).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 % bound.max(1) as u64).expect("a small number")
    }
}

/// Reads a file, converts it if that succeeds, and holds the mesh to what it promises.
fn survives(name: &str, bytes: &[u8]) -> bool {
    let mut outcome = None;
    let used = allocation_counter::measure(|| outcome = Some(read(bytes)));
    let bound = MEMORY.0 * bytes.len() as u64 + MEMORY.1;
    assert!(used.bytes_max < bound, "{name}: {} bytes of memory for {}", used.bytes_max, bytes.len());
    let Some(Ok(mesh)) = outcome else { return false };
    check(name, &mesh);
    if let Ok(model) = ConvertedModel::new(&mesh, None) {
        let json = model.json().expect("JSON");
        let value: serde_json::Value = serde_json::from_str(&json).expect("valid JSON");
        assert!(value["model"]["nodes"].is_object());
        assert!(!model.summary().is_empty());
    }
    true
}

fn check(name: &str, mesh: &MeshData) {
    let nodes = mesh.node_labels.len();
    assert_eq!(mesh.coordinates.len(), nodes, "{name}");
    assert!(mesh.coordinates.iter().flatten().all(|coordinate| coordinate.is_finite()), "{name}");
    let elements = &mesh.elements;
    assert_eq!([elements.labels.len(), elements.nodes.len(), elements.sections.len()], [elements.len(); 3], "{name}");
    for (shape, list) in elements.shapes.iter().zip(elements.nodes.iter()) {
        assert_eq!(list.len(), shape.nodes(), "{name}");
        assert!(list.iter().all(|node| (*node as usize) < nodes), "{name}");
    }
    let ascends = |set: &Vec<u32>, count: usize| {
        set.windows(2).all(|pair| pair[0] < pair[1]) && set.last().is_none_or(|last| (*last as usize) < count)
    };
    assert!(mesh.node_sets.values().all(|set| ascends(set, nodes)), "{name}");
    assert!(mesh.element_sets.values().all(|set| ascends(set, elements.len())), "{name}");
    assert!(mesh.surfaces.values().flat_map(|surface| surface.iter()).flatten().all(|node| (*node as usize) < nodes));
}

#[test]
fn files_that_are_cut_are_refused() {
    for (name, bytes) in all() {
        let whole = bytes.trim_ascii_end().len();
        for end in (0..whole).step_by(1 + whole / 700) {
            let is_read = survives(&name, &bytes[..end]);
            // A deck has no end of its own, and what follows the elements may be missing.
            assert!(
                !is_read || name.ends_with(".inp") || name.starts_with("periodic"),
                "{name} is read up to byte {end}"
            );
        }
    }
}

#[test]
fn changed_bytes_do_no_harm() {
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    for (name, bytes) in all() {
        assert!(survives(&name, &bytes), "{name}");
        for _ in 0..300 {
            let mut changed = bytes.clone();
            for _ in 0..=numbers.below(4) {
                let at = numbers.below(changed.len());
                changed[at] = u8::try_from(numbers.below(256)).expect("a byte");
            }
            survives(&name, &changed);
        }
    }
}

#[test]
fn lines_that_are_gone_doubled_or_exchanged_do_no_harm() {
    let mut numbers = Numbers(0x2545_f491_4f6c_dd1d);
    for (name, bytes) in all() {
        let lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
        for line in (0..lines.len()).step_by(1 + lines.len() / 100) {
            let gone = [&lines[..line], &lines[line + 1..]].concat().concat();
            let doubled = [&lines[..=line], &lines[line..]].concat().concat();
            let mut exchanged = lines.clone();
            exchanged.swap(line, numbers.below(lines.len()));
            for changed in [gone, doubled, exchanged.concat()] {
                survives(&name, &changed);
            }
        }
    }
}

#[test]
fn huge_and_strange_numbers_do_no_harm() {
    const STRANGE: [&str; 12] = [
        "18446744073709551615",
        "9223372036854775808",
        "4294967295",
        "99999999999999999999999",
        "-1",
        "-9223372036854775808",
        "0",
        "1e999",
        "NaN",
        "inf",
        "1000000000000",
        "1e308",
    ];
    let mut numbers = Numbers(0x1234_5678_9abc_def1);
    for (name, bytes) in all().into_iter().filter(|(name, _)| !name.contains("binary") && !name.starts_with("cube")) {
        let text = String::from_utf8(bytes).expect("text");
        let is_separator = |letter: char| letter.is_whitespace() || letter == ',';
        let words: Vec<&str> = text.split_inclusive(is_separator).collect();
        for word in (0..words.len()).step_by(1 + words.len() / 200) {
            let end = words[word].trim_start_matches(|letter| !is_separator(letter));
            let strange = format!("{}{end}", STRANGE[numbers.below(STRANGE.len())]);
            let changed = [&words[..word], &[strange.as_str()], &words[word + 1..]].concat().concat();
            survives(&name, changed.as_bytes());
        }
    }
}

#[test]
fn numbers_of_binary_files_that_are_huge_do_no_harm() {
    for (name, bytes) in all().into_iter().filter(|(name, _)| name.contains("binary") || name.starts_with("cube")) {
        for at in (0..bytes.len().saturating_sub(8)).step_by(1 + bytes.len() / 400) {
            for value in [u64::MAX, 1 << 63, 1 << 40, 0x7fff_ffff_7fff_ffff] {
                let mut changed = bytes.clone();
                changed[at..at + 8].copy_from_slice(&value.to_le_bytes());
                survives(&name, &changed);
            }
        }
    }
}
