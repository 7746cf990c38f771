//! Attacks on signed sheets, keys and the register of instruments, by somebody without Kim's key.

use crate::common::{Place, text};
use crate::signing::{signed, verify, with_key};

/// What stands before the certificate in a page.
const BEGIN: &str = "<script type=\"application/json\" id=\"ptu-certificate\">";

/// Goal: a sheet whose certificate stands elsewhere, twice, in another form or with other statements is told as changed, and so
/// is whatever is added to the page.
#[test]
fn a_sheet_takes_no_other_content() {
    let place = with_key();
    let run = "run atp/overspeed --inject eb_relay.slow";
    signed(&place, run).exits(1);
    let note = "runs note latest 'clicks late' --who Kim";
    signed(&place, note).exits(0);
    let report = "report latest --out sheet.html";
    signed(&place, report).exits(0);
    place
        .ptu(&["runs", "certificate", "latest", "--out", "a.ptucert"])
        .exits(0);
    signed(&place, "run tcms/link").exits(0);
    place
        .ptu(&["runs", "certificate", "latest", "--out", "b.ptucert"])
        .exits(0);
    let page = place.read("sheet.html");
    verify(&place, "sheet.html").exits(0).prints(&["unchanged"]);
    let (before, rest) = page.split_once(BEGIN).expect("a certificate");
    let (json, after) = rest.split_once("</script>").expect("its end");
    assert_eq!(after, "</body></html>");
    let element = format!("{BEGIN}{json}</script>");
    let bare = format!("{before}{after}");
    let passed = "<p class=\"verdict good\"><strong>Passed</strong></p>";
    let of_another = place.read("b.ptucert").trim().to_owned();
    let own = place.read("a.ptucert").trim().to_owned();
    let note_of = json.rfind(",{\"signature\"").expect("a note's signature");
    let end_of_run = json.find("],\"sheet\"").expect("its end");
    let forged = [
        // In an attribute, with a false first signature that holds markup.
        bare.replacen(
            "<body>",
            &format!(
                "<body data-x='{BEGIN}{}</script>'>",
                json.replacen('{', &format!("{{\"signature\":\"'>{passed}\","), 1)
            ),
            1,
        ),
        bare.replacen("<body>", &format!("<body>{element}"), 1),
        bare.replacen("<head>", &format!("<head>{element}"), 1),
        format!("{bare}{element}"),
        page.replacen("<body>", &format!("<body>{element}"), 1),
        page.replacen("<body>", &format!("<body><!--{element}-->{passed}"), 1),
        page.replacen("<body>", "<body><SCRIPT>alert(1)</SCRIPT>", 1),
        page.replacen(&element, &format!("{element}<script>alert(1)</script>"), 1),
        page.replacen(BEGIN, &BEGIN.replace(" id", "  id"), 1),
        format!("{page}{passed}"),
        format!("{page}\n"),
        page.replacen(
            json,
            &json.replacen("\"signature\":", "\"signature\":\"x\",\"signature\":", 1),
            1,
        ),
        page.replacen(json, &json.replacen(':', ": ", 1), 1),
        page.replacen(json, &json.replace("\"run\"", "\"\\u0072un\""), 1),
        // Another run's statement put first, last or in place of the run's, and a note's taken out.
        page.replacen("\"run\":[", &format!("\"run\":[{of_another},"), 1),
        page.replacen("],\"sheet\"", &format!(",{of_another}],\"sheet\""), 1),
        page.replacen(&own, &of_another, 1),
        [
            before,
            BEGIN,
            &json[..note_of],
            &json[end_of_run..],
            "</script>",
            after,
        ]
        .concat(),
        // Without the signature of the sheet.
        page.replacen(json, &format!("{}]}}", &json[..end_of_run]), 1)
            .replace(">Failed<", ">Passed<"),
    ];
    for (number, forged) in forged.iter().enumerate() {
        assert_ne!(*forged, page, "{number}");
        place.write("forged.html", forged);
        let said = verify(&place, "forged.html");
        assert!(
            said.code != Some(0) && !said.out.contains("unchanged"),
            "{number}: {}",
            said.all()
        );
    }
}

