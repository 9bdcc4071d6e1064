//! A battery whose voltage falls with charge and sags with current.

use crate::range::{Unfit, within};

/// Most points of a table of open-circuit voltage.
const MOST_POINTS: usize = 64;

/// Cells in series behind one internal resistance.
#[derive(Clone, Debug, PartialEq)]
pub struct Battery {
    /// Cells in series, 1 to 24.
    pub cells: u32,
    /// State of charge, 0 to 1 and rising, and one cell's open-circuit voltage, V.
    ///
    /// From the cell's data sheet at a small current. Straight lines between, flat outside.
    pub open_circuit: Vec<[f64; 2]>,
    /// Internal resistance of all cells and cables, ohm, 0 to 10.
    pub resistance: f64,
    /// Charge from full to empty, Ah, above 0.
    pub capacity: f64,
}

impl Battery {
    /// A voltage that nothing changes, V: no sag, and charge for years.
    pub fn ideal(volts: f64) -> Self {
        Self {
            cells: 1,
            open_circuit: vec![[0.0, volts]],
            resistance: 0.0,
            capacity: 1e9,
        }
    }

    /// Open-circuit voltage of all cells at a state of charge from 0 to 1, V.
    pub fn open_circuit_voltage(&self, state_of_charge: f64) -> f64 {
        let table = &self.open_circuit;
        let above = table.partition_point(|point| point[0] < state_of_charge);
        let cell = match (
            above.checked_sub(1).and_then(|i| table.get(i)),
            table.get(above),
        ) {
            (Some([x0, y0]), Some([x1, y1])) => y0 + (y1 - y0) * (state_of_charge - x0) / (x1 - x0),
            (Some([_, only]), None) | (None, Some([_, only])) => *only,
            (None, None) => 0.0,
        };
        cell * f64::from(self.cells)
    }

    /// Voltage at the terminals while `power` in W is drawn, V.
    ///
    /// From `V (E - V) / R = P`. More than the battery can give, `E^2 / 4 R`, is met with
    /// half the open-circuit voltage, where it gives most.
    pub fn voltage(&self, state_of_charge: f64, power: f64) -> f64 {
        self.under_load(self.open_circuit_voltage(state_of_charge), power)
    }

    /// The same at a known open-circuit voltage.
    pub(crate) fn under_load(&self, open: f64, power: f64) -> f64 {
        let root = open * open - 4.0 * self.resistance * power;
        0.5 * (open + root.max(0.0).sqrt())
    }

    /// Charge from full to empty, As.
    pub(crate) fn ampere_seconds(&self) -> f64 {
        self.capacity * 3600.0
    }

    pub(crate) fn check(&self) -> Result<(), Unfit> {
        within("battery cells", f64::from(self.cells), 1.0, 24.0)?;
        within("battery resistance", self.resistance, 0.0, 10.0)?;
        within("battery capacity", self.capacity, 1e-6, 1e12)?;
        let points = self.open_circuit.len() as f64;
        within(
            "battery open_circuit points",
            points,
            1.0,
            MOST_POINTS as f64,
        )?;
        for [charge, volts] in &self.open_circuit {
            within("battery open_circuit charge", *charge, 0.0, 1.0)?;
            within("battery open_circuit volts", *volts, 0.1, 100.0)?;
        }
        let rising = self.open_circuit.is_sorted_by(|a, b| a[0] < b[0]);
        match rising {
            true => Ok(()),
            false => Err(Unfit(
                "battery open_circuit must be in rising order of charge".into(),
            )),
        }
    }
}
