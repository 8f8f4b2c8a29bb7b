//! What to record when two effects cannot be told apart: the excitation in which they differ most.

use crate::specimen::Candidate;

/// One sentence: amplitude, speed, valve state.
#[must_use]
pub fn separate(a: &Candidate, b: &Candidate) -> String {
    let is = |x: &str, y: &str| (a.id == x && b.id == y) || (a.id == y && b.id == x);
    let any = |x: &str| a.id == x || b.id == x;
    let how = if is("oil_compressibility", "mount_compliance") {
        "sine of 5 mm at 0.5 m/s with all valves closed, once at the static position and once held at 60 mm of jounce: \
         the mount stays as stiff, the oil column shortens"
    } else if is("oil_compressibility", "entrained_air") {
        "slow sawtooth from -80 mm to 60 mm, valve 3 closed: air shows below 1 MPa only"
    } else if is("seal_friction", "side_load_friction") {
        "the same slow triangle of 10 mm at 5 mm/s about -60, 0 and 60 mm: side-load friction follows the force, the seal's does not"
    } else if is("seal_friction", "accumulator_piston_friction") {
        "triangle of 10 mm at 5 mm/s with p1 and p2 recorded: the seal's hysteresis is in the force only, the piston's between p1 and p2"
    } else if is("gas_heat_transfer", "sensor_skew") {
        "a step of 50 mm within 0.2 s held for 30 s, valves open: heat relaxes over seconds, a late sensor does not"
    } else if is("real_gas", "gas_charge_error") {
        "slow sawtooth over the whole travel with valve 3 closed, up to 12 MPa: the real gas departs with pressure, the charge does not"
    } else if a.place == "main-seal" && b.place == "main-seal" {
        "strokes of full travel at a tenth and at ten times the speed, each at the lowest and the highest pressure: viscous \
         friction follows the speed, a seal's does not, and what grows with pressure does so at every speed"
    } else if any("line_resistance") || any("damper_leakage") || any("damping_fade") {
        "sines of 25 mm at 0.05, 0.2 and 0.8 m/s, valves 1 and 2 closed, each for 60 s: leakage shows at low, resistance at high speed, fade over time"
    } else if any("valve_transition") || any("valve_delay") {
        "valve steps at pressure differences of 0.2, 2 and 6 MPa, sampled at 1 kHz or faster"
    } else if any("sensor_lag") || any("sensor_skew") || any("sensor_gain") {
        "the two columns on one calibrated reference: a ramp of 0.5 m/s for the time, three held levels for the gain"
    } else {
        "slow (5 mm/s) and fast (0.5 m/s) triangles of 20 and 80 mm in all four states of valves 1 and 3"
    };
    format!("To separate {} from {}: {how}.", a.name(), b.name())
}
