//! A journey over section 61 through the wire, with a train that follows its effort.

// Each test file uses its own part of the journey.
#![allow(dead_code)]

use protocol::SCAN;
use protocol::injection::FaultMode;
use protocol::line::Section;
use protocol::message::{DoorSide, Mode, ModeSwitch, Outputs, TrainLines, TwcWayside};

use crate::common::{self, Bench};

/// A train that follows its effort, on the level, with the markers of section 61.
pub struct Journey {
    pub bench: Bench,
    pub section: Section,
    /// True position and speed, m and m/s.
    pub x_m: f64,
    pub v_mps: f64,
    pub accel_mps2: f64,
    /// Distance the wheels count over distance run.
    pub wheels_tell: f64,
    /// Each tachometer's pulses over those of a sound one on these wheels.
    pub channels_tell: [f64; 2],
    /// Marker and where its pulse comes, m.
    pub markers: Vec<(u8, f64)>,
    /// Share of the demand that traction and brake give.
    pub follows: f64,
    /// Share of the demand that TCMS says the train gives.
    pub says: f64,
    /// Acceleration TCMS makes by itself, whatever is asked, m/s².
    pub by_tcms_mps2: Option<f64>,
    /// Position by the last status less the true one then, m.
    pub position_error_m: f64,
}

impl Journey {
    pub fn new(faults: &[FaultMode]) -> Self {
        let mut bench = Bench::new(faults);
        let section = common::line().section(61).unwrap().clone();
        bench.code("65");
        bench.input.mode_switch = ModeSwitch::Automatic;
        bench.station = Some(TwcWayside {
            departure: 1,
            ..common::departure(&section)
        });
        bench.run(1.5);
        bench.input.lines.insert(TrainLines::START);
        bench.run(0.3);
        bench.input.lines.remove(TrainLines::START);
        assert_eq!(bench.status.mode, Mode::AutomaticRun);
        Self {
            bench,
            x_m: section.start_m,
            v_mps: 0.0,
            accel_mps2: 0.0,
            wheels_tell: 1.0,
            channels_tell: [1.0; 2],
            markers: (1..).zip(section.markers_m).collect(),
            follows: 1.0,
            says: 1.0,
            by_tcms_mps2: None,
            position_error_m: 0.0,
            section,
        }
    }

    /// The same journey but for one change.
    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    pub fn step(&mut self) {
        let dt = SCAN.as_secs();
        let effort = f64::from(self.bench.status.effort);
        let asked = match effort {
            _ if self.bench.braking() => -1.25,
            _ if self.by_tcms_mps2.is_some() => self.by_tcms_mps2.unwrap_or(0.0),
            _ if self.bench.has(Outputs::FSB) => -3.5 / 3.6,
            _ if self.bench.has(Outputs::HOLDING_BRAKE) => -0.7 * 3.5 / 3.6,
            e if e > 0.0 && !self.bench.has(Outputs::POWER_CUT) => {
                let fade = (40.0 / 3.6) / self.v_mps.max(40.0 / 3.6);
                e / 1023.0 * 3.0 / 3.6 * fade * self.follows
            }
            e if e < 0.0 => e / 1024.0 * 3.5 / 3.6 * self.follows,
            _ => 0.0,
        };
        if let Some(tcms) = &mut self.bench.tcms {
            tcms.effort = (effort * self.says) as i16;
        }
        self.accel_mps2 += (asked - self.accel_mps2) * dt / 0.3;
        let before = self.x_m;
        self.v_mps = (self.v_mps + self.accel_mps2 * dt).max(0.0);
        self.x_m += self.v_mps * dt;
        let wheel_mps = self.v_mps * self.wheels_tell;
        self.bench.speeds = self.channels_tell.map(|tells| wheel_mps * tells);
        let passed = |&&(_, at): &&(u8, f64)| before < at && at <= self.x_m;
        if let Some(&(marker, at)) = self.markers.iter().find(passed) {
            let input = &mut self.bench.input;
            input.marker = marker;
            input.marker_edges = input.marker_edges.wrapping_add(1);
            input.marker_edge_us = ((self.x_m - at) / self.v_mps * 1e6) as u16;
        }
        if before < 100.0 && self.x_m >= 100.0 {
            self.bench.station = Some(TwcWayside {
                station: self.section.to_station,
                next_station: self.section.to_station + 1,
                loop_id: self.section.to_loop,
                door_side: DoorSide::from_label(&self.section.door_side).unwrap(),
                ..common::departure(&self.section)
            });
        }
        self.bench.scan();
        // A status is made in the first scan of each cycle.
        if self.bench.now.as_us() % 50_000 == 10_000 {
            self.position_error_m = f64::from(self.bench.status.position_cm) / 100.0 - self.x_m;
        }
    }

    /// Runs to its end: standing for ten seconds, or long past the platform.
    pub fn run(mut self) -> Self {
        let mut stands_s = 0.0;
        for _ in 0..20_000 {
            self.step();
            stands_s = if self.v_mps > 0.0 || self.x_m < 1.0 {
                0.0
            } else {
                stands_s + SCAN.as_secs()
            };
            if stands_s > 10.0 {
                return self;
            }
        }
        panic!("no end: {} m, {} m/s", self.x_m, self.v_mps);
    }

    pub fn until_position(mut self, x_m: f64) -> Self {
        while self.x_m < x_m {
            self.step();
        }
        self
    }

    /// True position less the stop point, m.
    pub fn stop_error_m(&self) -> f64 {
        self.x_m - self.section.stop_m
    }

    #[track_caller]
    pub fn stops_within(&self, most_m: f64) {
        let error_m = self.stop_error_m();
        assert!(error_m.abs() < most_m, "{error_m}");
    }

    #[track_caller]
    pub fn knows_its_place_within(&self, most_m: f64) {
        let error_m = self.position_error_m;
        assert!(error_m.abs() < most_m, "{error_m}");
    }

    /// Events besides those of a good run.
    pub fn faults(&mut self) -> Vec<&'static str> {
        let usual = ["power_up", "mode_changed", "eb_released"];
        let mut events = self.bench.events();
        events.retain(|event| !usual.contains(event));
        events
    }
}
