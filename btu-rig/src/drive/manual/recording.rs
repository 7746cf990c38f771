//! Collects rows, performed steps and the logs of unit and TCMS during a manual run.

use protocol::signal::{Sample, Signal};
use protocol::{CYCLE, Instant};

use super::row::PAIRS;
use super::{Action, Done, Pair, Row};
use crate::drive::Landmark;
use crate::drive::landmarks::of_log;
use crate::procedure::UnitEvent;
use crate::rig::{PairEfforts, Rig, Truth};
use crate::tcms::PowerCuts;

/// Demands of TCMS on an MT pair: inverters, air of trailers, air of motor cars.
const DEMANDS: [[Signal; 3]; PAIRS] = [
    [Signal::Motor1, Signal::AirTrailer1, Signal::AirMotor1],
    [Signal::Motor2, Signal::AirTrailer2, Signal::AirMotor2],
    [Signal::Motor3, Signal::AirTrailer3, Signal::AirMotor3],
    [Signal::Motor4, Signal::AirTrailer4, Signal::AirMotor4],
];

/// Rows, steps done and logs so far.
#[derive(Debug, Default)]
pub(super) struct Recording {
    /// When the sequence began: rows are kept from here on.
    pub began: Option<Instant>,
    pub rows: Vec<Row>,
    pub done: Vec<Done>,
    /// Entries of both logs and when they were read.
    log: Vec<(Instant, UnitEvent)>,
}

impl Recording {
    /// One scan.
    pub fn scan(&mut self, now: Instant, truth: &Truth, lever: f64, rig: &mut Rig) {
        let read = rig.take_events().into_iter();
        self.log.extend(read.map(|event| (now, event)));
        let Some(began) = self.began else { return };
        if now.as_us().is_multiple_of(CYCLE.as_us()) {
            self.rows
                .push(row(now.since(began).as_secs(), truth, lever, rig));
        }
    }

    /// Notes that something was done.
    pub fn note(&mut self, now: Instant, line: usize, truth: &Truth, actions: Vec<Action>) {
        let Some(began) = self.began else { return };
        self.done.push(Done {
            line,
            t_s: now.since(began).as_secs(),
            x_m: truth.position_m,
            speed_kmh: truth.speed_mps.abs() * 3.6,
            actions,
        });
    }

    /// What was done, and what unit and TCMS logged, in order of time.
    pub fn landmarks(&self) -> Vec<Landmark> {
        let Some(began) = self.began else {
            return Vec::new();
        };
        let mut found: Vec<_> = self
            .done
            .iter()
            .map(|done| Landmark {
                t_s: done.t_s,
                x_m: done.x_m,
                what: done.what(),
            })
            .collect();
        let places = self.rows.iter().map(|row| (row.t_s, row.x_m));
        let places: Vec<_> = places.collect();
        found.extend(of_log(&self.log, began.as_secs(), &places));
        found.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        found
    }
}

fn row(t_s: f64, truth: &Truth, lever: f64, rig: &Rig) -> Row {
    let sample = rig.sample();
    let get = |signal| sample.get(signal).unwrap_or(f64::NAN);
    let given = rig.pair_efforts();
    Row {
        t_s,
        x_m: truth.position_m,
        speed_kmh: truth.speed_mps.abs() * 3.6,
        limit_kmh: get(Signal::Limit),
        accel_mps2: get(Signal::TrainAccel),
        jerk_mps3: get(Signal::TrainJerk),
        lever,
        value: get(Signal::TcmsValue),
        motor_demand_n: get(Signal::MotorDemand),
        brake_demand_n: get(Signal::BrakeDemand),
        traction_n: truth.traction_n,
        electric_n: truth.electric_brake_n,
        air_n: truth.air_brake_n,
        pairs: std::array::from_fn(|pair| of_pair(sample, DEMANDS[pair], &given[pair])),
        other_brakes: other_brakes(sample),
        sliding: truth.sliding,
    }
}

fn of_pair(sample: &Sample, signals: [Signal; 3], given: &PairEfforts) -> Pair {
    let [motor_demand_n, air_t_demand_n, air_m_demand_n] =
        signals.map(|signal| sample.get(signal).unwrap_or(f64::NAN));
    Pair {
        motor_demand_n,
        traction_n: given.traction_n,
        electric_n: given.electric_n,
        air_t_demand_n,
        air_t_n: given.air_trailers_n,
        air_m_demand_n,
        air_m_n: given.air_motors_n,
    }
}

/// Emergency, security or parking brake.
fn other_brakes(sample: &Sample) -> bool {
    let bits = sample.get(Signal::PowerCutCauses).unwrap_or(0.0) as u16;
    [
        PowerCuts::EMERGENCY,
        PowerCuts::SECURITY,
        PowerCuts::PARKING,
    ]
    .iter()
    .any(|cut| bits & cut.bits() != 0)
}
