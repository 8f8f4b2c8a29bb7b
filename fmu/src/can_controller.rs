//! The controller as a node on CAN: frames in, frames out, a tick of 5 ms. It is the firmware's node, port and protection, behind a terminal of FMI-LS-BUS.
//!
//! ```text
//!   time      0          5 ms        10 ms
//!   tick                 1           2              tick k decides at the end of the step that reaches k times 5 ms, from the frames that came before;
//!   Rx_Data   |-- frames -->|-- frames -->|         its frames are in Tx_Data when that step returns
//! ```
//!
//! A tool may take any step. One that is longer than a tick hides the frames of several ticks from the bus until it returns, so a tool takes steps of at most
//! 5 ms, and shorter ones to deliver frames when they arrive.

use oleo_controller::{Configuration, Node, Outputs, Port, VehicleDescription};
use oleo_interface::tick::TICK_S;
use serde::{Deserialize, Serialize};

use crate::complaint::Complaint;
use crate::controller_parameters;
use crate::decision;
use crate::definition::Definition;
use crate::ls_bus::operation::ArbitrationLost;
use crate::ls_bus::terminal::{NOTIFICATIONS, Terminal};
use crate::ls_bus::transceiver::Transceiver;
use crate::model::{Model, Network, is_on};
use crate::variable::{Role, Variable, Word};

/// The bit rate that the controller's database is made for, bit/s.
const BIT_RATE: u32 = oleo_controller::can::bus_load::BIT_RATES[0];
/// How far the time may be from a tick, as a fraction of it: what adding up of steps in doubles can make of it.
const TICK_TOLERANCE: f64 = 1e-6;

const CAN: Terminal = Terminal {
    name: "CanChannel",
    rx_data: 1,
};
const NOTIFIED: usize = CAN.rx_data + Terminal::SIZE;
const FIRST_DECISION: usize = NOTIFIED + 1;
const FIRST_OF_BUS: usize = FIRST_DECISION + decision::SIZE;
/// Outputs of the peripheral.
const OF_BUS: usize = 5;
const BEHAVIOUR: usize = FIRST_OF_BUS + OF_BUS;
const FIRST_PARAMETER: usize = BEHAVIOUR + 1;

/// The words of [`NodeStatus`](crate::ls_bus::operation::NodeStatus), in the order of their numbers less one.
const STATUSES: [Word; 3] = [
    ("error-active", "few errors"),
    ("error-passive", "many errors"),
    ("bus-off", "too many errors of own frames; nothing is sent"),
];
/// The words of [`ArbitrationLost`].
const BEHAVIOURS: [Word; 2] = [
    (
        "buffer-and-retransmit",
        "the bus keeps a frame that has lost its arbitration",
    ),
    (
        "discard-and-notify",
        "the bus drops it and says so, and the node sends it again",
    ),
];

/// The definition of the FMU of the controller on CAN, and the node behind it.
pub fn can_controller(vehicle: VehicleDescription) -> (Definition, CanController) {
    let mut variables = vec![Variable::time()];
    variables.extend(CAN.variables());
    variables.push(Variable::switch(
        NOTIFICATIONS,
        Role::Structural,
        "the bus confirms frames and tells of errors and lost arbitration",
    ));
    variables.extend(decision::variables());
    variables.extend([
        Variable::word(
            "can_status",
            "CanStatus",
            &STATUSES,
            Role::Output,
            0,
            "state of the node on the bus",
        ),
        Variable::output(
            "transmit_errors",
            "",
            "transmit error counter of the node, 0 unless the bus tells of errors",
        ),
        Variable::output(
            "receive_errors",
            "",
            "receive error counter of the node, 0 unless the bus tells of errors",
        ),
        Variable::output("format_errors", "", "number of bus operations that could not be read"),
        Variable::output(
            "frames_dropped",
            "",
            "number of frames that the bus did not take in time, of which the oldest are dropped",
        ),
    ]);
    debug_assert_eq!(variables.len(), BEHAVIOUR);
    variables.push(Variable::word(
        "arbitration_lost",
        "ArbitrationLost",
        &BEHAVIOURS,
        Role::Fixed,
        0,
        "what the node asks the bus to do with a frame that has lost its arbitration",
    ));
    variables.extend(controller_parameters::variables(vehicle));
    let definition = Definition {
        identifier: "oleo_can_controller",
        description: "Controller of four two-stage hydropneumatic struts as a node on CAN (FMI-LS-BUS 1.0)".to_owned(),
        variables,
        tick_s: None,
        step_s: TICK_S,
        stop_s: 10.0,
        terminal: Some(CAN),
    };
    (definition, CanController { running: None })
}

