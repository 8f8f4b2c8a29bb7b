//! `oleo-hil`
