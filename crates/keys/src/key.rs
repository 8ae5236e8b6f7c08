//! Keys of named, versioned data.
//!
//! A key is a hash of names and numbers that the code writes down, not of what a type looks like: a field that gets another
//! name, or another place in its type, changes no key. Who changes what a name means raises the version beside it.

use faer::{Mat, MatRef};
use nalgebra::{Matrix3, Vector3};

use crate::hash::{Digest, Hash};

/// A key in the making.
#[derive(Debug, Clone, Default)]
pub struct Key(Digest);

/// Data that keys are made of.
///
/// The names and the version of a type say which parts follow, so that different data of one type never write the same.
pub trait Keyed {
    /// The key with this data.
    #[must_use]
    fn key(&self, key: Key) -> Key;
}

impl Key {
    /// The key of nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// With the name and the version of what follows: of a type, or of a question.
    #[must_use]
    pub fn of(self, name: &str, version: u32) -> Self {
        Self(self.0.text(name).numbers(&[version]))
    }

    /// With a named part.
    #[must_use]
    pub fn with<T: Keyed + ?Sized>(self, name: &str, part: &T) -> Self {
        part.key(Self(self.0.text(name)))
    }

    /// Its hash.
    pub fn finish(self) -> Hash {
        self.0.finish()
    }
}

/// Lists of plain numbers are written at once, with their length.
macro_rules! plain {
    ($($number:ty),*) => {$(
        impl Keyed for $number {
            fn key(&self, key: Key) -> Key {
                Key(key.0.numbers(&[*self]))
            }
        }
        impl Keyed for [$number] {
            fn key(&self, key: Key) -> Key {
                Key(key.0.numbers(self))
            }
        }
        impl Keyed for Vec<$number> {
            fn key(&self, key: Key) -> Key {
                self.as_slice().key(key)
            }
        }
        impl<const N: usize> Keyed for [$number; N] {
            fn key(&self, key: Key) -> Key {
                self.as_slice().key(key)
            }
        }
    )*};
}

plain!(f64, u64, u32, usize);

impl Keyed for bool {
    fn key(&self, key: Key) -> Key {
        u32::from(*self).key(key)
    }
}

impl Keyed for str {
    fn key(&self, key: Key) -> Key {
        Key(key.0.text(self))
    }
}

impl Keyed for Hash {
    fn key(&self, key: Key) -> Key {
        Key(key.0.hash(self))
    }
}

impl<T: Keyed> Keyed for Option<T> {
    fn key(&self, key: Key) -> Key {
        self.iter().fold(self.is_some().key(key), |key, value| value.key(key))
    }
}

impl<T: Keyed + ?Sized> Keyed for &T {
    fn key(&self, key: Key) -> Key {
        (*self).key(key)
    }
}

/// Lists of what is no plain number.
macro_rules! lists {
    ($($entry:ty),*) => {$(
        impl Keyed for [$entry] {
            fn key(&self, key: Key) -> Key {
                self.iter().fold(self.len().key(key), |key, entry| entry.key(key))
            }
        }
    )*};
}

lists!(Vector3<f64>, Mat<f64>, Vec<f64>, [usize; 2], [usize; 4]);

impl Keyed for Vector3<f64> {
    fn key(&self, key: Key) -> Key {
        self.as_slice().key(key)
    }
}

impl Keyed for Matrix3<f64> {
    fn key(&self, key: Key) -> Key {
        self.as_slice().key(key)
    }
}

/// Rows and columns, then column by column.
impl Keyed for MatRef<'_, f64> {
    fn key(&self, key: Key) -> Key {
        self.col_iter().fold([self.nrows(), self.ncols()].key(key), |key, column| match column.try_as_col_major() {
            Some(column) => column.as_slice().key(key),
            None => column.iter().copied().collect::<Vec<f64>>().key(key),
        })
    }
}

impl Keyed for Mat<f64> {
    fn key(&self, key: Key) -> Key {
        self.as_ref().key(key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same data under other names of the language.
    struct Old {
        place: [f64; 2],
        strength: f64,
    }

    struct New {
        size: f64,
        at: Vec<f64>,
    }

    impl Keyed for Old {
        fn key(&self, key: Key) -> Key {
            key.of("force", 1).with("at", &self.place).with("size", &self.strength)
        }
    }

    impl Keyed for New {
        fn key(&self, key: Key) -> Key {
            key.of("force", 1).with("at", &self.at).with("size", &self.size)
        }
    }

    /// Regression only: the key of earlier versions: files of users have it.
    const KNOWN: &str = "d982656243773519f1a6600ec89ba05ca3f2c076195bf3a8c3bc9ba14106c621";

    #[test]
    fn other_names_in_the_program_give_the_same_key() {
        let old = Old { place: [1.0, -2.5], strength: 3.0 }.key(Key::new()).finish();
        let new = New { size: 3.0, at: vec![1.0, -2.5] }.key(Key::new()).finish();
        assert_eq!(old, new);
        assert_eq!(old.to_string(), KNOWN);
    }

    #[test]
    fn other_data_names_or_versions_give_other_keys() {
        let key =
            |name: &str, version, part: &str, number: f64| Key::new().of(name, version).with(part, &number).finish();
        let one = key("force", 1, "size", 0.0);
        for other in [
            key("forces", 1, "size", 0.0),
            key("force", 2, "size", 0.0),
            key("force", 1, "sizes", 0.0),
            key("force", 1, "size", -0.0),
        ] {
            assert_ne!(other, one);
        }
        let list = |list: &[f64], rest: &[f64]| Key::new().with("list", list).with("rest", rest).finish();
        assert_ne!(list(&[1.0, 2.0], &[]), list(&[1.0], &[2.0]));
        let matrix = |rows, columns| Key::new().with("matrix", &Mat::<f64>::zeros(rows, columns)).finish();
        assert_ne!(matrix(2, 3), matrix(3, 2));
        assert_ne!(Key::new().with("a", &Some(0.0)).finish(), Key::new().with("a", &None::<f64>).finish());
    }
}
