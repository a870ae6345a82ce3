//! Reading of the recorded efficiencies of independent programs.

use goniochrome_waves::Complex64;
use goniochrome_waves::response::{Order, Response};
use serde_json::Value;

/// Contents of a file of `tests/data`.
pub fn read(name: &str) -> Value {
    let path = format!("{}/../../tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Number at a key.
pub fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} is no number in {value}"))
}

/// List at a key.
pub fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().unwrap_or_else(|| panic!("{key} is no list in {value}"))
}

/// Complex index written as `[n, k]`.
pub fn index(value: &Value) -> Complex64 {
    Complex64::new(value[0].as_f64().expect("n"), value[1].as_f64().expect("k"))
}

/// Largest difference of a response from the efficiencies that `record` has at the keys `orders_R`, `R_s`, `R_p`, and
/// those of T where it has them.
pub fn largest_difference(response: &Response, record: &Value) -> f64 {
    let mut largest = 0.0_f64;
    type Efficiency = fn(&Response, &Order) -> [f64; 2];
    let sides: [(&str, &[Order], Efficiency); 2] = [
        ("R", &response.reflected, Response::reflected_efficiency),
        ("T", &response.transmitted, Response::transmitted_efficiency),
    ];
    for (side, orders, efficiency) in sides {
        let Some(numbers) = record[format!("orders_{side}")].as_array() else { continue };
        for (i, m) in numbers.iter().enumerate() {
            let m = m.as_i64().expect("order");
            let order = orders.iter().find(|order| i64::from(order.index[0]) == m).expect("order is kept");
            let found = efficiency(response, order);
            for (found, polarisation) in found.iter().zip(["s", "p"]) {
                let expected = record[format!("{side}_{polarisation}")][i].as_f64().expect("efficiency");
                largest = largest.max((found - expected).abs());
            }
        }
    }
    largest
}
