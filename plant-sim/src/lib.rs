//! `oleo-plant-sim`

pub mod course;
pub mod handling;
pub mod measures;
pub mod rig;
pub mod road;
pub mod specimen;
pub mod strut;
pub mod strut_first;
pub mod study;
pub mod vehicle;
