//! A slave with the controller's outputs at hand, and a master that speaks to it by name.
#![allow(dead_code, reason = "each test program uses a part")]

use oleo_controller::{Builder, Corners, Gauge, Inputs, Outputs, StrutPressures};
use oleo_xcp::{Budget, Sample, Slave, measurement};

pub struct Pair {
    pub slave: Slave,
    pub inputs: Inputs,
    pub outputs: Outputs,
    pub tick: u32,
    pub writable: bool,
    /// Frames of measured data that came since they were looked at.
    pub data: Vec<Vec<u8>>,
}

impl Pair {
    pub fn new(slave: Slave) -> Self {
        let pressure = Corners::splat(StrutPressures::splat(Gauge(2.0e6)));
        Self {
            slave,
            inputs: Inputs::from_values(Corners::splat(0.01), pressure),
            outputs: Outputs::default(),
            tick: 0,
            writable: false,
            data: Vec::new(),
        }
    }

    pub fn connected() -> Self {
        let mut pair = Self::new(Slave::new(Builder::default(), Budget::at(500_000)));
        assert_eq!(pair.command(&[0xFF, 0]).unwrap()[0], 0xFF);
        pair
    }

    /// One tick; returns all that the slave sends.
    pub fn step(&mut self) -> Vec<Vec<u8>> {
        let sample = Sample {
            tick: self.tick,
            plant_tick: self.tick as u8,
            inputs: &self.inputs,
            outputs: &self.outputs,
            writable: self.writable,
        };
        self.tick += 1;
        let sent = self.slave.end_of_tick(&sample);
        sent.iter().map(|packet| packet.to_vec()).collect()
    }

    /// Sends a command and returns its answer.
    pub fn command(&mut self, bytes: &[u8]) -> Option<Vec<u8>> {
        self.slave.receive(bytes);
        let mut answer = None;
        for packet in self.step() {
            if packet[0] >= 0xFC {
                assert!(answer.replace(packet).is_none(), "one answer to one command");
            } else {
                self.data.push(packet);
            }
        }
        answer
    }

    /// The error code of a command that must be refused.
    pub fn refusal(&mut self, bytes: &[u8]) -> u8 {
        let answer = self.command(bytes).unwrap();
        assert_eq!(answer[0], 0xFE, "{bytes:02X?} was answered with {answer:02X?}");
        answer[1]
    }

    /// Sends a command that must succeed.
    pub fn ok(&mut self, bytes: &[u8]) -> Vec<u8> {
        let answer = self.command(bytes).unwrap();
        assert_eq!(answer[0], 0xFF, "{bytes:02X?} was answered with {answer:02X?}");
        answer
    }

    pub fn upload(&mut self, address: u32, count: u8) -> Vec<u8> {
        let [a, b, c, d] = address.to_le_bytes();
        self.ok(&[0xF4, count, 0, 0, a, b, c, d])[1..].to_vec()
    }

    /// Allocates and writes one list, with an ODT for each row of (address, bytes), and selects it.
    pub fn select_list(&mut self, odts: &[&[(u32, u8)]], stamped: bool, prescaler: u8) {
        self.ok(&[0xD6]);
        self.ok(&[0xD5, 0, 1, 0]);
        self.ok(&[0xD4, 0, 0, 0, odts.len() as u8]);
        for (odt, entries) in (0..).zip(odts) {
            self.ok(&[0xD3, 0, 0, 0, odt, entries.len() as u8]);
        }
        for (odt, entries) in (0..).zip(odts) {
            self.ok(&[0xE2, 0, 0, 0, odt, 0]);
            for (address, bytes) in *entries {
                let [a, b, c, d] = address.to_le_bytes();
                self.ok(&[0xE1, 0xFF, *bytes, 0, a, b, c, d]);
            }
        }
        self.ok(&[0xE0, if stamped { 0x10 } else { 0 }, 0, 0, 0, 0, prescaler, 0]);
        self.ok(&[0xDE, 2, 0, 0]);
    }
}

pub fn address_of(name: &str) -> u32 {
    measurement::quantities()
        .find(|quantity| quantity.name == name)
        .unwrap()
        .address
}
