//! Register addresses of the LSM303AGR, with the names of ST's driver.

registers! { accelerometer_name:
    /// Identity of the accelerometer.
    WHO_AM_I_A = 0x0F,
    /// Data rate, low-power bit, axes.
    CTRL_REG1_A = 0x20,
    /// High-pass filter.
    CTRL_REG2_A = 0x21,
    /// What drives the pin INT_1_XL.
    CTRL_REG3_A = 0x22,
    /// Block update, full scale, high resolution, SPI enable.
    CTRL_REG4_A = 0x23,
    /// Latch of the interrupt requests.
    CTRL_REG5_A = 0x24,
    /// Reading it resets the high-pass filter in mode 0.
    REFERENCE_A = 0x26,
    /// New data and overrun per axis.
    STATUS_REG_A = 0x27,
    /// First of six output bytes.
    OUT_X_L_A = 0x28,
    /// Which axes and events generator 1 compares.
    INT1_CFG_A = 0x30,
    /// What generator 1 found; reading it clears the latch.
    INT1_SRC_A = 0x31,
    /// Threshold of generator 1, 7 bits.
    INT1_THS_A = 0x32,
    /// Samples that generator 1 waits, 7 bits.
    INT1_DURATION_A = 0x33,
}

registers! { magnetometer_name:
    /// First of six bytes subtracted from the output.
    OFFSET_X_REG_L_M = 0x45,
    /// High byte of the X offset.
    OFFSET_X_REG_H_M = 0x46,
    /// Low byte of the Y offset.
    OFFSET_Y_REG_L_M = 0x47,
    /// High byte of the Y offset.
    OFFSET_Y_REG_H_M = 0x48,
    /// Low byte of the Z offset.
    OFFSET_Z_REG_L_M = 0x49,
    /// High byte of the Z offset.
    OFFSET_Z_REG_H_M = 0x4A,
    /// Identity of the magnetometer.
    WHO_AM_I_M = 0x4F,
    /// Mode, rate, temperature compensation.
    CFG_REG_A_M = 0x60,
    /// Filters, and what the comparator sees.
    CFG_REG_B_M = 0x61,
    /// Pin, interface, block update.
    CFG_REG_C_M = 0x62,
    /// Comparator of the magnetometer.
    INT_CTRL_REG_M = 0x63,
    /// What the comparator found; reading it clears the latch.
    INT_SOURCE_REG_M = 0x64,
    /// Low byte of the threshold.
    INT_THS_L_REG_M = 0x65,
    /// High byte of the threshold.
    INT_THS_H_REG_M = 0x66,
    /// New data and overrun per axis.
    STATUS_REG_M = 0x67,
    /// First of six output bytes.
    OUTX_L_REG_M = 0x68,
}
