//! The iron of a board, from a log of its turning: an ellipsoid fit.
//!
//! Earth's field is a sphere in body axes; iron moves it away from zero and bends it to an
//! ellipsoid. The ellipsoid that fits the samples best, by linear least squares, shows what makes
//! it a sphere again, but for its size: the matrix found keeps volumes.

use std::fmt;

use nalgebra::{Matrix3, SMatrix, SVector, SymmetricEigen, Vector3};

use crate::refusal::Refusal;
use reflex_settings::{Declared, Setting, Settings, Value};

/// Samples that each direction needs: single ones may be jumps.
const FEWEST: usize = 5;
/// A direction holds what is within this angle of it: together they hold all.
const NEAR_COS: f64 = 0.82;
/// The most that is left over: more is no iron that travels with the board.
const MOST_LEFT: f64 = 0.05;

/// The iron that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundIron {
    /// What is added to the field, in gauss.
    pub hard: Vector3<f64>,
    /// The symmetric matrix that undoes what is bent.
    pub soft: Matrix3<f64>,
    /// Mean strength of the field without the iron, in gauss.
    pub field: f64,
    /// Standard deviation of its strength as a share, with the iron and without it.
    pub left: [f64; 2],
    /// Samples that show it.
    pub samples: usize,
}

/// The fields in the firmware's log: a line with `Field([X, Y, Z])` each; lines that are cut off do not
/// count.
#[must_use]
pub fn logged(log: &[u8]) -> Vec<[f64; 3]> {
    let text = String::from_utf8_lossy(log);
    let lines = text.lines().filter_map(|line| {
        let (_, field) = line.split_once("Field([")?;
        let (numbers, _) = field.split_once("])")?;
        let mut axes = numbers
            .split(',')
            .map(|number| number.trim().parse::<f64>());
        let field = [axes.next()?.ok()?, axes.next()?.ok()?, axes.next()?.ok()?];
        (axes.next().is_none() && field.iter().all(|axis| axis.is_finite())).then_some(field)
    });
    lines.collect()
}

/// Finds the iron in fields (gauss, body axes).
///
/// # Errors
/// Fields that do not show it, in one line without the file's name: too few directions, a strength
/// that differs for other reasons, iron beyond the ranges of a board's file.
pub fn find(fields: &[[f64; 3]]) -> Result<FoundIron, Refusal> {
    let fields: Vec<Vector3<f64>> = fields.iter().map(|field| Vector3::from(*field)).collect();
    let (hard, soft) = ellipsoid(&fields)
        .ok_or_else(|| Refusal::new("the field lies on no ellipsoid: turn the board all round"))?;
    let straight: Vec<_> = fields.iter().map(|field| soft * (field - hard)).collect();
    check_directions(&straight)?;
    let (field, left) = strength(&straight);
    if left > MOST_LEFT {
        return Err(Refusal::new(format!(
            "the strength of the field still differs by {:.0} %, at most {:.0} % may be left: turn \
             the board away from steel and magnets, motors off",
            left * 100.0,
            MOST_LEFT * 100.0
        )));
    }
    let found = FoundIron {
        hard,
        soft,
        field,
        left: [strength(&fields).1, left],
        samples: fields.len(),
    };
    for (setting, value) in found.settings() {
        let checked = setting.check(Value::Axes(value), None);
        checked.map_err(|range| Refusal::new(format!("{} {range}", setting.path())))?;
    }
    Ok(found)
}

