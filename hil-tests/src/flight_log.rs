//! Flight logs: flights written down for the tools that people know.
//!
//! ```text
//! calls of either tier -> mirror -> rows of topics -> MCAP (protobuf) or ULog
//! ```
//! The calls of an autopilot say all that it did; made again on the host they also say what it thought.
//! So a flight log needs nothing of the board, and stamps are those of the firmware: the same flight
//! gives the same bytes. What was flown is on disk after a second, whatever ends the program.

mod mcap;
mod protobuf;
#[cfg(test)]
mod tests;
mod topics;
mod ulog;

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use reflex::app::{Call, Event, Ran, Stamped};
use reflex::control::{Setpoint, Yaw};
use reflex::link::Message;
use reflex::math::Quaternion;
use reflex::reactive::{Fit, Refit};
use reflex::reset::Mode;
use reflex::safety::FlightState;
use reflex::sensors::{ChipSample, Input};

use crate::logics::Start;
use crate::output_file::OutputFile;
use crate::record::Mirror;
use crate::refusal::Refusal;
use topics::{FITS, MOST_MOTORS, Topic};

/// The option that names the file.
const OPTION: &str = "record";
/// Time of the flight between two instants at which all is on disk, us.
const FLUSH_US: u64 = 1_000_000;

/// A format, under way in a file.
trait LogFile {
    /// Writes a row of a topic.
    fn row(&mut self, at_us: u64, topic: Topic, numbers: &[f32]) -> Result<()>;

    /// Writes a line of text.
    fn line(&mut self, at_us: u64, text: &str) -> Result<()>;

    /// What was written is on disk, and can be read.
    fn flush(&mut self) -> Result<()>;

    /// Writes what stands at the end.
    fn finish(self: Box<Self>) -> Result<()>;
}

/// How the log of a format begins.
type Begin = fn(BufWriter<File>) -> Result<Box<dyn LogFile>>;

/// The formats by their extensions.
const FORMATS: [(&str, Begin); 2] = [
    ("mcap", |file| Ok(Box::new(mcap::McapFile::begin(file)?))),
    ("ulg", |file| Ok(Box::new(ulog::UlogFile::begin(file)?))),
];

/// The log of one flight under way.
pub(crate) struct FlightLog {
    path: PathBuf,
    file: Box<dyn LogFile>,
    mirror: Mirror,
    /// How many of a growing list of calls were taken.
    taken: usize,
    /// Flight state and mode as they were last told.
    told: Option<(FlightState, Mode)>,
    flushed_us: u64,
}

impl FlightLog {
    /// Refuses a file that no log can be written to, before anything is flown.
    pub(crate) fn check(path: &Path) -> Result<(), Refusal> {
        let file = OutputFile::new(OPTION, path);
        file.check()?;
        file.check_is_no_pipe()?;
        format_of(path).map(drop)
    }

    /// Refuses the recorded flight itself, which would be lost.
    pub(crate) fn check_is_not(path: &Path, flight: &Path) -> Result<(), Refusal> {
        OutputFile::new(OPTION, path).check_is_not(flight)
    }

    /// Opens the file for a flight of an autopilot that is given this at its start.
    ///
    /// # Errors
    /// A file that cannot be written, or whose extension names no format.
    pub(crate) fn create(path: &Path, start: &Start) -> Result<Self> {
        let begin = format_of(path)?;
        let file = OutputFile::new(OPTION, path).create()?;
        Ok(Self {
            path: path.to_owned(),
            file: begin(file).with_context(|| unwritable(path))?,
            mirror: Mirror::new(start),
            taken: 0,
            told: None,
            flushed_us: 0,
        })
    }

    /// Takes what is new of a list of calls that grows.
    ///
    /// # Errors
    /// A file that cannot be written; calls that give another command on the host.
    pub(crate) fn follow(&mut self, calls: &[Stamped]) -> Result<()> {
        for stamped in &calls[self.taken..] {
            self.take(stamped)?;
        }
        self.taken = calls.len();
        Ok(())
    }

