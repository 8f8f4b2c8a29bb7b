//! How a tool connects: the empty file with the interface description (`IF_DATA XCP`), and the rules by which that is read (`A2ML`).
//!
//! The rules are the part of the definitions of the XCP specification (part "interface specification", *recalled*) that this slave uses.

use std::format;
use std::string::String;

use oleo_controller::interface::tick::TICK_MS;

use crate::bus::{REQUEST_ID, RESPONSE_ID};
use crate::daq::{MOST_ENTRY_BYTES, MOST_LISTS};
use crate::packet::MOST_BYTES;

/// Name of the one module.
pub(super) const MODULE: &str = "controller";

const RULES: &str = r#"
      block "IF_DATA" taggedunion if_data {
        "XCP" struct {
          taggedstruct {
            block "PROTOCOL_LAYER" struct {
              uint;
              uint; uint; uint; uint; uint; uint; uint;
              uchar;
              uint;
              enum { "BYTE_ORDER_MSB_LAST" = 0, "BYTE_ORDER_MSB_FIRST" = 1 };
              enum { "ADDRESS_GRANULARITY_BYTE" = 1, "ADDRESS_GRANULARITY_WORD" = 2, "ADDRESS_GRANULARITY_DWORD" = 4 };
              taggedstruct {
                ("OPTIONAL_CMD" enum {
                  "GET_COMM_MODE_INFO" = 251, "GET_ID" = 250, "SET_MTA" = 246, "UPLOAD" = 245, "SHORT_UPLOAD" = 244,
                  "BUILD_CHECKSUM" = 243, "DOWNLOAD" = 240, "SET_DAQ_PTR" = 226, "WRITE_DAQ" = 225,
                  "SET_DAQ_LIST_MODE" = 224, "GET_DAQ_LIST_MODE" = 223, "START_STOP_DAQ_LIST" = 222,
                  "START_STOP_SYNCH" = 221, "GET_DAQ_CLOCK" = 220, "GET_DAQ_PROCESSOR_INFO" = 218,
                  "GET_DAQ_RESOLUTION_INFO" = 217, "GET_DAQ_EVENT_INFO" = 215, "FREE_DAQ" = 214, "ALLOC_DAQ" = 213,
                  "ALLOC_ODT" = 212, "ALLOC_ODT_ENTRY" = 211
                })*;
              };
            };
            block "DAQ" struct {
              enum { "STATIC" = 0, "DYNAMIC" = 1 };
              uint;
              uint;
              uchar;
              enum { "OPTIMISATION_TYPE_DEFAULT" = 0 };
              enum { "ADDRESS_EXTENSION_FREE" = 0, "ADDRESS_EXTENSION_ODT" = 1, "ADDRESS_EXTENSION_DAQ" = 3 };
              enum { "IDENTIFICATION_FIELD_TYPE_ABSOLUTE" = 0 };
              enum { "GRANULARITY_ODT_ENTRY_SIZE_DAQ_BYTE" = 1 };
              uchar;
              enum { "NO_OVERLOAD_INDICATION" = 0, "OVERLOAD_INDICATION_PID" = 1, "OVERLOAD_INDICATION_EVENT" = 2 };
              taggedstruct {
                "PRESCALER_SUPPORTED";
                block "TIMESTAMP_SUPPORTED" struct {
                  uint;
                  enum { "NO_TIME_STAMP" = 0, "SIZE_BYTE" = 1, "SIZE_WORD" = 2, "SIZE_DWORD" = 4 };
                  enum { "UNIT_1MS" = 6, "UNIT_10MS" = 7, "UNIT_100MS" = 8, "UNIT_1S" = 9 };
                };
                (block "EVENT" struct {
                  char[101];
                  char[9];
                  uint;
                  enum { "DAQ" = 1, "STIM" = 2, "DAQ_STIM" = 3 };
                  uchar;
                  uchar;
                  uchar;
                  uchar;
                })*;
              };
            };
          };
          taggedstruct {
            block "XCP_ON_CAN" struct {
              uint;
              taggedstruct {
                "CAN_ID_MASTER" ulong;
                "CAN_ID_SLAVE" ulong;
                "BAUDRATE" ulong;
              };
            };
          };
        };
      };
"#;

/// Commands beyond those that every slave has.
const COMMANDS: [&str; 20] = [
    "GET_COMM_MODE_INFO",
    "GET_ID",
    "SET_MTA",
    "UPLOAD",
    "SHORT_UPLOAD",
    "BUILD_CHECKSUM",
    "SET_DAQ_PTR",
    "WRITE_DAQ",
    "SET_DAQ_LIST_MODE",
    "GET_DAQ_LIST_MODE",
    "START_STOP_DAQ_LIST",
    "START_STOP_SYNCH",
    "GET_DAQ_CLOCK",
    "GET_DAQ_PROCESSOR_INFO",
    "GET_DAQ_RESOLUTION_INFO",
    "GET_DAQ_EVENT_INFO",
    "FREE_DAQ",
    "ALLOC_DAQ",
    "ALLOC_ODT",
    "ALLOC_ODT_ENTRY",
];

/// Longest that a tool waits for an answer, ms. The slave answers at the end of the tick.
const LONGEST_WAIT_MS: u32 = 1000;

/// A file without quantities, for a bus of a bit rate (bit/s).
pub(super) fn frame(bit_rate: u32) -> String {
    let mut commands = String::new();
    let writes: &[&str] = if cfg!(feature = "calibration") {
        &["DOWNLOAD"]
    } else {
        &[]
    };
    for name in COMMANDS.iter().chain(writes) {
        commands += &format!("          OPTIONAL_CMD {name}\n");
    }
    let wait = format!("{LONGEST_WAIT_MS} ").repeat(7);
    format!(
        r#"ASAP2_VERSION 1 71
/begin PROJECT oleo "Controllable hydropneumatic suspension"
  /begin MODULE {MODULE} "XCP on CAN"
    /begin A2ML{RULES}    /end A2ML
    /begin IF_DATA XCP
      /begin PROTOCOL_LAYER
        0x0100 {wait}{MOST_BYTES} {MOST_BYTES} BYTE_ORDER_MSB_LAST ADDRESS_GRANULARITY_BYTE
{commands}      /end PROTOCOL_LAYER
      /begin DAQ
        DYNAMIC {MOST_LISTS} 1 0 OPTIMISATION_TYPE_DEFAULT ADDRESS_EXTENSION_FREE IDENTIFICATION_FIELD_TYPE_ABSOLUTE
        GRANULARITY_ODT_ENTRY_SIZE_DAQ_BYTE {MOST_ENTRY_BYTES} NO_OVERLOAD_INDICATION
        PRESCALER_SUPPORTED
        /begin TIMESTAMP_SUPPORTED
          {TICK_MS} SIZE_WORD UNIT_1MS
        /end TIMESTAMP_SUPPORTED
        /begin EVENT
          "tick" "tick" 0 DAQ {MOST_LISTS} {TICK_MS} 6 0
        /end EVENT
      /end DAQ
      /begin XCP_ON_CAN
        0x0100
        CAN_ID_MASTER {REQUEST_ID:#06x}
        CAN_ID_SLAVE {RESPONSE_ID:#06x}
        BAUDRATE {bit_rate}
      /end XCP_ON_CAN
    /end IF_DATA
  /end MODULE
/end PROJECT
"#
    )
}
