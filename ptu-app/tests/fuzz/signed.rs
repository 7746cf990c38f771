//! Signed things and their signers: certificates, sheets, lists of keys and key files.

use fault_db::{Signed, Signer, Statement};
use ptu_report::{has_certificate, read_certificate};
use ptu_runs::keys::{KeyFile, KeyList};

use crate::common::Place;
use crate::{fuzz, fuzz_text, memory};

/// A place with a key, a list in which it is trusted, and a signed run with its sheet and certificate.
fn signed() -> Place {
    let place = Place::new();
    place.write("pin.txt", "sesame-7\n");
    let pin = ["--pin-file", "pin.txt"];
    let new = ["key", "new", "--who", "Kim", "--out", "kim.key"];
    place.ptu(&[&new[..], &pin].concat()).exits(0);
    place.ptu("key trust kim.pub --keys depot.keys").exits(0);
    let run = "run tcms/link --report sheet.html --key kim.key --pin-file pin.txt";
    place.ptu(run).exits(0);
    place
        .ptu("runs certificate latest --out run.ptucert")
        .exits(0);
    place
}

#[test]
fn certificates_and_sheets() {
    let place = signed();
    let certificate = place.read("run.ptucert");
    let kept = Signed::read(certificate.trim()).expect("a certificate");
    assert!(Statement::of(&kept).is_some(), "{certificate}");
    fuzz_text("certificate", [certificate], 20_000, |text| {
        let Ok(read) = Signed::read(text.trim()) else {
            return;
        };
        // Whatever is still believed says what was signed.
        assert_eq!(read.statement(), kept.statement(), "{text}");
    });
    fuzz_text("sheet", [place.read("sheet.html")], 1_000, |text| {
        if has_certificate(text) {
            let _ = read_certificate(text);
        }
    });
}

/// A private key that comes out of a damaged file is the one that was written: signatures by it are those of its owner.
#[test]
fn lists_of_keys_and_key_files() {
    let place = signed();
    let folder = memory();
    let file = folder.path().join("keys");
    for (name, of) in [("key-list", "depot.keys"), ("public-key", "kim.pub")] {
        fuzz(name, [place.read(of)]).run(20_000, |bytes| {
            std::fs::write(&file, bytes).expect("written");
            if let Ok(list) = KeyList::read(&file) {
                let _ = list.text();
            }
        });
    }
    fuzz("key-file", [place.read("kim.key")]).run(20_000, |bytes| {
        std::fs::write(&file, bytes).expect("written");
        let _ = KeyFile::read(&file).map(|key| key.entry().clone());
    });
    // Opening costs a memory-hard function on purpose.
    let whole = KeyFile::read(&place.path("kim.key")).expect("a key file");
    let public = |signer: &Signer| signer.public_key().to_owned();
    let key = public(&whole.open("sesame-7").expect("its PIN"));
    fuzz("opened-key", [place.read("kim.key")]).run(20, |bytes| {
        std::fs::write(&file, bytes).expect("written");
        if let Ok(signer) = KeyFile::read(&file).and_then(|key| key.open("sesame-7")) {
            assert_eq!(public(&signer), key);
        }
    });
}