    /// Takes a call.
    ///
    /// # Errors
    /// As those of [`Self::follow`].
    pub(crate) fn take(&mut self, stamped: &Stamped) -> Result<()> {
        self.mirror.take(stamped)?;
        let written = self.write(stamped);
        written.with_context(|| unwritable(&self.path))
    }

    /// Takes how a simulated drone truly is: its attitude, its position and velocity.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(crate) fn truth(
        &mut self,
        at_us: u64,
        attitude: [f32; 4],
        [position, velocity]: [[f32; 3]; 2],
    ) -> Result<()> {
        let place = [position, velocity].concat();
        let attitude = attitude_row(attitude);
        let written = (self.file)
            .row(at_us, Topic::TrueAttitude, &attitude)
            .and_then(|()| self.file.row(at_us, Topic::TruePlace, &place));
        written.with_context(|| unwritable(&self.path))
    }

    /// Ends the log.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(crate) fn finish(self) -> Result<()> {
        let finished = self.file.finish();
        finished.with_context(|| unwritable(&self.path))
    }

    fn write(&mut self, stamped: &Stamped) -> Result<()> {
        let at_us = stamped.at.ticks();
        match &stamped.call {
            Call::Imu(reading) => {
                let axes = [reading.rates.0, reading.force.0].map(|axes| axes.to_array());
                let numbers = [&axes.concat()[..], &[reading.temperature]].concat();
                self.file.row(at_us, Topic::Imu, &numbers)?;
            }
            Call::Chip(sample) => self.sample(at_us, sample)?,
            Call::Message(message) => self.message(at_us, message)?,
            Call::Battery(reading) => {
                let numbers = [reading.volts, reading.amps];
                self.file.row(at_us, Topic::Battery, &numbers)?;
            }
            Call::Ran(ran) => self.run(at_us, ran)?,
            Call::Judged(changed) => {
                self.file.row(at_us, Topic::Verdict, &[flag(*changed)])?;
            }
            Call::Refit(refit) => self.model(at_us, refit)?,
            _ => {}
        }
        self.state(at_us)?;
        while let Some(event) = self.mirror.next_event() {
            // Runs have a topic of their own.
            if !matches!(event, Event::Ran { .. } | Event::Runs(_)) {
                self.file.line(at_us, &format!("{event:?}"))?;
            }
        }
        if at_us >= self.flushed_us + FLUSH_US {
            self.flushed_us = at_us;
            self.file.flush()?;
        }
        Ok(())
    }

    fn sample(&mut self, at_us: u64, sample: &ChipSample) -> Result<()> {
        let topic = match sample.input {
            Input::ChipAccel => Topic::Accelerometer,
            Input::ChipMag => Topic::Magnetometer,
            // No chip with a clock of its own delivers them.
            Input::Gyro | Input::Accel | Input::Turned | Input::Command | Input::Owed => {
                return Ok(());
            }
        };
        let [x, y, z] = sample.axes.to_array();
        let numbers = [x, y, z, f32::from(sample.cause as u8)];
        self.file.row(at_us, topic, &numbers)
    }

    fn message(&mut self, at_us: u64, message: &Message) -> Result<()> {
        match message {
            Message::Setpoint(setpoint) => {
                self.file
                    .row(at_us, Topic::Setpoint, &setpoint_row(setpoint))
            }
            Message::Goal(goal) => {
                let axes = [goal.position.0, goal.velocity.0].map(|axes| axes.to_array());
                let heading = goal.heading.unwrap_or(f32::NAN);
                let numbers = [&axes.concat()[..], &[heading]].concat();
                self.file.row(at_us, Topic::Goal, &numbers)
            }
            Message::Pose(pose) => {
                let axes = [pose.position.0, pose.velocity.0].map(|axes| axes.to_array());
                // Both come whole, or not at all.
                let numbers = [&axes.concat()[..], &[1.0; 4]].concat();
                self.file.row(at_us, Topic::Place, &numbers)
            }
            // What they do shows in the flight's state and in the lines.
            _ => Ok(()),
        }
    }

    /// A run: why, what came of it, and the estimate behind it.
    fn run(&mut self, at_us: u64, ran: &Ran) -> Result<()> {
        let autopilot = self.mirror.autopilot();
        let mut decision = vec![
            f32::from(ran.reason.number()),
            ran.expected.unwrap_or(f32::NAN),
        ];
        for input in Input::ALL {
            let change = autopilot.change_met(input);
            let probability = match (change, autopilot.fit(input)) {
                (Some(change), Fit::Model(model)) => model.probability(change),
                _ => f32::NAN,
            };
            decision.extend([
                flag(ran.asked.contains(input)),
                change.unwrap_or(f32::NAN),
                probability,
                autopilot.threshold(input),
            ]);
        }
        let attitude = attitude_row(autopilot.telemetry().attitude.to_array());
        let mut motors = [f32::NAN; MOST_MOTORS];
        for (motor, share) in motors.iter_mut().zip(ran.shares.iter()) {
            *motor = *share;
        }
        self.file.row(at_us, Topic::Decision, &decision)?;
        self.file.row(at_us, Topic::Command, &motors)?;
        self.file.row(at_us, Topic::Attitude, &attitude)
    }

    fn model(&mut self, at_us: u64, refit: &Refit) -> Result<()> {
        let autopilot = self.mirror.autopilot();
        let (fit, [b1, b2]) = match autopilot.fit(refit.input) {
            Fit::Unfit => (0.0, [f32::NAN; 2]),
            Fit::Irrelevant => (1.0, [f32::NAN; 2]),
            Fit::Model(model) => (FITS.len() as f32 - 1.0, [model.b1, model.b2]),
        };
        let threshold = autopilot.threshold(refit.input);
        let numbers = [f32::from(refit.input as u8), fit, b1, b2, threshold];
        self.file.row(at_us, Topic::Model, &numbers)
    }

    /// Flight state and mode, where either is new.
    fn state(&mut self, at_us: u64) -> Result<()> {
        let telemetry = self.mirror.autopilot().telemetry();
        let (state, mode) = (telemetry.state, telemetry.mode());
        if self.told == Some((state, mode)) {
            return Ok(());
        }
        self.told = Some((state, mode));
        // PX4's numbers: initialising, disarmed, armed.
        let arming = match state {
            FlightState::Calibrating => 0.0,
            _ if state.is_armed() => 2.0,
            _ => 1.0,
        };
        let numbers = [state.number(), mode.number()].map(f32::from);
        let numbers = [&numbers[..], &[arming]].concat();
        self.file.row(at_us, Topic::State, &numbers)?;
        self.file
            .row(at_us, Topic::Landed, &[flag(!state.is_in_the_air())])
    }
}

