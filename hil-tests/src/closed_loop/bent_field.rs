//! What iron and motors make of the field at a simulated magnetometer.

use nalgebra::{Matrix3, Vector3};
use reflex_config::plant::Magnetometer;

/// All that bends it, in body axes and gauss.
pub(super) struct BentField {
    magnets: Vector3<f64>,
    steel: Matrix3<f64>,
    of_an_ampere: Vector3<f64>,
}

impl BentField {
    /// Iron in the words of a board's file: the matrix there undoes what steel does here.
    pub(super) fn of(sensor: &Magnetometer) -> Self {
        let ([xx, yy, zz], [xy, xz, yz]) =
            (sensor.soft_iron_diagonal, sensor.soft_iron_off_diagonal);
        let undoes = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        Self {
            magnets: sensor.hard_iron_gauss.into(),
            steel: undoes.try_inverse().expect("its range has an inverse"),
            of_an_ampere: sensor.motor_gauss_per_a.into(),
        }
    }

    /// What the chip is exposed to in Earth's field while motors draw so many A.
    pub(super) fn around(&self, earth: Vector3<f64>, amperes: f64) -> Vector3<f64> {
        self.steel * earth + self.magnets + self.of_an_ampere * amperes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_iron_a_field_keeps_its_bits() {
        let earth = Vector3::new(0.21, -0.03, 0.43);
        assert_eq!(
            BentField::of(&Magnetometer::default()).around(earth, 30.0),
            earth
        );
    }

    #[test]
    fn magnets_and_currents_add_and_the_matrix_undoes_what_steel_bends() {
        let bent = BentField::of(&Magnetometer {
            hard_iron_gauss: [0.3, -0.2, 0.1],
            soft_iron_diagonal: [1.1, 0.9, 1.0],
            soft_iron_off_diagonal: [0.05, 0.0, -0.1],
            motor_gauss_per_a: [0.0, 0.002, 0.001],
        });
        let earth = Vector3::new(0.2, 0.1, 0.4);
        let off = bent.around(earth, 10.0) - Vector3::new(0.3, -0.18, 0.11);
        let undoes = Matrix3::new(1.1, 0.05, 0.0, 0.05, 0.9, -0.1, 0.0, -0.1, 1.0);
        assert!((undoes * off - earth).norm() < 1e-12);
    }
}
