//! Attacks on signed sheets, keys and the register of instruments, by somebody without Kim's key.

use crate::common::{Place, Said, text};

/// Text in a page before the certificate.
const BEGIN: &str = "<script type=\"application/json\" id=\"ptu-certificate\">";

const PIN: &str = "sesame-7";

/// A key `kim.key` of Kim, trusted in `depot.keys`.
pub fn with_key() -> Place {
    let place = Place::new();
    place.write("pin.txt", &format!("{PIN}\n"));
    place
        .ptu("key new --who Kim --out kim.key --pin-file pin.txt")
        .exits(0)
        .prints(&["of Kim (technician)", "kim.pub", "ptu run --key"]);
    (place.ptu("key trust kim.pub --keys depot.keys"))
        .exits(0)
        .prints(&["trusted: Kim"]);
    place
}

/// A command that signs with Kim's key.
pub fn signed(place: &Place, line: &str) -> Said {
    place.ptu(&format!("{line} --key kim.key --pin-file pin.txt"))
}

pub fn verify(place: &Place, what: &str) -> Said {
    place.ptu(&["verify", what, "--keys", "depot.keys"])
}

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
        .ptu("runs certificate latest --out a.ptucert")
        .exits(0);
    signed(&place, "run tcms/link").exits(0);
    place
        .ptu("runs certificate latest --out b.ptucert")
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
        .ptu("trace show latest")
        .exits(0)
        .prints(&["Kim (unsigned)", "late here"]);
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
    let ptu = |arguments: &str| place.ptu_where(("TZ", zone), arguments);
    ptu("instrument add B-0031 --kind bench").exits(0);
    let calibrate = "instrument calibrate B-0031 --calibrated-by 'lab 7'";
    let calibrated = |on: i64, due: i64| {
        let days = format!("--on {} --due {}", day(on), day(due));
        ptu(&format!("{calibrate} {days}")).exits(0);
        let shown = ptu("instrument list").exits(0);
        let run = ptu("run tcms/link --unit tcp:127.0.0.1:1").exits(3);
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
    ptu(&format!("{calibrate} --due 2999-01-01")).exits(0);
    let shown = ptu("instrument list --json").exits(0);
    let shown: serde_json::Value = serde_json::from_str(&shown.out).expect("JSON");
    assert_eq!(text(&shown[0]["calibrated"]), day(here));
}
