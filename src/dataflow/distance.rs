//! How far a value moved: what a quantum is held against.

/// Values of which a quantum can say whether they changed.
pub trait Distance {
    /// The largest difference in any component; not a number where one is not.
    fn distance(&self, other: &Self) -> f32;
}

impl Distance for f32 {
    fn distance(&self, other: &Self) -> f32 {
        (self - other).abs()
    }
}

impl<const N: usize> Distance for [f32; N] {
    fn distance(&self, other: &Self) -> f32 {
        let differences = self.iter().zip(other).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, |largest, it| if it < largest { largest } else { it })
    }
}
