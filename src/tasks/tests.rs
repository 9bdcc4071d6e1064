//! The tasks on a board of the tests' own: what they raise, and what they bring.

use super::chips::{Chips, Done, Fetches, Work, serve};
use super::control::{LONGEST_SLEEP, Motors, failsafe, hyperperiod};
use super::imu::{Guard, Remedy, Report, received};
use super::link::{Link, Overrun, Port, receive};
use super::mpu6050::Sensor;
use super::store::{keep, restored};
use super::*;
use crate::app::{Autopilot, ChipOrder, ChipSetting, Fault, OrderError, StoreEvent};
use crate::config::SETTINGS;
use crate::graph::{CONFIGURED, Cascade};
use crate::link::{Answer, Message, SigningKey, StoreCommand};
use crate::safety::{FlightState, MotorOutput};
use crate::sensors::{Cause, Input};
use crate::settings::{Parameter, Settings};
use crate::store::tests::Nor;
use crate::store::{Content, Found, Store};
use crate::time::{at_micros, micros};
use mavlink::dialects::common::SETUP_SIGNING_DATA;
use mavlink::{MAVLinkV2MessageRaw, MavHeader};
use reflex_drivers::mpu6050::CHECKS;
use reflex_drivers::orders::{Obeyed, Sample};

type Pilot = Autopilot<(), Cascade>;

fn pilot() -> Pilot {
    Autopilot::with_logic(SETTINGS, (), Cascade::default())
}

/// Notes what is raised; time passes by a microsecond with every look.
#[derive(Default)]
struct Noted {
    now: u64,
    raised: Vec<Task>,
    hyperperiod_at: Option<Instant>,
}

impl Board for Noted {
    fn now(&mut self) -> Instant {
        self.now += 1;
        at_micros(self.now)
    }

    fn raise(&mut self, task: Task) {
        self.raised.push(task);
    }

    fn raise_hyperperiod_at(&mut self, at: Instant) {
        self.hyperperiod_at = Some(at);
    }
}

#[derive(Default)]
struct Written(u32);

impl Motors for Written {
    fn write(&mut self, _: &MotorOutput) {
        self.0 += 1;
    }
}

/// Chips that obey, or whose bus fails.
struct Played {
    fails: bool,
    work: Vec<Work>,
}

impl Chips for Played {
    fn fetch(&mut self, input: Input) -> Result<Sample, OrderError> {
        self.work.push(Work::Fetch(input, at_micros(0)));
        if self.fails {
            return Err(OrderError::Bus);
        }
        Ok(Sample {
            axes: [0.0; 3],
            cause: Cause::DataReady,
        })
    }

    fn execute(&mut self, order: ChipOrder) -> Result<Obeyed, OrderError> {
        self.work.push(Work::Order(order));
        if self.fails {
            return Err(OrderError::Bus);
        }
        Ok(Obeyed {
            sample: None,
            setting: ChipSetting::EverySample,
        })
    }
}

fn served(fetches: &mut Fetches, fails: bool) -> (Vec<Work>, Noted, Pilot) {
    let (mut board, mut pilot) = (Noted::default(), pilot());
    let work = Vec::new();
    let mut chips = Played { fails, work };
    serve(
        &mut board,
        &mut Unshared(fetches),
        &mut Unshared(&mut pilot),
        &mut chips,
    );
    (chips.work, board, pilot)
}

#[test]
fn samples_are_fetched_before_orders_are_carried_out() {
    let mut fetches = Fetches::default();
    fetches.ask(Input::ChipMag, at_micros(7));
    fetches.ask(Input::ChipAccel, at_micros(8));
    let (work, board, _) = served(&mut fetches, false);
    let fetched = |work: &Work| matches!(work, Work::Fetch(..));
    assert_eq!(work.len(), 4, "{work:?}");
    assert!(work[..2].iter().all(fetched) && !work[2..].iter().any(fetched));
    assert_eq!(board.raised, []);
}

#[test]
fn a_second_interrupt_before_the_fetch_takes_the_place_of_the_first() {
    let mut fetches = Fetches::default();
    fetches.ask(Input::ChipMag, at_micros(7));
    fetches.ask(Input::ChipMag, at_micros(9));
    assert_eq!(fetches.take(), Some((Input::ChipMag, at_micros(9))));
    assert_eq!(fetches.take(), None);
}

