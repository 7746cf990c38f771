//! TLS and passwords: who is let in, and whom a laptop trusts.

use std::path::Path;
use std::sync::OnceLock;

use fault_db::StoreError;
use rcgen::{BasicConstraints, CertificateParams, IsCa, Issuer, KeyPair};

use crate::common::refused;
use crate::laptop::connect;
use crate::private::{Cluster, NO_HURRY, give_away};

/// A server that has a certificate for `localhost` from an unknown issuer and asks kim for a password.
struct Guarded {
    cluster: Cluster,
    folder: tempfile::TempDir,
}

impl Guarded {
    fn address(&self, host: &str, options: &str) -> String {
        format!(
            "postgres://kim:s%40cret@{host}:{}/postgres?{options}",
            self.cluster.port()
        )
    }

    fn file(&self, name: &str) -> String {
        self.folder.path().join(name).to_string_lossy().into_owned()
    }
}

fn issuer(folder: &Path, name: &str) -> Issuer<'static, KeyPair> {
    let key = KeyPair::generate().expect("a key");
    let mut about = CertificateParams::default();
    about.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
    let certificate = about.self_signed(&key).expect("a certificate");
    std::fs::write(folder.join(name), certificate.pem()).expect("a file");
    Issuer::new(about, key)
}

fn guarded() -> &'static Guarded {
    static GUARDED: OnceLock<Guarded> = OnceLock::new();
    GUARDED.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        give_away(folder.path());
        let trusted = issuer(folder.path(), "issuer.pem");
        issuer(folder.path(), "other.pem");
        std::fs::write(folder.path().join("empty.pem"), "nothing\n").expect("a file");
        let key = KeyPair::generate().expect("a key");
        let about = CertificateParams::new(["localhost".to_owned()]).expect("a name");
        let certificate = about.signed_by(&key, &trusted).expect("a certificate");
        let [cert_file, key_file] = ["server.pem", "key.pem"].map(|name| folder.path().join(name));
        std::fs::write(&cert_file, certificate.pem()).expect("a file");
        std::fs::write(&key_file, key.serialize_pem()).expect("a file");
        give_away(&key_file);
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o600);
        std::fs::set_permissions(&key_file, mode).expect("permissions");
        let hba = folder.path().join("hba.conf");
        let rules = "host all ptu 127.0.0.1/32 trust\nhostssl all kim all scram-sha-256\n";
        std::fs::write(&hba, rules).expect("a file");
        let cluster = Cluster::start(&[
            NO_HURRY,
            "ssl = on",
            &format!("ssl_cert_file = '{}'", cert_file.display()),
            &format!("ssl_key_file = '{}'", key_file.display()),
            &format!("hba_file = '{}'", hba.display()),
        ]);
        let mut client = cluster.client("postgres");
        client
            .batch_execute("CREATE ROLE kim LOGIN SUPERUSER PASSWORD 's@cret'")
            .expect("kim");
        let port = cluster.port();
        cluster.set_up(&format!(
            "postgres://ptu@127.0.0.1:{port}/postgres?sslmode=disable"
        ));
        Guarded { cluster, folder }
    })
}

#[test]
fn a_server_is_trusted_by_its_issuer_and_its_name() {
    let server = guarded();
    let by = |name: &str| format!("sslrootcert={}", server.file(name));
    let issuer = by("issuer.pem");
    for accepted in [
        server.address("localhost", &issuer),
        server.address("localhost", &format!("{issuer}&sslmode=require")),
        server.address("localhost", "sslmode=prefer"),
        // On this machine no certificate is needed.
        server.address("localhost", ""),
    ] {
        connect(&accepted).unwrap_or_else(|error| panic!("{accepted}: {error}"));
    }
    for (host, options, words) in [
        ("localhost", "sslmode=verify-full".to_owned(), "sslrootcert"),
        (
            "localhost",
            by("other.pem"),
            "nobody known here issued its certificate",
        ),
        ("127.0.0.1", by("issuer.pem"), "for another host"),
        ("localhost", by("empty.pem"), "no certificate in it"),
        ("localhost", by("gone.pem"), "gone.pem"),
    ] {
        let address = server.address(host, &options);
        let error = refused!(
            connect(&address),
            StoreError::ServerNotTrusted { .. },
            words
        );
        assert!(!error.to_string().contains("cret@"), "{error}");
    }
    // In the clear the server does not want kim.
    let clear = connect(&server.address("localhost", "sslmode=disable"));
    refused!(clear, StoreError::ServerRefuses { .. });
}

#[test]
fn a_server_without_tls_is_refused_unless_told_otherwise() {
    let plain = crate::private::shared().database();
    let insisting = plain.replace("disable", "require");
    refused!(connect(&insisting), _, "it has no TLS");
    connect(&plain.replace("disable", "prefer")).expect("a server");
}

#[test]
fn passwords_come_from_a_file_and_are_never_shown() {
    use std::os::unix::fs::PermissionsExt as _;
    let server = guarded();
    let file = server.folder.path().join("pass");
    std::fs::write(&file, "localhost:*:*:kim:s@cret\n").expect("a file");
    let allow = |mode| {
        let mode = std::fs::Permissions::from_mode(mode);
        std::fs::set_permissions(&file, mode).expect("permissions");
    };
    let port = server.cluster.port();
    let address = format!(
        "postgres://kim@localhost:{port}/postgres?passfile={}",
        file.display()
    );
    allow(0o600);
    let store = connect(&address).expect("a server");
    assert!(!format!("{store:?} {}", store.path().display()).contains("cret"));
    allow(0o644);
    refused!(connect(&address), _, "chmod 600");

    let wrong = server.address("localhost", "").replace("s%40cret", "wrong");
    let refused = refused!(
        connect(&wrong),
        StoreError::ServerRefuses { .. },
        "password"
    );
    assert!(!refused.to_string().contains("wrong@"), "{refused}");
}
