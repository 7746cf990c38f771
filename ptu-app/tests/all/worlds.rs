//! Lines, unit types and trains that nobody made by hand: a sound unit passes on each, and an unsafe one is found.

use std::path::{Path, PathBuf};

use crate::common::made_plans::Chance;
use crate::common::{Place, Said, copy_folder, list, scripts, text};
use fuzzing::draw;

/// Worlds of the long suite.
const WORLDS: usize = 200;
/// Acceleration of a train that one per mille takes, km/h/s.
const KMH_PER_S_PER_PERMILLE: f64 = 0.0353;

/// A number between two others, to a tenth.
fn between(chance: &mut Chance, low: f64, high: f64) -> f64 {
    let tenths = ((high - low) * 10.0).max(0.0) as usize;
    low + chance.below(tenths + 1) as f64 / 10.0
}

/// Text of a shipped file, to be changed.
fn shipped(file: &str) -> String {
    std::fs::read_to_string(scripts().join(file)).expect("shipped")
}

/// Sets the first key of this name after a place in a file, such as `[ato.train]`.
fn set(text: &mut String, place: &str, key: &str, value: f64) {
    let place = text.find(place).expect("the place");
    let line = text[place..].find(&format!("\n{key} = ")).expect("the key") + place + 1;
    let end = text[line..].find('\n').map_or(text.len(), |end| line + end);
    text.replace_range(line..end, &format!("{key} = {value:?}"));
}

/// Limits of 2 to 11 codes, 25 to 130 km/h, and a stop; rates that a receiver tells apart.
fn codes(chance: &mut Chance) -> Vec<(usize, f64)> {
    let mut limits = vec![0];
    let count = 3 + chance.below(10);
    while limits.len() < count {
        let limit = 25 + chance.below(106);
        if !limits.contains(&limit) {
            limits.push(limit);
        }
    }
    limits.sort_unstable();
    let mut rates: Vec<f64> = Vec::new();
    while rates.len() < count {
        let highest = if chance.one_in(4) { 100.0 } else { 40.0 };
        let rate = between(chance, 1.5, highest);
        if rates.iter().all(|other| (other - rate).abs() > 1.05) {
            rates.push(rate);
        }
    }
    limits.into_iter().zip(rates).collect()
}

/// Sections of 200 m to 15 km, whose markers lie as those of line 8 where there is room, under codes of the table.
fn line(chance: &mut Chance, codes: &[(usize, f64)], steepest: f64) -> String {
    let sections = [1, 1, 2, 3, 4, 6, 10, 20][chance.below(8)];
    // What a line may leave out, or say as public data do.
    let loops = match sections {
        3 | 6 => "",
        _ => "loops_m = [170.0, 30.0]\n",
    };
    let by_limits = matches!(sections, 4 | 10);
    let mut line = format!("name = \"drawn\"\n{loops}");
    for section in 1..=sections {
        let length_m = match chance.below(8) {
            0..3 => between(chance, 200.0, 900.0),
            7 => between(chance, 2000.0, 15_000.0),
            _ => between(chance, 600.0, 2000.0),
        };
        // Twice as far before the stop point as the fastest train stops in, where there is room.
        let fastest_mps = codes.iter().map(|(limit, _)| *limit).max().unwrap_or(0) as f64 / 3.6;
        let psm1_m = (1.5 * fastest_mps * fastest_mps).clamp(546.0, 2000.0);
        let psm = match length_m {
            ..650.0 => [0.3 * length_m, 0.55 * length_m],
            _ => [(length_m - psm1_m).max(0.3 * length_m), length_m - 108.5],
        };
        let every = |chance: &mut Chance, from_m: f64, to_m: f64| {
            let mut places_m = vec![0.0];
            while let Some(&last) = places_m.last().filter(|&&last| last < length_m - to_m) {
                places_m.push(last + between(chance, from_m, to_m));
            }
            places_m.retain(|&at_m| at_m < length_m - 60.0);
            places_m
        };
        let gradients: Vec<_> = (every(chance, 120.0, 600.0).into_iter())
            .map(|at_m| {
                let permille = between(chance, 0.0, 2.0 * steepest) - steepest;
                format!("{{ at_m = {at_m:?}, permille = {permille:?} }}")
            })
            .collect();
        let sent: Vec<_> = (every(chance, 300.0, 2500.0).into_iter())
            .map(|at_m| {
                let (limit, _) = codes[1 + chance.below(codes.len() - 1)];
                match by_limits {
                    true => format!("{{ at_m = {at_m:?}, kmh = {limit}.4 }}"),
                    false => format!("{{ at_m = {at_m:?}, code = \"{limit}\" }}"),
                }
            })
            .collect();
        let middle_m = length_m / 2.0;
        let tunnels = match sections {
            2 => format!("tunnels = [{{ from_m = 50.0, to_m = {middle_m:?} }}]\n"),
            _ => String::new(),
        };
        let side = ["left", "right", "right", "both"][chance.below(4)];
        let (from, to) = (99 + section, 100 + section);
        line += &format!(
            "[[sections]]\nsection = {section}\nroute = 1\nlength_m = {length_m:?}\nfrom_station = {from}\nfrom_loop = {from}0\n\
             to_station = {to}\nto_loop = {to}0\nstart_m = 0.0\nstop_m = {length_m:?}\n\
             markers_m = [{:?}, {:?}, {:?}, {:?}]\ndoor_side = \"{side}\"\n{tunnels}gradients = [{}]\n{} = [{}]\n",
            psm[0],
            psm[1],
            length_m - 21.0,
            length_m - 3.5,
            gradients.join(", "),
            if by_limits { "limits" } else { "speed_codes" },
            sent.join(", ")
        );
    }
    line
}

