//! Waveforms in files, what a channel is made of, and how sound cards are calibrated.

use btu_rig::waveform::ChannelConfig;
use protocol::config::UnitConfig;
use ptu_runs::signal;
use ptu_runs::sound::Calibrations;

use crate::common::Place;
use crate::{fuzz, fuzz_text, memory, refused_by_name, shipped};

#[test]
fn waveforms_channels_and_calibrations() {
    let place = Place::new();
    place
        .ptu("signal make code 55 code.wav --seconds 0.2")
        .exits(0);
    let unit =
        UnitConfig::from_toml(&shipped("units", "toml")["units/sg100.toml"]).expect("shipped");
    let folder = memory();
    let file = folder.path().join("a.wav");
    let whole = std::fs::read(place.path("code.wav")).expect("made");
    fuzz("wav", [whole]).run(800, |bytes| {
        std::fs::write(&file, bytes).expect("written");
        refused_by_name(&file, signal::read(&file, &unit, 1_000.0));
    });
    let channel = "gain = 0.9\nnoise_mv = 12.0\nhum_mv = 40.0\nhum_hz = 60.0\nhum_lines = 5\ninverter_mv = 30.0\n\
        inverter_hz = [400.0, 1200.0]\ninverter_sweep_s = 4.0\ndropouts_per_s = 0.2\ndropout_s = 0.01\nclip_mv = 900.0\n";
    ChannelConfig::from_toml(channel).expect("a channel");
    fuzz_text("channel", [channel], 20_000, |text| {
        let _ = ChannelConfig::from_toml(text);
    });
    let known = r#"{"calibrations":[{"device":"coil","direction":"output","channel":"atp","full_scale_mv":1000.0,"at_us":5,
        "instrument":"Fluke 87","uncertainty_percent":2.0}]}"#;
    let calibrations = folder.path().join("sound.json");
    std::fs::write(&calibrations, known).expect("written");
    Calibrations::load(&calibrations).expect("calibrations");
    fuzz("calibrations", [known]).run(20_000, |bytes| {
        std::fs::write(&calibrations, bytes).expect("written");
        let _ = Calibrations::load(&calibrations);
    });
}
