//! Structs of settings: fields and declarations in one place.

use crate::choices::Choice;
use crate::inputs::Inputs;
use crate::setting::{Kind, Setting, Value};
use crate::time::{Duration, from_seconds, seconds};

/// A struct of settings, as [`declare!`](crate::declare) makes it.
pub trait Declared: Copy + PartialEq + 'static {
    /// The declarations, in the order of the fields.
    const SETTINGS: &'static [Setting];

    /// How many bytes [`Self::write`] makes.
    const LENGTH: usize;

    /// Each field's value as it is written, in the order of the fields.
    fn value(&self, place: usize) -> Option<Value>;

    /// With another value of one field.
    ///
    /// `None` where no field is in this place, or its value is of another kind. Ranges are not
    /// checked.
    #[must_use]
    fn with(self, place: usize, value: Value) -> Option<Self>;

    /// The struct of the values that are given for its declarations, as [`Self::with`].
    fn collect(value: &mut impl FnMut(&'static Setting) -> Option<Value>) -> Option<Self>;

    /// Hands every field's bytes on, in the order of the fields.
    fn write(&self, put: &mut dyn FnMut([u8; 4]));

    /// Reads what [`Self::write`] wrote; `None` where a number means nothing.
    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self>;

    /// All fields with their declarations, in order.
    fn values(&self) -> impl Iterator<Item = (&'static Setting, Value)> {
        let settings = Self::SETTINGS.iter().enumerate();
        settings.filter_map(|(place, setting)| Some((setting, self.value(place)?)))
    }

    /// Where a field's declaration is.
    fn place(name: &str) -> Option<usize> {
        Self::SETTINGS
            .iter()
            .position(|setting| setting.name == name)
    }
}

/// Declares a struct of settings: each field with its meaning, type and [`Setting`].
///
/// The comment above a field is its meaning, in one line.
#[macro_export]
macro_rules! declare {
    ($(#[$of:meta])* pub struct $name:ident {
        $(#[doc = $meaning:literal] $field:ident: $type:ty = $setting:expr,)*
    }) => {
        $(#[$of])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        pub struct $name {
            $(#[doc = $meaning] pub $field: $type,)*
        }

        impl $crate::Declared for $name {
            const SETTINGS: &'static [$crate::Setting] = &[
                $($setting.named(stringify!($field)).meaning($meaning.trim_ascii()),)*
            ];

            const LENGTH: usize = 0 $(+ <$type as $crate::Field>::LENGTH)*;

            fn value(&self, place: usize) -> Option<$crate::Value> {
                let kind = Self::SETTINGS.get(place)?.kind;
                let mut before = 0..place;
                $(if before.next().is_none() {
                    return Some($crate::Field::value(self.$field, kind));
                })*
                None
            }

            fn with(mut self, place: usize, value: $crate::Value) -> Option<Self> {
                let kind = Self::SETTINGS.get(place)?.kind;
                let mut before = 0..place;
                $(if before.next().is_none() {
                    self.$field = $crate::Field::from_value(value, kind)?;
                    return Some(self);
                })*
                None
            }

            fn collect(
                value: &mut impl FnMut(&'static $crate::Setting) -> Option<$crate::Value>,
            ) -> Option<Self> {
                let mut settings = Self::SETTINGS.iter();
                Some(Self {
                    $($field: {
                        let setting = settings.next()?;
                        $crate::Field::from_value(value(setting)?, setting.kind)?
                    },)*
                })
            }

            fn write(&self, put: &mut dyn FnMut([u8; 4])) {
                $($crate::Field::write(self.$field, put);)*
            }

            fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
                Some(Self { $($field: $crate::Field::read(take)?,)* })
            }
        }
    };
}

/// The type of a field: its value as it is written, and its bytes.
pub trait Field: Copy {
    /// How many bytes it takes.
    const LENGTH: usize = 4;

    /// The value in the unit of its declaration.
    fn value(self, kind: Kind) -> Value;

    /// The field of a value, `None` for a value of another kind.
    fn from_value(value: Value, kind: Kind) -> Option<Self>;

    /// Hands its bytes on.
    fn write(self, put: &mut dyn FnMut([u8; 4]));

    /// Reads them, `None` where there are none or they mean nothing.
    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self>;
}

impl Field for f32 {
    fn value(self, _: Kind) -> Value {
        Value::Number(self.into())
    }

    fn from_value(value: Value, _: Kind) -> Option<Self> {
        match value {
            Value::Number(number) => Some(number as f32),
            _ => None,
        }
    }

    fn write(self, put: &mut dyn FnMut([u8; 4])) {
        put(self.to_le_bytes());
    }

    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
        Some(Self::from_le_bytes(take()?))
    }
}

impl Field for [f32; 3] {
    const LENGTH: usize = 12;

    fn value(self, _: Kind) -> Value {
        Value::Axes(self.map(f64::from))
    }

    fn from_value(value: Value, _: Kind) -> Option<Self> {
        match value {
            Value::Axes(numbers) => Some(numbers.map(|number| number as f32)),
            _ => None,
        }
    }

    fn write(self, put: &mut dyn FnMut([u8; 4])) {
        for number in self {
            number.write(put);
        }
    }

    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
        Some([f32::read(take)?, f32::read(take)?, f32::read(take)?])
    }
}

impl Field for u32 {
    fn value(self, _: Kind) -> Value {
        Value::Number(self.into())
    }

    fn from_value(value: Value, _: Kind) -> Option<Self> {
        match value {
            Value::Number(number) => Some(number as Self),
            _ => None,
        }
    }

    fn write(self, put: &mut dyn FnMut([u8; 4])) {
        put(self.to_le_bytes());
    }

    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
        Some(Self::from_le_bytes(take()?))
    }
}

impl Field for Duration {
    fn value(self, kind: Kind) -> Value {
        Value::Number(match kind {
            Kind::Rate(_) => 1.0 / seconds(self),
            _ => seconds(self),
        })
    }

    fn from_value(value: Value, kind: Kind) -> Option<Self> {
        match (value, kind) {
            (Value::Number(rate), Kind::Rate(_)) => Some(from_seconds(1.0 / rate)),
            (Value::Number(seconds), _) => Some(from_seconds(seconds)),
            _ => None,
        }
    }

    fn write(self, put: &mut dyn FnMut([u8; 4])) {
        (self.ticks() as u32).write(put);
    }

    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
        Some(Self::from_ticks(u32::read(take)?.into()))
    }
}

impl Field for Inputs {
    fn value(self, _: Kind) -> Value {
        Value::Inputs(self)
    }

    fn from_value(value: Value, _: Kind) -> Option<Self> {
        match value {
            Value::Inputs(inputs) => Some(inputs),
            _ => None,
        }
    }

    fn write(self, put: &mut dyn FnMut([u8; 4])) {
        u32::from(self.bits()).write(put);
    }

    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
        let bits = u32::read(take)?.try_into().ok()?;
        // Where a bit belongs to no input, another version wrote the block, or somebody made a mistake.
        Some(Self::from_bits(bits)).filter(|inputs| inputs.bits() == bits)
    }
}

impl<T: Choice> Field for T {
    fn value(self, _: Kind) -> Value {
        Value::Word(self.number())
    }

    fn from_value(value: Value, _: Kind) -> Option<Self> {
        match value {
            Value::Word(number) => T::from_number(number),
            _ => None,
        }
    }

    fn write(self, put: &mut dyn FnMut([u8; 4])) {
        self.number().write(put);
    }

    fn read(take: &mut impl FnMut() -> Option<[u8; 4]>) -> Option<Self> {
        T::from_number(u32::read(take)?)
    }
}
