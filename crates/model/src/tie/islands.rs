//! Bodies that are connected.

/// Numbers of the bodies that pairs connect with each other, each list ascending, by their first body. `None` in a pair is the
/// ground, which does not connect. Bodies in no pair are left out.
pub(crate) fn islands(bodies: usize, pairs: &[[Option<usize>; 2]]) -> Vec<Vec<usize>> {
    let mut island: Vec<usize> = (0..bodies).collect();
    let mut is_tied = vec![false; bodies];
    for pair in pairs {
        pair.iter().flatten().for_each(|body| is_tied[*body] = true);
        if let [Some(a), Some(b)] = *pair {
            let (a, b) = (island[a].min(island[b]), island[a].max(island[b]));
            island.iter_mut().filter(|number| **number == b).for_each(|number| *number = a);
        }
    }
    let of = |first: usize| (0..bodies).filter(|body| is_tied[*body] && island[*body] == first).collect::<Vec<usize>>();
    (0..bodies).map(of).filter(|members| !members.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ground_does_not_connect() {
        let pairs = [[Some(4), Some(1)], [Some(1), None], [Some(0), None], [Some(5), Some(4)]];
        assert_eq!(islands(6, &pairs), [vec![0], vec![1, 4, 5]]);
        assert!(islands(3, &[]).is_empty());
    }
}
