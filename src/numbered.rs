//! Enums whose values have numbers, for records and tables of counts.

/// Declares an enum together with the number of each value, and the way back.
///
/// A variant `Variant(Type in LIST)` has a number for each value of the list.
macro_rules! numbered {
    ($(#[$doc:meta])* $name:ident {
        $($(#[$variant_doc:meta])* $variant:ident $(($of:ident in $list:expr))?,)*
    }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(target_os = "none", derive(defmt::Format))]
        pub enum $name { $($(#[$variant_doc])* $variant $(($of))?,)* }

        impl $name {
            /// All of them, in the order of their numbers.
            #[allow(clippy::indexing_slicing, reason = "the compiler evaluates it")]
            pub const ALL: [Self; Self::COUNT] = {
                let firsts = [$($crate::numbered::numbered!(@value $variant $(, $list[0])?)),*];
                let mut all = [firsts[0]; Self::COUNT];
                let mut number = 0;
                $(
                    let mut place = 0;
                    while place < $crate::numbered::numbered!(@count $($list)?) {
                        all[number] =
                            $crate::numbered::numbered!(@value $variant $(, $list[place])?);
                        number += 1;
                        place += 1;
                    }
                )*
                all
            };

            /// How many there are.
            pub const COUNT: usize = 0 $(+ $crate::numbered::numbered!(@count $($list)?))*;

            /// The one of a number, `None` past the last.
            #[must_use]
            pub fn from_number(number: u8) -> Option<Self> {
                Self::ALL.get(usize::from(number)).copied()
            }

            /// Its number.
            #[must_use]
            pub fn number(self) -> u8 {
                let before = Self::ALL.iter().take_while(|other| **other != self);
                before.count() as u8
            }
        }
    };
    (@count) => { 1 };
    (@count $list:expr) => { $list.len() };
    (@value $variant:ident) => { Self::$variant };
    (@value $variant:ident, $value:expr) => { Self::$variant($value) };
}

pub(crate) use numbered;