/// Goal: no sheet runs a script or asks for anything.
#[test]
fn a_sheet_allows_no_script_and_no_request() {
    let place = with_key();
    signed(&place, "run tcms/link --report sheet.html").exits(0);
    place.ptu(&["run", "tcms/link"]).exits(0);
    let runs = place.run_ids();
    let [second, first] = [&runs[0], &runs[1]];
    place.ptu(&format!(
        "runs compare {second} {first} --report compared.html"
    ));
    for name in ["sheet.html", "compared.html"] {
        let page = place.read(name);
        let head = page.split_once("<style>").expect("a head").0;
        assert!(
            head.contains("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none';"),
            "{head}"
        );
        assert!(!head.contains("script"), "{head}");
    }
}

/// Goal: a PDF, a table and JSON say nothing that is signed, and `ptu verify` says so with the way to find out.
#[test]
fn what_has_no_signature_is_told_as_such() {
    let place = with_key();
    signed(&place, "run tcms/link").exits(0);
    for name in ["a.pdf", "a.csv", "a.json", "a.junit.xml"] {
        place.ptu(&["report", "latest", "--out", name]).exits(0);
        verify(&place, name)
            .exits(3)
            .explains(&["carries no signature", "ptu verify RUN"]);
    }
}

/// Goal: a key signs as what the list says that it is.
#[test]
fn a_technician_does_not_sign_as_a_bench() {
    let place = with_key();
    let key = place.read("kim.key").replace("\"technician\"", "\"bench\"");
    place.write("kim.key", &key);
    signed(&place, "run tcms/link").exits(0);
    verify(&place, "latest")
        .exits(1)
        .prints(&["NOT VERIFIED", "Kim (technician)"]);
    verify(&place, "history.db")
        .exits(1)
        .prints(&["Kim (technician)"]);
}

/// Goal: of several files the narrowest days of a key hold, and a key has one name in all.
#[test]
fn a_key_that_the_list_ended_stays_ended() {
    let place = with_key();
    signed(&place, "run tcms/link").exits(0);
    let depot = place.path("depot");
    std::fs::create_dir(&depot).expect("a folder");
    let list = place.read("depot.keys");
    let until = list
        .lines()
        .find(|line| line.starts_with("until"))
        .expect("a day");
    let from = list
        .lines()
        .find(|line| line.starts_with("from"))
        .expect("a day");
    let ended = list.replace(until, &from.replace("from", "until"));
    let check = || place.ptu(&["verify", "latest", "--keys", "depot"]);
    place.write("depot/a.keys", &list);
    check().exits(0);
    for (first, second) in [
        ("depot/a.keys", "depot/z.pub"),
        ("depot/z.pub", "depot/a.keys"),
    ] {
        place.write(first, &ended);
        place.write(second, &list);
        check().exits(1).prints(&["expired on"]);
    }
    place.write("depot/z.pub", &list.replace("\"Kim\"", "\"Lee\""));
    check().exits(3).explains(&["Kim", "Lee", "one key"]);
}

/// Goal: a signature that is dated in the future is doubted.
#[test]
fn a_signature_of_next_year_is_doubted() {
    use std::sync::Arc;
    let place = with_key();
    let store = fault_db::Store::open(&place.path("history.db"), ptu_runs::clock::open_options())
        .expect("opens");
    signed(&place, "run tcms/link").exits(0);
    let path = place.path("kim.key");
    let signer = ptu_runs::keys::KeyFile::read(&path)
        .expect("read")
        .open("sesame-7")
        .expect("opens");
    store.sign_with(Some(Arc::new(signer)));
    let run = store.resolve_run("latest").expect("a run");
    let ahead = ptu_runs::clock::now_us() + 300 * 86_400_000_000;
    store
        .add_run_note(run, "Kim", "later", ahead)
        .expect("noted");
    store.close().expect("closed");
    verify(&place, "latest")
        .exits(1)
        .prints(&["NOT VERIFIED", "in the future"]);
    verify(&place, "history.db")
        .exits(1)
        .prints(&["in the future"]);
}