/// A node behind a table of values.
pub struct CanController {
    running: Option<Running>,
}

#[derive(Serialize, Deserialize)]
struct Running {
    port: Port<Transceiver>,
    /// Time since the begin, s, and the ticks that were made in it.
    elapsed_s: f64,
    ticks: u64,
    /// What the last tick decided. After going back to a state it is in the table of values only, until the next tick.
    #[serde(skip)]
    decided: Option<Outputs>,
}

fn configuration(values: &[f64]) -> Result<Configuration, Complaint> {
    controller_parameters::configuration(&values[FIRST_PARAMETER..])
}

impl Model for CanController {
    fn begin(&mut self, values: &[f64]) -> Result<(), Complaint> {
        let behaviour = match values[BEHAVIOUR] as usize {
            0 => ArbitrationLost::BufferAndRetransmit,
            _ => ArbitrationLost::DiscardAndNotify,
        };
        let transceiver = Transceiver::new(BIT_RATE, behaviour, is_on(values[NOTIFIED]));
        self.running = Some(Running {
            port: Port::new(transceiver, Node::new(configuration(values)?)),
            elapsed_s: 0.0,
            ticks: 0,
            decided: Some(Outputs::default()),
        });
        Ok(())
    }

    fn step(&mut self, _: &[f64], duration_s: f64) -> Result<(), Complaint> {
        let running = self.running.as_mut().ok_or_else(not_begun)?;
        running.elapsed_s += duration_s;
        let due = (running.elapsed_s / TICK_S + TICK_TOLERANCE) as u64;
        while running.ticks < due {
            running.decided = Some(running.port.tick());
            running.ticks += 1;
        }
        Ok(())
    }

    fn outputs(&self, values: &mut [f64]) {
        let Some(Running { port, decided, .. }) = &self.running else {
            return;
        };
        if let Some(outputs) = decided {
            decision::write(outputs, &mut values[FIRST_DECISION..FIRST_OF_BUS]);
        }
        let can = port.can();
        let (transmit_errors, receive_errors) = can.errors();
        values[FIRST_OF_BUS..BEHAVIOUR].copy_from_slice(&[
            f64::from(can.status() as u8 - 1),
            f64::from(transmit_errors),
            f64::from(receive_errors),
            f64::from(can.format_errors()),
            f64::from(port.counters().dropped),
        ]);
    }

    fn save(&self) -> Result<Vec<u8>, Complaint> {
        let running = self.running.as_ref().ok_or_else(not_begun)?;
        postcard::to_allocvec(running).map_err(Complaint::new)
    }

    fn load(&mut self, values: &[f64], bytes: &[u8]) -> Result<(), Complaint> {
        let read: Running = postcard::from_bytes(bytes).map_err(Complaint::new)?;
        self.running = Some(Running {
            port: read.port.under(configuration(values)?),
            ..read
        });
        Ok(())
    }

    fn network(&mut self) -> Option<&mut dyn Network> {
        self.running.as_mut().map(|running| running as &mut dyn Network)
    }
}

impl Network for Running {
    fn take(&mut self, operations: &[u8]) {
        self.port.can_mut().take(operations);
        self.port.poll();
    }

    fn take_sent(&mut self) -> Vec<u8> {
        self.port.can_mut().take_sent()
    }
}

fn not_begun() -> Complaint {
    Complaint::new("the model has not begun: call the functions of the initialization mode first")
}