#[test]
fn after_an_order_that_failed_the_owner_waits_to_be_raised() {
    let mut fetches = Fetches::default();
    fetches.ask(Input::ChipAccel, at_micros(7));
    let (work, board, pilot) = served(&mut fetches, true);
    assert!(
        matches!(work[..], [Work::Fetch(..), Work::Order(_)]),
        "{work:?}"
    );
    assert_eq!(board.raised, []);
    assert_eq!(pilot.faults(Fault::ChipBus), 2);
}

#[test]
fn an_order_is_reported_with_the_time_at_which_its_bus_was_done() {
    let (mut board, mut pilot) = (Noted::default(), pilot());
    let order = pilot.next_order().expect("a chip to program");
    let done = Done::Ordered(order, Err(OrderError::Identity));
    let report = done.report(&mut board, &mut Unshared(&mut pilot));
    assert_eq!((report, board.now), (Err(OrderError::Identity), 1));
}

#[test]
fn a_run_writes_the_motors_and_raises_the_owner_of_the_chips() {
    let (mut board, mut pilot, mut motors) = (Noted::default(), pilot(), Written::default());
    let (pilot, written) = (&mut Unshared(&mut pilot), &mut Unshared(&mut motors));
    hyperperiod(&mut board, pilot, written);
    assert_eq!(board.raised, [], "nothing was due");
    board.now = SETTINGS.failsafe.ticks();
    let mut guard = Guard::<Sensor>::new(at_micros(board.now));
    failsafe(&mut board, pilot, written, &mut Unshared(&mut guard));
    assert_eq!(board.raised, [Task::Chips, Task::Idle]);
    assert_eq!(motors.0, 1);
}

#[test]
fn the_failsafe_sleeps_no_longer_than_a_watchdog_allows() {
    let (mut board, mut motors) = (Noted::default(), Written::default());
    let mut pilot = Autopilot::with_logic(
        Settings {
            failsafe: micros(900_000),
            ..SETTINGS
        },
        (),
        Cascade::default(),
    );
    let mut guard = Guard::<Sensor>::new(at_micros(0));
    let next = failsafe(
        &mut board,
        &mut Unshared(&mut pilot),
        &mut Unshared(&mut motors),
        &mut Unshared(&mut guard),
    );
    assert_eq!(next, at_micros(1) + LONGEST_SLEEP);
}

#[test]
fn a_silent_sensor_is_repaired_and_each_check_follows_a_burst_in_time() {
    let mut guard = Guard::<Sensor>::new(at_micros(0));
    assert_eq!(
        guard.check(at_micros(0), || at_micros(400)),
        None,
        "not asked for"
    );
    assert!(!guard.is_silent(at_micros(20_000)));
    assert!(guard.is_silent(at_micros(20_001)));
    assert_eq!(
        guard.check(at_micros(0), || at_micros(600)),
        None,
        "too late"
    );
    for _ in 0..2 {
        for expected in CHECKS {
            assert_eq!(guard.check(at_micros(0), || at_micros(599)), Some(expected));
        }
        assert_eq!(guard.check(at_micros(0), || at_micros(599)), None, "once");
        guard.hear(at_micros(30_000));
        assert!(!guard.is_silent(at_micros(40_000)));
    }
}

#[test]
fn two_bursts_that_fail_in_a_row_call_for_a_repair() {
    let mut guard = Guard::<Sensor>::new(at_micros(0));
    assert!(!guard.fail());
    guard.hear(at_micros(1_000));
    assert!(!guard.fail());
    assert!(guard.fail());
    assert!(!guard.fail(), "counted anew");
}

#[test]
fn a_sensor_that_answers_and_still_samples_nothing_is_reset() {
    let mut guard = Guard::<Sensor>::new(at_micros(0));
    assert_eq!(guard.remedy(at_micros(90_000)), Remedy::Configure);
    guard.repaired(at_micros(100_000), false);
    assert_eq!(guard.remedy(at_micros(190_000)), Remedy::Configure);
    guard.repaired(at_micros(200_000), true);
    assert_eq!(guard.remedy(at_micros(220_000)), Remedy::Configure, "soon");
    assert_eq!(guard.remedy(at_micros(220_001)), Remedy::Reset);
    guard.hear(at_micros(221_000));
    assert_eq!(guard.remedy(at_micros(290_000)), Remedy::Configure);
}