/// Goal: a note that nobody signed, in the signer's name on a signed run, is marked wherever it is read.
#[test]
fn an_unsigned_note_on_a_signed_run_is_marked() {
    let place = with_key();
    signed(&place, "run tcms/link").exits(0);
    signed(&place, "runs note latest mine --who Kim").exits(0);
    place.ptu(&["report", "latest", "--out", "a.html"]).exits(0);
    assert!(!place.read("a.html").contains("unsigned"));
    place.ptu("runs note latest 'not mine' --who Kim").exits(0);
    let shown = place.ptu(&["runs", "show", "latest"]).exits(0);
    let marked: Vec<&str> = shown
        .out
        .lines()
        .filter(|line| line.contains("unsigned"))
        .collect();
    assert!(
        marked.len() == 1 && marked[0].contains("not mine"),
        "{}",
        shown.out
    );
    place.ptu(&["report", "latest", "--out", "a.html"]).exits(0);
    assert!(place.read("a.html").contains("Kim (unsigned)"));
    verify(&place, "latest")
        .exits(1)
        .prints(&["NOT VERIFIED", "is not signed"]);
    verify(&place, "history.db")
        .exits(1)
        .prints(&["NOT VERIFIED", "is not signed"]);
    let notes = place.json(&["runs", "show", "latest", "--json"])["notes"].clone();
    let signed_by = [&notes[0]["signed_by"], &notes[1]["signed_by"]];
    assert_eq!(
        signed_by,
        [&serde_json::json!("Kim"), &serde_json::Value::Null]
    );
}

/// Goal: a note that nobody signed is marked at its trace, too.
#[test]
fn an_unsigned_note_on_a_trace_is_marked() {
    let place = with_key();
    let run = "run atp/overspeed --inject eb_relay.slow";
    signed(&place, run).exits(1);
    let store = fault_db::Store::open(&place.path("history.db"), ptu_runs::clock::open_options())
        .expect("opens");
    let trace = store.resolve_trace("latest").expect("a trace");
    let of_note = fault_db::TracePlace { trace, at_us: 0 };
    (store.add_trace_note(of_note, "Kim", "late here", ptu_runs::clock::now_us())).expect("noted");
    store.close().expect("closed");
    place
        .ptu(&["trace", "show", "latest"])
        .exits(0)
        .prints(&["Kim (unsigned)", "late here"]);
}

/// Goal: no key signs a sheet of a run that was changed, or a page of a case, which carries no signature.
#[test]
fn a_key_signs_no_sheet_that_it_cannot_vouch_for() {
    let place = with_key();
    let run = "run atp/overspeed --inject eb_relay.slow";
    signed(&place, run).exits(1);
    let case = "report latest --case --out case.html";
    signed(&place, case)
        .exits(2)
        .explains(&["a case", "carries no signature"]);
    let report = "report latest --out sheet.html";
    signed(&place, report).exits(0);
    let conn = rusqlite::Connection::open(place.path("history.db")).expect("opens");
    conn.execute_batch("UPDATE step SET verdict = 'passed' WHERE verdict = 'failed'")
        .expect("changed");
    drop(conn);
    signed(&place, report)
        .exits(3)
        .explains(&["was changed", "ptu verify"]);
}

