//! Register addresses of the MPU6050, with the names of RM-MPU-6000A.

registers! { name:
    /// Divider of the sample rate, less one.
    SMPLRT_DIV = 0x19,
    /// Low-pass filter.
    CONFIG = 0x1A,
    /// Range of the gyro.
    GYRO_CONFIG = 0x1B,
    /// Range of the accelerometer and high-pass filter of the motion detector.
    ACCEL_CONFIG = 0x1C,
    /// Threshold of the motion detector.
    MOT_THR = 0x1F,
    /// Duration of the motion detector, in ms.
    MOT_DUR = 0x20,
    /// Level and hold of the INT pin.
    INT_PIN_CFG = 0x37,
    /// What drives the INT pin.
    INT_ENABLE = 0x38,
    /// What happened; reading it clears it.
    INT_STATUS = 0x3A,
    /// Resets of the signal paths.
    SIGNAL_PATH_RESET = 0x68,
    /// Counting of the motion detector.
    MOT_DETECT_CTRL = 0x69,
    /// Sleep and clock source.
    PWR_MGMT_1 = 0x6B,
    /// Standby per axis.
    PWR_MGMT_2 = 0x6C,
    /// Identity.
    WHO_AM_I = 0x75,
}