/// Centre of the ellipsoid, and the symmetric matrix that makes it a sphere of the same volume.
fn ellipsoid(fields: &[Vector3<f64>]) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    // Around the mean and of size one, the equations are of one size too.
    let count = fields.len() as f64;
    let mean = fields.iter().sum::<Vector3<f64>>() / count;
    let size = (fields
        .iter()
        .map(|field| (field - mean).norm())
        .sum::<f64>()
        / count)
        .recip();
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    let mut right = SVector::<f64, 9>::zeros();
    for field in fields {
        let [x, y, z]: [f64; 3] = ((field - mean) * size).into();
        let row = SVector::from([x * x, y * y, z * z, x * y, x * z, y * z, x, y, z]);
        normal += row * row.transpose();
        right += row;
    }
    let [xx, yy, zz, xy, xz, yz, x, y, z]: [f64; 9] = normal.cholesky()?.solve(&right).into();
    let [xy, xz, yz] = [xy, xz, yz].map(|factor| factor / 2.0);
    let form = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let linear = Vector3::new(x, y, z);
    let centre = form.try_inverse()? * linear * -0.5;
    let level = 1.0 + centre.dot(&(form * centre));
    let SymmetricEigen {
        eigenvectors: axes,
        eigenvalues: squares,
    } = SymmetricEigen::new(form / level);
    if !squares.iter().all(|square| *square > 0.0) {
        return None;
    }
    let stretch = squares.map(f64::sqrt);
    let stretch = stretch / stretch.product().cbrt();
    let soft = axes * Matrix3::from_diagonal(&stretch) * axes.transpose();
    Some((mean + centre / size, soft))
}

/// Refuses samples that leave out a side or a corner.
fn check_directions(straight: &[Vector3<f64>]) -> Result<(), Refusal> {
    let signs = [-1.0, 0.0, 1.0];
    let directions = signs.iter().flat_map(|x| {
        let of_x = signs.iter().flat_map(move |y| signs.map(|z| [*x, *y, z]));
        of_x.map(Vector3::from)
    });
    for direction in directions {
        // Sides and corners; what lies between them is near to both.
        let axes = direction.abs().sum();
        if axes != 1.0 && axes != 3.0 {
            continue;
        }
        let near = |field: &&Vector3<f64>| {
            field.dot(&direction) > NEAR_COS * field.norm() * direction.norm()
        };
        let found = straight.iter().filter(near).count();
        if found < FEWEST {
            let [x, y, z]: [f64; 3] = direction.into();
            return Err(Refusal::new(format!(
                "{found} samples with the field along x {x:+}, y {y:+}, z {z:+}, at least {FEWEST} \
                 are needed: turn each side and each corner of the board into the field"
            )));
        }
    }
    Ok(())
}

/// Mean strength, and its standard deviation as a share of it.
fn strength(fields: &[Vector3<f64>]) -> (f64, f64) {
    let count = fields.len() as f64;
    let mean = fields.iter().map(Vector3::norm).sum::<f64>() / count;
    let square = |field: &Vector3<f64>| (field.norm() / mean - 1.0).powi(2);
    (
        mean,
        (fields.iter().map(square).sum::<f64>() / count).sqrt(),
    )
}

