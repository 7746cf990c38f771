//! Traces come back as they went in, small, and damage never passes for data.

mod common;

use common::{Random, realistic_trace};
use fault_db::trace::{MAX_ROWS, TraceCodec};
use fault_db::{Channel, ChannelKind, TraceData, TraceError};
use proptest::prelude::*;

fn codec() -> TraceCodec {
    TraceCodec::new().expect("a codec")
}

fn decode_all(blob: &[u8], trace: &TraceData) -> Result<Vec<Vec<f64>>, TraceError> {
    let wanted: Vec<_> = (0..trace.channels.len()).collect();
    codec().decode(blob, &trace.channels, trace.rows(), &wanted)
}

/// Equal, where a missing sample equals a missing sample.
fn assert_same(found: &[Vec<f64>], expected: &[Vec<f64>]) {
    assert_eq!(found.len(), expected.len());
    for (place, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert_eq!(found.len(), expected.len(), "column {place}");
        for (row, (a, b)) in found.iter().zip(expected).enumerate() {
            assert!(
                a == b || (a.is_nan() && b.is_nan()),
                "column {place} row {row}: {a} {b}"
            );
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
        assert_same(
            &decode_all(&blob, &trace).expect("readable"),
            &trace.columns,
        );
        total += blob.len();
    }
    let bytes_per_sample = total as f64 / (20.0 * 600.0 * 40.0);
    println!("{bytes_per_sample:.4} bytes per sample");
    assert!(bytes_per_sample <= 0.13, "{bytes_per_sample:.4}");
}

fn kinds() -> impl Strategy<Value = ChannelKind> {
    prop_oneof![
        prop_oneof![
            Just(0.1),
            Just(0.01),
            Just(0.25),
            Just(1.0),
            Just(0.3),
            Just(1e-6)
        ]
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
            (trace.channels, trace.columns) = columns
                .into_iter()
                .enumerate()
                .map(|(n, (kind, samples))| {
                    let channel = Channel {
                        name: format!("c{n}"),
                        unit: String::new(),
                        kind,
                    };
                    (channel, samples)
                })
                .unzip();
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

    /// The checksum in the table catches what happens to pass here; nothing may panic.
    #[test]
    fn any_damage_is_an_error_or_at_least_no_panic(
        trace in traces(), at in any::<prop::sample::Index>(), with in 1u8.., cut in any::<bool>(),
    ) {
        let mut blob = codec().encode(&trace).expect("encodable");
        let at = at.index(blob.len());
        if cut {
            blob.truncate(at);
            prop_assert!(decode_all(&blob, &trace).is_err(), "cut at {at}");
        } else {
            blob[at] ^= with;
            let _ = decode_all(&blob, &trace);
        }
    }

    #[test]
    fn any_bytes_are_no_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let mut trace = realistic_trace(40, 1);
        trace.channels.truncate(3);
        let blob = [&[40, 3][..], &bytes].concat();
        let _ = codec().decode(&blob, &trace.channels, 40, &[0, 1, 2]);
    }
}

/// Goal: a blob of a few bytes must not make us allocate what it claims to hold.
#[test]
fn claims_beyond_the_limits_are_refused() {
    let trace = realistic_trace(4, 1);
    let wanted: Vec<_> = (0..40).collect();
    let rows = MAX_ROWS + 1;
    let found = codec().decode(&[0; 4], &trace.channels, rows, &[0]);
    assert_eq!(found, Err(TraceError::TooLarge { rows, columns: 1 }));
    let found = codec().decode(&[0; 4], &trace.channels, MAX_ROWS, &wanted);
    assert_eq!(
        found,
        Err(TraceError::TooLarge {
            rows: MAX_ROWS,
            columns: 40
        })
    );
    // One run-length column, compressed, plain length 2^40: varint 80 80 80 80 80 20.
    let claim = [4, 1, 0x09, 8, 0x80, 0x80, 0x80, 0x80, 0x80, 0x20, 0, 0];
    let what = "it claims to be larger than it can be";
    let found = codec().decode(&claim, &trace.channels[..1], 4, &[0]);
    assert_eq!(
        found,
        Err(TraceError::Column {
            channel: "speed".to_owned(),
            what
        })
    );
}

#[test]
fn one_channel_is_read_although_another_is_damaged() {
    let trace = realistic_trace(600, 7);
    let mut blob = codec().encode(&trace).expect("encodable");
    let last = blob.len() - 1;
    blob[last] ^= 0xFF;
    let found = codec()
        .decode(&blob, &trace.channels, 600, &[4])
        .expect("not that one");
    assert_same(&found, &trace.columns[4..5]);
}

#[test]
fn what_cannot_be_read_back_is_refused() {
    let refused = |change: &dyn Fn(&mut TraceData)| {
        let mut trace = realistic_trace(10, 1);
        change(&mut trace);
        codec().encode(&trace).expect_err("refused").to_string()
    };
    assert_eq!(
        refused(&|t| drop(t.columns.pop())),
        "40 channels but 39 columns"
    );
    assert_eq!(
        refused(&|t| t.columns[2].truncate(9)),
        "channel \"tacho_pulses_1\" has 9 samples, the others 10"
    );
    assert_eq!(
        refused(&|t| t.channels[1] = t.channels[0].clone()),
        "channel \"speed\" comes twice"
    );
    assert_eq!(
        refused(&|t| t.trigger_row = Some(10)),
        "trigger row 10 of a trace with 10 rows"
    );
    assert_eq!(
        refused(&|t| t.period_us = 0),
        "the period is 0 µs; it must be positive"
    );
    let zero = ChannelKind::Number { lsb: 0.0 };
    assert!(refused(&|t| t.channels[0].kind = zero.clone()).contains("lsb 0"));
}

/// Goal: gaps cost little. Method: a link that drops one row in 50, and once for two seconds.
#[test]
fn gaps_return_as_gaps() {
    let mut trace = realistic_trace(600, 3);
    let mut random = Random::new(9);
    let gone: Vec<bool> = (0..600)
        .map(|row| (100..140).contains(&row) || random.one_in(50))
        .collect();
    for column in &mut trace.columns {
        for (sample, gone) in column.iter_mut().zip(&gone) {
            if *gone {
                *sample = f64::NAN;
            }
        }
    }
    let blob = codec().encode(&trace).expect("encodable");
    assert_same(
        &decode_all(&blob, &trace).expect("readable"),
        &trace.columns,
    );
}
