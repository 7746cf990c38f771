//! A second code in the ATP antenna, of a neighbouring track circuit: the stronger counts, or none.

use protocol::injection::{Effect, Place};
use protocol::message::Crosstalk;

use crate::common::{Bench, fault, signal_of};

/// Limit under code 25 at 500 mV with code 75 beside it for 2 s, km/h.
fn limit_kmh(bench: &mut Bench, second_mv: u16) -> f64 {
    for _ in 0..40 {
        beside(bench, second_mv);
        bench.run(0.05);
    }
    shown_kmh(bench)
}

fn shown_kmh(bench: &Bench) -> f64 {
    (f64::from(bench.output.limit_cms) * 0.036).round()
}

fn beside(bench: &mut Bench, level_mv: u16) {
    let (carrier_hz, code_rate_chz) = signal_of("75");
    bench.send(Crosstalk {
        carrier_hz,
        code_rate_chz,
        level_mv,
    });
}

/// 4 dB are a factor of 1.585: 500 mV are so much above 315 mV, and 793 mV above 500 mV.
#[test]
fn the_stronger_counts_while_the_other_stays_4_db_below_it() {
    for (second_mv, expected) in [
        (0, 25.0),
        (250, 25.0),
        (315, 25.0),
        (317, 0.0),
        (500, 0.0),
        (791, 0.0),
        (794, 75.0),
    ] {
        let mut bench = Bench::hearing("25", &[]);
        assert_eq!(limit_kmh(&mut bench, second_mv), expected, "{second_mv} mV");
    }
}

#[test]
fn what_is_no_longer_told_is_gone() {
    let mut bench = Bench::hearing("25", &[]);
    assert_eq!(limit_kmh(&mut bench, 500), 0.0);
    bench.run(0.8);
    assert_eq!(shown_kmh(&bench), 25.0);
}

#[test]
fn a_receiver_without_separation_takes_the_weaker() {
    let mut bench = Bench::hearing("25", &[fault(Place::CodeSeparation, Effect::Dead)]);
    assert_eq!(limit_kmh(&mut bench, 0), 25.0);
    assert_eq!(limit_kmh(&mut bench, 250), 75.0);
}
