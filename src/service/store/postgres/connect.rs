//! Connects a process to the server, and checks server and schema before the service starts.

use crate::service::store::StoreError;
use crate::service::store::contract::error::Result;
use crate::service::store::contract::location::Url;
use crate::service::store::sql::migrations::{MigrationFile, migration_files, migrator};
use sqlx::postgres::{PgConnectOptions, PgConnection, PgSslMode};
use sqlx::{ConnectOptions, Connection};
use std::str::FromStr;
use std::time::Duration;
use tokio::time::timeout;

const MIGRATIONS: &[MigrationFile] = migration_files![
    "postgres":
    "0001_jobs",
    "0002_sweeps",
    "0003_summaries",
    "0004_turns",
    "0005_counted_losses",
    "0006_responses",
    "0007_changes",
    "0008_refinement",
    "0009_curves",
];

/// In the format of `server_version_num`.
const OLDEST_SERVER: i32 = 140_000;
const TO_CONNECT: Duration = Duration::from_secs(15);

/// The options that a URL may have.
const PARAMETERS: [&str; 10] = [
    "application_name",
    "dbname",
    "host",
    "hostaddr",
    "options",
    "password",
    "port",
    "sslmode",
    "statement-cache-capacity",
    "user",
];

/// Timeouts after which the server releases the locks of a process that is disconnected or suspended.
const SERVER_SETTINGS: [(&str, &str); 6] = [
    ("idle_in_transaction_session_timeout", "10s"),
    ("lock_timeout", "15s"),
    ("statement_timeout", "100s"),
    ("tcp_keepalives_idle", "10"),
    ("tcp_keepalives_interval", "5"),
    ("tcp_keepalives_count", "3"),
];

/// # Errors
/// The URL is malformed; the error does not repeat any part of it, which may be a password.
pub(super) fn options(url: &Url) -> Result<PgConnectOptions> {
    let bad = |why: String| StoreError::Open(why.into());
    let text = url.with_password();
    let query = text.split_once('?').map_or("", |(_, query)| query);
    for name in query.split('&').filter_map(|pair| pair.split('=').next()).filter(|name| !name.is_empty()) {
        if !PARAMETERS.contains(&name) {
            let known = PARAMETERS.join(", ");
            return Err(bad(format!("there is an unknown parameter; known are {known}")));
        }
    }
    // The message may repeat a part of the URL.
    let options = PgConnectOptions::from_str(text).map_err(|_| {
        bad("this is no URL of a PostgreSQL database; postgres://USER@HOST:PORT/DATABASE is one, where characters such as / @ \
             : ? # % in a password are written %2F %40 %3A %3F %23 %25"
            .to_owned())
    })?;
    match options.get_ssl_mode() {
        PgSslMode::Disable | PgSslMode::Allow | PgSslMode::Prefer => {}
        PgSslMode::Require | PgSslMode::VerifyCa | PgSslMode::VerifyFull => {
            return Err(bad(
                "this program does not encrypt connections of the database by itself; a private network, a \
                            tunnel or a proxy beside it does, without sslmode"
                    .to_owned(),
            ));
        }
    }
    // Only in a URL does an IPv6 address have brackets.
    let bare = options.get_host().strip_prefix('[').and_then(|host| host.strip_suffix(']')).map(str::to_owned);
    let options = match bare {
        Some(host) => options.host(&host),
        None => options,
    };
    let named = options.get_application_name().is_some();
    let options = if named { options } else { options.application_name("arcslip") };
    Ok(options.ssl_mode(PgSslMode::Disable).options(SERVER_SETTINGS))
}

/// Creates or migrates the tables; under a lock, so that processes do this one after another.
pub(super) async fn prepare(options: &PgConnectOptions) -> Result<()> {
    let open = |error: sqlx::Error| StoreError::Open(Box::new(error));
    // The migration of a large table may take long, and other processes wait for it here.
    let patient = options.clone().options([("lock_timeout", "0"), ("statement_timeout", "0")]);
    let mut connection = timeout(TO_CONNECT, patient.connect())
        .await
        .map_err(|_| StoreError::Open("the server does not answer".into()))?
        .map_err(open)?;
    let prepared = migrate(&mut connection).await.map_err(StoreError::Open);
    // Closing the connection releases the lock in any case.
    connection.close().await.map_err(open)?;
    prepared
}

async fn migrate(connection: &mut PgConnection) -> std::result::Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let (version, encoding): (i32, String) =
        sqlx::query_as("SELECT current_setting('server_version_num')::int, current_setting('server_encoding')")
            .fetch_one(&mut *connection)
            .await?;
    if version < OLDEST_SERVER {
        return Err(format!("the server is PostgreSQL {}; 14 or newer is required", version / 10_000).into());
    }
    if encoding != "UTF8" {
        return Err(
            format!("the encoding of the database is {encoding}; a database with ENCODING 'UTF8' is required").into()
        );
    }
    let mut migrations = migrator(MIGRATIONS);
    // Migrations of later versions only add to the schema, unless the check below says otherwise.
    migrations.set_ignore_missing(true);
    migrations.run(&mut *connection).await?;
    let least: i64 =
        sqlx::query_scalar("SELECT max(least_version) FROM compatibility").fetch_one(&mut *connection).await?;
    let known = migrations.iter().map(|one| one.version).max().unwrap_or(0);
    if least > known {
        return Err(format!(
            "the database was changed by a later version of this program so that this one cannot use it: it asks for \
             schema {least}, and this one knows {known}; the later version would do"
        )
        .into());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_migration_is_listed() {
        crate::service::store::sql::migrations::assert_complete("postgres", super::MIGRATIONS);
    }
}
