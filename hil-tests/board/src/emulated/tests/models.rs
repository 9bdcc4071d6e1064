//! EXTI, SYSCFG, motor timers and link, driven as the core would.

use rigless::chip::uart::Peer;
use rigless::mcu::{Mcu, Operate};
use rigless::soc::Width;
use rigless::time::VirtualNanos;

use super::{Pulse, sensors};
use crate::bus_fault::Script;
use crate::emulated::link::Link;
use crate::emulated::part::Part;
use crate::emulated::wiring;

const RCC_APB1ENR: u64 = 0x4002_3840;
const RCC_APB2ENR: u64 = 0x4002_3844;
const EXTICR1: u64 = 0x4001_3808;
const IMR: u64 = 0x4001_3C00;
const RTSR: u64 = 0x4001_3C08;
const FTSR: u64 = 0x4001_3C0C;
const SWIER: u64 = 0x4001_3C10;
const PR: u64 = 0x4001_3C14;
const TIM3: u64 = 0x4000_0400;

/// The part, whose buses and pins a test drives.
struct DrivenPart(Part);

impl DrivenPart {
    fn new(imu: Pulse) -> Self {
        Self(Part::new(sensors(imu), Link::default(), Script::default()).unwrap())
    }

    fn write(&mut self, at_ns: u64, address: u64, value: u64) {
        self.0
            .write(VirtualNanos(at_ns), address, Width::W32, value)
            .unwrap();
    }

    fn read(&mut self, at_ns: u64, address: u64) -> u64 {
        self.0
            .read(VirtualNanos(at_ns), address, Width::W32)
            .unwrap()
    }

    /// Routes EXTI0 to port C, whose pin 0 pulses.
    fn listen(mut self, trigger: u64) -> Self {
        self.write(0, RCC_APB2ENR, 1 << 14);
        self.write(0, EXTICR1, 0x222);
        self.write(0, trigger, 1);
        self
    }

    /// The session's stops at `instants`, and the interrupts they raised.
    fn stop_at(&mut self, instants: &[u64]) -> Vec<u16> {
        for &at_ns in instants {
            self.0.advance_to(VirtualNanos(at_ns));
            self.0.poll(VirtualNanos(at_ns));
        }
        let raised = self.0.drain_interrupts();
        raised.into_iter().map(|change| change.interrupt).collect()
    }
}

const PULSE: Pulse = Pulse {
    from_ns: 1_000,
    to_ns: 51_000,
    now_ns: 0,
};
const EXTI0_INTERRUPT: u16 = 6;

#[test]
fn a_rising_pin_interrupts_at_its_instant_until_the_pending_bit_is_cleared() {
    let mut part = DrivenPart::new(PULSE).listen(RTSR);
    part.write(0, IMR, 1);
    assert!(part.stop_at(&[0]).is_empty());
    assert_eq!(part.0.next_event(), Some(VirtualNanos(1_000)));
    assert_eq!(part.stop_at(&[1_000]), [EXTI0_INTERRUPT]);
    assert_eq!(part.read(1_000, PR), 1);
    part.write(1_100, PR, 2);
    assert_eq!(part.read(1_100, PR), 1, "a zero leaves the bit alone");
    part.write(1_200, PR, 1);
    assert_eq!(part.read(1_200, PR), 0);
    assert_eq!(
        part.stop_at(&[51_000]),
        [EXTI0_INTERRUPT],
        "the line falls again, once"
    );
    assert_eq!(part.read(51_000, PR), 0, "the falling edge is not selected");
}

#[test]
fn a_falling_pin_is_heard_by_the_falling_trigger_alone() {
    let mut part = DrivenPart::new(PULSE).listen(FTSR);
    part.stop_at(&[0, 1_000]);
    assert_eq!(part.read(1_000, PR), 0);
    part.stop_at(&[51_000]);
    assert_eq!(part.read(51_000, PR), 1);
}

#[test]
fn a_masked_line_pends_without_an_interrupt_until_it_is_unmasked() {
    let mut part = DrivenPart::new(PULSE).listen(RTSR);
    assert!(part.stop_at(&[0, 1_000]).is_empty());
    assert_eq!(part.read(1_000, PR), 1);
    part.write(2_000, IMR, 1);
    assert_eq!(part.stop_at(&[]), [EXTI0_INTERRUPT]);
}

#[test]
fn software_pends_a_line_once_until_it_is_cleared() {
    let mut part = DrivenPart::new(Pulse::default());
    part.write(0, SWIER, 1 << 12);
    assert_eq!(part.read(0, PR), 1 << 12);
    part.write(0, PR, 1 << 12);
    assert_eq!((part.read(0, PR), part.read(0, SWIER)), (0, 0));
}

#[test]
fn another_port_on_the_line_hears_nothing() {
    let mut part = DrivenPart::new(PULSE).listen(RTSR);
    part.write(0, EXTICR1, 0x221);
    part.write(0, IMR, 1);
    assert!(part.stop_at(&[0, 1_000]).is_empty());
    let problems = wiring::problems(&part.0, 0);
    let wrong = "EXTI0 listens at PB0, but MPU6050 INT is at PC0";
    assert!(
        problems.iter().any(|problem| problem == wrong),
        "{problems:?}"
    );
}

