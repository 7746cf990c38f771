//! `ptu run --signals sampled`: the same scripts through waveforms.

use crate::common::Place;

/// Goal: codes, markers, TWC, tachometers and a drive pass through waveforms as they do through numbers.
#[test]
fn scripts_pass_through_waveforms() {
    let place = Place::new();
    let run = "run atp/limit_speed atp/speed_input ato/markers twc --signals sampled";
    place.ptu(run).exits(0);
}

/// Goal: a fault that weakens the signal is found in its waveform, and noise that a receiver stands is none.
#[test]
fn a_weak_receiver_is_found_and_noise_is_none() {
    let place = Place::new();
    place.write("noise.toml", "noise_mv = 20.0\nhum_mv = 30.0\n");
    let noisy = ["--signals", "sampled:noise.toml", "--jobs", "1"];
    let step = ["run", "atp/limit_speed", "--step", "weak signal just*"];
    place
        .ptu(&[&step[..], &["--signals", "sampled"]].concat())
        .exits(0);
    place
        .ptu(
            &[
                &step[..],
                &[
                    "--signals",
                    "sampled",
                    "--inject",
                    "atp_receiver.insensitive",
                ],
            ]
            .concat(),
        )
        .exits(1);
    let codes = ["run", "atp/limit_speed", "--step", "code * gives *"];
    place.ptu(&[&codes[..], &noisy].concat()).exits(0);
}
