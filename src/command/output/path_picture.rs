//! The picture of a path that a command draws.

use crate::command::output::outcome::Failure;
use crate::command::output::picture_file::PictureFile;
use crate::model::{JobRequest, Model};
use crate::result::increment::Increment;
use crate::studies::picture::path::{Against, svg};

/// A picture that is drawn when the path has ended, as the largest displacement is only known then.
pub struct PathPicture<'a> {
    file: PictureFile<'a>,
    against: Option<Against>,
    increments: Vec<Increment>,
}

impl<'a> PathPicture<'a> {
    /// # Errors
    /// Increments do not record what is to be drawn.
    pub fn planned(
        file: Option<PictureFile<'a>>,
        against: Option<&str>,
        request: &JobRequest,
    ) -> Result<Option<Self>, Failure> {
        let Some(file) = file else { return Ok(None) };
        let against = against.map(|text| Against::read(text, request)).transpose();
        let against = against.map_err(|error| Failure::Input(vec![format!("--against {error}")]))?;
        let recorded = request.analysis.record.as_ref().and_then(|record| record.nodes.as_ref());
        let is_recorded = |nodes: &Vec<String>| match &against {
            None => !nodes.is_empty(),
            Some(against) => against.node().is_none_or(|node| nodes.iter().any(|name| name == node)),
        };
        if !recorded.is_none_or(is_recorded) {
            let what = "/analysis/record/nodes: the displacement to be drawn is not recorded; add its node";
            return Err(Failure::Input(vec![what.to_owned()]));
        }
        Ok(Some(Self { file, against, increments: Vec::new() }))
    }

    pub fn push(&mut self, increment: Increment) {
        self.increments.push(increment);
    }

    /// # Errors
    /// There is nothing to draw, or the file cannot be written.
    pub fn write(self, model: &Model) -> Result<(), Failure> {
        let svg = svg(model, &self.increments, self.against).map_err(Failure::other)?;
        self.file.write(&svg)
    }
}
