//! The data of a page, read back.

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::GzDecoder;
use serde_json::Value;

/// The data of a page as a browser would read them.
pub fn data(page: &str) -> Value {
    let (_, rest) = page.split_once("<script type=\"application/json\" id=\"data\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// The bytes of a list of numbers: differences to the number a stride before, bytes of the same place beside each other.
pub fn bytes(numbers: &Value) -> Vec<u8> {
    let mut planes = Vec::new();
    let packed = STANDARD.decode(numbers["packed"].as_str().unwrap()).unwrap();
    GzDecoder::new(&packed[..]).read_to_end(&mut planes).unwrap();
    let size = match numbers["type"].as_str().unwrap() {
        "f64" => 8,
        "f32" | "u32" => 4,
        _ => 2,
    };
    let (count, stride) = (planes.len() / size, numbers["stride"].as_u64().unwrap() as usize);
    let mut values: Vec<u64> = Vec::with_capacity(count);
    for i in 0..count {
        let difference: u64 = (0..size).map(|byte| u64::from(planes[byte * count + i]) << (8 * byte)).sum();
        values.push(difference.wrapping_add(i.checked_sub(stride).map_or(0, |before| values[before])));
    }
    values.iter().flat_map(|value| value.to_le_bytes()[..size].to_vec()).collect()
}
