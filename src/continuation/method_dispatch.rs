//! Path tracing by the method that the analysis names.

use crate::continuation::path::iterator::Path;
use crate::continuation::penalty::RegularisedPath;
use crate::continuation::scene::Scene;
use crate::model::request::Method;
use crate::resources::cancel::CancelFlag;
use crate::result::increment::Increment;
use crate::result::report::Report;

/// A path being traced, by either of two methods; an iterator of increments like the paths it contains.
pub enum TracedPath<'a> {
    /// `auto` and `mpec`.
    Exact(Box<Path<'a>>),
    /// `regularised`.
    Regularised(Box<RegularisedPath<'a>>),
}

impl<'a> TracedPath<'a> {
    pub fn new(scene: &'a Scene, cancel: CancelFlag) -> Self {
        match scene.analysis.method {
            Method::Auto | Method::Mpec => Self::Exact(Box::new(Path::new(scene, cancel))),
            Method::Regularised => Self::Regularised(Box::new(RegularisedPath::new(scene, cancel))),
        }
    }

    /// Present when the path has ended, that is when `next` has returned `None`.
    pub fn report(&self) -> Option<Report> {
        match self {
            Self::Exact(path) => path.report(),
            Self::Regularised(path) => path.report(),
        }
    }
}

impl Iterator for TracedPath<'_> {
    type Item = Increment;

    fn next(&mut self) -> Option<Increment> {
        match self {
            Self::Exact(path) => path.next(),
            Self::Regularised(path) => path.next(),
        }
    }
}
