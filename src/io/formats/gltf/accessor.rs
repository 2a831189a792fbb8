//! Numbers of accessors, checked against the bytes there are before anything is allocated for them.

use super::buffers::Buffers;
use super::document::{Accessor, Document, at};
use crate::io::columns::column::Scalar;
use crate::io::error::Fault;
use crate::io::options::ReadOptions;
use std::cell::Cell;

/// Data source of accessors.
pub(super) struct AccessorSource<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers<'a>,
    pub(super) options: &'a ReadOptions,
    /// Bytes read so far. A file may refer to the same numbers repeatedly: the memory limit also bounds the bytes read
    /// for one frame, and so the time for it.
    pub(super) spent_bytes: Cell<u64>,
}

/// Entries that lie at a distance from each other.
struct Entries<'a> {
    bytes: &'a [u8],
    stride: usize,
    scalar: Scalar,
    normalized: bool,
}

impl<'a> AccessorSource<'a> {
    /// Nothing is read yet.
    pub(super) fn new(document: &'a Document, buffers: &'a Buffers<'a>, options: &'a ReadOptions) -> Self {
        Self {
            document,
            buffers,
            options,
            spent_bytes: Cell::new(0),
        }
    }
}

impl AccessorSource<'_> {
    /// Fails if `bytes` and the bytes read before exceed the limit of one frame.
    pub(super) fn spend(&self, bytes: u64) -> Result<(), Fault> {
        let spent = self.spent_bytes.get().saturating_add(bytes);
        self.spent_bytes.set(spent);
        self.options.claim("the model", spent)
    }

    /// Number of entries that accessor `index` claims.
    pub(super) fn count(&self, index: usize) -> Result<usize, Fault> {
        Ok(at(&self.document.accessors, index, "accessor")?.count)
    }

    /// Entries of `N` numbers each.
    pub(super) fn read<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, Fault> {
        let accessor = at(&self.document.accessors, index, "accessor")?;
        if components(accessor, index)? != N {
            return Err(Fault::entry(
                "accessor",
                index,
                format!("its entries are {}, expected {N} numbers", accessor.r#type),
            ));
        }
        self.read_as(
            index,
            |entries, entry| {
                let mut values = [0.0; N];
                for (component, value) in values.iter_mut().enumerate() {
                    *value = entries.number(entry, component) as f32;
                }
                values
            },
            [0.0; N],
        )
    }

    /// Reads colours, with or without an alpha channel.
    pub(super) fn read_colors(&self, index: usize) -> Result<Vec<[f32; 4]>, Fault> {
        let accessor = at(&self.document.accessors, index, "accessor")?;
        if components(accessor, index)? == 4 {
            return self.read(index);
        }
        let colors: Vec<[f32; 3]> = self.read(index)?;
        Ok(colors
            .into_iter()
            .map(|[red, green, blue]| [red, green, blue, 1.0])
            .collect())
    }

    /// Whole numbers.
    pub(super) fn read_indices(&self, index: usize) -> Result<Vec<u32>, Fault> {
        let accessor = at(&self.document.accessors, index, "accessor")?;
        if components(accessor, index)? != 1 {
            return Err(Fault::entry(
                "accessor",
                index,
                format!("its entries are {}, expected single numbers", accessor.r#type),
            ));
        }
        self.read_as(index, |entries, entry| entries.number(entry, 0) as u32, 0)
    }

    /// Every number of the entries, each as a separate column.
    pub(super) fn read_columns(&self, index: usize) -> Result<Vec<Vec<f64>>, Fault> {
        let accessor = at(&self.document.accessors, index, "accessor")?;
        let columns = 0..components(accessor, index)?;
        let column = |component| self.read_as(index, |entries, entry| entries.number(entry, component), 0.0);
        columns.map(column).collect()
    }

    fn read_as<T: Clone>(
        &self,
        index: usize,
        read: impl Fn(&Entries<'_>, usize) -> T,
        zero: T,
    ) -> Result<Vec<T>, Fault> {
        let accessor = at(&self.document.accessors, index, "accessor")?;
        let components = components(accessor, index)?;
        let needed = (accessor.count as u64).saturating_mul(size_of::<T>() as u64);
        self.spend(needed)?;
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let entries = self.entries(
                    view,
                    accessor.byte_offset,
                    accessor.component_type,
                    accessor.normalized,
                    components,
                    accessor.count,
                    index,
                )?;
                (0..accessor.count).map(|entry| read(&entries, entry)).collect()
            }
            // Zeros, which the sparse entries below may override.
            None => vec![zero; accessor.count],
        };
        // The crate `gltf` 1.4 unwraps in sparse accessors, and subtracts from counts that may be zero.
        if let Some(sparse) = &accessor.sparse {
            let indices = &sparse.indices;
            let places = self.entries(
                indices.buffer_view,
                indices.byte_offset,
                indices.component_type,
                false,
                1,
                sparse.count,
                index,
            )?;
            let differing = self.entries(
                sparse.values.buffer_view,
                sparse.values.byte_offset,
                accessor.component_type,
                accessor.normalized,
                components,
                sparse.count,
                index,
            )?;
            for entry in 0..sparse.count {
                let place = places.number(entry, 0) as usize;
                *values.get_mut(place).ok_or_else(|| {
                    Fault::entry(
                        "accessor",
                        index,
                        format!("its sparse entry {place} is none of its {}", accessor.count),
                    )
                })? = read(&differing, entry);
            }
        }
        Ok(values)
    }

    #[expect(clippy::too_many_arguments, reason = "what an accessor says about its entries")]
    fn entries(
        &self,
        view: usize,
        offset: usize,
        component_type: u32,
        normalized: bool,
        components: usize,
        count: usize,
        accessor: usize,
    ) -> Result<Entries<'_>, Fault> {
        let scalar = match component_type {
            5120 => Scalar::I8,
            5121 => Scalar::U8,
            5122 => Scalar::I16,
            5123 => Scalar::U16,
            5125 => Scalar::U32,
            5126 => Scalar::F32,
            other => {
                return Err(Fault::entry(
                    "accessor",
                    accessor,
                    format!("component type {other} is unknown"),
                ));
            }
        };
        let bytes = self.buffers.view(self.document, view)?;
        let stride = self.document.buffer_views[view].byte_stride;
        let entry_bytes = components * scalar.byte_size();
        let stride = stride.filter(|&stride| stride > 0).unwrap_or(entry_bytes);
        let needed = match count {
            0 => Some(0),
            _ => (count - 1)
                .checked_mul(stride)
                .and_then(|bytes| bytes.checked_add(entry_bytes)),
        };
        let rest = bytes.get(offset..).unwrap_or_default();
        if needed.is_none_or(|needed| needed > rest.len()) {
            return Err(Fault::entry(
                "accessor",
                accessor,
                format!(
                    "its {count} entries of {entry_bytes} bytes go beyond the {} bytes of its view: the file is \
                     damaged",
                    bytes.len()
                ),
            ));
        }
        Ok(Entries {
            bytes: rest,
            stride,
            scalar,
            normalized,
        })
    }
}

impl Entries<'_> {
    /// Precondition: the entry is one of those that were checked.
    fn number(&self, entry: usize, component: usize) -> f64 {
        let at = entry * self.stride + component * self.scalar.byte_size();
        let number = self.scalar.read(&self.bytes[at..], false);
        let full_scale = match self.scalar {
            _ if !self.normalized => return number,
            Scalar::I8 => f64::from(i8::MAX),
            Scalar::U8 => f64::from(u8::MAX),
            Scalar::I16 => f64::from(i16::MAX),
            Scalar::U16 => f64::from(u16::MAX),
            _ => return number,
        };
        (number / full_scale).max(-1.0)
    }
}

fn components(accessor: &Accessor, index: usize) -> Result<usize, Fault> {
    // Matrices of bytes and shorts have padding, but none of those are read here.
    match accessor.r#type.as_str() {
        "SCALAR" => Ok(1),
        "VEC2" => Ok(2),
        "VEC3" => Ok(3),
        "VEC4" => Ok(4),
        "MAT4" => Ok(16),
        other => Err(Fault::entry(
            "accessor",
            index,
            format!("entries of type `{}` are not read", other.escape_default()),
        )),
    }
}
