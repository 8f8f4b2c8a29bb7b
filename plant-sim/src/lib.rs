//! `oleo-plant-sim`

pub mod measures;
pub mod road;
pub mod strut;
pub mod vehicle;
