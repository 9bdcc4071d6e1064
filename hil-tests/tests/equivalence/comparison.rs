//! The software's decision about a sample, beside the chip's.

use reflex::math::Vec3;
use reflex::reactive::{self, Fit, Logistic, Watch};
use reflex::settings::Reference;

/// What both decided about one sample; changes and thresholds in SI units.
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    /// Largest per-axis absolute difference of the sample and its reference.
    pub change: f64,
    /// What the change must exceed.
    pub threshold: f64,
    /// The software asks for a run.
    pub software: bool,
    /// The chip interrupted.
    pub chip: bool,
    /// Samples since the chip was re-armed: 1 for the first one after it.
    pub age: i32,
    /// The largest change among the samples between re-arming and this one.
    pub largest: f64,
    /// Since re-arming, or in the reference, a data register stood at its end:
    /// there it shows less than what the comparator may have seen.
    pub clipped: bool,
}

/// A sample in whole units, as the data registers show it.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Its axes.
    pub axes: Vec3,
    /// Some register stands at its end.
    pub clipped: bool,
}

impl Decision {
    /// The software asks, the chip does not.
    pub fn is_missed(&self) -> bool {
        self.software && !self.chip
    }

    /// The chip asks, the software does not.
    pub fn is_extra(&self) -> bool {
        self.chip && !self.software
    }

    /// How far the change is from the threshold.
    pub fn distance(&self) -> f64 {
        (self.change - self.threshold).abs()
    }
}

/// The firmware's comparison, fed with a chip's samples.
///
/// Samples and threshold are whole multiples of one unit below 2^24, so that
/// the firmware's `f32` arithmetic on them is exact.
pub struct Comparison {
    watch: Watch,
    software: reactive::Decision,
    previous: bool,
    unit: f64,
    age: i32,
    largest: f64,
    newest_clipped: bool,
    clipped: bool,
}

impl Comparison {
    /// Compares with a threshold in units, one being `unit` in SI.
    ///
    /// `first` is the sample that the chip was armed with.
    pub fn new(reference: Reference, threshold: f32, unit: f64, first: Sample) -> Self {
        let mut software = reactive::Decision::new(0.5, reactive::Rest::Open);
        // At even odds the model's threshold is -b1/b2.
        let (b1, b2) = (-threshold, 1.0);
        software.set_fit(Fit::Model(Logistic { b1, b2 }));
        assert_eq!(software.threshold(), threshold);
        let mut comparison = Self {
            watch: Watch::new(reference),
            software,
            previous: reference == Reference::PreviousSample,
            unit,
            age: 0,
            largest: 0.0,
            newest_clipped: false,
            clipped: false,
        };
        comparison.rearm_at(first);
        comparison
    }

    /// The software's decision about a sample, beside the chip's.
    pub fn decide(&mut self, sample: Sample, chip: bool) -> Decision {
        let x = self.watch.take(&sample.axes);
        let software = self.software.take(x);
        self.newest_clipped = sample.clipped;
        self.clipped |= sample.clipped;
        let change = f64::from(x.expect("armed with a sample")) * self.unit;
        self.age += 1;
        let decision = Decision {
            change,
            threshold: f64::from(self.software.threshold()) * self.unit,
            software,
            chip,
            age: self.age,
            largest: self.largest,
            clipped: self.clipped,
        };
        self.largest = self.largest.max(change);
        decision
    }

    /// A run used the newest sample, and the chip was re-armed with it.
    pub fn rearm(&mut self) {
        if !self.previous {
            self.watch.on_run();
        }
        self.forget();
    }

    /// The chip was re-armed with this sample, about which it decided nothing.
    pub fn rearm_at(&mut self, sample: Sample) {
        self.watch.rearm(sample.axes);
        self.newest_clipped = sample.clipped;
        self.forget();
    }

    fn forget(&mut self) {
        (self.age, self.largest) = (0, 0.0);
        self.clipped = self.newest_clipped;
    }
}

/// Decisions counted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// All of them, but for the clipped ones.
    pub decisions: u64,
    /// Those in which a data register may show too little to compare with.
    pub clipped: u64,
    /// The software asked for a run.
    pub asked: u64,
    /// The chip did not where the software did.
    pub missed: u64,
    /// The chip did where the software did not.
    pub extra: u64,
    /// The largest distance between change and threshold at a disagreement.
    pub worst: f64,
    /// The same as a share of the threshold.
    pub worst_share: f64,
}

impl Tally {
    /// Counts one.
    pub fn note(&mut self, decision: &Decision) {
        if decision.clipped {
            self.clipped += 1;
            return;
        }
        self.decisions += 1;
        self.asked += u64::from(decision.software);
        self.missed += u64::from(decision.is_missed());
        self.extra += u64::from(decision.is_extra());
        if decision.software != decision.chip {
            let distance = decision.distance();
            self.worst = self.worst.max(distance);
            self.worst_share = self.worst_share.max(distance / decision.threshold);
        }
    }

    /// Decisions on which both agree.
    pub fn agreed(&self) -> u64 {
        self.decisions - self.missed - self.extra
    }
}
