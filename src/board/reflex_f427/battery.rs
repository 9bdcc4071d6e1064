//! Voltage and current of the battery: ADC1 over PC3 and PC5, by DMA2 stream 0.
//!
//! Each look takes the last conversion of both and begins the next: 47 us that nobody waits for.

use core::sync::atomic::{AtomicU16, Ordering};

use reflex::app::{Autopilot, Recorder};
use reflex::battery::{BatteryReading, LOOK};
use reflex::graph::ControlLogic;
use reflex::tasks::Lock;
use reflex::time::Duration;
use stm32f4xx_hal::gpio::{PC3, PC5};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{self, Enable};

use crate::board::{now, sleep};

/// Channels of PC3 and PC5.
const CHANNELS: [u32; 2] = [13, 15];

/// Where the controller stores both.
static SAMPLES: [AtomicU16; 2] = [AtomicU16::new(0), AtomicU16::new(0)];

/// What measures the battery.
pub struct Gauge(pac::ADC1);

impl Gauge {
    /// Ready for the first look.
    pub fn start(
        (converter, common, controller): (pac::ADC1, pac::ADC_COMMON, &pac::DMA2),
        (voltage, current): (PC3, PC5),
        rcc: &mut rcc::Rcc,
    ) -> Self {
        let _ = (voltage.into_analog(), current.into_analog());
        pac::ADC1::enable(rcc);
        pac::DMA2::enable(rcc);
        let stream = controller.st(0);
        // SAFETY: the converter's data register, and memory of both samples, atomic and for ever.
        unsafe {
            stream
                .par()
                .write(|w| w.bits(converter.dr().as_ptr() as u32));
            stream.m0ar().write(|w| w.bits(SAMPLES.as_ptr() as u32));
        }
        stream.ndtr().write(|w| w.ndt().set(2));
        stream.cr().write(|w| {
            w.chsel().set(0).psize().bits16().msize().bits16();
            w.minc().incremented().circ().enabled().en().enabled()
        });
        // 84 MHz by 4: at most 36 MHz are allowed.
        common.ccr().write(|w| w.adcpre().div4());
        converter.cr1().write(|w| w.scan().enabled());
        converter
            .smpr1()
            .write(|w| w.smp13().cycles480().smp15().cycles480());
        converter.sqr1().write(|w| w.l().set(1));
        let [first, second] = CHANNELS;
        // SAFETY: channels that the converter has.
        unsafe { converter.sqr3().write(|w| w.bits(first | second << 5)) };
        converter
            .cr2()
            .write(|w| w.dma().enabled().dds().continuous().adon().enabled());
        Self(converter)
    }

    /// The last conversion; zeros where there was none since the last look.
    fn read(&mut self) -> BatteryReading {
        let steps = SAMPLES.each_ref().map(|sample| {
            let steps = sample.load(Ordering::Relaxed);
            sample.store(0, Ordering::Relaxed);
            steps
        });
        self.0.cr2().modify(|_, w| w.swstart().start());
        BatteryReading::of_steps(steps)
    }

    /// Measures for so long, look by look.
    pub async fn watch<R: Recorder, L: ControlLogic>(
        &mut self,
        length: Duration,
        pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    ) {
        for _ in 0..length / LOOK {
            self.tell(pilot);
            sleep(LOOK).await;
        }
    }

    /// Tells the autopilot what was measured, and the log a new state.
    fn tell<R: Recorder, L: ControlLogic>(
        &mut self,
        pilot: &mut impl Lock<Target = Autopilot<R, L>>,
    ) {
        let reading = self.read();
        if let Some(state) = pilot.lock(|pilot| pilot.on_battery(now(), &reading)) {
            defmt::warn!("battery {}: {}", state, reading);
        }
    }
}
