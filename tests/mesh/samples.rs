//! The sample files.

use arcslip::model::mesh::MeshFormat;
use arcslip::model::mesh::data::error::MeshError;
use arcslip::model::mesh::data::mesh_data::MeshData;
use std::path::{Path, PathBuf};

pub fn folder() -> PathBuf {
    // The folder of this file, wherever the program runs.
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mesh")
}

/// Names and contents of all sample files, by name.
pub fn all() -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(folder().join("samples")).expect("a folder of samples");
    let mut files: Vec<(String, Vec<u8>)> = entries
        .map(|entry| {
            let path = entry.expect("a sample").path();
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            (name, std::fs::read(path).expect("a sample to read"))
        })
        .collect();
    files.sort();
    assert!(files.len() >= 60, "{} samples", files.len());
    files
}

pub fn sample(name: &str) -> Vec<u8> {
    std::fs::read(folder().join("samples").join(name)).expect("a sample to read")
}

pub fn read(bytes: &[u8]) -> Result<MeshData, MeshError> {
    MeshFormat::of(bytes)?.read(bytes)
}

pub fn mesh(name: &str) -> MeshData {
    read(&sample(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

pub fn point(mesh: &MeshData, node: u32) -> [f64; 3] {
    mesh.coordinates[node as usize]
}

pub fn mean(points: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64)
}

pub fn near(one: &[f64], other: &[f64], tolerance: f64) -> bool {
    one.len() == other.len() && one.iter().zip(other).all(|(one, other)| (one - other).abs() <= tolerance)
}
