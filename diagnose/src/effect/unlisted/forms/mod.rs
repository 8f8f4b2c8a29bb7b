//! Forms of laws: how a table comes from a few fitted numbers, one file for each.
//!
//! | form | its value | fitted |
//! |---|---|---|
//! | `added` | is added; zero at rest | rises from knot to knot, of any sign |
//! | `rising` | is added and never falls with its argument | rises from knot to knot, none negative |
//! | `level` | is added and never negative | the value at each knot |
//! | `factor` | multiplies what is believed; one at rest | logarithmic rises from knot to knot |
//! | `bell` | is added around one argument | height, position, half width |
//! | `groove` | is added over a stretch of its argument and runs out at the ends | depth, position, half width, length of the ends |
//! | `ramp` | is added, grows at a constant rate and then stays | its value after a minute, duration of the growth |
//! | `onset` | is added or multiplies, as believed until a moment, and stays after a while of change | its value in the end, the moment, duration of the change |
//! | `parabola` | is added, a polynomial of second degree, of any sign or never negative | its three coefficients |
//! | `power` | is added and follows a power of its argument | its value at the largest argument, exponent |
//! | `proportional` | is added and is proportional to its argument | the value at an argument of one |
//! | `redlich_kwong` | is the compressibility factor of a gas over its density | volume of the molecules, their attraction |
//! | `remembering` | is added or multiplies, and follows an energy that is held or a recent change | its size, time constant of the memory |
//! | `relaxing` | multiplies, and follows what has changed lately | its exponent, time constant of the memory |
//! | `saturating` | is added, rises and comes to an end | its end, the argument where half of it is reached |
//! | `settling` | is added or multiplies, and settles with time | its end, time constant |
//! | `shearing` | is added and never negative, a power of its argument that is reached over a volume of oil | its level, exponent, volume |
//! | `stiffening` | is added, a force that grows with the displacement and its third power | stiffness, stiffening |
//! | `stops` | is added beyond a threshold in either direction | sizes, thresholds, exponent |
//! | `swinging` | is added or multiplies, and swings about what is believed | amplitude, phase, frequency |
//! | `choke` | multiplies a flow over the root of the drop, which approaches a largest flow | inverse argument, sharpness of the bend |
//! | `threshold` | is added beyond a threshold of its argument, in proportion to what is beyond it | its rise, the threshold |
//! | `with_memory`, `with_presliding` | is one of the tables above | the numbers of the table, a time constant or a volume |
//! | `pulled_shut` | multiplies what is believed, and falls with the size of its argument | inverse argument, exponent |

mod added;
mod bell;
mod choke;
mod factor;
mod form;
mod groove;
mod level;
mod onset;
mod parabola;
mod power;
mod proportional;
mod pulled_shut;
mod ramp;
mod redlich_kwong;
mod relaxing;
mod remembering;
mod rises;
mod rising;
mod saturating;
mod settling;
mod shearing;
mod stiffening;
mod stops;
mod swinging;
mod threshold;
mod with_memory;
mod with_presliding;

#[cfg(test)]
mod tests;

pub use added::Added;
pub use bell::Bell;
pub use choke::Choke;
pub use factor::Factor;
pub use form::{ClosedForm, Form, Grid};
pub use groove::Groove;
pub use level::Level;
pub use onset::Onset;
pub use parabola::{LevelParabola, Parabola};
pub use power::Power;
pub use proportional::{Proportional, ProportionalAmount};
pub use pulled_shut::PulledShut;
pub use ramp::Ramp;
pub use redlich_kwong::RedlichKwong;
pub use relaxing::Relaxing;
pub use remembering::{Fading, Heated, Lingering};
pub use rises::is_of_free_table;
pub use rising::Rising;
pub use saturating::Saturating;
pub use settling::{SettlingAdded, SettlingFactor, SettlingLevel};
pub use shearing::Shearing;
pub use stiffening::Stiffening;
pub use stops::Stops;
pub use swinging::{SwingingAdded, SwingingFactor};
pub use threshold::Threshold;
pub use with_memory::WithMemory;
pub use with_presliding::WithPresliding;
