//! `arcslip convert`: prints the model of a mesh file.

use crate::command::output::outcome::{Failure, Outcome};
use crate::command::output::written::{folders_exist, is_standard_output, write};
use crate::model::mesh::MeshFormat;
use crate::model::mesh::convert::ConvertedModel;
use crate::model::mesh::data::mesh_data::PlaneState;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Print the model of a mesh: a file of gmsh (2.2 or 4.1, text or binary) or a deck of Abaqus.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// A mesh file, or `-` for standard input. Its first letter says its format.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Write the model here; `-` is standard output.
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
    /// What holds in the third direction of plane elements, where the file does not tell it.
    #[arg(long, value_enum)]
    plane: Option<Plane>,
}

/// What holds in the third direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Plane {
    /// No strain.
    Strain,
    /// No stress.
    Stress,
    /// A body of revolution about the axis y.
    Axisymmetric,
}

impl Plane {
    fn state(self) -> PlaneState {
        match self {
            Self::Strain => PlaneState::Strain,
            Self::Stress => PlaneState::Stress,
            Self::Axisymmetric => PlaneState::Axisymmetric,
        }
    }
}

pub fn run(arguments: &Arguments) -> Outcome {
    folders_exist(&[("--out", Some(arguments.out.as_path()))])?;
    let at_fault =
        |error: &dyn std::fmt::Display| Failure::Input(vec![format!("{}: {error}", arguments.file.display())]);
    let bytes = bytes(&arguments.file).map_err(|error| at_fault(&error))?;
    let format = MeshFormat::of(&bytes).map_err(|error| at_fault(&error))?;
    let mesh = format.read(&bytes).map_err(|error| at_fault(&error))?;
    drop(bytes);
    let model = ConvertedModel::new(&mesh, arguments.plane.map(Plane::state)).map_err(|error| at_fault(&error))?;
    write(&arguments.out, &model.json().map_err(Failure::other)?)?;
    eprintln!("read as {}", format.name());
    model.summary().iter().for_each(|line| eprintln!("{line}"));
    Ok(ExitCode::SUCCESS)
}

/// The contents of a file or of standard input.
fn bytes(file: &Path) -> std::io::Result<Vec<u8>> {
    if !is_standard_output(file) {
        return std::fs::read(file);
    }
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes)?;
    Ok(bytes)
}