/// A train of cars, or a point mass, that brakes at this rate, of which its unit is told.
fn train(chance: &mut Chance, brake: f64, unit: &mut String) -> String {
    set(unit, "[ato.train]", "brake_kmh_per_s", brake);
    let emergency = brake.max(4.5);
    if chance.one_in(2) {
        let mut ideal =
            shipped("trains/ideal.toml").replace("gradients = false", "gradients = true");
        set(&mut ideal, "", "service_kmh_per_s", brake);
        let power = between(chance, 2.0, 3.5);
        set(&mut ideal, "", "power_kmh_per_s", power);
        set(unit, "[ato.train]", "power_kmh_per_s", power);
        set(unit, "[ato.train]", "empty_kg", 200_000.0);
        set(unit, "[ato.train]", "rotating_kg", 0.0);
        set(unit, "[ato.train]", "base_speed_kmh", 130.0);
        set(&mut ideal, "", "emergency_kmh_per_s", emergency);
        return ideal;
    }
    let mut cars = shipped("trains/line6.toml");
    set(&mut cars, "[service_brake]", "kmh_per_s", brake);
    set(&mut cars, "[emergency_brake]", "kmh_per_s", emergency);
    let air = |line: &str| match line.strip_prefix("air_n = ") {
        Some(newtons) => {
            let newtons: f64 = newtons.parse().expect("N");
            format!("air_n = {:.0}\n", newtons * (brake / 3.5).max(1.0) + 20.0)
        }
        None => format!("{line}\n"),
    };
    cars.lines().map(air).collect()
}

/// A scripts folder with a line, a unit type and a train that are drawn by a seed.
fn world(place: &Place, seed: usize) -> PathBuf {
    let mut chance = Chance(seed as u64);
    let (codes, brake) = (codes(&mut chance), between(&mut chance, 1.5, 4.5));
    // A train that its brake holds on the line.
    let steepest = ((brake - 1.0) / KMH_PER_S_PER_PERMILLE).min(40.0);
    let line = line(&mut chance, &codes, steepest.floor());
    let mut unit = shipped("units/sg100.toml").replace("name = \"sg100\"", "name = \"drawn\"");
    let codes = codes.iter().map(|(limit, rate)| {
        format!("[[codes]]\nname = \"{limit}\"\nlimit_kmh = {limit}\ncarrier_hz = 3000\nrate_hz = {rate:?}\n\n")
    });
    let table =
        unit.find("[[codes]]").expect("codes")..unit.find("[receiver]").expect("a receiver");
    unit.replace_range(table, &codes.collect::<String>());
    let proof_mps2 = 0.6 * (brake - KMH_PER_S_PER_PERMILLE * steepest) / 3.6;
    set(
        &mut unit,
        "[overspeed]",
        "brake_proof_mps2",
        proof_mps2.min(0.4),
    );
    set(&mut unit, "[ato]", "decel_kmh_per_s", brake.min(3.5));
    let folder = place.path("scripts");
    copy_folder(&scripts(), &folder);
    let train = train(&mut chance, brake, &mut unit);
    for (kind, text) in [("lines", line), ("units", unit), ("trains", train)] {
        let file = folder.join(kind).join("drawn.toml");
        std::fs::write(file, text).expect("written");
    }
    folder
}

/// Runs all procedures in a world.
fn run(place: &Place, world: &Path, more: &[&str]) -> Said {
    let all = "run -q --report report.json --line drawn --unit-config drawn --train drawn";
    let words: Vec<_> = all.split(' ').chain(more.iter().copied()).collect();
    place.ptu_where(("PTU_SCRIPTS", world), &words)
}

/// Goal: no line, unit type or train makes a sound unit fail: what a step needs of them is derived, or the step is skipped
/// with its reason. What is unsafe in a unit is found on each that has all steps.
#[test]
#[ignore = "long suite: two runs in each of 200 worlds"]
fn a_sound_unit_passes_on_any_line_and_an_unsafe_one_is_found() {
    let modes = Place::new().json("catalog faults --json");
    let modes: Vec<_> = (list(&modes).iter())
        .filter(|mode| mode["unsafe"] == true && mode["on"] == "unit")
        .map(|mode| text(&mode["id"]).to_owned())
        .collect();
    let mut wrong = 0;
    for seed in draw::drawn(1..=WORLDS, 50) {
        let place = Place::new();
        let world = world(&place, seed);
        let sound = run(&place, &world, &[]);
        let report = place.read_json("report.json");
        let skipped = list(&report["steps"])
            .iter()
            .filter(|step| step["verdict"] == "skipped" && step["procedure"] != "ptu/identity");
        let reasons: Vec<_> = skipped.map(|step| text(&step["message"])).collect();
        assert!(!reasons.contains(&""), "world {seed}: {report}");
        let mode = &modes[seed % modes.len()];
        let found = run(&place, &world, &["--inject", mode]);
        // What finds it may be what the world has no room for.
        let lacks = reasons.iter().any(|why| !why.contains("condition"));
        let is_told = found.code == Some(1) || lacks && found.code == Some(0);
        if sound.code != Some(0) || !is_told {
            println!("world {seed}: {}\n{mode}: {}", sound.all(), found.all());
            wrong += 1;
        }
    }
    assert_eq!(wrong, 0, "worlds, which are printed by their seeds");
}
