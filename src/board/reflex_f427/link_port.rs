//! USART2 at the link's rate: a DMA ring in, DMA blocks out.
//!
//! Incoming bytes land in a ring without an instruction; the line's idle interrupt and the DMA's
//! half and full interrupts say that there is something to take. Outgoing frames are gathered and
//! sent in blocks: nothing waits for the line.

use heapless::Vec;
use reflex::config::LINK_BAUD;
use reflex::tasks::link::{Overrun, Port};
use stm32f4xx_hal::ClearFlags;
use stm32f4xx_hal::dma::traits::{Channel, Stream, StreamISR};
use stm32f4xx_hal::dma::{ChannelX, DmaDirection, Stream5, Stream6};
use stm32f4xx_hal::pac;
use stm32f4xx_hal::rcc::{self, Enable, Reset};

/// Bytes of the ring: 11 ms at 460800 baud, twice what an interrupt every half of it needs.
pub const RING: usize = 512;
/// Bytes of a block going out, and of those gathered for the next.
pub const BLOCK: usize = 128;
/// APB1 clock in Hz.
const PCLK: u32 = 42_000_000;

/// The port with its two DMA streams.
pub struct LinkPort {
    usart: pac::USART2,
    receive: Stream5<pac::DMA1>,
    send: Stream6<pac::DMA1>,
    ring: &'static mut [u8; RING],
    /// The next byte of the ring to be read.
    next: usize,
    block: &'static mut [u8; BLOCK],
    gathered: Vec<u8, BLOCK>,
    sending: bool,
}

impl LinkPort {
    /// Starts to receive; buffers must be where the DMA controller reaches them.
    pub fn start(
        usart: pac::USART2,
        (receive, send): (Stream5<pac::DMA1>, Stream6<pac::DMA1>),
        (ring, block): (&'static mut [u8; RING], &'static mut [u8; BLOCK]),
        rcc: &mut rcc::Rcc,
    ) -> Self {
        pac::USART2::enable(rcc);
        pac::USART2::reset(rcc);
        let mut port = Self {
            usart,
            receive,
            send,
            ring,
            next: 0,
            block,
            gathered: Vec::new(),
            sending: false,
        };
        port.start_receiving();
        port.prepare_sending();
        let divider = (PCLK + LINK_BAUD / 2) / LINK_BAUD;
        port.usart.brr().write(|w| {
            w.div_mantissa().set((divider >> 4) as u16);
            w.div_fraction().set((divider & 0xF) as u8)
        });
        port.usart
            .cr3()
            .write(|w| w.dmar().enabled().dmat().enabled());
        port.usart.cr1().write(|w| {
            w.re().enabled().te().enabled();
            w.idleie().enabled().ue().enabled()
        });
        port
    }

    fn start_receiving(&mut self) {
        let stream = &mut self.receive;
        stream.set_channel(ChannelX::<4>::VALUE);
        stream.set_direction(DmaDirection::PeripheralToMemory);
        stream.set_memory_increment(true);
        stream.set_circular_mode(true);
        stream.set_peripheral_address(self.usart.dr().as_ptr() as u32);
        stream.set_memory_address(self.ring.as_mut_ptr() as u32);
        stream.set_number_of_transfers(RING as u16);
        stream.clear_all_flags();
        stream.listen_half_transfer();
        stream.listen_transfer_complete();
        // SAFETY: configured above; the ring is static and read as volatile bytes only.
        unsafe { stream.enable() };
    }

    fn prepare_sending(&mut self) {
        let stream = &mut self.send;
        stream.set_channel(ChannelX::<4>::VALUE);
        stream.set_direction(DmaDirection::MemoryToPeripheral);
        stream.set_memory_increment(true);
        stream.set_peripheral_address(self.usart.dr().as_ptr() as u32);
        stream.set_memory_address(self.block.as_mut_ptr() as u32);
        stream.listen_transfer_complete();
    }

    /// Where the DMA writes next.
    fn position(&self) -> usize {
        (RING - usize::from(self.receive.number_of_transfers())) % RING
    }

    /// The end of a block: starts the next one.
    pub fn on_sent(&mut self) {
        self.send.clear_all_flags();
        self.sending = false;
        self.send_block();
    }

    fn send_block(&mut self) {
        let length = self.gathered.len();
        if length == 0 {
            return;
        }
        for (place, byte) in self.block.iter_mut().zip(&self.gathered) {
            // SAFETY: a valid reference; volatile, because the DMA controller reads it.
            unsafe { core::ptr::write_volatile(place, *byte) };
        }
        self.gathered.clear();
        self.send.set_number_of_transfers(length as u16);
        self.send.clear_all_flags();
        self.sending = true;
        // SAFETY: configured in `prepare_sending`; the block is static, `length` is within it, and
        // it is written again only after `on_sent`.
        unsafe { self.send.enable() };
    }
}

/// Copies out of the ring, byte by byte.
fn copy(ring: &[u8], into: &mut [u8]) {
    for (byte, place) in into.iter_mut().zip(ring) {
        // SAFETY: a valid reference; volatile, because the DMA controller writes the ring.
        *byte = unsafe { core::ptr::read_volatile(place) };
    }
}

impl Port for LinkPort {
    // Also clears what raised the interrupt.
    fn take(&mut self, into: &mut [u8]) -> Result<usize, Overrun> {
        let status = self.usart.sr().read();
        if status.idle().bit_is_set() || status.ore().bit_is_set() {
            // Status, then data: clears both. The DMA controller has taken the byte long ago.
            self.usart.dr().read();
        }
        self.receive.clear_half_transfer();
        let lapped = self.receive.is_transfer_complete();
        let end = self.position();
        // Bytes up to `end` on the same lap, or on the next one where the ring began anew.
        let lapped = lapped || end < self.next;
        if lapped {
            self.receive.clear_transfer_complete();
        }
        let waiting = if lapped {
            RING - self.next + end
        } else {
            end - self.next
        };
        if waiting > RING {
            self.next = end;
            return Err(Overrun);
        }
        let count = waiting.min(into.len());
        let (into, _) = into.split_at_mut_checked(count).unwrap_or_default();
        let (to_end, anew) = into.split_at_mut(count.min(RING - self.next));
        copy(self.ring.get(self.next..).unwrap_or_default(), to_end);
        copy(&self.ring[..], anew);
        self.next = (self.next + count) % RING;
        Ok(count)
    }

    fn send(&mut self, frame: &[u8]) -> Result<(), Overrun> {
        self.gathered
            .extend_from_slice(frame)
            .map_err(|_| Overrun)?;
        if !self.sending {
            self.send_block();
        }
        Ok(())
    }
}
