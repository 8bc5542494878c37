//! The migrations of a database, compiled into the program.
//!
//! `sqlx::migrate!` does the same, but builds both database drivers a second time, for the compiler.

use sqlx::SqlSafeStr;
use sqlx::migrate::{Migration, MigrationType, Migrator};

/// A file of `migrations` without its ending, and its text.
pub struct MigrationFile {
    pub name: &'static str,
    pub text: &'static str,
}

/// The files of a folder of `migrations`, all of them, in order.
macro_rules! migration_files {
    ($folder:literal: $($name:literal),* $(,)?) => {
        &[$($crate::service::store::sql::migrations::MigrationFile {
            name: $name,
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/migrations/", $folder, "/", $name, ".sql")),
        }),*]
    };
}
pub(in crate::service::store) use migration_files;

/// The migrations of these files, numbered from 1.
pub fn migrator(files: &[MigrationFile]) -> Migrator {
    let migration = |(file, version): (&MigrationFile, i64)| {
        let description = file.name.split_once('_').map_or(file.name, |(_, words)| words).replace('_', " ");
        Migration::new(version, description.into(), MigrationType::Simple, file.text.into_sql_str(), false)
    };
    Migrator::with_migrations(files.iter().zip(1..).map(migration).collect())
}

/// Whether the files are those of the folder, with their numbers.
#[cfg(test)]
pub fn assert_complete(folder: &str, files: &[MigrationFile]) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("migrations").join(folder);
    let entries = std::fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("an entry").file_name());
    let mut found: Vec<String> = entries.map(|name| name.to_string_lossy().into_owned()).collect();
    found.sort();
    let listed: Vec<String> = files.iter().map(|file| format!("{}.sql", file.name)).collect();
    assert_eq!(listed, found);
    for (file, number) in files.iter().zip(1..) {
        assert!(file.name.starts_with(&format!("{number:04}_")), "{}", file.name);
    }
}
