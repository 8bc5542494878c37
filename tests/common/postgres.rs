//! A real PostgreSQL on loopback, from the binaries of Debian's package, in a folder of its own.
//!
//! It ends with the test program however that ends: a shell between them waits for the program's end of a pipe to close, then
//! stops the server and removes the folder. Where there are no binaries tests say that they show nothing; with
//! `ARCSLIP_POSTGRES=required` they fail.

use rustix::process::{Pid, Signal, geteuid, kill_process};
use sqlx::postgres::{PgConnectOptions, PgConnection};
use sqlx::{ConnectOptions, Connection};
use std::net::TcpListener;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(600);
/// Who runs it, where this is root: PostgreSQL does not run as root.
const USER: &str = "postgres";

/// `$1` the binary, `$2` the folder, `$3` the port, the rest its settings. Starts anew what has ended, unless `away` is there.
const SHELL: &str = r#"
    folder=$2; exec 3<&0
    ( cat <&3 > /dev/null; touch "$folder/over"; kill -QUIT "$(head -1 "$folder/data/postmaster.pid")" ) 2> /dev/null &
    binary=$1; port=$3; shift 3
    until [ -e "$folder/over" ]; do
        if [ -e "$folder/away" ]; then sleep 0.02; continue; fi
        "$@" "$binary" -D "$folder/data" -p "$port" < /dev/null >> "$folder/log" 2>&1 3<&-
    done
    rm -rf "$folder"
"#;

pub struct Postgres {
    folder: PathBuf,
    port: u16,
    shell: Child,
    _pipe: Option<ChildStdin>,
}

/// Where the binaries are: the newest version's folder.
fn binaries() -> Option<PathBuf> {
    let versions = std::fs::read_dir("/usr/lib/postgresql").ok()?;
    let mut found: Vec<PathBuf> =
        versions.filter_map(|version| Some(version.ok()?.path().join("bin"))).filter(|bin| bin.is_dir()).collect();
    found.sort();
    found.pop()
}

fn privileges() -> Vec<&'static str> {
    if geteuid().is_root() { vec!["setpriv", "--reuid", USER, "--regid", USER, "--clear-groups"] } else { Vec::new() }
}

/// As whoever runs the server.
fn command(program: &Path) -> Command {
    let mut words = privileges().into_iter();
    match words.next() {
        None => Command::new(program),
        Some(first) => {
            let mut command = Command::new(first);
            command.args(words).arg(program);
            command
        }
    }
}

impl Postgres {
    /// `synced`: every commit is on the disk before it is told. `None`, having said so: there are no binaries.
    pub fn start(synced: bool) -> Option<Self> {
        let Some(binaries) = binaries() else {
            let required = std::env::var("ARCSLIP_POSTGRES").is_ok_and(|value| value == "required");
            assert!(!required, "PostgreSQL is required and not there; apt-get install postgresql would do");
            eprintln!("skipped: no PostgreSQL in /usr/lib/postgresql; what was to be shown on it is not");
            return None;
        };
        let folder = tempfile::Builder::new().prefix("arcslip-postgres-").tempdir().expect("a folder").keep();
        std::fs::set_permissions(&folder, std::fs::Permissions::from_mode(0o777)).expect("permissions");
        let data = folder.join("data");
        let made = command(&binaries.join("initdb"))
            .args(["--auth=trust", "--username=arcslip", "--encoding=UTF8", "--no-locale", "-D"])
            .arg(&data)
            .args((!synced).then_some("--no-sync"))
            .output()
            .expect("initdb runs");
        assert!(made.status.success(), "{made:?}");
        let sync = if synced { "on" } else { "off" };
        let settings = format!(
            "listen_addresses = '127.0.0.1'\nunix_socket_directories = '{}'\nfsync = {sync}\nmax_connections = 300\n",
            folder.display()
        );
        let file = data.join("postgresql.auto.conf");
        std::fs::write(file, settings).expect("written");
        let port = TcpListener::bind("127.0.0.1:0").expect("a port").local_addr().expect("its address").port();
        let mut shell = Command::new("sh")
            .args(["-c", SHELL, "sh"])
            .arg(binaries.join("postgres"))
            .arg(&folder)
            .arg(port.to_string())
            .args(privileges())
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("a shell");
        let pipe = shell.stdin.take();
        Some(Self { folder, port, shell, _pipe: pipe })
    }

    pub fn port(&self) -> u16 {
        self.port
    }

    /// A database of its own, empty; its URL.
    pub async fn database(&self) -> String {
        let name = format!("test_{}", uuid::Uuid::now_v7().simple());
        let mut connection = self.connected().await;
        let create = sqlx::AssertSqlSafe(format!("CREATE DATABASE {name}"));
        sqlx::query(create).execute(&mut connection).await.expect("a database");
        connection.close().await.expect("closed");
        format!("postgres://arcslip@127.0.0.1:{}/{name}", self.port)
    }

    /// Waits until it takes connections.
    pub async fn connected(&self) -> PgConnection {
        let began = Instant::now();
        let options = PgConnectOptions::new_without_pgpass().host("127.0.0.1").port(self.port).username("arcslip");
        loop {
            match options.clone().database("postgres").connect().await {
                Ok(connection) => return connection,
                Err(error) => assert!(began.elapsed() < PATIENCE, "it does not start: {error}"),
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    }

    /// Ends it as if its machine had: nothing is put in order. It is away for so long, and comes back by itself.
    pub async fn crash(&self, away: Duration) {
        let (mark, lock) = (self.folder.join("away"), self.folder.join("data/postmaster.pid"));
        std::fs::write(&mark, "").expect("written");
        let id = std::fs::read_to_string(&lock).expect("it runs").lines().next().and_then(|id| id.parse().ok());
        kill_process(id.and_then(Pid::from_raw).expect("a process"), Signal::QUIT).expect("signalled");
        tokio::time::sleep(away).await;
        std::fs::remove_file(mark).expect("removed");
        self.connected().await.close().await.expect("closed");
    }
}

impl Drop for Postgres {
    fn drop(&mut self) {
        drop(self._pipe.take());
        let _ = self.shell.wait();
    }
}

/// One for all tests of a program. `None`: there are no binaries.
pub fn shared() -> Option<&'static Postgres> {
    static SHARED: OnceLock<Option<Postgres>> = OnceLock::new();
    SHARED.get_or_init(|| Postgres::start(false)).as_ref()
}
