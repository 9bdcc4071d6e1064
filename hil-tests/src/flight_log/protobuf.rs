//! Topics as protobuf messages, which the log describes to those who read it.
//!
//! Foxglove's own schemas are for poses and scenes, east, north, up. These topics are plain numbers:
//! plots and tables show them by the names of their fields.

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto,
    FileDescriptorProto, FileDescriptorSet,
};

use super::topics::{Field, Kind, Topic};

const PACKAGE: &str = "reflex";
/// The message for lines of the log, and its one field.
const LINE: &str = "Line";
const TEXT: &str = "text";

/// What a schema of MCAP holds: all messages, the same for every topic.
pub(super) fn described() -> Vec<u8> {
    let file = vec![file()];
    FileDescriptorSet { file }.encode_to_vec()
}

/// The full name of a topic's message.
pub(super) fn full_name(topic: Topic) -> String {
    format!("{PACKAGE}.{}", name(topic))
}

/// The full name of the message for lines of the log.
pub(super) fn line_name() -> String {
    format!("{PACKAGE}.{LINE}")
}

/// The bytes of a row whose fields are of these kinds.
pub(super) fn row(kinds: &[Kind], mut numbers: &[f32]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (kind, number) in kinds.iter().zip(1..) {
        let (own, rest) = numbers.split_at(kind.width());
        numbers = rest;
        match kind {
            Kind::Number => put_float(&mut bytes, number, own[0]),
            Kind::Flag | Kind::Choice(_) => {
                put_key(&mut bytes, number, WireType::Varint);
                put_varint(&mut bytes, own[0] as u32);
            }
            Kind::Vector | Kind::Quaternion => {
                let mut axes = Vec::new();
                for (axis, number) in own.iter().zip(1..) {
                    put_float(&mut axes, number, *axis);
                }
                put_bytes(&mut bytes, number, &axes);
            }
            // Packed, as repeated numbers are by default.
            Kind::Motors => {
                let motors = own.iter().filter(|share| !share.is_nan());
                let packed: Vec<u8> = motors.flat_map(|share| share.to_le_bytes()).collect();
                put_bytes(&mut bytes, number, &packed);
            }
        }
    }
    bytes
}

/// The bytes of a line of the log.
pub(super) fn line(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    put_bytes(&mut bytes, 1, text.as_bytes());
    bytes
}

/// How protobuf writes a value: the low bits of its key.
#[derive(Clone, Copy)]
enum WireType {
    Varint = 0,
    Length = 2,
    FourBytes = 5,
}

fn put_key(bytes: &mut Vec<u8>, number: u32, wire: WireType) {
    put_varint(bytes, number << 3 | wire as u32);
}

/// Seven bits a byte, the lowest first; the eighth says that more follow.
fn put_varint(bytes: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

fn put_float(bytes: &mut Vec<u8>, number: u32, float: f32) {
    put_key(bytes, number, WireType::FourBytes);
    bytes.extend(float.to_le_bytes());
}

fn put_bytes(bytes: &mut Vec<u8>, number: u32, content: &[u8]) {
    put_key(bytes, number, WireType::Length);
    put_varint(bytes, content.len() as u32);
    bytes.extend(content);
}

/// The name of a topic's message: `sensors/imu` is `SensorsImu`.
fn name(topic: Topic) -> String {
    let words = topic.name().split('/');
    words
        .flat_map(|word| {
            let (first, rest) = word.split_at(1);
            [first.to_uppercase(), rest.to_owned()]
        })
        .collect()
}

fn file() -> FileDescriptorProto {
    let axes = |name: &str, axes: &[&str]| {
        let fields = axes.iter().zip(1..);
        DescriptorProto {
            name: Some(name.to_owned()),
            field: fields
                .map(|(axis, number)| field(axis, number, Type::Float))
                .collect(),
            ..DescriptorProto::default()
        }
    };
    let line = DescriptorProto {
        name: Some(LINE.to_owned()),
        field: vec![field(TEXT, 1, Type::String)],
        ..DescriptorProto::default()
    };
    let shared = [
        axes("Vector", &["x", "y", "z"]),
        axes("Quaternion", &["w", "x", "y", "z"]),
        line,
    ];
    FileDescriptorProto {
        name: Some("reflex/flight_log.proto".to_owned()),
        package: Some(PACKAGE.to_owned()),
        message_type: shared.into_iter().chain(Topic::ALL.map(message)).collect(),
        syntax: Some("proto3".to_owned()),
        ..FileDescriptorProto::default()
    }
}

fn message(topic: Topic) -> DescriptorProto {
    let own = name(topic);
    let fields = topic.fields();
    DescriptorProto {
        enum_type: fields.iter().filter_map(choice).collect(),
        field: (fields.iter().zip(1..))
            .map(|(declared, number)| field_of(&own, declared, number))
            .collect(),
        name: Some(own),
        ..DescriptorProto::default()
    }
}

fn field(name: &str, number: i32, of: Type) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        label: Some(Label::Optional as i32),
        r#type: Some(of as i32),
        ..FieldDescriptorProto::default()
    }
}

fn field_of(message: &str, declared: &Field, number: i32) -> FieldDescriptorProto {
    let of_type = |of| field(&declared.name, number, of);
    let named = |of, name: &str| FieldDescriptorProto {
        type_name: Some(format!(".{PACKAGE}.{name}")),
        ..of_type(of)
    };
    match &declared.kind {
        Kind::Number => of_type(Type::Float),
        Kind::Flag => of_type(Type::Bool),
        Kind::Choice(_) => named(Type::Enum, &format!("{message}.{}", enum_name(declared))),
        Kind::Vector => named(Type::Message, "Vector"),
        Kind::Quaternion => named(Type::Message, "Quaternion"),
        Kind::Motors => FieldDescriptorProto {
            label: Some(Label::Repeated as i32),
            ..of_type(Type::Float)
        },
    }
}

/// The enum of a field: no field has that name.
fn enum_name(field: &Field) -> String {
    format!("{}_choice", field.name)
}

/// The enum of a choice. Names of values hold for the whole message, hence the field's before them.
fn choice(field: &Field) -> Option<EnumDescriptorProto> {
    let Kind::Choice(names) = &field.kind else {
        return None;
    };
    let value = |(name, number): (&String, i32)| EnumValueDescriptorProto {
        name: Some(format!("{}_{name}", field.name)),
        number: Some(number),
        ..EnumValueDescriptorProto::default()
    };
    Some(EnumDescriptorProto {
        name: Some(enum_name(field)),
        value: names.iter().zip(0..).map(value).collect(),
        ..EnumDescriptorProto::default()
    })
}
