//! A closed set written once: the enum, `ALL`, its names, `Display` and `FromStr`.

/// Declares a closed set. Each member has a doc comment (also shown by `about()`) and the stable
/// name that files and the command line use.
///
/// ```
/// gnomon_core::catalogue! {
///     /// Sides of a coin.
///     pub enum Side {
///         /// The side with the head.
///         Heads = "heads",
///         /// The other side.
///         Tails = "tails",
///     }
/// }
/// assert_eq!(Side::ALL.len(), 2);
/// assert_eq!("tails".parse::<Side>().unwrap(), Side::Tails);
/// assert!("edge".parse::<Side>().unwrap_err().to_string().contains("heads, tails"));
/// ```
///
/// A set whose members are rows says all that is known of a member beside its name, and what follows
/// from a fact is derived from it: a fact that is missing does not compile.
///
/// ```
/// struct Facts { legs: u32 }
/// gnomon_core::catalogue! {
///     /// Animals.
///     pub enum Animal: Facts {
///         /// It sings.
///         Bird = "bird" => Facts { legs: 2 },
///         /// It spins.
///         Spider = "spider" => Facts { legs: 8 },
///     }
/// }
/// assert_eq!(Animal::Spider.row().legs, 8);
/// ```
#[macro_export]
macro_rules! catalogue {
    ($(#[$meta:meta])* pub enum $Set:ident: $Row:ty {
        $($(#[doc = $doc:literal])+ $Item:ident = $name:literal => $row:expr),+ $(,)?
    }) => {
        $crate::catalogue! {
            $(#[$meta])*
            pub enum $Set { $($(#[doc = $doc])+ $Item = $name),+ }
        }

        impl $Set {
            /// The member's row: every fact about it but its name.
            #[must_use]
            #[inline(always)]
            const fn row(self) -> &'static $Row {
                match self { $(Self::$Item => { const ROW: $Row = $row; &ROW }),+ }
            }
        }
    };
    ($(#[$meta:meta])* pub enum $Set:ident {
        $($(#[doc = $doc:literal])+ $Item:ident = $name:literal),+ $(,)?
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $Set { $($(#[doc = $doc])+ $Item),+ }

        impl $Set {
            /// Every member, in report order.
            pub const ALL: &'static [Self] = &[$(Self::$Item),+];

            /// The stable name used in files and on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$Item => $name),+ }
            }

            /// The first lines of the member's documentation.
            #[must_use]
            pub fn about(self) -> String {
                match self { $(Self::$Item => concat!($($doc, "\n"),+)),+ }
                    .lines().map(str::trim).collect::<Vec<_>>().join(" ").trim().to_string()
            }
        }

        impl std::fmt::Display for $Set {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $Set {
            type Err = $crate::Error;
            fn from_str(text: &str) -> $crate::Result<Self> {
                Self::ALL.iter().copied().find(|member| member.name() == text).ok_or_else(|| {
                    let names: Vec<_> = Self::ALL.iter().map(|m| m.name()).collect();
                    $crate::Error::bad_input(
                        format!("'{text}'"),
                        concat!("not a known ", stringify!($Set)),
                        format!("use one of {}", names.join(", ")),
                    )
                })
            }
        }

        impl serde::Serialize for $Set {
            fn serialize<S: serde::Serializer>(&self, s: S) -> std::result::Result<S::Ok, S::Error> {
                s.serialize_str(self.name())
            }
        }
    };
}
