//! The description file for calibration tools (ASAM MCD-2 MC, "A2L"), written from the tables that the slave itself serves.
//!
//! Name, place, kind, unit and range of every quantity come from [`measurement`] and
//! [`calibration`]; how to connect comes from [`bus`](crate::bus) and `daq`. So a file and a slave of the same build
//! cannot disagree, and [`identity`], which is in the file as `EPK`, tells builds apart. The crate `a2lfile`
//! writes the file and checks it before it is given away.

mod interface;

use std::string::{String, ToString};
use std::vec::Vec;

use a2lfile::{
    A2lError, A2lFile, AddrEpk, ByteOrder, ByteOrderEnum, Characteristic, CharacteristicType, CompuMethod, CompuTabRef,
    CompuVtab, ConversionType, DataType, EcuAddress, Epk, FncValues, Group, IndexMode, Measurement, ModCommon, ModPar,
    Module, ReadOnly, RecordLayout, RefCharacteristic, RefMeasurement, Root, ValuePairsStruct,
};

use crate::memory::{IDENTITY_ADDRESS, identity};
use crate::quantity::{Kind, Quantity};
use crate::{calibration, measurement};

/// What can go wrong although nothing outside of this program takes part: its own file does not pass a check.
#[derive(Debug)]
pub struct DescriptionError(String);

impl core::fmt::Display for DescriptionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "the description file for calibration tools is not consistent: {}",
            self.0
        )
    }
}

impl core::error::Error for DescriptionError {}

impl From<A2lError> for DescriptionError {
    fn from(error: A2lError) -> Self {
        Self(error.to_string())
    }
}

/// The place of a value in a record: it is alone in it.
const VALUE_LAYOUT: &str = "VALUE_F32";

/// The description of this slave on a bus of a bit rate, bit/s.
///
/// # Errors
/// The file that was made does not pass its own check, which is a fault of this program.
pub fn description(bit_rate: u32) -> Result<String, DescriptionError> {
    let (mut file, _) = a2lfile::load_from_string(&interface::frame(bit_rate), None, true)?;
    if let Some(module) = file.project.module.get_mut(interface::MODULE) {
        fill(module);
    }
    let text = checked(&file)?;
    // Once more from the text: what is given away is what was checked.
    checked(&a2lfile::load_from_string(&text, None, true)?.0)?;
    Ok(text)
}

/// The text of a file without complaints.
fn checked(file: &A2lFile) -> Result<String, DescriptionError> {
    match file.check().first() {
        None => Ok(file.write_to_string()),
        Some(complaint) => Err(DescriptionError(complaint.to_string())),
    }
}

fn fill(module: &mut Module) {
    let mut parameters = ModPar::new("The controller of a hydropneumatic suspension".into());
    parameters.epk = Some(Epk::new(identity().as_str().into()));
    parameters.addr_epk.push(AddrEpk::new(IDENTITY_ADDRESS));
    module.mod_par = Some(parameters);
    let mut common = ModCommon::new(String::new());
    common.byte_order = Some(ByteOrder::new(ByteOrderEnum::MsbLast));
    module.mod_common = Some(common);
    let mut layout = RecordLayout::new(VALUE_LAYOUT.into());
    layout.fnc_values = Some(FncValues::new(
        1,
        DataType::Float32Ieee,
        IndexMode::ColumnDir,
        a2lfile::AddrType::Direct,
    ));
    module.record_layout.push(layout);
    let mut units = Vec::new();
    for quantity in measurement::quantities() {
        let conversion = conversion(module, &quantity, &mut units);
        module.measurement.push(measured(&quantity, conversion));
    }
    for quantity in calibration::quantities() {
        let conversion = conversion(module, &quantity, &mut units);
        module.characteristic.push(calibrated(&quantity, conversion));
    }
    module.group.extend(groups());
}

