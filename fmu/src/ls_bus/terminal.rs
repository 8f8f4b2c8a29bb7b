//! The four variables of a network, and the files that tell a tool of them (chapters 2, 4.3 and 4.4).

use crate::variable::{Kind, Role, Variable};

/// Type of the bytes in `Rx_Data` and `Tx_Data`; a tool connects only what is equal.
const MIME_TYPE: &str = "application/org.fmi-standard.fmi-ls-bus.can; version=\"1.0.0\"";
/// Most bytes of operations that are exchanged at a time.
pub const MOST_BYTES: usize = 1 << 16;
/// The structural parameter by which a tool says that its bus confirms frames.
pub const NOTIFICATIONS: &str = "org.fmi_standard.fmi_ls_bus.Can_BusNotifications";

/// A network, and the places of its variables in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Terminal {
    /// Name of the network.
    pub name: &'static str,
    /// Place of `Rx_Data`.
    pub rx_data: usize,
}

impl Terminal {
    /// Number of variables.
    pub const SIZE: usize = 4;

    /// Place of `Rx_Clock`.
    pub fn rx_clock(self) -> usize {
        self.rx_data + 1
    }

    /// Place of `Tx_Data`.
    pub fn tx_data(self) -> usize {
        self.rx_data + 2
    }

    /// Place of `Tx_Clock`.
    pub fn tx_clock(self) -> usize {
        self.rx_data + 3
    }

    /// The variables, in the order of their places.
    pub fn variables(self) -> [Variable; Self::SIZE] {
        let data = |member: &str, role, clock, description: &str| Variable {
            name: format!("{}.{member}", self.name),
            description: description.to_owned(),
            kind: Kind::Binary {
                mime_type: MIME_TYPE,
                most_bytes: MOST_BYTES,
                clock,
            },
            role,
            start: 0.0,
        };
        let clock = |member: &str, role, description: &str| Variable {
            name: format!("{}.{member}", self.name),
            description: description.to_owned(),
            kind: Kind::Clock,
            role,
            start: 0.0,
        };
        [
            data(
                "Rx_Data",
                Role::Input,
                self.rx_clock(),
                "bus operations from the network to this node",
            ),
            clock(
                "Rx_Clock",
                Role::Input,
                "ticks when there are bus operations in Rx_Data",
            ),
            data(
                "Tx_Data",
                Role::Output,
                self.tx_clock(),
                "bus operations from this node to the network",
            ),
            clock(
                "Tx_Clock",
                Role::Output,
                "ticks when there are bus operations in Tx_Data",
            ),
        ]
    }

    /// Files beside the description, each with its path in the FMU.
    pub fn files(self) -> [(&'static str, String); 2] {
        let member = |member: &str| {
            format!(
                "      <TerminalMemberVariable variableName=\"{0}.{member}\" memberName=\"{member}\" variableKind=\"signal\"/>\n",
                self.name
            )
        };
        let members = ["Rx_Data", "Rx_Clock", "Tx_Data", "Tx_Clock"].map(member).concat();
        let terminals = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiTerminalsAndIcons fmiVersion=\"3.0\">\n  <Terminals>\n    \
             <Terminal name=\"{}\" terminalKind=\"org.fmi-ls-bus.network-terminal\" matchingRule=\"org.fmi-ls-bus.transceiver\" \
             description=\"CAN of the suspension\">\n{members}    </Terminal>\n  </Terminals>\n</fmiTerminalsAndIcons>\n",
            self.name
        );
        let manifest = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiLayeredStandardManifest \
             xmlns:fmi-ls=\"http://fmi-standard.org/fmi-ls-manifest\" fmi-ls:fmi-ls-name=\"org.fmi-standard.fmi-ls-bus\" \
             fmi-ls:fmi-ls-version=\"1.0.0\" fmi-ls:fmi-ls-description=\"Layered Standard for the simulation of bus communication on a \
             Physical Signal Abstraction or Network Abstraction based level.\" isBusSimulationFMU=\"false\"/>\n";
        [
            ("terminalsAndIcons/terminalsAndIcons.xml", terminals),
            (
                "extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml",
                manifest.to_owned(),
            ),
        ]
    }
}
