//! Smoothing of a recorded displacement that is used as an input: it removes the noise and keeps the corners.
//!
//! Displacement is measured too. Differentiated as it is, 5 um of noise at 500 Hz is 3.5 mm/s, which a damper turns into
//! 10 to 25 kPa: three to six times the pressure sensors' noise. A low-pass would round the corners of sawtooth and
//! trapezoid moves, where the speed jumps. So each sample gets a polynomial through the widest neighbourhood that the
//! stated noise can explain (local polynomial regression, Fan & Gijbels 1996; width by a chi-square test of the fit). Where
//! no neighbourhood that reaches to both sides passes, the speed jumps: the sample keeps one speed from its left and one
//! from its right. Stretches without motion are made exactly still.
//!
//! | file | what it holds |
//! |---|---|
//! | `local_fit` | polynomials over a neighbourhood, and how wide it may be |
//! | `projection` | orthonormal polynomials, and what samples are made of them |
//! | `chi_square` | how much noise alone can leave |
//! | `holds` | stretches without motion, and how moves begin and end at them |
//! | `noise` | the noise of the samples |
//! | `samples` | what is known of each sample so far |
//! | `smooth` | the smoothed motion |
//! | `free_motion` | the smoothed motion of a strut in a vehicle |

mod chi_square;
mod free_motion;
mod holds;
mod local_fit;
mod noise;
mod projection;
mod samples;
mod smooth;

pub use free_motion::{FreeMotion, smooth_free_motion};
pub use smooth::{smooth_displacement, smooth_uneven_displacement};
