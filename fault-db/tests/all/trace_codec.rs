//! Traces come back as they went in, small, and damage never passes for data.

use crate::common::{realistic_trace, refused};
use fault_db::trace::{ENCODING, MAX_ROWS, Shape, TraceCodec};
use fault_db::{Channel, ChannelKind, TraceData, TraceError};
use proptest::prelude::*;

fn codec() -> TraceCodec {
    TraceCodec::new().expect("a codec")
}

/// The head of a blob around any directory, with the checksum that it should have.
fn head(rows: u8, columns: u8, directory: &[u8]) -> Vec<u8> {
    let length = u8::try_from(directory.len()).expect("short");
    let varint = [length | 0x80, 1];
    let length = if length < 0x80 {
        &[length][..]
    } else {
        &varint
    };
    let mut blob = [&[rows, columns], length, directory].concat();
    blob.extend(crc32fast::hash(&blob).to_le_bytes());
    blob
}

fn shape(encoding: i64, rows: usize, channels: &[Channel]) -> Shape<'_> {
    Shape {
        encoding,
        rows,
        channels,
    }
}

fn decode_all(blob: &[u8], trace: &TraceData) -> Result<Vec<Vec<f64>>, TraceError> {
    let wanted: Vec<_> = (0..trace.channels.len()).collect();
    let shape = shape(ENCODING, trace.rows(), &trace.channels);
    codec().decode(blob, &shape, &wanted, 0..trace.rows())
}

/// Equal, where a missing sample equals a missing sample.
fn assert_same(found: &[Vec<f64>], expected: &[Vec<f64>]) {
    assert_eq!(found.len(), expected.len());
    for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(found.len(), expected.len(), "column {place}");
        for (row, (a, b)) in found.iter().zip(expected).enumerate() {
            let same = a == b || (a.is_nan() && b.is_nan());
            assert!(same, "column {place} row {row}: {a} {b}");
        }
    }
}

/// Goal: the size the project promises, on several trains. Method: bytes by samples.
#[test]
fn a_realistic_trace_takes_at_most_0_13_bytes_per_sample() {
    let mut total = 0;
    for seed in 1..=20 {
        let trace = realistic_trace(600, seed);
        let blob = codec().encode(&trace).expect("encodable");
        let found = decode_all(&blob, &trace).expect("readable");
        assert_same(&found, &trace.columns);
        total += blob.len();
    }
    let bytes_per_sample = total as f64 / (20.0 * 600.0 * 40.0);
    println!("{bytes_per_sample:.4} bytes per sample");
    assert!(bytes_per_sample <= 0.13, "{bytes_per_sample:.4}");
}

fn kinds() -> impl Strategy<Value = ChannelKind> {
    prop_oneof![
        prop::sample::select(vec![0.1, 0.01, 0.25, 1.0, 0.3, 1e-6])
            .prop_map(|lsb| ChannelKind::Number { lsb }),
        Just(ChannelKind::Bit),
        Just(ChannelKind::Enum {
            labels: [(-3, "off".to_owned())].into()
        }),
    ]
}

/// Whole steps, tenths written as decimals, anything a double can be, gaps.
fn samples(rows: usize) -> impl Strategy<Value = Vec<f64>> {
    let sample = prop_oneof![
        8 => (-2000i32..2000).prop_map(f64::from),
        4 => Just(1.0),
        2 => (-2000i32..2000).prop_map(|n| f64::from(n) / 10.0),
        1 => (-2000i32..2000).prop_map(|n| f64::from(n) * 0.1),
        1 => Just(f64::NAN),
    ];
    prop_oneof![
        4 => proptest::collection::vec(sample, rows),
        2 => proptest::collection::vec((-5i32..5).prop_map(f64::from), rows),
        1 => proptest::collection::vec(any::<f64>(), rows),
        1 => Just(vec![f64::NAN; rows]),
    ]
}

