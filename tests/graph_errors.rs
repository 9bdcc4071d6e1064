//! What the compiler says of a graph that is declared wrongly.
//!
//! Each file of `graph_errors/` stands beside what is expected of it. After a change on purpose,
//! `TRYBUILD=overwrite cargo test --test graph_errors` writes it anew.

#[test]
fn every_mistake_is_shown_at_its_line() {
    trybuild::TestCases::new().compile_fail("tests/graph_errors/*.rs");
}
