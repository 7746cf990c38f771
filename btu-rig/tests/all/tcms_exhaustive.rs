//! The standard EMU's modules (S4) against oracles that know nothing of their code: every combination of
//! inputs. `cargo test -p btu-rig --test all tcms_exhaustive -- --nocapture` shows how many.

#![allow(
    clippy::print_stdout,
    reason = "figures, for whoever asks with --nocapture"
)]

use btu_rig::tcms::{
    BrakeInputs, BrakeOutputs, DrivingInputs, DrivingOutputs, EbSources, LineInputs, TcmsData,
    driving_control, emergency_line, full_service_brake,
};
use btu_rig::train::TrainData;

/// The modes as the papers list them: emergency, yard, manual, automatic, driverless.
const MODES: usize = 5;

fn tcms() -> TcmsData {
    TrainData::line6().tcms().clone()
}

fn bits<const N: usize>(number: u32) -> [bool; N] {
    std::array::from_fn(|at| number & (1 << at) != 0)
}

/// Causes of the full service brake by their column, and whether each counts in the modes of hand
/// (emergency, yard, manual) and of ATO (automatic, driverless).
const CAUSES: [(usize, &str, bool, bool); 8] = [
    (5, "BCXVVVFF", true, true),
    (6, "BCXECUF", true, true),
    (7, "BCXBCCSF", true, true),
    (8, "BCXNRB", true, true),
    (9, "BCXATOF", false, true),
    (10, "BCXDOREQ", true, true),
    (11, "BCXACFSB", true, true),
    (12, "BCXDMFSB", true, false),
];

#[test]
fn full_service_brake_in_every_combination() {
    let (mut checked, mut applied) = (0, 0);
    let mut by_cause = [0; CAUSES.len()];
    for number in 0..1 << 14 {
        let columns: [bool; 14] = bits(number);
        let [
            emo,
            ymo,
            mmo,
            amo,
            dmo,
            vvvff,
            ecuf,
            bccsf,
            nrb,
            atof,
            doreq,
            acfsb,
            dmfsb,
            inb7,
        ] = columns;
        let out = full_service_brake(&BrakeInputs {
            bcxemod: emo,
            bcxymod: ymo,
            bcxmmod: mmo,
            bcxamod: amo,
            bcxdmod: dmo,
            bcxvvvff: vvvff,
            bcxecuf: ecuf,
            bcxbccsf: bccsf,
            bcxnrb: nrb,
            bcxatof: atof,
            bcxdoreq: doreq,
            bcxacfsb: acfsb,
            bcxdmfsb: dmfsb,
            bcxinb7: inb7,
        });
        let modes = columns[..MODES].iter().filter(|on| **on).count();
        let hand = modes != 1 || columns[..3].contains(&true);
        let ato = modes != 1 || columns[3..MODES].contains(&true);
        let mut wanted = false;
        for (at, (column, _, in_hand, in_ato)) in CAUSES.iter().enumerate() {
            let counts = columns[*column] && (*in_hand && hand || *in_ato && ato);
            by_cause[at] += u32::from(counts);
            wanted |= counts;
        }
        let full = wanted || columns[13];
        let oracle = BrakeOutputs {
            bcyinfsb: wanted,
            bcymsb: full,
            bcypcut: full,
        };
        assert_eq!(out, oracle, "combination {number:014b}");
        checked += 1;
        applied += u32::from(wanted);
    }
    println!("full-service-brake module: {checked} combinations, {applied} with the brake on");
    for ((_, name, ..), count) in CAUSES.iter().zip(by_cause) {
        println!("  {name}: counts in {count}");
    }
    assert_eq!(checked, 16_384);
    // Six causes count in half of all; the dead man not in the 2 modes of ATO alone, ATO failed not in
    // the 3 of hand alone: 8192 less 2/32 and 3/32 of them.
    assert_eq!(by_cause, [8192, 8192, 8192, 8192, 7424, 8192, 8192, 7680]);
}

/// Value for P, B, neutral and a source's value, by S4, and beyond S4 on the safe side. One row for
/// each case, the first that fits counts.
fn value(power: bool, brake: bool, neutral: bool, cut: bool, value: i16) -> i16 {
    let value = i32::from(value);
    let rows: [(bool, i32); 6] = [
        // Beyond eleven bits: it has no meaning.
        (!(-1024..1024).contains(&value), -1024),
        // B, also with P: a value of B's.
        (brake && value > 0, -value),
        (brake, value),
        // A value that brakes brakes.
        (value < 0, value),
        // P, unless something takes it away.
        (power && !neutral && !cut, value),
        (true, 0),
    ];
    let (_, out) = rows.into_iter().find(|(fits, _)| *fits).unwrap();
    i16::try_from(out).unwrap()
}

const VALUES: [i16; 17] = [
    i16::MIN,
    -20_000,
    -1025,
    -1024,
    -1023,
    -727,
    -512,
    -1,
    0,
    1,
    153,
    512,
    1022,
    1023,
    1024,
    20_000,
    i16::MAX,
];

