//! Counts every frame that passes and, if wanted, keeps it. Logs, bus load and modes are computed from the trace later.
//!
//! In the loop an entry costs a copy of some 32 bytes. Frames of [`crate::sync`] are left out, because they would not be on a vehicle's
//! bus. Messages of the vehicle's database and other frames are counted separately, so that two ends can compare what was sent with
//! what arrived. What an inertial unit sends is counted for itself, because the other end does not listen to it.

use std::time::{Duration, Instant};

use oleo_controller::can::MESSAGES;

use super::{Bus, BusCounters, BusError};
use crate::{Frame, imu, sync};

/// Direction of a frame, seen from the end that keeps the trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The frame was sent by this node.
    Sent,
    /// The frame was received by this node.
    Received,
}

/// One frame on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceEntry {
    /// Tick during which the frame passed.
    pub tick: u32,
    /// Time since the start in a run in real time, microseconds; 0 in lockstep.
    pub wall_us: u32,
    /// Direction of the frame.
    pub direction: Direction,
    /// The frame that was sent.
    pub frame: Frame,
}

/// A decorator that keeps [`TraceEntry`]s.
#[derive(Debug)]
pub struct Trace<B> {
    inner: B,
    tick: u32,
    started: Option<Instant>,
    entries: Option<Vec<TraceEntry>>,
    sent: u64,
    received: u64,
    of_unit: u64,
    foreign: u64,
}

impl<B: Bus> Trace<B> {
    /// Wraps `inner`, with memory for `capacity` frames. With `wall_clock` the entries carry the time since this call.
    pub fn new(inner: B, capacity: usize, wall_clock: bool) -> Self {
        let started = wall_clock.then(Instant::now);
        Self {
            started,
            entries: Some(Vec::with_capacity(capacity)),
            ..Self::counting(inner)
        }
    }

    /// Wraps `inner` and only counts.
    pub fn counting(inner: B) -> Self {
        Self {
            inner,
            tick: 0,
            started: None,
            entries: None,
            sent: 0,
            received: 0,
            of_unit: 0,
            foreign: 0,
        }
    }

    /// Number of messages of the database that this end sent.
    pub fn messages_sent(&self) -> u64 {
        self.sent
    }

    /// Number of messages of the database that arrived at this end.
    pub fn messages_received(&self) -> u64 {
        self.received
    }

    /// Number of messages of an inertial unit that this end sent.
    pub fn unit_messages_sent(&self) -> u64 {
        self.of_unit
    }

    /// Number of frames with other identifiers that passed.
    pub fn foreign(&self) -> u64 {
        self.foreign
    }

    /// The frames that have passed so far, in order.
    pub fn entries(&self) -> &[TraceEntry] {
        self.entries.as_deref().unwrap_or(&[])
    }

    /// Takes the entries out of the trace.
    pub fn take_entries(&mut self) -> Vec<TraceEntry> {
        self.entries.take().unwrap_or_default()
    }

    fn note(&mut self, direction: Direction, frame: &Frame) {
        if sync::is_sync(frame) {
            return;
        }
        let known = frame
            .standard_id()
            .is_some_and(|id| MESSAGES.iter().any(|message| message.id == id));
        match (known, direction) {
            (true, Direction::Sent) => self.sent += 1,
            (true, Direction::Received) => self.received += 1,
            (false, Direction::Sent) if imu::of_unit(frame.standard_id()).is_some() => self.of_unit += 1,
            (false, _) => self.foreign += 1,
        }
        if let Some(entries) = &mut self.entries {
            let wall_us = self.started.map_or(0, |start| start.elapsed().as_micros() as u32);
            entries.push(TraceEntry {
                tick: self.tick,
                wall_us,
                direction,
                frame: *frame,
            });
        }
    }
}

impl<B: Bus> Bus for Trace<B> {
    fn begin_tick(&mut self, tick: u32) {
        self.tick = tick;
        self.inner.begin_tick(tick);
    }

    fn send(&mut self, frame: &Frame) -> Result<(), BusError> {
        self.inner.send(frame)?;
        self.note(Direction::Sent, frame);
        Ok(())
    }

    fn offer(&mut self, frame: &Frame) -> Result<bool, BusError> {
        let sent = self.inner.offer(frame)?;
        if sent {
            self.note(Direction::Sent, frame);
        }
        Ok(sent)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<Frame>, BusError> {
        let frame = self.inner.receive(wait)?;
        if let Some(frame) = &frame {
            self.note(Direction::Received, frame);
        }
        Ok(frame)
    }

    fn counters(&self) -> BusCounters {
        self.inner.counters()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::in_process_pair;
    use crate::frame::standard;

    #[test]
    fn both_directions_are_kept_with_their_tick_and_sync_frames_are_not() {
        let (a, mut b) = in_process_pair();
        let mut a = Trace::new(a, 4, false);
        let frame = Frame::whole(standard(0x110), [7; 8]);
        a.begin_tick(3);
        a.send(&frame).unwrap();
        let end = sync::Sync::End { sent: 0 }.encode(sync::Role::Plant, sync::Session::default());
        a.send(&end).unwrap();
        b.send(&frame).unwrap();
        a.begin_tick(4);
        assert_eq!(a.receive(Duration::ZERO).unwrap(), Some(frame));
        let seen: Vec<_> = a.entries().iter().map(|e| (e.tick, e.direction)).collect();
        assert_eq!(seen, [(3, Direction::Sent), (4, Direction::Received)]);
        b.send(&Frame::whole(standard(0x7DF), [0; 8])).unwrap();
        a.receive(Duration::ZERO).unwrap();
        assert_eq!((a.messages_sent(), a.messages_received(), a.foreign()), (1, 1, 1));
    }
}
