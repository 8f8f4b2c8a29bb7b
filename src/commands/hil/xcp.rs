//! The options of `oleo hil` by which a calibration tool reaches the controller.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use oleo_hil::bus::BusAddress;
use oleo_hil::companion::Companion;
use oleo_hil::scenario::Scenario;
use oleo_hil::sync::Role;

use crate::failure::Failure;

/// What a calibration tool may do.
#[derive(clap::Args)]
pub struct XcpArgs {
    /// Let a calibration tool read the controller by XCP on CAN (identifiers 0x3F0 and 0x3F1), on a bus of this bit rate, which bounds
    /// how much it may ask for in a tick. Needs a bus that others can reach. docs/xcp.md describes it
    #[arg(long, value_name = "BIT_RATE", num_args = 0..=1, default_missing_value = "500000", conflicts_with = "firmware",
          value_parser = PossibleValuesParser::new(["500000", "1000000"]).try_map(|rate| rate.parse::<u32>()))]
    xcp: Option<u32>,
    /// Let the tool also write the controller's tuning, while all valves are closed. Needs a program that was built with the
    /// feature `calibration`
    #[arg(long, requires = "xcp")]
    xcp_write: bool,
}

impl XcpArgs {
    /// What the controller's node serves beside the controller, if the user asked for it.
    pub fn companion(&self, scenario: &Scenario, node: Option<Role>) -> Result<Option<Box<dyn Companion>>, Failure> {
        let Some(bit_rate) = self.xcp else { return Ok(None) };
        if node == Some(Role::Plant) {
            return Err(Failure::new(
                "--xcp: the plant's node has no controller; give it to the controller's node",
            ));
        }
        if scenario.bus == BusAddress::InProcess {
            return Err(Failure::new(
                "--xcp: no tool reaches a bus in memory: give --bus socketcan:IFACE, such as socketcan:vcan0",
            ));
        }
        slave(scenario, bit_rate, self.xcp_write).map(Some)
    }
}

#[cfg(not(feature = "xcp"))]
fn slave(_: &Scenario, _: u32, _: bool) -> Result<Box<dyn Companion>, Failure> {
    Err(Failure::new(
        "--xcp: this program was built without XCP; build it with `cargo build --release --features xcp`",
    ))
}

#[cfg(all(feature = "xcp", not(feature = "calibration")))]
fn slave(scenario: &Scenario, bit_rate: u32, writes: bool) -> Result<Box<dyn Companion>, Failure> {
    if writes {
        return Err(Failure::new(
            "--xcp-write: this program does not write; build it with `cargo build --release --features calibration`",
        ));
    }
    Ok(Box::new(oleo_hil::xcp::Xcp::new(
        oleo_hil::run::builder(scenario)?,
        bit_rate,
    )))
}

#[cfg(feature = "calibration")]
fn slave(scenario: &Scenario, bit_rate: u32, writes: bool) -> Result<Box<dyn Companion>, Failure> {
    let xcp = oleo_hil::xcp::Xcp::new(oleo_hil::run::builder(scenario)?, bit_rate);
    Ok(Box::new(if writes { xcp.writable() } else { xcp }))
}
