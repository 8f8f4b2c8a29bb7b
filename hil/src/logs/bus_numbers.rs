//! Numbers of buses, for formats that do not name them.

/// Gives each bus a number from 1 to 255.
#[derive(Debug, Default)]
pub struct BusNumbers {
    names: Vec<String>,
}

impl BusNumbers {
    /// The number of a bus: that of a log whose buses have numbers, else its place in the order in which buses appear.
    pub fn of(&mut self, bus: &str) -> u8 {
        if let Some(number) = bus.parse().ok().filter(|number| *number >= 1) {
            return number;
        }
        let known = self.names.iter().position(|known| known == bus);
        let place = known.unwrap_or_else(|| {
            self.names.push(bus.to_owned());
            self.names.len() - 1
        });
        u8::try_from(place + 1).unwrap_or(u8::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buses_keep_their_numbers_or_get_one_in_the_order_of_appearance() {
        let mut numbers = BusNumbers::default();
        let found = ["can1", "vcan0", "can1", "7", "0", "255", "256"].map(|bus| numbers.of(bus));
        assert_eq!(found, [1, 2, 1, 7, 3, 255, 4]);
    }
}
