//! The train as a point mass: dv/dt = −r·v + u/M [S0 eq. 8], with gradient, curve and starting
//! resistance. A fuller train can take this one's place behind [`Train::step`].
//!
//! Efforts are accelerations of the whole inertial mass: load compensation keeps them the same
//! from empty to full (S3), so the mass matters only for what gravity does.

use super::motion::Piece;

/// One kilogram-force per tonne, m/s² (N/kg).
const KGF_PER_T: f64 = 9.80665e-3;

/// Brake effort that counts as applied, m/s² [default].
const BRAKING_MPS2: f64 = 0.02;

/// Data of the train.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainConfig {
    /// Empty mass, kg [S3: 268 807].
    pub empty_kg: f64,
    /// Rotating parts as mass, kg [S3: 296 368 − 268 807].
    pub rotating_kg: f64,
    /// Greatest passenger load, kg [S3: 160 000].
    pub full_load_kg: f64,
    /// Acceleration at full effort before resistance, m/s² [S3: 397.8 kN / 456.368 t].
    pub power_mps2: f64,
    /// Speed up to which full effort is there, m/s; constant power beyond [S3: 40 km/h].
    pub base_speed_mps: f64,
    /// Full service brake, m/s² [S3, S4: 3.5 km/h/s].
    pub service_mps2: f64,
    /// Emergency brake, m/s² [Korean standard EMU: 4.5 km/h/s].
    pub emergency_mps2: f64,
    /// Holding brake, share of full service [S4: 70 %].
    pub holding_share: f64,
    /// Jerk limit of powering and service braking, m/s³ [S1: 0.8].
    pub jerk_mps3: f64,
    /// Jerk while the emergency brake builds up, m/s³ [default].
    pub emergency_jerk_mps3: f64,
    /// Time constant of every effort, s [default].
    pub lag_s: f64,
    /// Speed-proportional resistance, 1/s [S0: r = 0.001].
    pub drag_per_s: f64,
    /// Resistance when starting, kgf/t [Korean rolling-stock engineer exam: 4.0].
    pub starting_kgf_t: f64,
    /// Speed up to which it counts, m/s [the same: 3 km/h].
    pub starting_mps: f64,
    /// Resistance in a double-track tunnel, kgf/t [Korean traction notes: 1].
    pub tunnel_kgf_t: f64,
    /// Curve resistance times radius, kgf·m/t [Korean traction notes: 700/R].
    pub curve_kgf_m_t: f64,
}

impl Default for TrainConfig {
    /// The eight-car line 6 train.
    fn default() -> Self {
        Self {
            empty_kg: 268_807.0,
            rotating_kg: 27_561.0,
            full_load_kg: 160_000.0,
            power_mps2: 397.8 / 456.368,
            base_speed_mps: 40.0 / 3.6,
            service_mps2: 3.5 / 3.6,
            emergency_mps2: 4.5 / 3.6,
            holding_share: 0.7,
            jerk_mps3: 0.8,
            emergency_jerk_mps3: 3.0,
            lag_s: 0.2,
            drag_per_s: 0.001,
            starting_kgf_t: 4.0,
            starting_mps: 3.0 / 3.6,
            tunnel_kgf_t: 1.0,
            curve_kgf_m_t: 700.0,
        }
    }
}

/// What acts on the train.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainInputs {
    /// Share of full effort, −1 full service brake .. 1 full power.
    pub demand: f64,
    /// Full service brake, whatever the demand.
    pub full_service: bool,
    /// Emergency brake; no power and no electric brake while it is on (S3).
    pub emergency: bool,
    /// Holding brake.
    pub holding: bool,
    /// No power.
    pub power_cut: bool,
    /// The reverser points backward.
    pub backward: bool,
    /// Passengers, kg.
    pub load_kg: f64,
    /// Gradient, ‰, uphill positive.
    pub gradient_permille: f64,
    /// Curve radius, m; 0 = straight.
    pub curve_radius_m: f64,
}

/// What the train did in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrainState {
    /// Its motion: moving, and standing for the rest if it came to a stop.
    pub pieces: [Piece; 2],
    /// A brake is on.
    pub braking: bool,
}

/// An effort that follows its demand with lag and jerk limit.
#[derive(Clone, Copy, Debug, Default)]
struct Effort {
    mps2: f64,
}

impl Effort {
    fn follow(&mut self, demand_mps2: f64, lag_s: f64, jerk_mps3: f64, dt_s: f64) {
        let change = (demand_mps2 - self.mps2) * (dt_s / lag_s).min(1.0);
        self.mps2 += change.clamp(-jerk_mps3 * dt_s, jerk_mps3 * dt_s);
    }
}

/// The train.
#[derive(Debug, Default)]
pub struct Train {
    config: TrainConfig,
    velocity_mps: f64,
    /// Powering above 0, service braking below.
    service: Effort,
    emergency: Effort,
}

impl Train {
    /// Puts the train at a speed, m/s, forward positive, with no effort.
    pub fn set_velocity(&mut self, velocity_mps: f64) {
        self.velocity_mps = velocity_mps;
        self.service = Effort::default();
        self.emergency = Effort::default();
    }

    /// Its data.
    pub fn config(&self) -> &TrainConfig {
        &self.config
    }