#[test]
fn a_selector_written_without_its_clock_is_lost_and_told() {
    let mut part = DrivenPart::new(PULSE);
    part.write(0, EXTICR1, 0x222);
    assert_eq!(part.read(0, EXTICR1), 0);
    assert_eq!(part.0.drain_told()[0].register, "EXTICR1");
}

/// TIM3 at 16 MHz (the internal oscillator) with a period of 1000 ticks.
fn part_with_motors() -> DrivenPart {
    let mut part = DrivenPart::new(Pulse::default());
    part.write(0, RCC_APB1ENR, 1 << 1);
    part.0.settle(&mut NoMemory).unwrap();
    for (offset, value) in [
        (0x2C, 999),
        (0x18, 0x6868),
        (0x20, 0x1),
        (0x14, 1),
        (0x00, 0x81),
    ] {
        part.write(0, TIM3 + offset, value);
    }
    part
}

struct NoMemory;

impl rigless::emulator::Memory for NoMemory {
    fn read(&mut self, address: u64, width: Width) -> Result<u64, rigless::emulator::Error> {
        Err(rigless::emulator::Error::Memory { address, width })
    }
    fn write(
        &mut self,
        address: u64,
        width: Width,
        _: u64,
    ) -> Result<(), rigless::emulator::Error> {
        Err(rigless::emulator::Error::Memory { address, width })
    }
}

#[test]
fn a_pulse_is_programmed_at_once_and_applied_at_the_next_update_event() {
    let mut part = part_with_motors();
    part.write(100_000, TIM3 + 0x34, 160);
    let write = part.0.timers[0].writes[0];
    assert_eq!(
        (write.at_ns, write.pulse_ns, write.driven),
        (100_000, 10_000, true)
    );
    assert_eq!(write.applied_ns, 125_000, "the period is 62.5 us");
    assert_eq!(part.0.timers[0].period_ns(), Some(62_500));
    assert_eq!(part.0.driven(), 1);
}

#[test]
fn the_counter_follows_the_virtual_clock() {
    let mut part = part_with_motors();
    assert_eq!(part.read(62_500 + 1_000, TIM3 + 0x24), 16);
    assert_eq!(
        part.read(63_500, TIM3 + 0x10),
        1,
        "an update event has come"
    );
    part.write(63_500, TIM3 + 0x10, 0);
    assert_eq!(part.read(63_500, TIM3 + 0x10), 0);
}

#[test]
fn a_new_period_waits_for_the_update_event() {
    let mut part = part_with_motors();
    part.write(10_000, TIM3 + 0x2C, 1_999);
    part.write(20_000, TIM3 + 0x34, 160);
    part.write(70_000, TIM3 + 0x34, 320);
    let writes = &part.0.timers[0].writes;
    assert_eq!(writes[0].applied_ns, 62_500);
    assert_eq!(writes[1].applied_ns, 62_500 + 125_000);
}

#[test]
fn what_the_motor_timers_do_not_play_is_told() {
    let mut part = part_with_motors();
    part.write(0, TIM3 + 0x0C, 1);
    part.write(0, TIM3 + 0x20, 0x3);
    let registers: Vec<_> = part
        .0
        .drain_told()
        .iter()
        .map(|told| told.register)
        .collect();
    assert_eq!(registers, ["DIER", "CCER"]);
}

#[test]
fn a_part_out_of_reset_has_every_pin_wrong() {
    let problems = wiring::problems(&DrivenPart::new(Pulse::default()).0, 0b1_0000);
    let motor = "PD12 (TIM4_CH1) is an input, not AF2 push-pull";
    assert!(
        problems.iter().any(|problem| problem == motor),
        "{problems:?}"
    );
    assert!(
        !problems.iter().any(|problem| problem.starts_with("PC6")),
        "motor 1 is not driven"
    );
}

#[test]
fn a_frame_begins_at_its_instant_and_the_next_follows_it() {
    let mut link = Link::default();
    let asked = |link: &mut Link, at_ns| link.transmit(VirtualNanos(at_ns));
    assert_eq!(asked(&mut link, 0), None);
    link.schedule(100, vec![1, 2]);
    link.schedule(101, vec![3]);
    assert_eq!(link.next_start(), 100);
    assert_eq!(asked(&mut link, 99), None);
    let heard: Vec<_> = (0..4)
        .map(|byte| asked(&mut link, 100 + 22 * byte))
        .collect();
    assert_eq!(heard, [Some(1), Some(2), Some(3), None]);
    assert_eq!(link.used().received, 3);
}

#[test]
fn a_frame_before_the_receiver_is_enabled_is_lost() {
    let mut link = Link::default();
    link.schedule(100, vec![1, 2]);
    link.schedule(200, vec![3]);
    assert_eq!(link.transmit(VirtualNanos(150)), None);
    assert_eq!(link.transmit(VirtualNanos(200)), Some(3));
    assert_eq!(link.used().lost, 2);
}
