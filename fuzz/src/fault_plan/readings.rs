//! What a faulty sensor says instead of the truth.

use std::collections::VecDeque;

use oleo_controller::{Corner, Inputs, Reading};

use super::plan::{Event, What};

/// What a sensor fault remembers of the ticks before.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    held: Option<Reading>,
    past: VecDeque<Reading>,
}

/// Pressures are this much larger than displacements, in SI units: 4 MPa to 80 mm.
const PA_PER_M: f32 = 5.0e7;

/// Changes the readings of a tick as the event does that has been present for `since` ticks.
pub fn spoil(event: &Event, since: u32, memory: &mut Memory, inputs: &mut Inputs) {
    if since == 0 {
        *memory = Memory::default();
    }
    if event.what == What::Swapped {
        let other = Corner::ALL[(event.corner.index() + 1 + usize::from(event.size) % 3) % 4];
        let mine = *reading(inputs, event, event.corner);
        let theirs = core::mem::replace(reading(inputs, event, other), mine);
        *reading(inputs, event, event.corner) = theirs;
        return;
    }
    let unit = if event.point.is_some() { PA_PER_M } else { 1.0 };
    // Up to 0.127 m or 6.4 MPa, both ways.
    let offset = f32::from(event.size as i8) * 1.0e-3 * unit;
    let alternating = if since.is_multiple_of(2) { 1.0 } else { -1.0 };
    let reading = reading(inputs, event, event.corner);
    let Some(value) = reading.value() else { return };
    let held = memory.held.get_or_insert(*reading).value().unwrap_or(value);
    *reading = match event.what {
        What::Missing => Reading::INVALID,
        What::OutOfRange => Reading::new(unit * if offset < 0.0 { -0.3 } else { 0.75 }),
        What::Jumping => Reading::new(value + alternating * offset),
        What::Noisy => Reading::new(value + 0.1 * offset * noise(since, event.size)),
        What::Stuck => Reading::new(held),
        What::StuckWithNoise => Reading::new(held + 2.0e-4 * unit * noise(since, event.size)),
        What::Offset => Reading::new(value + offset),
        What::Drift => Reading::new(value + 5.0e-4 * offset * since as f32),
        What::Gain => Reading::new(value * f32::from(event.size) / 64.0),
        What::Reversed => Reading::new(-value),
        What::Delayed => {
            memory.past.push_back(*reading);
            let late = memory.past.len() > usize::from(event.size);
            let first = memory.past.front().copied();
            if late {
                memory.past.pop_front();
            }
            first.unwrap_or(*reading)
        }
        _ => return,
    };
}

/// The reading of an event at a corner.
fn reading<'a>(inputs: &'a mut Inputs, event: &Event, corner: Corner) -> &'a mut Reading {
    match event.point {
        Some(point) => &mut inputs.pressure[corner][point],
        None => &mut inputs.displacement[corner],
    }
}

/// Between -1 and 1, and for each seed another one.
fn noise(n: u32, seed: u8) -> f32 {
    // The finaliser of MurmurHash3 (Appleby, public domain).
    let mut bits = n ^ u32::from(seed) << 24;
    bits = (bits ^ bits >> 16).wrapping_mul(0x85EB_CA6B);
    bits = (bits ^ bits >> 13).wrapping_mul(0xC2B2_AE35);
    (bits ^ bits >> 16) as i32 as f32 / 2_147_483_648.0
}
