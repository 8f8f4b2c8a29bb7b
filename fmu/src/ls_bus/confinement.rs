//! Fault confinement: what errors on the bus make of a node (ISO 11898-1; the rules for `Bus Error` operations are those of the FMI-LS-BUS Implementer's
//! Guide, "Realization of CAN error handling").
//!
//! ```text
//!   error-active <--- both counters below 128 ---> error-passive --- transmit errors above 255 ---> bus-off
//!        ^                                                                                            |
//!        +------------------------- 128 frames or errors of others have been seen --------------------+
//! ```

use serde::{Deserialize, Serialize};

use super::operation::{ErrorCode, ErrorFlag, NodeStatus};

/// From this many errors on a node is error-passive.
const PASSIVE: u16 = 128;
/// Beyond this many transmit errors a node is bus-off.
const MOST_TRANSMIT_ERRORS: u16 = 255;
/// A receiver that was error-passive and receives a frame has this many errors left (119 to 127 are permitted).
const AFTER_PASSIVE: u16 = 127;
/// Operations of others after which a node that is bus-off takes part again.
const RECOVERY: u8 = 128;

/// The error counters of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Confinement {
    transmit_errors: u16,
    receive_errors: u16,
    /// What was seen since the node has been bus-off.
    seen: Option<u8>,
}

impl Confinement {
    /// The state that the node tells.
    pub fn status(&self) -> NodeStatus {
        if self.seen.is_some() {
            NodeStatus::BusOff
        } else if self.transmit_errors.max(self.receive_errors) >= PASSIVE {
            NodeStatus::ErrorPassive
        } else {
            NodeStatus::ErrorActive
        }
    }

    /// Errors of own frames, and of others'.
    pub fn errors(&self) -> (u16, u16) {
        (self.transmit_errors, self.receive_errors)
    }

    /// An own frame was acknowledged.
    pub fn confirmed(&mut self) {
        self.transmit_errors = self.transmit_errors.saturating_sub(1);
    }

    /// A frame of somebody else was received.
    pub fn received(&mut self) {
        if !self.recovers() {
            self.receive_errors = match self.receive_errors {
                few @ ..PASSIVE => few.saturating_sub(1),
                _ => AFTER_PASSIVE,
            };
        }
    }

    /// A frame was destroyed.
    pub fn disturbed(&mut self, code: ErrorCode, flag: ErrorFlag, is_sender: bool) {
        if self.recovers() {
            return;
        }
        let is_broken = code == ErrorCode::BrokenErrorFrame;
        if is_broken || (!is_sender && flag == ErrorFlag::Primary) {
            self.receive_errors = self.receive_errors.saturating_add(8);
        } else if !is_sender {
            self.receive_errors = self.receive_errors.saturating_add(1);
        }
        // A node that is alone on the bus becomes error-passive, and not bus-off.
        let is_alone = self.status() == NodeStatus::ErrorPassive && code == ErrorCode::Ack;
        if (is_sender || is_broken) && !is_alone {
            self.transmit_errors = self.transmit_errors.saturating_add(8);
        }
        if self.transmit_errors > MOST_TRANSMIT_ERRORS {
            self.seen = Some(0);
        }
    }

    /// Whether the node is bus-off; counts what it sees, and takes part again after enough.
    fn recovers(&mut self) -> bool {
        let Some(seen) = self.seen else { return false };
        if seen + 1 < RECOVERY {
            self.seen = Some(seen + 1);
        } else {
            *self = Self::default();
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own_errors(node: &mut Confinement, code: ErrorCode, number: u32) {
        (0..number).for_each(|_| node.disturbed(code, ErrorFlag::Primary, true));
    }

    #[test]
    fn own_errors_lead_to_bus_off_and_frames_of_others_back() {
        let mut node = Confinement::default();
        own_errors(&mut node, ErrorCode::Bit, 15);
        assert_eq!((node.errors(), node.status()), ((120, 0), NodeStatus::ErrorActive));
        own_errors(&mut node, ErrorCode::Bit, 1);
        assert_eq!((node.errors(), node.status()), ((128, 0), NodeStatus::ErrorPassive));
        node.confirmed();
        assert_eq!(node.status(), NodeStatus::ErrorActive);
        own_errors(&mut node, ErrorCode::Bit, 16);
        assert_eq!((node.errors(), node.status()), ((255, 0), NodeStatus::ErrorPassive));
        own_errors(&mut node, ErrorCode::Bit, 1);
        assert_eq!(node.status(), NodeStatus::BusOff);
        (0..127).for_each(|_| node.received());
        assert_eq!(node.status(), NodeStatus::BusOff);
        node.disturbed(ErrorCode::Crc, ErrorFlag::Secondary, false);
        assert_eq!(node, Confinement::default());
    }

    #[test]
    fn a_node_that_is_alone_is_never_bus_off() {
        let mut node = Confinement::default();
        own_errors(&mut node, ErrorCode::Ack, 1000);
        assert_eq!((node.errors(), node.status()), ((128, 0), NodeStatus::ErrorPassive));
    }

    #[test]
    fn a_receiver_forgets_its_errors_frame_by_frame() {
        let mut node = Confinement::default();
        node.disturbed(ErrorCode::Crc, ErrorFlag::Secondary, false);
        node.disturbed(ErrorCode::Crc, ErrorFlag::Primary, false);
        node.disturbed(ErrorCode::BrokenErrorFrame, ErrorFlag::Secondary, false);
        assert_eq!(node.errors(), (8, 17));
        (0..3).for_each(|_| node.received());
        assert_eq!(node.errors(), (8, 14));
        (0..20).for_each(|_| node.disturbed(ErrorCode::Crc, ErrorFlag::Primary, false));
        assert_eq!(node.status(), NodeStatus::ErrorPassive);
        node.received();
        assert_eq!((node.errors(), node.status()), ((8, 127), NodeStatus::ErrorActive));
        node.disturbed(ErrorCode::Crc, ErrorFlag::Secondary, false);
        (0..200_000).for_each(|_| node.disturbed(ErrorCode::Crc, ErrorFlag::Primary, false));
        assert_eq!(node.status(), NodeStatus::ErrorPassive, "a receiver is never bus-off");
    }
}
