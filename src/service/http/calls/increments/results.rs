//! The path in the formats of other programs: VTK for ParaView, and Parquet.

use crate::output::parquet::{PathTable, Sheet};
use crate::output::vtk::{Collection, Grid};
use crate::result::increment::Increment;
use crate::service::http::answer::problem::{Kind, Problem};
use crate::service::http::answer::tag::Tag;
use crate::service::http::calls::increments::archive::Archive;
use crate::service::http::calls::increments::stored::{Stored, StoredPath};
use crate::service::http::document;
use crate::service::http::tasks::target::Target;
use crate::service::http::view::job::Job;
use async_stream::try_stream;
use axum::body::Body;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use std::io::{self, Write};
use std::sync::Arc;
use tokio_stream::Stream;
use zip::CompressionMethod;

/// Most files of one archive, as its list of them is kept until its end.
const MOST_FILES: u64 = 100_000;

/// The increments stored so far for ParaView, as a zip file.
///
/// `path.pvd` lists a file `path/000012.vtu` for every increment, by arc length. Each has the nodes as points, with
/// `displacement`, `support_reaction`, `contact_status` (0 free, 1 slip, 2 stick, 255 none), `gap` and `contact_reaction`; the
/// elements as cells, with `element`, `axial_force` and `spring_force`; and load factor, arc length, energies, stage, point,
/// event and branch as field data. Values that are not recorded are not-a-number.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results.pvd", tag = document::INCREMENTS, operation_id = "get_results_pvd",
    responses((status = 200, description = "A zip file.", body = Vec<u8>, content_type = "application/zip"))
)]
pub async fn pvd(target: Target<Job>) -> Result<Response, Problem> {
    let record = target.find().await?;
    if record.last_index.is_some_and(|last| last >= MOST_FILES) {
        let detail = format!(
            "the path has more than {MOST_FILES} increments, too many files for one archive; `results.parquet` has them all"
        );
        return Err(Problem::new(Kind::AnswerTooLarge, detail));
    }
    let branch = record.parent.as_ref().map_or_else(String::new, |parent| {
        format!("direction {} at increment {} of job {}", parent.direction, parent.increment, parent.job)
    });
    answer(target, "pvd", record.status.is_ended(), record.last_index, |path| vtk_files(path, branch))
}

/// The increments stored so far as Apache Parquet: a zip file with `increments.parquet`, `nodes.parquet`,
/// `elements.parquet` and `contacts.parquet`, whose rows have the `index` of their increment.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/results.parquet", tag = document::INCREMENTS, operation_id = "get_results_parquet",
    responses((status = 200, description = "A zip file.", body = Vec<u8>, content_type = "application/zip"))
)]
pub async fn parquet(target: Target<Job>) -> Result<Response, Problem> {
    let job = target.standing().await?;
    answer(target, "parquet", job.status.is_ended(), job.last_index, parquet_files)
}

/// The archive as an answer, with an entity tag once the job has ended.
fn answer<Bytes: Stream<Item = io::Result<Vec<u8>>> + Send + 'static>(
    target: Target<Job>,
    extension: &str,
    is_ended: bool,
    last_index: Option<u64>,
    files: impl FnOnce(StoredPath) -> Bytes,
) -> Result<Response, Problem> {
    let Target { service, id, headers, .. } = target;
    let own = [
        (header::CONTENT_TYPE, "application/zip".to_owned()),
        (header::CONTENT_DISPOSITION, format!("attachment; filename=\"path-{id}-{extension}.zip\"")),
    ];
    let make = || Ok((own, Body::from_stream(files(StoredPath::new(service, id)))).into_response());
    if !is_ended {
        return make();
    }
    Tag::of(format!("{extension} {id} {last_index:?}").as_bytes()).answer(&headers, make)
}

/// The archive of VTK's files while it is made.
struct VtkFiles {
    archive: Archive,
    collection: Collection,
    list: String,
}

impl VtkFiles {
    fn push(&mut self, grid: &Grid, increment: &Increment) -> io::Result<()> {
        if increment.index >= MOST_FILES {
            return Err(io::Error::other("the path has grown beyond the files of one archive"));
        }
        let name = format!("path/{:06}.vtu", increment.index);
        self.archive.begin(&name, CompressionMethod::Deflated)?;
        grid.write(increment, &mut self.archive)?;
        self.list.push_str(&self.collection.entry(increment.arc_length, &name));
        Ok(())
    }

    fn finish(mut self) -> io::Result<Vec<u8>> {
        self.archive.begin("path.pvd", CompressionMethod::Deflated)?;
        write!(self.archive, "{}{}{}", Collection::HEAD, self.list, Collection::TAIL)?;
        self.archive.finish()
    }
}

fn vtk_files(mut path: StoredPath, branch: String) -> impl Stream<Item = io::Result<Vec<u8>>> {
    try_stream! {
        let grid = Arc::new(path.of_request(move |request| Grid::of(request, branch)).await?);
        let (archive, collection, list) = (Archive::default(), Collection::default(), String::new());
        let mut files = VtkFiles { archive, collection, list };
        while let Some(page) = path.next_page().await? {
            let grid = Arc::clone(&grid);
            let push = move |files: &mut VtkFiles, stored: Stored| files.push(&grid, &stored.increment);
            files = path.each(page, files, push).await?;
            yield files.archive.take();
        }
        yield files.finish()?;
    }
}

/// The tables one after the other; each reads the path anew, so that memory holds one group of rows.
fn parquet_files(mut path: StoredPath) -> impl Stream<Item = io::Result<Vec<u8>>> {
    try_stream! {
        let (dimension, units) = path.of_request(|request| (request.model.dimension, request.model.units.clone())).await?;
        let mut archive = Archive::default();
        let made = archive.made();
        for table in PathTable::ALL {
            // Parquet compresses its columns itself.
            archive.begin(&format!("{}.parquet", table.name()), CompressionMethod::Stored)?;
            let mut sheet = table.sheet(archive, dimension, units.as_ref()).map_err(io::Error::other)?;
            path.rewind();
            while let Some(page) = path.next_page().await? {
                let push = move |sheet: &mut Sheet<Archive>, Stored { increment, measure }: Stored| {
                    table.push(sheet, dimension, &increment, measure.as_ref()).map_err(io::Error::other)
                };
                sheet = path.each(page, sheet, push).await?;
                yield made.take();
            }
            archive = sheet.finish().map_err(io::Error::other)?;
        }
        yield archive.finish()?;
    }
}
