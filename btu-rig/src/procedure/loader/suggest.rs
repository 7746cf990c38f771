//! Suggests known names that are close to a misspelt one.

/// The end of a message: `; did you mean X?` if a candidate is near, else the candidates if they
/// are few, else nothing.
pub(super) fn hint<'a>(wrong: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    match near(wrong, candidates.iter().copied()) {
        near if !near.is_empty() => near,
        _ if !candidates.is_empty() && candidates.len() <= 12 => {
            format!("; possible: {}", candidates.join(", "))
        }
        _ => String::new(),
    }
}

/// Suggests the nearest candidate; empty where none is near.
pub(super) fn near<'a>(wrong: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    let candidates = candidates.into_iter();
    let all = candidates.map(|name| (strsim::osa_distance(wrong, name), name));
    all.min()
        .filter(|(distance, _)| *distance <= (wrong.chars().count() / 3).max(2))
        .map_or_else(String::new, |(_, name)| format!("; did you mean `{name}`?"))
}

#[cfg(test)]
mod tests {
    use super::hint;

    #[test]
    fn near_names_are_offered_and_short_lists_shown() {
        let few = ["eb", "fsb", "speed"];
        assert_eq!(hint("sped", few), "; did you mean `speed`?");
        assert_eq!(hint("altogether", few), "; possible: eb, fsb, speed");
        assert_eq!(hint("x", []), "");
    }
}