/// The name of a quantity's conversion, which is made when it is the first with it: one for each unit, one for each enumeration.
fn conversion(module: &mut Module, quantity: &Quantity, known: &mut Vec<String>) -> String {
    if quantity.names.is_empty() {
        if quantity.unit.is_empty() {
            return "NO_COMPU_METHOD".into();
        }
        let name = std::format!("unit_{}", quantity.unit.replace('/', "_per_"));
        if !known.contains(&name) {
            known.push(name.clone());
            let unit = quantity.unit.into();
            let method = CompuMethod::new(
                name.clone(),
                String::new(),
                ConversionType::Identical,
                "%12.6".into(),
                unit,
            );
            module.compu_method.push(method);
        }
        return name;
    }
    let (name, table) = (
        std::format!("names_{}", quantity.name),
        std::format!("table_{}", quantity.name),
    );
    let mut method = CompuMethod::new(
        name.clone(),
        String::new(),
        ConversionType::TabVerb,
        "%3.0".into(),
        String::new(),
    );
    method.compu_tab_ref = Some(CompuTabRef::new(table.clone()));
    module.compu_method.push(method);
    let mut words = CompuVtab::new(
        table,
        String::new(),
        ConversionType::TabVerb,
        quantity.names.len() as u16,
    );
    words.value_pairs = (quantity.names.iter().enumerate())
        .map(|(number, word)| ValuePairsStruct::new(number as f64, (*word).into()))
        .collect();
    module.compu_vtab.push(words);
    name
}

/// A number in single precision with the digits by which people write it: 0.1, not 0.10000000149.
fn in_words(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| value.into())
}

fn measured(quantity: &Quantity, conversion: String) -> Measurement {
    let kind = match quantity.kind {
        Kind::U8 => DataType::Ubyte,
        Kind::U16 => DataType::Uword,
        Kind::U32 => DataType::Ulong,
        Kind::F32 => DataType::Float32Ieee,
    };
    let (least, most) = quantity.range;
    let (name, description) = (quantity.name.into(), quantity.description.into());
    let mut measurement = Measurement::new(
        name,
        description,
        kind,
        conversion,
        0,
        0.0,
        in_words(least),
        in_words(most),
    );
    measurement.ecu_address = Some(EcuAddress::new(quantity.address));
    measurement
}

fn calibrated(quantity: &Quantity, conversion: String) -> Characteristic {
    let (least, most) = quantity.range;
    let mut characteristic = Characteristic::new(
        quantity.name.into(),
        quantity.description.into(),
        CharacteristicType::Value,
        quantity.address,
        VALUE_LAYOUT.into(),
        0.0,
        conversion,
        in_words(least),
        in_words(most),
    );
    // A tool offers nothing that this build refuses.
    if cfg!(not(feature = "calibration")) {
        characteristic.read_only = Some(ReadOnly::new());
    }
    characteristic
}

/// What a tool shows as folders.
fn groups() -> [Group; 2] {
    let mut measured = Group::new(
        "measured".into(),
        "What the controller is told, estimates and decides".into(),
    );
    let mut names = RefMeasurement::new();
    names.identifier_list = measurement::quantities().map(|quantity| quantity.name.into()).collect();
    measured.ref_measurement = Some(names);
    measured.root = Some(Root::new());
    let mut tuning = Group::new("tuning".into(), "Tuning of the controller".into());
    let mut names = RefCharacteristic::new();
    names.identifier_list = calibration::quantities().map(|quantity| quantity.name.into()).collect();
    tuning.ref_characteristic = Some(names);
    tuning.root = Some(Root::new());
    [measured, tuning]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_has_every_quantity_as_the_slave_has_it() {
        let text = description(500_000).unwrap();
        let (file, complaints) = a2lfile::load_from_string(&text, None, true).unwrap();
        assert!(complaints.is_empty() && file.check().is_empty());
        let module = &file.project.module[0];
        for quantity in measurement::quantities() {
            let measurement = module.measurement.get(quantity.name).unwrap();
            assert_eq!(measurement.ecu_address.as_ref().unwrap().address, quantity.address);
            assert_eq!(measurement.lower_limit as f32, quantity.range.0, "{}", quantity.name);
        }
        for quantity in calibration::quantities() {
            let characteristic = module.characteristic.get(quantity.name).unwrap();
            assert_eq!(characteristic.address, quantity.address);
            assert_eq!(characteristic.upper_limit as f32, quantity.range.1);
            assert_eq!(characteristic.read_only.is_none(), cfg!(feature = "calibration"));
        }
        assert_eq!(module.measurement.len(), measurement::quantities().count());
        let parameters = module.mod_par.as_ref().unwrap();
        assert_eq!(parameters.epk.as_ref().unwrap().identifier, identity().as_str());
    }

    #[test]
    fn the_interface_is_read_by_the_rules_that_the_file_states() {
        let (file, _) = a2lfile::load_from_string(&description(1_000_000).unwrap(), None, true).unwrap();
        let interface = &file.project.module[0].if_data[0];
        assert!(interface.ifdata_valid, "IF_DATA follows the A2ML of the file");
    }
}
