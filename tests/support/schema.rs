//! The part of JSON Schema that the project's schemas use.
#![allow(clippy::wildcard_enum_match_arm, reason = "singles one member out")]

use serde_json::Value;

/// Every place where `value` breaks `schema`; `root` resolves `#/$defs/…`.
pub(crate) fn violations(root: &Value, schema: &Value, value: &Value, place: &str) -> Vec<String> {
    if let Some(reference) = schema["$ref"].as_str() {
        let target = root.pointer(reference.trim_start_matches('#')).expect("a defined reference");
        return violations(root, target, value, place);
    }
    let mut found = Vec::new();
    if !has_type(&schema["type"], value) {
        found.push(format!("{place}: {value} is no {}", schema["type"]));
    }
    if let Some(allowed) = schema["enum"].as_array()
        && !allowed.contains(value)
    {
        found.push(format!("{place}: {value} is none of {}", schema["enum"]));
    }
    if let (Some(low), Some(x)) = (schema["minimum"].as_f64(), value.as_f64())
        && x < low
    {
        found.push(format!("{place}: {x} is below {low}"));
    }
    if let (Some(high), Some(x)) = (schema["maximum"].as_f64(), value.as_f64())
        && x > high
    {
        found.push(format!("{place}: {x} is above {high}"));
    }
    for (i, item) in value.as_array().into_iter().flatten().enumerate() {
        if !schema["items"].is_null() {
            found.extend(violations(root, &schema["items"], item, &format!("{place}[{i}]")));
        }
    }
    let Some(members) = value.as_object() else { return found };
    for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
        if !members.contains_key(name) {
            found.push(format!("{place}: {name} is missing"));
        }
    }
    for (name, member) in members {
        let own = &schema["properties"][name.as_str()];
        let rule = if own.is_null() { &schema["additionalProperties"] } else { own };
        if rule.is_object() {
            found.extend(violations(root, rule, member, &format!("{place}.{name}")));
        }
    }
    found
}

fn has_type(types: &Value, value: &Value) -> bool {
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "null" => value.is_null(),
        other => panic!("the schema uses the unknown type {other}"),
    };
    match types {
        Value::Null => true,
        Value::String(name) => is(name),
        Value::Array(names) => names.iter().filter_map(Value::as_str).any(is),
        other => panic!("{other} is no type"),
    }
}
