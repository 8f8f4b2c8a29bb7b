//! Steps of an instant: a step ends where a valve begins or ends to move, and may be as short as a fraction of a microsecond.

use oleo_interface::StrutValves;
use oleo_plant_sim::strut::{Effects, Strut, StrutModel};

const SOFT: StrutValves<bool> = StrutValves::new(true, true, true);

/// What a long step of a coarse motion leaves of the rod's stroke is micrometres. In an incompressible chamber they would be a blow if the next
/// step supplied them within an instant.
#[test]
fn a_step_of_an_instant_is_no_blow() {
    let mut model = StrutModel::defender110(8000.0);
    model.effects = Effects::default();
    let mut strut = Strut::at_rest(&model, SOFT).unwrap();
    // Both moves are longer than the speeds of nothing say.
    let before = strut.advance_with_speeds(2e-6, 0.0, 0.0, 0.02, SOFT).pressure_pa;
    let after = strut.advance_with_speeds(4e-6, 0.0, 0.0, 2e-7, SOFT).pressure_pa;
    for (before, after) in before.into_iter().zip(after) {
        assert!((after - before).abs() < 1e5, "{before} {after}");
    }
    // And the stroke is not lost: it is supplied in the end.
    let slow = strut.advance_with_speeds(4e-6, 0.0, 0.0, 0.1, SOFT);
    let settled = strut.advance_with_speeds(4e-6, 0.0, 0.0, 0.1, SOFT).pressure_pa[0];
    assert!(settled > before[0] && (settled - slow.pressure_pa[0]).abs() < 100.0);
}