    /// One step of at most 5 ms.
    pub fn step(&mut self, dt_s: f64, inputs: &TrainInputs) -> TrainState {
        self.follow_demands(dt_s, inputs);
        let drive = self.drive_mps2(inputs);
        let resistance = self.resistance_mps2(inputs);
        let brake = (-self.service.mps2).max(self.emergency.mps2).max(0.0);
        // Brakes and resistance oppose motion; at rest they hold as far as they reach.
        let direction = match self.velocity_mps {
            v if v != 0.0 => v.signum(),
            _ if drive.abs() <= brake + resistance => 0.0,
            _ => drive.signum(),
        };
        let accel_mps2 = if direction == 0.0 {
            0.0
        } else {
            drive - direction * (brake + resistance)
        };
        let speed_mps = self.velocity_mps;
        let end = speed_mps + accel_mps2 * dt_s;
        let stops = speed_mps != 0.0 && end * speed_mps <= 0.0;
        let seconds = if stops { -speed_mps / accel_mps2 } else { dt_s };
        self.velocity_mps = if stops { 0.0 } else { end };
        let rest = Piece {
            seconds: dt_s - seconds,
            ..Piece::default()
        };
        TrainState {
            pieces: [
                Piece {
                    seconds,
                    speed_mps,
                    accel_mps2,
                },
                rest,
            ],
            braking: brake > BRAKING_MPS2,
        }
    }

    fn follow_demands(&mut self, dt_s: f64, inputs: &TrainInputs) {
        let c = &self.config;
        let mut share = inputs.demand.clamp(-1.0, 1.0);
        if inputs.power_cut || inputs.emergency {
            share = share.min(0.0);
        }
        if inputs.holding {
            share = share.min(-c.holding_share);
        }
        if inputs.full_service {
            share = -1.0;
        }
        let service = if share < 0.0 {
            share * c.service_mps2
        } else {
            let fade = c.base_speed_mps / self.velocity_mps.abs().max(c.base_speed_mps);
            share * c.power_mps2 * fade
        };
        self.service.follow(service, c.lag_s, c.jerk_mps3, dt_s);
        let emergency = if inputs.emergency {
            c.emergency_mps2
        } else {
            0.0
        };
        self.emergency
            .follow(emergency, c.lag_s, c.emergency_jerk_mps3, dt_s);
    }

    /// Traction and gravity, forward positive.
    fn drive_mps2(&self, inputs: &TrainInputs) -> f64 {
        let traction = self.service.mps2.max(0.0);
        let traction = if inputs.backward { -traction } else { traction };
        // 1 ‰ is 1 kgf/t.
        traction - inputs.gradient_permille * KGF_PER_T * self.weight_share(inputs)
    }

    /// Everything but brakes that opposes motion.
    fn resistance_mps2(&self, inputs: &TrainInputs) -> f64 {
        let c = &self.config;
        let speed = self.velocity_mps.abs();
        let mut kgf_t = c.tunnel_kgf_t;
        if speed < c.starting_mps {
            kgf_t = kgf_t.max(c.starting_kgf_t);
        }
        if inputs.curve_radius_m > 0.0 {
            kgf_t += c.curve_kgf_m_t / inputs.curve_radius_m;
        }
        c.drag_per_s * speed + kgf_t * KGF_PER_T * self.weight_share(inputs)
    }

    /// Mass that weighs over mass that must be accelerated.
    fn weight_share(&self, inputs: &TrainInputs) -> f64 {
        let mass = self.config.empty_kg + inputs.load_kg;
        mass / (mass + self.config.rotating_kg)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.005;

    /// Runs until `done` and gives time, distance and the greatest size of acceleration.
    fn run(train: &mut Train, inputs: &TrainInputs, done: impl Fn(f64) -> bool) -> (f64, f64, f64) {
        let (mut time, mut way, mut peak) = (0.0, 0.0, 0.0f64);
        while !done(train.velocity_mps) && time < 300.0 {
            let state = train.step(DT, inputs);
            time += DT;
            way += state.pieces.iter().map(Piece::distance_m).sum::<f64>();
            peak = peak.max(state.pieces[0].accel_mps2.abs());
        }
        (time, way, peak)
    }

    /// P4 to 35 km/h at about 3.0 km/h/s [S1, S3]: 11.7 s and the 1.1 s the jerk limit costs.
    #[test]
    fn full_power_accelerates_as_printed() {
        let mut train = Train::default();
        let inputs = TrainInputs {
            demand: 1.0,
            ..TrainInputs::default()
        };
        let (time, _, peak) = run(&mut train, &inputs, |v| v >= 35.0 / 3.6);
        assert!((11.7..13.2).contains(&time), "{time}");
        assert!((2.9..3.15).contains(&(peak * 3.6)), "{}", peak * 3.6);
    }

    /// From 60 km/h: v²/2a plus about half the build-up time at speed.
    #[test]
    fn brakes_stop_within_their_distances_and_stay() {
        let service = TrainInputs {
            demand: -1.0,
            ..TrainInputs::default()
        };
        let emergency = TrainInputs {
            emergency: true,
            demand: 1.0,
            ..TrainInputs::default()
        };
        for (inputs, low_m, high_m) in [(service, 140.0, 160.0), (emergency, 105.0, 120.0)] {
            let mut train = Train::default();
            train.set_velocity(60.0 / 3.6);
            let (_, way, _) = run(&mut train, &inputs, |v| v <= 0.0);
            assert!((low_m..high_m).contains(&way), "{way}");
            let downhill = TrainInputs {
                gradient_permille: -35.0,
                ..inputs
            };
            for _ in 0..1000 {
                train.step(DT, &downhill);
                assert_eq!(train.velocity_mps, 0.0);
            }
        }
    }

    #[test]
    fn without_brakes_it_rolls_back_on_a_ruling_gradient() {
        let mut train = Train::default();
        let uphill = TrainInputs {
            gradient_permille: 35.0,
            ..TrainInputs::default()
        };
        let (_, way, _) = run(&mut train, &uphill, |v| v < -0.5);
        assert!(way < 0.0);
        let held = TrainInputs {
            holding: true,
            ..uphill
        };
        run(&mut train, &held, |v| v >= 0.0);
        assert_eq!(train.velocity_mps, 0.0);
    }
}