/// All 2^5 modes, 2^3 contacts, powering cut, 2^2 bits of ATO, and values of either source. The source
/// that does not count must change nothing.
#[test]
fn driving_control_in_every_mode_and_command() {
    let (mut checked, mut powers, mut brakes) = (0_u32, 0_u32, 0_u32);
    for number in 0..1 << 11 {
        let [emo, ymo, mmo, amo, dmo, p, b, coa, cut, aop, aob]: [bool; 11] = bits(number);
        for hand_value in VALUES {
            for ato_value in VALUES {
                let out = driving_control(&DrivingInputs {
                    drxemod: emo,
                    drxymod: ymo,
                    drxmmod: mmo,
                    drxamod: amo,
                    drxdmod: dmo,
                    drxmcrv: hand_value,
                    drxp: p,
                    drxb: b,
                    drxcoa: coa,
                    drxpcut: cut,
                    drxtebe: ato_value,
                    drxaop: aop,
                    drxaob: aob,
                });
                let on = |modes: &[bool]| modes.iter().filter(|on| **on).count();
                let by_hand_and_ato = (on(&[emo, ymo, mmo]), on(&[amo, dmo]));
                let wanted = match by_hand_and_ato {
                    (1, 0) => value(p, b, coa, cut, hand_value),
                    (0, 1) => value(aop, aob, false, cut, ato_value),
                    _ => -1024,
                };
                let oracle = DrivingOutputs {
                    dryinb7: by_hand_and_ato == (1, 0) && wanted == -1024,
                    dryinp: wanted > 0,
                    dryinb: wanted < 0,
                    dryincoa: wanted == 0,
                    drytebe: wanted,
                };
                assert_eq!(
                    out, oracle,
                    "combination {number:011b}, controller {hand_value}, ATO {ato_value}"
                );
                assert!(!(cut && out.dryinp) && (-1024..=1023).contains(&out.drytebe));
                checked += 1;
                powers += u32::from(out.dryinp);
                brakes += u32::from(out.dryinb);
            }
        }
    }
    println!("driving-control module: {checked} combinations, {powers} power, {brakes} brake");
    assert_eq!(checked, 2048 * 17 * 17);
    // 3 modes of hand: P without B, neutral or cut (1 of 16 contacts), 4 bits of ATO, 5 values in
    // range that power, 17 of the other source. 2 of ATO: P without B or cut (1 of 8), 8 contacts.
    assert_eq!(powers, 3 * 4 * 5 * 17 + 2 * 8 * 5 * 17);
}

/// 0 to 10 V in steps of 1 mV against the printed table, in whole numbers: break points 500, 4800, 5200
/// and 9500 mV. Where the table's value lies half-way either neighbour will do.
#[test]
fn every_millivolt_of_the_controller() {
    let data = tcms();
    let [a, b, c, d] = data.controller_v.map(|volts| (volts * 1000.0) as i64);
    let mut counts = [0_u32; 4];
    let mut before: Option<i64> = None;
    for millivolts in 0..=10_000_i64 {
        let volts = millivolts as f64 / 1000.0;
        let got = i64::from(data.value(volts));
        // Twice the distance to the exact value, times its divisor.
        let (range, off, span) = if millivolts <= a || millivolts >= d {
            (0, 2 * (got + 1024), 1)
        } else if millivolts < b {
            (1, 2 * (got * (b - a) + (b - millivolts) * 1024), b - a)
        } else if millivolts <= c {
            (2, 2 * got, 1)
        } else {
            (3, 2 * (got * (d - c) - (millivolts - c) * 1023), d - c)
        };
        assert!(
            off.abs() <= if span == 1 { 0 } else { span },
            "{millivolts} mV: {got}"
        );
        assert_eq!(data.controller_failed(volts), range == 0, "{millivolts} mV");
        if range != 0 {
            assert!(
                before.is_none_or(|before| before <= got),
                "{millivolts} mV: {got} falls"
            );
            before = Some(got);
        }
        counts[range] += 1;
    }
    let [failed, brake, neutral, power] = counts;
    let checked: u32 = counts.iter().sum();
    println!(
        "controller: {checked} voltages, {failed} failed, {brake} brake, {neutral} neutral, {power} power"
    );
    assert_eq!((checked, counts), (10_001, [1002, 4299, 401, 4299]));
    for volts in [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -1.0,
        11.0,
        f64::MAX,
    ] {
        assert_eq!(data.value(volts), -1024, "{volts} V");
        assert!(data.controller_failed(volts), "{volts} V");
    }
}

/// What opens the line, by its column; the last column is the cut-out. ATC's relay and the valid cab
/// hold it, the others open it.
#[test]
fn emergency_line_in_every_combination() {
    const SOURCES: [(EbSources, bool); 6] = [
        (EbSources::HCR, false),
        (EbSources::CONTROLLER, true),
        (EbSources::BUTTON_1, true),
        (EbSources::BUTTON_2, true),
        (EbSources::ATC, false),
        (EbSources::MAIN_RESERVOIR, true),
    ];
    let (mut checked, mut energised) = (0, 0);
    for number in 0..1 << 7 {
        let columns: [bool; 7] = bits(number);
        let [
            cab_valid,
            controller,
            button_1,
            button_2,
            atc_relay,
            low,
            cut_out,
        ] = columns;
        let line = emergency_line(&LineInputs {
            cab_valid,
            controller,
            buttons: [button_1, button_2],
            atc_relay,
            main_reservoir_low: low,
            cut_out,
        });
        let mut open = 0;
        for (at, (source, opens_when)) in SOURCES.into_iter().enumerate() {
            let opens = columns[at] == opens_when;
            assert_eq!(line.sources.contains(source), opens, "{number:07b}");
            open += u32::from(opens);
        }
        // Fail-safe: nothing energises it without the relay, and the cut-out hides the brake only.
        assert_eq!(line.energised, open == 0, "{number:07b}");
        assert!(atc_relay || !line.energised, "{number:07b}");
        assert_eq!(line.applied, open != 0 && !cut_out, "{number:07b}");
        let but_atc = open - u32::from(!atc_relay);
        assert_eq!(line.fed, but_atc == 0, "{number:07b}");
        checked += 1;
        energised += u32::from(line.energised);
    }
    println!("emergency brake train line: {checked} combinations, {energised} energised");
    assert_eq!((checked, energised), (128, 2));
}