#[test]
fn reports_of_the_sensor_become_samples_faults_and_repairs() {
    let (mut board, mut pilot) = (Noted::default(), pilot());
    let mut take = |report: &Report<Sensor>| {
        received(&mut board, &mut Unshared(&mut pilot), report).map(|found| found.register)
    };
    assert_eq!(take(&Report::Burst(at_micros(5), [0; 15])), None);
    assert_eq!(
        take(&Report::Fault(at_micros(6), Fault::ImuOverrun, false)),
        None
    );
    let [identity, ..] = CHECKS;
    assert_eq!(take(&Report::Check(identity, [0x68, 0, 0, 0])), None);
    assert_eq!(take(&Report::Check(identity, [0x70, 0, 0, 0])), Some(0x75));
    let failed = Report::<Sensor>::Fault(at_micros(7), Fault::ImuBus, true);
    received(&mut board, &mut Unshared(&mut pilot), &failed);
    let faults = [
        Fault::ImuStale,
        Fault::ImuOverrun,
        Fault::ImuConfiguration,
        Fault::ImuBus,
    ];
    assert_eq!(faults.map(|fault| pilot.faults(fault)), [1; 4]);
    assert_eq!(board.raised, [Task::RepairImu; 2]);
}

/// A port with these bytes to be taken, or one that lost some.
struct Bytes(Result<Vec<u8>, Overrun>);

/// A port with these bytes to be taken, that keeps what is sent.
struct Talk {
    heard: Vec<u8>,
    said: Vec<Vec<u8>>,
}

impl Port for Talk {
    fn take(&mut self, into: &mut [u8]) -> Result<usize, Overrun> {
        let count = self.heard.len().min(into.len());
        into[..count].copy_from_slice(&self.heard[..count]);
        self.heard.drain(..count);
        Ok(count)
    }

    fn send(&mut self, frame: &[u8]) -> Result<(), Overrun> {
        self.said.push(frame.to_vec());
        Ok(())
    }
}

impl Port for Bytes {
    fn take(&mut self, into: &mut [u8]) -> Result<usize, Overrun> {
        let bytes = self.0.as_mut().map_err(|lost| *lost)?;
        let count = bytes.len().min(into.len());
        into[..count].copy_from_slice(&bytes[..count]);
        bytes.drain(..count);
        Ok(count)
    }

    fn send(&mut self, _: &[u8]) -> Result<(), Overrun> {
        Ok(())
    }
}

#[test]
fn bytes_that_were_lost_are_a_fault() {
    for (bytes, fault) in [
        (Err(Overrun), Some(Fault::LinkOverrun)),
        (Ok(vec![0; 200]), None),
    ] {
        let (mut board, mut pilot) = (Noted::default(), pilot());
        let mut link = Link::new(Bytes(bytes), true, 4);
        receive(
            &mut board,
            &mut Unshared(&mut link),
            &mut Unshared(&mut pilot),
        );
        let counted = pilot.faults(Fault::LinkOverrun) + pilot.faults(Fault::LinkFrame);
        assert_eq!(counted, u32::from(fault.is_some()));
    }
}