/// Goal: a key or PIN that others can read is refused, and a PIN of spaces and names that look alike are not taken.
#[test]
fn keys_pins_and_names_that_protect_nothing_are_refused() {
    let place = with_key();
    #[cfg(unix)]
    for name in ["kim.key", "pin.txt"] {
        use std::os::unix::fs::PermissionsExt as _;
        let rights = |mode| {
            std::fs::set_permissions(place.path(name), std::fs::Permissions::from_mode(mode))
                .expect("set")
        };
        rights(0o644);
        let run = signed(&place, "run tcms/link");
        run.exits(2).explains(&[name, "open to others", "chmod"]);
        rights(0o600);
    }
    place.write("spaces.txt", "      \n");
    let new = |who: &str, pin: &str| {
        place.ptu(&format!(
            "key new --who '{who}' --out new.key --pin-file {pin}"
        ))
    };
    new("Lee", "spaces.txt").exits(2).explains(&["at least 6"]);
    for name in [
        "Kim\u{a0}",
        "Kim\u{a0}Lee",
        "Kim  Lee",
        "Kim\u{200b}",
        "Kim\u{202e}",
        "\u{3000}Kim",
        "Kim\u{fe0f}",
        "Kim\u{2800}",
        "Jose\u{301}",
        "\u{1100}\u{1161}",
    ] {
        new(name, "pin.txt").exits(2).explains(&["name"]);
        let list = place
            .read("depot.keys")
            .replace("\"Kim\"", &format!("\"{name}\""));
        place.write("other.keys", &list);
        place
            .ptu(&["key", "list", "--keys", "other.keys"])
            .exits(3)
            .explains(&["name"]);
    }
    for name in ["Kim Lee", "Jos\u{e9}", "김"] {
        new(name, "pin.txt").exits(0);
        std::fs::remove_file(place.path("new.key")).expect("made");
        std::fs::remove_file(place.path("new.pub")).expect("made");
    }
}

/// Goal: days of a calibration are days where the bench stands: in Seoul at 8 in the morning of the due day it is over, and
/// one made today holds.
/// Method: the program runs where it is another day than in Greenwich.
#[test]
fn a_calibration_ends_on_the_day_of_the_bench() {
    let place = Place::with_database();
    let now = ptu_runs::clock::now_us();
    let hour = 3_600_000_000;
    let (zone, here) = match now / hour % 24 {
        10.. => ("XXX-14", now + 14 * hour),
        _ => ("XXX+12", now - 12 * hour),
    };
    let day = |at_us| ptu_runs::clock::utc_day(at_us);
    assert_ne!(day(now), day(here));
    let ptu = |arguments: &[&str]| {
        let output = place.command(arguments).env("TZ", zone).output();
        crate::common::Said::from(output.expect("starts"))
    };
    ptu(&["instrument", "add", "B-0031", "--kind", "bench"]).exits(0);
    let calibrated = |on: i64, due: i64| {
        let days = ["--on", &day(on), "--due", &day(due)];
        ptu(&[
            &[
                "instrument",
                "calibrate",
                "B-0031",
                "--calibrated-by",
                "lab 7",
            ][..],
            &days,
        ]
        .concat())
        .exits(0);
        let shown = ptu(&["instrument", "list"]).exits(0);
        let run = ptu(&["run", "tcms/link", "--unit", "tcp:127.0.0.1:1"]).exits(3);
        assert_eq!(
            shown.out.contains("not calibrated"),
            run.err.contains("the calibration of"),
            "{}",
            run.all()
        );
        !shown.out.contains("not calibrated")
    };
    assert!(calibrated(here, here + 24 * hour), "calibrated today");
    assert!(!calibrated(here - 24 * hour, here), "due today");
    let made = [
        "instrument",
        "calibrate",
        "B-0031",
        "--calibrated-by",
        "lab 7",
        "--due",
        "2999-01-01",
    ];
    ptu(&made).exits(0);
    let shown = ptu(&["instrument", "list", "--json"]).exits(0);
    let shown: serde_json::Value = serde_json::from_str(&shown.out).expect("JSON");
    assert_eq!(text(&shown[0]["calibrated"]), day(here));
}