/// The format that a file's extension names.
fn format_of(path: &Path) -> Result<Begin, Refusal> {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let format = FORMATS
        .iter()
        .find(|(name, _)| extension.is_some_and(|own| own.eq_ignore_ascii_case(name)));
    match format {
        Some((_, begin)) => Ok(*begin),
        None => {
            let known = FORMATS.map(|(name, _)| format!(".{name}")).join(" or ");
            Err(OutputFile::new(OPTION, path).refusal(format_args!("must end in {known}")))
        }
    }
}

fn unwritable(path: &Path) -> String {
    format!("--{OPTION} {}: cannot be written", path.display())
}

fn flag(yes: bool) -> f32 {
    f32::from(u8::from(yes))
}

/// A quaternion, and the angles that it is read by.
fn attitude_row(q: [f32; 4]) -> [f32; 7] {
    let [w, x, y, z] = q.map(f64::from);
    let rotation = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
    let (roll, pitch, yaw) = rotation.euler_angles();
    let [w, x, y, z] = q;
    [w, x, y, z, roll as f32, pitch as f32, yaw as f32]
}

fn setpoint_row(setpoint: &Setpoint) -> Vec<f32> {
    let attitude = setpoint.attitude.map(Quaternion::to_array);
    let rest = [setpoint.thrust.share(), flag(setpoint.yaw == Yaw::Heading)];
    [
        &attitude.unwrap_or([f32::NAN; 4])[..],
        &setpoint.rates.0.to_array(),
        &rest,
    ]
    .concat()
}