#[test]
fn a_signing_key_is_taken_over_a_cable_only() {
    let setup = SETUP_SIGNING_DATA {
        target_system: 1,
        secret_key: [7; 32],
        ..SETUP_SIGNING_DATA::DEFAULT
    };
    let mut frame = MAVLinkV2MessageRaw::new();
    frame.serialize_message_data(MavHeader::default(), &setup);
    for (wired, told) in [
        (true, "signing key: set"),
        (false, "signing key refused: not wired"),
    ] {
        let (mut board, mut pilot) = (Noted::default(), pilot());
        let port = Talk {
            heard: frame.raw_bytes().to_vec(),
            said: Vec::new(),
        };
        let mut link = Link::new(port, wired, 4);
        receive(
            &mut board,
            &mut Unshared(&mut link),
            &mut Unshared(&mut pilot),
        );
        link.beat(at_micros(5), FlightState::Disarmed);
        let [notice, beat] = &link.port().said[..] else {
            panic!("a notice and a heartbeat");
        };
        assert_eq!(&notice[11..11 + told.len()], told.as_bytes());
        // Frames of ours are signed, and others must be.
        assert_eq!([notice[2], beat[2]], [u8::from(wired); 2]);
        link.port().heard = frame.raw_bytes().to_vec();
        receive(
            &mut board,
            &mut Unshared(&mut link),
            &mut Unshared(&mut pilot),
        );
        assert_eq!(link.port().said.len(), if wired { 2 } else { 3 });
        assert_eq!(pilot.faults(Fault::LinkFrame), u32::from(wired));
    }
}

#[test]
fn what_was_set_once_holds_at_the_next_start() {
    let (mut board, mut pilot, mut store) = (Noted::default(), pilot(), Store::new(Nor::erased()));
    let port = Talk {
        heard: Vec::new(),
        said: Vec::new(),
    };
    let mut link = Link::new(port, true, 4);
    let key = SigningKey::new([7; 32], 9).expect("48 bits");
    link.restore(at_micros(0), key);
    let mut given = CONFIGURED;
    given.settings.hard_iron = [0.25, 0.0, -0.5];
    let mut turn = |pilot: &mut Pilot, store: &mut Store<Nor>| {
        let (mut pilot, mut link) = (Unshared(pilot), Unshared(&mut link));
        keep(
            &mut board,
            &mut pilot,
            &mut link,
            store,
            &CONFIGURED,
            |_| given,
        );
        store.load()
    };
    // Nothing is to be stored: nothing is.
    assert_eq!(
        turn(&mut pilot, &mut store),
        (Found::Empty, Content::default())
    );

    pilot.on_store(at_micros(1), StoreEvent::KeyDue);
    let (found, held) = turn(&mut pilot, &mut store);
    assert_eq!((found, held.key), (Found::Sound, Some(key)));
    assert!(held.parameters.is_empty());

    let command = |what| Message::Store(what);
    let (_, answer) = pilot.on_message(at_micros(2), &command(StoreCommand::Save));
    assert_eq!(answer, Some(Answer::Accepted));
    let (found, held) = turn(&mut pilot, &mut store);
    assert_eq!(held.parameters.len(), 2);
    assert_eq!(
        restored(&CONFIGURED, &held.parameters, found),
        (given, Found::Sound)
    );

    let _ = pilot.on_message(at_micros(3), &command(StoreCommand::Reset));
    let (_, held) = turn(&mut pilot, &mut store);
    assert_eq!((held.parameters.len(), held.key), (0, Some(key)));
}

#[test]
fn what_this_build_does_not_know_is_left_out_and_values_out_of_range_have_all_refused() {
    let unknown = Parameter {
        number: 1,
        word: [0; 4],
    };
    let restored = |parameters: &[Parameter]| restored(&CONFIGURED, parameters, Found::Sound);
    assert_eq!(restored(&[]), (CONFIGURED, Found::Sound));
    let mut known = CONFIGURED;
    known.settings.p_run = 0.7;
    let mut both = vec![unknown];
    known.beyond(&CONFIGURED, &mut |parameter| both.push(parameter));
    assert_eq!(restored(&both), (known, Found::PartlyKnown));
    let mut wrong = CONFIGURED;
    wrong.settings.p_run = 7.0;
    let mut held = vec![];
    wrong.beyond(&CONFIGURED, &mut |parameter| held.push(parameter));
    assert_eq!(restored(&held), (CONFIGURED, Found::OtherVersion));
}

#[test]
fn what_is_asked_for_is_raised() {
    let mut board = Noted::default();
    follow(&mut board, Next::Wait);
    follow(&mut board, Next::Hyperperiod);
    follow(&mut board, Next::HyperperiodAt(at_micros(9)));
    assert_eq!(board.raised, [Task::Hyperperiod]);
    assert_eq!(board.hyperperiod_at, Some(at_micros(9)));
}
