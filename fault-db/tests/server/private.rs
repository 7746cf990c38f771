//! A private PostgreSQL: its own cluster in a temporary folder on a free loopback port, gone with the
//! program that started it, however that ends.

use std::fs;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::os::unix::fs::chown;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use fault_db::{Address, IdSource, ServerSetup, Store};
use postgres::{Client, NoTls};
use tempfile::TempDir;

/// The account of the laptops.
pub const LAPTOPS: &str = "laptop";

/// Time in which a server starts on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// Between two looks whether it has.
const LOOK: Duration = Duration::from_millis(30);

/// A setting: data reaches the disk some time, since no test turns the power off.
pub const NO_HURRY: &str = "fsync = off";

/// A cluster. Dropping it, or the program's end, stops the server.
pub struct Cluster {
    folder: TempDir,
    port: u16,
    server: std::sync::Mutex<Child>,
    /// Process that stops the server once its input is closed, which happens when this program
    /// ends.
    _watchdog: Child,
}

/// The cluster all tests share that do not stop it.
pub fn shared() -> &'static Cluster {
    static SHARED: OnceLock<Cluster> = OnceLock::new();
    SHARED.get_or_init(|| Cluster::start(&[NO_HURRY]))
}

impl Cluster {
    /// Makes a cluster and starts its server with these settings.
    pub fn start(settings: &[&str]) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        give_away(folder.path());
        let data = folder.path().join("data");
        let made = program("initdb")
            .args([
                "-A",
                "trust",
                "-U",
                "ptu",
                "-E",
                "UTF8",
                "--locale=C.UTF-8",
                "--no-sync",
                "-D",
            ])
            .arg(&data)
            .output()
            .expect("initdb runs");
        let said = String::from_utf8_lossy(&made.stderr);
        assert!(made.status.success(), "initdb: {said}");
        for setting in settings {
            let configuration = data.join("postgresql.conf");
            let text = fs::read_to_string(&configuration).expect("a configuration");
            fs::write(&configuration, format!("{text}\n{setting}\n")).expect("a setting");
        }
        let watchdog = watch(folder.path());
        let port = free_port();
        let mut cluster = Self {
            server: serve(&data, port).into(),
            folder,
            port,
            _watchdog: watchdog,
        };
        let begun = Instant::now();
        while !cluster.is_up(begun) {
            // Somebody else took the port before the server did.
            cluster.port = free_port();
            cluster.server = serve(&data, cluster.port).into();
        }
        cluster
    }

    /// A new database that is ready for laptops, and its address with their account.
    pub fn database(&self) -> String {
        let address = self.empty();
        self.set_up(&address);
        address.replace("ptu@", &format!("{LAPTOPS}@"))
    }

    /// Makes a database ready for laptops, as its owner.
    pub fn set_up(&self, address: &str) -> ServerSetup {
        let address: Address = address.parse().expect("an address");
        Store::set_up_server(&address, ids(), LAPTOPS).expect("a server that is ready")
    }

    /// A new, empty database and its address with the account of its owner.
    pub fn empty(&self) -> String {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let name = format!("history_{}", NUMBER.fetch_add(1, Ordering::Relaxed));
        let mut client = self.client("postgres");
        client
            .batch_execute(&format!("CREATE DATABASE {name}"))
            .expect("a new database");
        self.address(&name)
    }

    pub fn address(&self, database: &str) -> String {
        format!(
            "postgres://ptu@127.0.0.1:{}/{database}?sslmode=disable",
            self.port
        )
    }

    pub fn port(&self) -> u16 {
        self.port
    }

    pub fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    /// A plain connection, past all that is ours, as the owner of all there is.
    pub fn client(&self, database: &str) -> Client {
        self.client_as("ptu", database)
    }

    /// A client of this account.
    pub fn client_as(&self, user: &str, database: &str) -> Client {
        let address = format!(
            "host=127.0.0.1 port={} user={user} dbname={database}",
            self.port
        );
        Client::connect(&address, NoTls).expect("the private server takes connections")
    }

    /// Kills the server and all that works for it, as a power cut would.
    pub fn kill(&self) {
        let mut server = self.server.lock().expect("nobody else panicked here");
        // All of it at once, as by a power cut: none has time to tell the others.
        let all = [vec![server.id()], children(server.id())].concat();
        let all: Vec<_> = all.iter().map(u32::to_string).collect();
        let kill = format!("kill -KILL {}", all.join(" "));
        let _ = Command::new("sh").args(["-c", &kill]).status();
        server.wait().expect("a server that was killed ends");
    }

    /// Starts the server again where it was.
    pub fn restart(&self) {
        let begun = Instant::now();
        loop {
            let _ = fs::remove_file(self.data().join("postmaster.pid"));
            let started = serve(&self.data(), self.port);
            *self.server.lock().expect("nobody else panicked here") = started;
            // One that was killed may have left somebody behind who is about to find out; until then no other
            // starts.
            if self.is_up(begun) {
                break;
            }
        }
    }

    /// Waits until the server takes connections; no if it ended instead.
    fn is_up(&self, begun: Instant) -> bool {
        while !self.answers() {
            let waited = begun.elapsed();
            assert!(
                waited < PATIENCE,
                "the private server does not start: {}",
                self.log()
            );
            std::thread::sleep(LOOK);
            let mut server = self.server.lock().expect("nobody else panicked here");
            if matches!(server.try_wait(), Ok(Some(_))) {
                return false;
            }
        }
        true
    }

    /// Whether it is this server that answers at its port.
    fn answers(&self) -> bool {
        let address = format!("host=127.0.0.1 port={} user=ptu dbname=postgres", self.port);
        let asked = Client::connect(&address, NoTls)
            .and_then(|mut client| client.query_one("SHOW data_directory", &[]));
        asked.is_ok_and(|row| self.data() == Path::new(row.get::<_, &str>(0)))
    }

    fn log(&self) -> String {
        fs::read_to_string(self.folder.path().join("log")).unwrap_or_default()
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        let mut server = self
            .server
            .lock()
            .unwrap_or_else(|broken| broken.into_inner());
        stop(server.id());
        let _ = server.wait();
    }
}

