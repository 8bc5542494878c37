//! What commands print and write, and how they end.

pub(crate) mod findings;
pub(crate) mod outcome;
pub(crate) mod path_file;
pub(crate) mod path_picture;
pub(crate) mod picture_file;
pub(crate) mod written;
