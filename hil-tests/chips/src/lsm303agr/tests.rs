//! Both dies against their datasheet, each by its registers.

mod accelerometer;
mod high_pass;
mod magnetometer;
mod spi;