impl FoundIron {
    /// The settings of a board's file, with their values.
    fn settings(&self) -> [(&'static Setting, [f64; 3]); 3] {
        let m = self.soft;
        let values = [
            ("hard_iron", self.hard.into()),
            ("soft_iron_diagonal", [m[(0, 0)], m[(1, 1)], m[(2, 2)]]),
            ("soft_iron_off_diagonal", [m[(0, 1)], m[(0, 2)], m[(1, 2)]]),
        ];
        values.map(|(name, value)| {
            let place = Settings::place(name).expect("the settings name it");
            (&Settings::SETTINGS[place], value)
        })
    }
}

/// Lines of a board's file.
impl fmt::Display for FoundIron {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [before, after] = self.left.map(|share| share * 100.0);
        writeln!(
            f,
            "# {} samples of {:.3} gauss. Their strength differs by {before:.1} %, less the iron by \
             {after:.1} %.",
            self.samples, self.field
        )?;
        let mut section = "";
        for (setting, [x, y, z]) in self.settings() {
            if setting.section != section {
                section = setting.section;
                writeln!(f, "[{section}]")?;
            }
            writeln!(f, "{} = [{x:.4}, {y:.4}, {z:.4}]", setting.key)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Directions all round, evenly.
    fn sphere(samples: usize) -> impl Iterator<Item = Vector3<f64>> {
        let golden = std::f64::consts::PI * (3.0 - 5_f64.sqrt());
        (0..samples).map(move |n| {
            let z = 1.0 - (2 * n + 1) as f64 / samples as f64;
            let (sine, cosine) = (golden * n as f64).sin_cos();
            let level = (1.0 - z * z).sqrt();
            Vector3::new(level * cosine, level * sine, z)
        })
    }

    fn noise(n: usize) -> Vector3<f64> {
        Vector3::new(12.9, 78.2, 37.7).map(|factor| (factor * n as f64).sin() * 4e-3)
    }

    fn bent(hard: Vector3<f64>, soft: Matrix3<f64>, samples: usize) -> Vec<[f64; 3]> {
        let undo = soft.try_inverse().expect("it is near one");
        let fields = sphere(samples).enumerate();
        let fields = fields.map(|(n, way)| undo * way * 0.48 + hard + noise(n));
        fields.map(Into::into).collect()
    }

    proptest! {
        #[test]
        fn a_made_up_ellipsoid_is_found_again(
            hard in [-1.5_f64..1.5, -1.5..1.5, -1.5..1.5],
            diagonal in [0.8_f64..1.2, 0.8..1.2, 0.8..1.2],
            [xy, xz, yz] in [-0.1_f64..0.1, -0.1..0.1, -0.1..0.1],
        ) {
            let ([xx, yy, zz], hard) = (diagonal, Vector3::from(hard));
            let soft = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            let soft = soft / soft.determinant().cbrt();
            let found = find(&bent(hard, soft, 400)).expect("all directions are there");
            prop_assert!((found.hard - hard).norm() < 3e-3, "{found:?}");
            prop_assert!((found.soft - soft).norm() < 1e-2, "{found:?}");
            prop_assert!((found.field - 0.48).abs() < 2e-3, "{found:?}");
            prop_assert!(found.left[1] < 0.01, "{found:?}");
        }
    }

    #[test]
    fn what_is_printed_is_a_table_of_a_boards_file() {
        let found = find(&bent(
            Vector3::new(0.2, -0.1, 0.05),
            Matrix3::identity(),
            400,
        ));
        let text = found.expect("all directions are there").to_string();
        let table: toml::Table = text.parse().expect("it is TOML");
        let numbers = |key: &str| -> Vec<f64> {
            let list = table["magnetometer"][key].as_array().expect(key);
            list.iter().filter_map(toml::Value::as_float).collect()
        };
        assert_eq!(numbers("soft_iron_off_diagonal").len(), 3);
        assert!((numbers("hard_iron_gauss")[0] - 0.2).abs() < 2e-3, "{text}");
        assert!(
            (numbers("soft_iron_diagonal")[2] - 1.0).abs() < 5e-3,
            "{text}"
        );
    }

    #[test]
    fn the_firmwares_log_shows_fields() {
        let log = b"0.5 INFO Field([0.21, -0.1, 0.4015])\n0.6 INFO Runs\n\xFF 0.7 INFO Field([1e-3, 0, 2])\n\
                    0.8 INFO Field([0.1, 0.2\n0.9 INFO Field([NaN, 0.1, 0.1])\n1 INFO Field([1, 2, 3, 4])";
        assert_eq!(logged(log), [[0.21, -0.1, 0.4015], [1e-3, 0.0, 2.0]]);
        assert!(logged(b"t,mx,my,mz\n0,1,2,3\n").is_empty());
    }

    fn refusal(fields: &[[f64; 3]]) -> String {
        find(fields).expect_err("it shows too little").to_string()
    }

    #[test]
    fn fields_that_do_not_show_the_iron_are_refused_in_one_line() {
        let all = bent(Vector3::zeros(), Matrix3::identity(), 400);
        let flat: Vec<_> = all.iter().map(|[x, y, _]| [*x, *y, 0.3]).collect();
        let half: Vec<_> = all.iter().copied().filter(|[.., z]| *z > 0.0).collect();
        let far = bent(Vector3::new(5.0, 0.0, 0.0), Matrix3::identity(), 400);
        let mut wild = all.clone();
        for (n, field) in wild.iter_mut().enumerate() {
            let factor = 1.0 + 0.2 * (n as f64 * 1.7).sin();
            *field = field.map(|axis| axis * factor);
        }
        for (fields, expected) in [
            (&[][..], "all round"),
            (&flat, "all round"),
            (&half, "z -1"),
            (&wild, "away from steel"),
            (&far, "magnetometer.hard_iron_gauss"),
        ] {
            let line = refusal(fields);
            assert!(
                line.contains(expected),
                "{line:?} does not say {expected:?}"
            );
            assert_eq!(line.lines().count(), 1, "{line:?}");
        }
    }
}
