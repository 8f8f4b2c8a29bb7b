//! The suspension controller.
#![no_std]