/// Ids that nothing else has.
fn ids() -> IdSource {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let mut now = since.expect("a clock after 1970").as_nanos() as u64;
    IdSource::new(move || {
        now += 1;
        let mut bytes = [0; 10];
        bytes[..8].copy_from_slice(&now.to_be_bytes());
        bytes[8..].copy_from_slice(&(std::process::id() as u16).to_be_bytes());
        (now / 1_000_000, bytes)
    })
}

/// The database's name in an address.
pub fn name_of(address: &str) -> &str {
    let name = address
        .rsplit('/')
        .next()
        .expect("an address has a database");
    name.split('?').next().expect("a name")
}

fn serve(data: &Path, port: u16) -> Child {
    let log = data.with_file_name("log");
    let out = fs::OpenOptions::new()
        .create(true)
        .append(true)
        .open(log)
        .expect("a log");
    program("postgres")
        .arg("-D")
        .arg(data)
        .args(["-p", &port.to_string(), "-h", "127.0.0.1"])
        .args(["-c", "unix_socket_directories=", "-c", "max_connections=60"])
        .args(["-c", "shared_buffers=64MB"])
        .stdin(Stdio::null())
        .stdout(out.try_clone().expect("a log"))
        .stderr(out)
        .process_group(0)
        .spawn()
        .expect("postgres runs")
}

/// Immediate shutdown: the sessions are told to end at once, nothing is written back.
fn stop(server: u32) {
    signal("QUIT", server);
}

/// The processes a process has started.
fn children(parent: u32) -> Vec<u32> {
    let of_parent = |process: &u32| {
        let stat = fs::read_to_string(format!("/proc/{process}/stat")).unwrap_or_default();
        // The name before them may hold anything, also brackets.
        let after_name = stat.rsplit_once(')').map_or("", |(_, rest)| rest);
        after_name.split_whitespace().nth(1) == Some(&parent.to_string())
    };
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let numbers = processes.filter_map(|process| process.file_name().to_str()?.parse().ok());
    numbers.filter(of_parent).collect()
}

/// Sends a signal to a process.
pub fn signal(name: &str, process: u32) {
    let kill = format!("kill -{name} {process}");
    let _ = Command::new("sh").args(["-c", &kill]).status();
}

/// A shell that waits for this program to end, killed or not, and then stops the server of this folder.
fn watch(folder: &Path) -> Child {
    let script = "cat >/dev/null; server=$(head -n 1 \"$1/data/postmaster.pid\" 2>/dev/null) \
        && kill -QUIT $server 2>/dev/null; sleep 1; rm -rf \"$1\"";
    Command::new("sh")
        .args(["-c", script, "watchdog"])
        .arg(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .process_group(0)
        .spawn()
        .expect("a shell")
}

/// A program of PostgreSQL, run by somebody who may: it refuses to serve root.
fn program(name: &str) -> Command {
    let mut command = Command::new(find(name));
    if let Some((user, group)) = somebody() {
        command.uid(user).gid(group).current_dir("/");
    }
    command
}

fn find(name: &str) -> PathBuf {
    let mut versions: Vec<_> = fs::read_dir("/usr/lib/postgresql")
        .into_iter()
        .flatten()
        .flatten()
        .map(|version| version.path().join("bin"))
        .collect();
    versions.sort();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = versions
        .into_iter()
        .rev()
        .chain(std::env::split_paths(&path));
    let mut found = folders
        .map(|folder| folder.join(name))
        .filter(|file| file.is_file());
    found
        .next()
        .expect("there is no PostgreSQL here: run scripts/test, which installs it")
}

/// Number and group of the user `postgres`, or of `nobody`, if this program is root's.
fn somebody() -> Option<(u32, u32)> {
    let owner = fs::metadata("/proc/self").expect("a process of our own");
    if std::os::unix::fs::MetadataExt::uid(&owner) != 0 {
        return None;
    }
    let users = fs::read_to_string("/etc/passwd").expect("users");
    let of = |name: &str| {
        let line = users
            .lines()
            .find(|line| line.starts_with(&format!("{name}:")))?;
        let mut fields = line.split(':').skip(2).map(|field| field.parse().ok());
        Some((fields.next()??, fields.next()??))
    };
    Some(
        of("postgres")
            .or_else(|| of("nobody"))
            .expect("a user other than root"),
    )
}

pub fn give_away(path: &Path) {
    if let Some((user, group)) = somebody() {
        chown(path, Some(user), Some(group)).expect("root may give a folder away");
    }
}

/// An address at which nothing listens, nor will while this lives: the near end of a connection.
pub struct Nobody {
    _listener: TcpListener,
    connection: TcpStream,
}

impl Nobody {
    pub fn there() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let at = listener.local_addr().expect("its number");
        let connection = TcpStream::connect(at).expect("a connection");
        let _listener = listener;
        Self {
            _listener,
            connection,
        }
    }

    pub fn address(&self) -> SocketAddr {
        self.connection.local_addr().expect("its number")
    }
}

fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    listener.local_addr().expect("its number").port()
}