fn traces() -> impl Strategy<Value = TraceData> {
    (0usize..120, 0usize..6).prop_flat_map(|(rows, count)| {
        let channel = (kinds(), samples(rows));
        proptest::collection::vec(channel, count).prop_map(|columns| {
            let mut trace = realistic_trace(1, 1);
            trace.trigger_row = None;
            (trace.channels, trace.columns) = (Vec::new(), Vec::new());
            for (n, (kind, samples)) in columns.into_iter().enumerate() {
                let (name, unit) = (format!("c{n}"), String::new());
                trace.channels.push(Channel { name, unit, kind });
                trace.columns.push(samples);
            }
            trace
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_trace_returns(trace in traces()) {
        let blob = codec().encode(&trace).expect("encodable");
        assert_same(&decode_all(&blob, &trace).expect("readable"), &trace.columns);
    }

    #[test]
    fn any_part_is_that_part_of_the_whole(
        trace in traces(), from in 0usize..130, to in 0usize..130, place in any::<prop::sample::Index>(),
    ) {
        prop_assume!(!trace.channels.is_empty());
        let blob = codec().encode(&trace).expect("encodable");
        let place = place.index(trace.channels.len());
        let shape = shape(ENCODING, trace.rows(), &trace.channels);
        let found = codec().decode(&blob, &shape, &[place], from..to).expect("readable");
        let whole = &trace.columns[place];
        let part = whole.get(from..to.min(whole.len())).unwrap_or_default();
        assert_same(&found, &[part.to_vec()]);
    }

    #[test]
    fn any_damage_is_an_error(
        trace in traces(), at in any::<prop::sample::Index>(), with in 1u8.., cut in any::<bool>(),
    ) {
        let mut blob = codec().encode(&trace).expect("encodable");
        let at = at.index(blob.len());
        if cut {
            blob.truncate(at);
            prop_assert!(decode_all(&blob, &trace).is_err(), "cut at {at}");
        } else {
            blob[at] ^= with;
            prop_assert!(decode_all(&blob, &trace).is_err(), "byte {at}");
        }
    }

    #[test]
    fn any_bytes_are_no_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let mut trace = realistic_trace(40, 1);
        trace.channels.truncate(3);
        let shape = shape(ENCODING, 40, &trace.channels);
        let blob = [&[40, 3][..], &bytes].concat();
        let _ = codec().decode(&blob, &shape, &[0, 1, 2], 0..40);
        // Past the checksums: any form of column with any body.
        let (tags, body) = bytes.split_at(bytes.len().min(3));
        let mut directory = Vec::new();
        for tag in tags {
            let body = &body[..body.len().min(50)];
            directory.extend([*tag, body.len() as u8]);
            directory.extend(crc32fast::hash(body).to_le_bytes());
        }
        let bodies = body[..body.len().min(50)].repeat(tags.len());
        let blob = [head(40, 3, &directory), bodies].concat();
        let _ = codec().decode(&blob, &shape, &[0, 1, 2], 0..40);
    }
}

/// Goal: a blob of a few bytes must not make us allocate what it claims to hold.
#[test]
fn sizes_beyond_the_limits_are_refused() {
    let trace = realistic_trace(4, 1);
    let wanted: Vec<_> = (0..40).collect();
    let rows = MAX_ROWS + 1;
    let of = |rows| shape(ENCODING, rows, &trace.channels);
    let found = codec().decode(&[0; 4], &of(rows), &[0], 0..rows);
    assert_eq!(found, Err(TraceError::TooLarge { rows, columns: 1 }));
    let rows = MAX_ROWS;
    let found = codec().decode(&[0; 4], &of(rows), &wanted, 0..rows);
    assert_eq!(found, Err(TraceError::TooLarge { rows, columns: 40 }));
    // One run-length column, compressed, plain length 2^40: varint 80 80 80 80 80 20.
    let body = [0x80, 0x80, 0x80, 0x80, 0x80, 0x20, 0, 0];
    let crc = crc32fast::hash(&body).to_le_bytes();
    let claim = [&head(4, 1, &[&[0x09, 8], &crc[..]].concat())[..], &body].concat();
    let what = "it claims to be larger than it can be";
    let one = shape(ENCODING, 4, &trace.channels[..1]);
    let found = codec().decode(&claim, &one, &[0], 0..4);
    let channel = "speed".to_owned();
    assert_eq!(found, Err(TraceError::Column { channel, what }));
}

/// Goal: no bit of a blob can change unseen, and no length but its own is accepted.
#[test]
fn every_flipped_bit_and_every_cut_is_found() {
    let trace = realistic_trace(120, 3);
    let blob = codec().encode(&trace).expect("encodable");
    let mut codec = codec();
    let shape = shape(ENCODING, 120, &trace.channels);
    let wanted: Vec<_> = (0..40).collect();
    let mut damaged = blob.clone();
    for bit in 0..blob.len() * 8 {
        damaged[bit / 8] ^= 1 << (bit % 8);
        let found = codec.decode(&damaged, &shape, &wanted, 0..120);
        let Err(TraceError::Blob { .. } | TraceError::Column { .. }) = found else {
            panic!("bit {bit}: {found:?}");
        };
        damaged[bit / 8] ^= 1 << (bit % 8);
    }
    for length in 0..blob.len() {
        let found = codec.decode(&blob[..length], &shape, &wanted, 0..120);
        let Err(TraceError::Blob { .. }) = found else {
            panic!("{length} bytes: {found:?}");
        };
    }
    let longer = [&blob[..], &[0]].concat();
    let found = codec.decode(&longer, &shape, &wanted, 0..120);
    let what = "bytes after the last column";
    let offset = blob.len();
    assert_eq!(found, Err(TraceError::Blob { offset, what }));
}

/// Goal: a part of a long trace needs its own blocks only. Method: 10 000 rows are three blocks; with
/// the middle one of a channel damaged, rows of the others are read, and across it nothing is.
#[test]
fn a_part_of_a_long_trace_needs_its_own_blocks_only() {
    let trace = realistic_trace(10_000, 5);
    let blob = codec().encode(&trace).expect("encodable");
    let found = decode_all(&blob, &trace).expect("readable");
    assert_same(&found, &trace.columns);
    let shape = shape(ENCODING, 10_000, &trace.channels);
    let read = |blob: &[u8], rows: std::ops::Range<usize>| {
        codec().decode(blob, &shape, &[0], rows.clone())
    };
    for rows in [0..4096, 4095..4097, 4096..8192, 100..9_900, 8_191..10_000] {
        let found = read(&blob, rows.clone()).expect("readable");
        assert_same(&found, &[trace.columns[0][rows].to_vec()]);
    }
    // The first channel's three blocks lie first of all bodies, each about a third of them.
    let of_speed = (0..blob.len()).find_map(|at| {
        let mut damaged = blob.clone();
        damaged[at] ^= 1;
        let is_middle = read(&damaged, 4096..4097).is_err() && read(&damaged, 0..4096).is_ok();
        is_middle.then_some(damaged)
    });
    let damaged = of_speed.expect("a byte of the middle block");
    assert!(read(&damaged, 8192..10_000).is_ok());
    assert!(read(&damaged, 4000..4200).is_err());
}

#[test]
fn what_cannot_be_read_back_is_refused() {
    let assert_refused = |words: &str, change: &dyn Fn(&mut TraceData)| {
        let mut trace = realistic_trace(10, 1);
        change(&mut trace);
        refused!(codec().encode(&trace), _, words);
    };
    assert_refused("40 channels but 39 columns", &|t| drop(t.columns.pop()));
    let short = "channel \"tacho_pulses_1\" has 9 samples, the others 10";
    assert_refused(short, &|t| t.columns[2].truncate(9));
    let twice = "channel \"speed\" comes twice";
    assert_refused(twice, &|t| t.channels[1] = t.channels[0].clone());
    let late = "trigger row 10 of a trace with 10 rows";
    assert_refused(late, &|t| t.trigger_row = Some(10));
    let still = "the period is 0 µs; it must be positive";
    assert_refused(still, &|t| t.period_us = 0);
    let zero = ChannelKind::Number { lsb: 0.0 };
    assert_refused("lsb 0", &|t| t.channels[0].kind = zero.clone());
}
