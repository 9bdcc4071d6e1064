//! The firmware's interrupt handlers, and what each is for.

/// Handlers as the table at the head of the firmware's `main.rs` has them: the way of a sample
/// first, from its interrupt to the end of its hyperperiod.
pub(crate) const HANDLERS: [(&str, &str); 14] = [
    ("EXTI0", "IMU interrupt"),
    ("I2C1_EV", "step of a burst"),
    ("DMA1_STREAM0", "IMU sample"),
    ("CAN2_TX", "hyperperiod"),
    ("EXTI1", "accelerometer's interrupt"),
    ("EXTI2", "magnetometer's interrupt"),
    ("I2C1_ER", "burst failed"),
    ("CAN1_RX1", "failsafe, late hyperperiod"),
    ("CAN2_RX0", "chips"),
    ("USART2", "link"),
    ("DMA1_STREAM5", "link"),
    ("DMA1_STREAM6", "link sent"),
    ("CAN1_RX0", "heartbeat"),
    ("TIM5", "clock"),
];
