//! `oleo-report`
