//! `oleo-diagnose`
