//! `oleo-plant-sim`
