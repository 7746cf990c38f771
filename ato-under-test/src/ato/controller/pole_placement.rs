//! Gains of the servo tracking controller from its closed-loop poles [S0 eq. 4 to 9].
//!
//! Plant (9): v' = A·v + B·u, A = e^(−rT), B = (1 − e^(−rT))/(M·r). Compensator (7): three
//! integrators of e = r − v. Law: u = −K·v + K_c·x_c. Its closed loop has the polynomial
//! (z − A + B·K)·(z − 1)³ + B·N(z), where N(z) = K_c·(zI − A_c)⁻¹·B_c·(z − 1)³ is linear in K_c, so
//! that comparing coefficients gives the gains without solving a system. (The printed coupling block of
//! eq. 4 lacks the minus sign of e = r − v.)

use protocol::CYCLE;

/// Gains of u = −K·v + K_c·x_c.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// K, N/(m/s).
    pub speed: f64,
    /// K_c for the triple, double and single integral of the error.
    pub integrals: [f64; 3],
}

/// Gains that place the closed-loop poles (real and imaginary parts, conjugates in pairs) for a train of
/// `mass_kg` with resistance `drag_per_s`, controlled every cycle.
pub fn place(poles: &[[f64; 2]; 4], mass_kg: f64, drag_per_s: f64) -> Gains {
    let t = CYCLE.as_secs();
    let decay = libm::exp(-drag_per_s * t);
    let input = if drag_per_s > 0.0 {
        (1.0 - decay) / (mass_kg * drag_per_s)
    } else {
        t / mass_kg
    };
    let [d0, d1, d2, d3] = polynomial(poles);
    // (z + c)·(z − 1)³ takes the cubic coefficient; the rest is B·N(z).
    let c = d3 + 3.0;
    let n2 = (d2 - (3.0 - 3.0 * c)) / input;
    let n1 = (d1 - (3.0 * c - 1.0)) / input;
    let n0 = (d0 + c) / input;
    // N(z) = k₁T³/6·(z² + 4z + 1) + k₂T²/2·(z² − 1) + k₃T·(z − 1)².
    let triple = (n0 + n1 + n2) / 6.0;
    let double = (n2 - n0) / 2.0;
    let single = (n2 + n0) / 2.0 - triple;
    Gains {
        speed: (c + decay) / input,
        integrals: [
            6.0 * triple / (t * t * t),
            2.0 * double / (t * t),
            single / t,
        ],
    }
}

/// Coefficients d₀ .. d₃ of the monic polynomial with these roots.
fn polynomial(roots: &[[f64; 2]; 4]) -> [f64; 4] {
    // Complex coefficients, highest power last; imaginary parts cancel between conjugates.
    let mut re = [0.0; 5];
    let mut im = [0.0; 5];
    re[0] = 1.0;
    for (degree, [a, b]) in roots.iter().enumerate() {
        for k in (0..=degree + 1).rev() {
            let (lower_re, lower_im) = if k > 0 {
                (re[k - 1], im[k - 1])
            } else {
                (0.0, 0.0)
            };
            let (here_re, here_im) = (re[k], im[k]);
            re[k] = lower_re - (a * here_re - b * here_im);
            im[k] = lower_im - (a * here_im + b * here_re);
        }
    }
    [re[0], re[1], re[2], re[3]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Poles as printed [S0 §3.1.2].
    const POLES: [[f64; 2]; 4] = [
        [0.6982, 0.0],
        [0.9682, 0.0],
        [0.92, 0.0332],
        [0.92, -0.0332],
    ];

    /// The four printed gains, to all five printed digits.
    #[test]
    fn the_printed_poles_give_the_printed_gains() {
        let gains = place(&POLES, 200_000.0, 0.001);
        let [triple, double, single] = gains.integrals;
        for (got, printed) in [
            (gains.speed, 1.9742e6),
            (triple, 2.3041e6),
            (double, 6.3462e6),
            (single, 5.4786e6),
        ] {
            assert!((got - printed).abs() <= 0.5e2, "{got} is not {printed}");
        }
    }

    /// Method: the closed loop's own recursion, from standstill to a target of 1 m/s: after 30 s the speed is the
    /// target, and it never rose above 1.6 m/s, for each mass.
    #[test]
    fn the_closed_loop_settles_for_any_mass() {
        for mass_kg in [200_000.0, 296_368.0, 456_368.0] {
            let gains = place(&POLES, mass_kg, 0.001);
            let (mut v, mut x) = (0.0f64, [0.0f64; 3]);
            let t = CYCLE.as_secs();
            let decay = libm::exp(-0.001 * t);
            let mut peak = 0.0f64;
            for _ in 0..600 {
                let u = -gains.speed * v
                    + gains
                        .integrals
                        .iter()
                        .zip(x)
                        .map(|(k, x)| k * x)
                        .sum::<f64>();
                let e = 1.0 - v;
                x = [
                    x[0] + t * x[1] + t * t / 2.0 * x[2] + t * t * t / 6.0 * e,
                    x[1] + t * x[2] + t * t / 2.0 * e,
                    x[2] + t * e,
                ];
                v = decay * v + (1.0 - decay) / (mass_kg * 0.001) * u;
                peak = peak.max(v);
            }
            assert!((v - 1.0).abs() < 1e-6, "{mass_kg} kg: {v}");
            assert!(peak < 1.6, "{mass_kg} kg: {peak}");
        }
    }

    #[test]
    fn without_resistance_the_limit_is_taken() {
        let with = place(&POLES, 200_000.0, 1e-9).speed;
        let without = place(&POLES, 200_000.0, 0.0).speed;
        assert!((with / without - 1.0).abs() < 1e-6);
    }
}
