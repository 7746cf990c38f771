//! Tables in every form that other programs write.

use fault_db::ChannelKind;

use super::super::series::plain;
use super::*;

fn read_as(text: &[u8], asked: &Columns) -> Result<(Table, bool), String> {
    let mode = Channel {
        name: "mode".into(),
        unit: String::new(),
        kind: ChannelKind::Enum {
            labels: [(0, "off".to_owned()), (3, "ato".to_owned())].into(),
        },
    };
    let speed = Channel {
        unit: "km/h".into(),
        ..plain("speed")
    };
    let known = KnownSignals::of(&[&[mode, speed]], &asked.names);
    let read = read_table(Path::new("x.csv"), text, &known, asked);
    read.map_err(|failure| failure.to_string())
}

fn read(text: &str) -> Result<Table, String> {
    read_as(text.as_bytes(), &Columns::default()).map(|(table, _)| table)
}

#[test]
fn tables_of_other_programs_are_read() {
    let table =
        read("\u{feff}t;mode;\"a \"\"b\"\"\";speed_kmh\r\n\r\n-0.5;ato;1e3;\r\n1;0;nan;7.5");
    let table = table.expect("read");
    let names: Vec<_> = table.channels.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["mode", "a \"b\"", "speed"]);
    assert_eq!(table.times_us, [-500_000, 1_000_000]);
    assert_eq!(table.columns[0], [3.0, 0.0]);
    assert_eq!(table.columns[1][0], 1000.0);
    assert!(table.columns[1][1].is_nan() && table.columns[2][0].is_nan());
    assert_eq!(table.columns[2][1], 7.5);
}

/// Goal: a table is read whatever wrote it. Method: the same two rows of a speed in every form.
#[test]
fn every_form_of_a_table_is_read_alike() {
    for text in [
        "time_s,speed\n-2,20\n-1,10.5\n",
        "time_s;speed\n-2,0;20,0\n-1,0;10,5\n",
        "time_s,speed,\n-2,20,\n-1,10.5,\n",
        "time_ms,speed\n-2000,20\n-1000,10.5\n",
        "Time [us]\tspeed\n-2000000\t20\n-1000000\t10.5\n",
        "speed,time_s\n10.5,-1\n20,-2\n",
        "x-axis,speed\nsecond,Volt\n-2,20\n-1,10.5\n",
        "# of a recorder\nModel,X\nx-axis,speed\nms,km/h\n-2000,20\n-1000,10.5\n",
        "\u{c2}g;speed\n-2;20\n-1;10.5\n",
        "time,note,speed,note\n-2,\"a\nb\",20,\n-1,ok,10.5,ok\n",
    ] {
        let table = read(text).expect(text);
        let names: Vec<_> = table.channels.iter().map(|c| c.name.as_str()).collect();
        let place = names.iter().position(|name| *name == "speed").expect(text);
        assert_eq!(table.times_us, [-2_000_000, -1_000_000], "{text}");
        assert_eq!(table.columns[place], [20.0, 10.5], "{text}");
    }
    let latin = read_as(b"time_s,Gr\xf6\xdfe\n0,1\n", &Columns::default());
    assert_eq!(latin.expect("Latin-1").0.channels[0].name, "Größe");
    let dates = "timestamp,speed\n2026-11-27T00:00:01.5Z,1\n2026-11-27 00:00:02,2\n";
    let (table, is_utc) = read_as(dates.as_bytes(), &Columns::default()).expect("dates");
    assert!(is_utc && table.times_us[1] - table.times_us[0] == 500_000);
    let asked = Columns {
        names: vec![("CH1".to_owned(), "speed".to_owned())],
        time: Some("at".to_owned()),
        unit: Some(TimeUnit::Milliseconds),
    };
    let astray = read_as(b"of a scope,\nCH1,att\n7,100\n", &asked);
    let told = "no column is called \"at\" (did you mean \"att\"?)";
    assert!(astray.expect_err("no such column").contains(told));
    let (table, _) = read_as(b"CH1,at\n7,100\n", &asked).expect("as said");
    assert_eq!(
        (table.times_us[0], &*table.channels[0].name),
        (100_000, "speed")
    );
}

#[test]
fn errors_are_reported_with_line_and_column() {
    for (text, told) in [
        ("", "x.csv: it is empty"),
        ("only", "x.csv: no line of headings has rows"),
        ("t,a\n", "x.csv: no rows stand below"),
        (
            "t,speed,speed\n0,1,1\n",
            "column 3 (\"speed\"): it comes twice",
        ),
        ("t,a,b\n1,1\n", "line 2: 2 fields where the headings are 3"),
        ("t,a\n1,1,1\n", "line 2: 3 fields where the headings are 2"),
        (
            "t,speed\n1,x\n",
            "line 2, column 2 (\"speed\"): \"x\" is no number",
        ),
        ("t,mode\n1,on\n", "\"on\" is none of off, ato"),
        (
            "t,a\nnan,1\n",
            "line 2, column 1 (\"t\"): \"nan\" is no time",
        ),
        ("t,a\n1e300,1\n", "\"1e300\" is no time"),
        (
            "t,a\n1,1\nx,1\n",
            "line 3, column 1 (\"t\"): \"x\" is no time",
        ),
        ("t,\"a\n1,1\n", "x.csv: no rows stand below"),
    ] {
        let found = read(text).expect_err(text);
        assert!(found.contains(told), "{text:?}: {found}");
    }
    let long = format!("t,a\n1,\"{}", "x\n".repeat(1 << 20));
    assert!(
        read(&long)
            .expect_err("no end")
            .contains("after line 1: longer than")
    );
}
