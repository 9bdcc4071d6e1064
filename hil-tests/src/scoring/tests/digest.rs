//! The digest of motor writes: its bytes, and that nothing escapes it.

use super::super::MotorDigest;
use proptest::prelude::*;

fn digest(writes: &[(u64, Vec<u16>)]) -> String {
    let mut digest = MotorDigest::new();
    for (at_ns, channels) in writes {
        digest.write(*at_ns, channels);
    }
    digest.hex()
}

#[test]
fn no_write_at_all_has_the_digest_of_nothing() {
    // FIPS 180-4, the empty message.
    let empty = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
    assert_eq!(digest(&[]), empty);
}

#[test]
fn writes_enter_as_time_count_and_values_little_endian() {
    // sha256 of 01 00*7, 02 00 00 00, 03 00 00 00, 00 04 00 00.
    let expected = "1edb0fe6d4ef15e2aaaf1dcc8ad21d0c311c7d7dc28218d1dc26dd3d2f3e72bb";
    assert_eq!(digest(&[(1, vec![3, 1024])]), expected);
}

#[test]
fn the_digest_can_be_read_while_it_grows() {
    let mut growing = MotorDigest::new();
    growing.write(1, &[1_u32]);
    let _ = growing.hex();
    growing.write(2, &[2_u32]);
    assert_eq!(growing.hex(), digest(&[(1, vec![1]), (2, vec![2])]));
}

#[test]
fn channels_do_not_run_into_the_next_write() {
    assert_ne!(
        digest(&[(1, vec![1, 2])]),
        digest(&[(1, vec![1]), (1, vec![2])])
    );
    assert_ne!(digest(&[(1, vec![])]), digest(&[]));
}

fn writes() -> impl Strategy<Value = Vec<(u64, Vec<u16>)>> {
    let write = (any::<u64>(), prop::collection::vec(any::<u16>(), 4));
    prop::collection::vec(write, 1..8)
}

proptest! {
    #[test]
    fn any_change_of_a_time_or_a_value_changes_it(
        writes in writes(),
        at in any::<prop::sample::Index>(),
        channel in 0..4_usize,
        by in 1..=u16::MAX,
    ) {
        let before = digest(&writes);
        prop_assert_eq!(&before, &digest(&writes));
        let at = at.index(writes.len());
        let mut late = writes.clone();
        late[at].0 ^= u64::from(by);
        prop_assert_ne!(&before, &digest(&late));
        let mut other = writes.clone();
        other[at].1[channel] ^= by;
        prop_assert_ne!(&before, &digest(&other));
        let mut fewer = writes.clone();
        fewer.remove(at);
        prop_assert_ne!(&before, &digest(&fewer));
    }

    #[test]
    fn the_order_of_different_writes_matters(one in any::<u64>(), other in any::<u64>()) {
        prop_assume!(one != other);
        let (one, other) = ((one, vec![1]), (other, vec![1]));
        prop_assert_ne!(digest(&[one.clone(), other.clone()]), digest(&[other, one]));
    }
}
