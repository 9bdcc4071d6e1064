//! The frames that the drone sends: heartbeat, answers to commands, and notices.

use super::{Answer, COMPONENT, Notice, Peer, SYSTEM};
use mavlink::consts::v2::{IFLAG_SIGNED, SIGNATURE_SIZE};
use mavlink::dialects::common::{
    COMMAND_ACK_DATA, HEARTBEAT_DATA, MavAutopilot, MavModeFlag, MavResult, MavState, MavType,
    STATUSTEXT_DATA,
};
use mavlink::utils::remove_trailing_zeroes;
use mavlink::{MAV_STX_V2, MavlinkVersion, MessageData, calculate_crc};

/// Length of the longest frame sent, in bytes: a STATUSTEXT, signed.
pub const LONGEST_FRAME_OUT: usize = 12 + STATUSTEXT_LENGTH + SIGNATURE_SIZE;

/// STATUSTEXT without its extensions, which number the pieces of longer texts.
const STATUSTEXT_LENGTH: usize = 1 + Notice::LONGEST;

/// COMMAND_ACK with its extensions `progress`, `result_param2`, target system and component.
const COMMAND_ACK_LENGTH: usize = 10;

/// An encoded frame, ready to be sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    bytes: heapless::Vec<u8, LONGEST_FRAME_OUT>,
    /// The byte that ties the checksum to the message's layout.
    extra: u8,
}

impl Frame {
    /// The bytes to send, 13 to [`LONGEST_FRAME_OUT`] of them.
    #[must_use]
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Says in the header that a signature follows; the checksum is made anew.
    pub(super) fn mark_signed(&mut self) {
        if let Some(flags) = self.bytes.get_mut(2) {
            *flags |= IFLAG_SIGNED;
        }
        self.bytes.truncate(self.bytes.len().saturating_sub(2));
        self.seal();
    }

    /// Adds a piece of the signature.
    pub(super) fn append(&mut self, piece: &[u8]) {
        // All of it fits: LONGEST_FRAME_OUT is the longest that is ever built.
        let _ = self.bytes.extend_from_slice(piece);
    }

    /// Ends header and payload with their checksum.
    fn seal(&mut self) {
        let checksum = calculate_crc(self.bytes.get(1..).unwrap_or_default(), self.extra);
        self.append(&checksum.to_le_bytes());
    }
}

/// What the drone says about itself (MAV_STATE in HEARTBEAT).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Status {
    /// Measuring its sensors' biases: not ready to arm.
    Calibrating,
    /// Ready to arm.
    Standby,
    /// Armed, motors may turn.
    Active,
    /// Flying with something lost, control still holds.
    Critical,
    /// Control is lost.
    Emergency,
}

/// Encodes frames and numbers them.
pub struct Sender {
    sequence: u8,
    kind: MavType,
}

impl Sender {
    /// A sender for a drone with so many motors; its first frame is number 0.
    ///
    /// HEARTBEAT names quadrotors, hexarotors and octorotors; others are generic multirotors.
    #[must_use]
    pub const fn new(motors: usize) -> Self {
        let kind = match motors {
            4 => MavType::MAV_TYPE_QUADROTOR,
            6 => MavType::MAV_TYPE_HEXAROTOR,
            8 => MavType::MAV_TYPE_OCTOROTOR,
            _ => MavType::MAV_TYPE_GENERIC_MULTIROTOR,
        };
        Self { sequence: 0, kind }
    }

    /// HEARTBEAT, customarily sent once per second.
    pub fn heartbeat(&mut self, armed: bool, status: Status) -> Frame {
        let heartbeat = HEARTBEAT_DATA {
            mavtype: self.kind,
            autopilot: MavAutopilot::MAV_AUTOPILOT_GENERIC,
            base_mode: if armed {
                MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED
            } else {
                MavModeFlag::empty()
            },
            system_status: match status {
                Status::Calibrating => MavState::MAV_STATE_CALIBRATING,
                Status::Standby => MavState::MAV_STATE_STANDBY,
                Status::Active => MavState::MAV_STATE_ACTIVE,
                Status::Critical => MavState::MAV_STATE_CRITICAL,
                Status::Emergency => MavState::MAV_STATE_EMERGENCY,
            },
            ..HEARTBEAT_DATA::DEFAULT
        };
        let mut payload = [0; HEARTBEAT_DATA::ENCODED_LEN];
        heartbeat.ser(MavlinkVersion::V2, &mut payload);
        self.frame(HEARTBEAT_DATA::ID, HEARTBEAT_DATA::EXTRA_CRC, &payload)
    }

    /// COMMAND_ACK: the answer to `command` (MAV_CMD) of the peer `to`.
    ///
    /// Written field by field: the crate's structure holds only commands that it knows, and
    /// not the extensions that routers need to find the peer.
    pub fn command_ack(&mut self, to: Peer, command: u16, answer: Answer) -> Frame {
        let result = match answer {
            Answer::Accepted => MavResult::MAV_RESULT_ACCEPTED,
            Answer::TemporarilyRejected => MavResult::MAV_RESULT_TEMPORARILY_REJECTED,
            Answer::Denied => MavResult::MAV_RESULT_DENIED,
            Answer::Unsupported => MavResult::MAV_RESULT_UNSUPPORTED,
        };
        let [low, high] = command.to_le_bytes();
        let payload: [u8; COMMAND_ACK_LENGTH] = [
            low,
            high,
            result as u8,
            0,
            0,
            0,
            0,
            0,
            to.system,
            to.component,
        ];
        self.frame(COMMAND_ACK_DATA::ID, COMMAND_ACK_DATA::EXTRA_CRC, &payload)
    }

    /// STATUSTEXT: tells every station what happened.
    pub fn notice(&mut self, notice: &Notice) -> Frame {
        let mut payload = [0; STATUSTEXT_LENGTH];
        let fields = [notice.severity() as u8].into_iter().chain(notice.line());
        for (field, value) in payload.iter_mut().zip(fields) {
            *field = value;
        }
        self.frame(STATUSTEXT_DATA::ID, STATUSTEXT_DATA::EXTRA_CRC, &payload)
    }

    /// Header, payload without its trailing zeros, checksum.
    fn frame(&mut self, id: u32, extra: u8, payload: &[u8]) -> Frame {
        let length = remove_trailing_zeroes(payload);
        let payload = payload.get(..length).unwrap_or_default();
        let [low, middle, high, _] = id.to_le_bytes();
        let header = [
            MAV_STX_V2,
            // At most LONGEST_FRAME_OUT.
            length as u8,
            0,
            0,
            self.sequence,
            SYSTEM,
            COMPONENT,
            low,
            middle,
            high,
        ];
        self.sequence = self.sequence.wrapping_add(1);
        let bytes = heapless::Vec::new();
        let mut frame = Frame { bytes, extra };
        frame.append(&header);
        frame.append(payload);
        frame.seal();
        frame
    }
}
