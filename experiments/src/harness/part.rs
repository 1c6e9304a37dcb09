//! One part of a study's cells, so that machines measure it together.

use std::str::FromStr;

/// One part of so many: cells are dealt out one by one, so that parts take about as long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    /// Number of the part, from 1.
    pub number: usize,
    /// How many parts there are.
    pub of: usize,
}

impl Share {
    /// Whether the cell of this number, from 0, is in the part.
    pub fn has(self, cell: usize) -> bool {
        cell % self.of == self.number - 1
    }

    /// As the command line writes it.
    pub fn words(self) -> String {
        format!("{}/{}", self.number, self.of)
    }
}

impl FromStr for Share {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parsed =
            text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
        match parsed {
            Some((number, of)) if (1..=of).contains(&number) && of <= 100_000 => Ok(Share { number, of }),
            _ => Err("allowed: a part such as 3/16, numbered from 1, of at most 100000".to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_is_in_one_part() {
        let parts: Vec<Share> = (1..=5).map(|n| format!("{n}/5").parse().unwrap()).collect();
        assert!((0..23).all(|cell| parts.iter().filter(|part| part.has(cell)).count() == 1));
        for bad in ["0/5", "6/5", "1", "a/b", "1/0", "-1/3", "1/1000000", ""] {
            assert!(bad.parse::<Share>().is_err(), "{bad}");
        }
        assert_eq!(parts[2].words(), "3/5");
    }
}
