//! What a node on a network and a tool exchange in the event mode: bus operations and the clocks that tell of them.
//!
//! ```text
//!   step ends --> offered: Tx_Clock ticks, once --> the tool fetches Tx_Data --> end of the instant: gone
//!   the tool sets Rx_Data and lets Rx_Clock tick --> end of the instant: the model takes them
//! ```

use serde::{Deserialize, Serialize};

use crate::complaint::Complaint;
use crate::ls_bus::terminal::MOST_BYTES;
use crate::ls_bus::transceiver::MOST_SENT;

/// Most bytes that may be left unfetched when a step begins, so that there is room for what it brings.
const MOST_LEFT: usize = MOST_BYTES - MOST_SENT;

/// Bus operations on their way.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Exchange {
    /// `Rx_Data`.
    pub received: Vec<u8>,
    /// `Rx_Clock` ticks in this instant.
    pub is_received: bool,
    /// `Tx_Data`.
    offered: Vec<u8>,
    /// `Tx_Clock` has ticked for them.
    is_told: bool,
    is_fetched: bool,
}

impl Exchange {
    /// Offers operations behind those that were not fetched.
    pub fn offer(&mut self, operations: Vec<u8>) {
        self.is_told &= operations.is_empty();
        self.offered.extend(operations);
    }

    /// Whether there is room for what a step brings.
    ///
    /// # Errors
    /// The tool has not fetched for too long.
    pub fn has_room(&self) -> Result<(), Complaint> {
        if self.offered.len() <= MOST_LEFT {
            return Ok(());
        }
        Err(Complaint::new(format!(
            "{} bytes of Tx_Data were not fetched: enter the event mode when a step asks for it, and get Tx_Data",
            self.offered.len()
        )))
    }

    /// Whether there is something to fetch.
    pub fn has_offers(&self) -> bool {
        !self.offered.is_empty()
    }

    /// Whether `Tx_Clock` ticks: once for what is offered.
    pub fn tells(&mut self) -> bool {
        let ticks = self.has_offers() && !self.is_told;
        self.is_told |= ticks;
        ticks
    }

    /// `Tx_Data`, which stays until the end of the instant.
    pub fn fetch(&mut self) -> &[u8] {
        self.is_fetched = true;
        &self.offered
    }

    /// Ends an instant of the event mode; returns what has been received in it.
    pub fn end_of_instant(&mut self) -> Option<Vec<u8>> {
        if std::mem::take(&mut self.is_fetched) {
            self.offered.clear();
        }
        self.is_told = false;
        let received = std::mem::take(&mut self.received);
        std::mem::take(&mut self.is_received).then_some(received)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_offered_is_told_once_and_stays_until_it_was_fetched() {
        let mut exchange = Exchange::default();
        assert!(!exchange.tells());
        exchange.offer(vec![1]);
        assert!(exchange.tells() && !exchange.tells());
        assert_eq!(exchange.end_of_instant(), None);
        // The tool has not fetched: it is told again, with what came since.
        exchange.offer(vec![2]);
        assert!(exchange.tells());
        assert_eq!(exchange.fetch(), [1, 2]);
        exchange.end_of_instant();
        assert!(!exchange.has_offers() && !exchange.tells());
    }

    #[test]
    fn what_is_received_counts_only_with_its_clock() {
        let mut exchange = Exchange {
            received: vec![1],
            ..Exchange::default()
        };
        assert_eq!(exchange.end_of_instant(), None);
        exchange.received = vec![2];
        exchange.is_received = true;
        assert_eq!(exchange.end_of_instant(), Some(vec![2]));
        assert_eq!(exchange.end_of_instant(), None);
    }

    #[test]
    fn a_tool_that_never_fetches_is_told_so() {
        let mut exchange = Exchange::default();
        exchange.offer(vec![0; MOST_LEFT]);
        exchange.has_room().unwrap();
        exchange.offer(vec![0]);
        let line = exchange.has_room().unwrap_err().to_string();
        assert!(line.starts_with("8193 bytes of Tx_Data were not fetched"), "{line}");
    }
}
