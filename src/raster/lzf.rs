//! LZF, as the Point Cloud Library packs images and clouds with it.

use crate::memory;

/// The bytes of an LZF block that claims to have `claimed_bytes` of them. Precondition: there is memory for them.
pub(crate) fn unpack_lzf(packed: &[u8], claimed_bytes: usize) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    memory::try_reserve(&mut bytes, claimed_bytes).map_err(|error| error.to_string())?;
    bytes.resize(claimed_bytes, 0);
    let count = lzf_rust::decompress(packed, &mut bytes).map_err(|error| error.to_string())?;
    bytes.truncate(count);
    Ok(bytes)
}
